#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dcem/em/medium/path_loss.hpp"

namespace test_path_loss {

using namespace dcem;

namespace {
struct NoModel {};
static_assert(!PathLossModel<NoModel>);

const double lengths_m[] = {1e-3, 0.5, 1.0, 1.5, 17.3, 100.0, 12345.6};
}  // namespace

TEST_CASE("Friis by hand: 32.448 dB at 1 GHz and 1 m, 20 dB per decade") {
  // 4π·1e9/299792458 = 41.916900; 20·log10 = 32.44778.
  CHECK(free_space_path_loss_db(1.0, 1e9) == doctest::Approx(32.44778).epsilon(1e-6));
  CHECK(free_space_path_loss_db(10.0, 1e9) - free_space_path_loss_db(1.0, 1e9) == doctest::Approx(20.0).epsilon(1e-14));
  CHECK(free_space_path_loss_db(1.0, 30e9) - free_space_path_loss_db(1.0, 3e9) == doctest::Approx(20.0).epsilon(1e-14));
}

TEST_CASE("close-in with n = 2 and no attenuation is Friis bit for bit") {
  const AnyPathLoss any{CloseIn{2.0, 0.0}};
  for (const double length_m : lengths_m) {
    CHECK(CloseIn{}.excess_amplitude(length_m) == 1.0);
    CHECK(FreeSpace{}.excess_amplitude(length_m) == 1.0);
    CHECK(any.excess_amplitude(length_m) == 1.0);
    CHECK(close_in_path_loss_db(CloseIn{}, length_m, 30e9) == free_space_path_loss_db(length_m, 30e9));
  }
}

TEST_CASE("close-in: FSPL(1 m) + 10 n log10 L + α L, on the total length") {
  const CloseIn model{3.2, 0.01};
  for (const double length_m : {1.0, 10.0, 250.0}) {
    const double expected = free_space_path_loss_db(1.0, 28e9) + 32.0 * std::log10(length_m) + 0.01 * length_m;
    // Sums of numbers near 200 dB.
    CHECK(close_in_path_loss_db(model, length_m, 28e9) == doctest::Approx(expected).epsilon(1e-14));
  }
  // n = 3 over n = 2 at 100 m: 20 dB more, a tenth of the field.
  CHECK(CloseIn{3.0, 0.0}.excess_amplitude(100.0) == doctest::Approx(0.1).epsilon(1e-14).scale(0.0));
  CHECK(CloseIn{1.0, 0.0}.excess_amplitude(100.0) == doctest::Approx(10.0).epsilon(1e-14));
  CHECK(AnyPathLoss{model}.excess_amplitude(250.0) == model.excess_amplitude(250.0));
}

TEST_CASE("below one metre the exponent adds nothing, the attenuation does, and 1 m is continuous") {
  const CloseIn model{4.0, 0.0};
  CHECK(model.excess_amplitude(0.999) == 1.0);
  CHECK(model.excess_amplitude(1e-9) == 1.0);
  CHECK(model.excess_amplitude(0.0) == 1.0);
  CHECK(model.excess_amplitude(1.0) == 1.0);
  CHECK(model.excess_amplitude(1.001) < 1.0);
  CHECK(CloseIn{4.0, 40.0}.excess_amplitude(0.5) == doctest::Approx(0.1).epsilon(1e-14).scale(0.0));  // 20 dB
}

TEST_CASE("no NaN out of the models, and bad values are refused") {
  for (const double length_m : {0.0, 1.0, 1e300})
    for (const double exponent : {1e-300, 2.0, 1e300, std::numeric_limits<double>::max()})
      for (const double attenuation : {0.0, 1.0, 1e300})
        CHECK_FALSE(std::isnan(CloseIn{exponent, attenuation}.excess_amplitude(length_m)));
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_NOTHROW(validate(CloseIn{3.2, 0.01}));
  for (const double bad : {0.0, -2.0, infinity, std::nan("")})
    CHECK_THROWS_AS(validate(CloseIn{bad, 0.0}), std::invalid_argument);
  for (const double bad : {-0.1, infinity, std::nan("")})
    CHECK_THROWS_AS(validate(CloseIn{2.0, bad}), std::invalid_argument);
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    CHECK_THROWS_AS(free_space_path_loss_db(bad, 1e9), std::invalid_argument);
    CHECK_THROWS_AS(free_space_path_loss_db(1.0, bad), std::invalid_argument);
  }
}

}  // namespace test_path_loss
