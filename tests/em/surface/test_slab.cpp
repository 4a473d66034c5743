#include <doctest/doctest.h>

#include <limits>

#include "dcem/core/constants.hpp"
#include "dcem/em/surface/slab.hpp"
#include "tests/reference/em_reference.hpp"

namespace test_slab {

using namespace dcem;

namespace {

// Roundings of a dozen operations on numbers of order one.
constexpr double rounding = 1e-14;

bool finite(const SurfaceResponse& response) {
  return is_finite(response.reflection.te) && is_finite(response.reflection.tm) &&
         is_finite(response.transmission.te) && is_finite(response.transmission.tm);
}

double power_te(const SurfaceResponse& response) {
  return std::norm(response.reflection.te) + std::norm(response.transmission.te);
}
double power_tm(const SurfaceResponse& response) {
  return std::norm(response.reflection.tm) + std::norm(response.transmission.tm);
}

}  // namespace

TEST_CASE("slab: the chain matrix of a transmission line, in 50 digits") {
  for (const auto& row : test::em_reference_rows()) {
    CAPTURE(row.relative_permittivity);
    CAPTURE(row.thickness_m);
    CAPTURE(row.cos_incidence);
    const auto got = slab_response(row.permittivity(), row.thickness_rad(), row.cos_incidence);
    // The phase kd·q has its own rounding, 1.1e-16 of up to 430 rad here; 1e-12 leaves a factor of five over the worst.
    const double bound = 1e-12;
    CHECK(test::relative_difference(got.reflection.te, row.slab_te) <= bound);
    CHECK(test::relative_difference(got.reflection.tm, row.slab_tm) <= bound);
    CHECK(test::relative_difference(got.transmission.te, row.insertion_te) <= bound);
    CHECK(test::relative_difference(got.transmission.tm, row.insertion_tm) <= bound);
  }
}

TEST_CASE("energy: without loss |R|² + |T|² = 1, with loss less, at every angle") {
  for (const double permittivity : {1.0, 1.0 + 1e-9, 2.5, 6.31, 81.0})
    for (const double thickness_rad : {1e-9, 0.01, 1.0, 3.0, 100.0})
      for (int step = 0; step <= 50; ++step) {
        const double cos_incidence = step / 50.0;
        const auto lossless = slab_response(permittivity, thickness_rad, cos_incidence);
        REQUIRE(std::abs(power_te(lossless) - 1.0) <= 4.0 * rounding);
        REQUIRE(std::abs(power_tm(lossless) - 1.0) <= 4.0 * rounding);
        for (const double loss : {1e-6, 0.3, 1e6}) {
          const auto lossy = slab_response({permittivity, -loss}, thickness_rad, cos_incidence);
          REQUIRE(power_te(lossy) <= 1.0 + rounding);
          REQUIRE(power_tm(lossy) <= 1.0 + rounding);
        }
      }
  // Strictly less where something is absorbed: about one neper per hundred radians.
  CHECK(power_te(slab_response({4.0, -0.04}, 100.0, 0.7)) < 0.5);
}

TEST_CASE("a slab of half a wavelength is a window, of a quarter a mirror") {
  const double permittivity = 4.0;
  const double index = 2.0;
  const auto window = slab_response(permittivity, pi / index, 1.0);
  CHECK(std::abs(window.reflection.te) <= rounding);
  CHECK(std::abs(std::abs(window.transmission.te) - 1.0) <= rounding);
  // Insertion phase: −(n − 1)·kd plus nothing else at a window = e^{−jπ/2}.
  CHECK(std::abs(window.transmission.te - Complex(0.0, -1.0)) <= rounding);
  // Quarter wave: transformed impedance 1/n², R = (1 − n²)/(1 + n²).
  const auto mirror = slab_response(permittivity, pi / (2.0 * index), 1.0);
  CHECK(std::abs(mirror.reflection.te - (1.0 - permittivity) / (1.0 + permittivity)) <= rounding);
}

TEST_CASE("nothing there: no contrast or no thickness leaves the straight path as it is") {
  for (const double cos_incidence : {0.0, 1e-300, 1e-160, 1e-9, 0.4, 1.0}) {
    CAPTURE(cos_incidence);
    const auto air = slab_response(1.0, 123.0, cos_incidence);
    CHECK(air.reflection == PolarizedCoefficients{0.0, 0.0});
    CHECK(std::abs(air.transmission.te - 1.0) <= rounding);
    CHECK(std::abs(air.transmission.tm - 1.0) <= rounding);
    if (cos_incidence < 1e-100) continue;  // exact grazing along a sheet without thickness has no limit
    const auto sheet = slab_response({5.0, -0.1}, 0.0, cos_incidence);
    CHECK(sheet.reflection == PolarizedCoefficients{0.0, 0.0});
    CHECK(std::abs(sheet.transmission.te - 1.0) <= rounding);
  }
}

TEST_CASE("thin sheet: the insertion phase is that of the added optical length") {
  // First order in kd at normal incidence: T = 1 − j(η − 1)kd/2. The next order is (kd)² ≈ 1e-10.
  const double thickness_rad = 1e-5;
  const Complex eta(3.0, -0.5);
  const auto sheet = slab_response(eta, thickness_rad, 1.0);
  const Complex first_order = Complex(0.0, -0.5) * (eta - 1.0) * thickness_rad;
  CHECK(std::abs(sheet.transmission.te - 1.0 - first_order) <= 1e-9);
  CHECK(std::abs(sheet.transmission.te - 1.0) >= 1e-5);  // the bound above is not the whole effect
}

TEST_CASE("a thick conductor is a half space: finite where the wave inside underflows") {
  const Complex metal = complex_permittivity(1.0, 1e7, 100e9);
  for (const double thickness_m : {1e-3, 1.0, 1e6, 1e300})
    for (const double cos_incidence : {0.0, 1e-6, 0.5, 1.0}) {
      const auto slab = slab_response(metal, wave_number_rad_per_m(100e9) * thickness_m, cos_incidence);
      const auto half_space = half_space_reflection(metal, cos_incidence);
      REQUIRE(finite(slab));
      CHECK(std::abs(slab.reflection.te - half_space.te) <= rounding);
      CHECK(std::abs(slab.reflection.tm - half_space.tm) <= rounding);
      CHECK(slab.transmission == PolarizedCoefficients{0.0, 0.0});
    }
}

TEST_CASE("attenuation far below rounding is kept: each centimetre more costs the same factor") {
  const Complex eta(5.0, -2.0);
  const auto thin = slab_response(eta, 200.0, 1.0);
  const auto thick = slab_response(eta, 300.0, 1.0);
  // |T| ∝ e^{kd·Im q}; reflections inside are e^{−170} and play no part.
  const double expected = std::exp(100.0 * decaying_square_root(eta).imag());
  CHECK(std::abs(thin.transmission.te) < 1e-30);
  CHECK(std::abs(thick.transmission.te) / std::abs(thin.transmission.te) ==
        doctest::Approx(expected).epsilon(1e-12).scale(0.0));
}

TEST_CASE("no NaN for any finite medium, thickness and angle") {
  const double huge = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const double permittivity : {1.0, 1.0 + 1e-16, 4.0, 1e150, 1e300})
    for (const double loss : {0.0, tiny, 1.0, 1e150, 1e300})
      for (const double thickness_rad : {0.0, tiny, 1e-3, pi, 1e10, huge})
        for (const double cos_incidence : {0.0, tiny, 1e-200, 1e-8, 0.5, 1.0}) {
          CAPTURE(permittivity);
          CAPTURE(loss);
          CAPTURE(thickness_rad);
          CAPTURE(cos_incidence);
          const auto response = slab_response({permittivity, -loss}, thickness_rad, cos_incidence);
          REQUIRE(finite(response));
          REQUIRE(power_te(response) <= 1.0 + rounding);
          REQUIRE(power_tm(response) <= 1.0 + rounding);
        }
}

}  // namespace test_slab
