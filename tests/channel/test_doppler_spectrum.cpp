/// Power over Doppler shift: where the bins lie, and that they hold everything.
#include "dcem/channel/doppler_spectrum.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "tests/channel/channel_draws.hpp"

namespace test_doppler_spectrum {

using namespace dcem;
using namespace dcem::test;

namespace {

PowerSample shifted(double doppler_hz, double power_ratio = 1.0) {
  PowerSample sample;
  sample.power_ratio = power_ratio;
  sample.doppler_hz = doppler_hz;
  return sample;
}

}  // namespace

TEST_CASE("bins are centred on multiples of their width, and those without power are left out") {
  const std::vector<PowerSample> samples{shifted(-1004.0),   shifted(0.0, 2.0),    shifted(4.0, 3.0),
                                         shifted(-4.9, 4.0), shifted(1000.0, 5.0), shifted(50.0, 0.0)};
  const auto bins = doppler_spectrum(samples, 10.0);
  REQUIRE(bins.size() == 3);
  CHECK(bins[0].doppler_hz == -1000.0);
  CHECK(bins[0].power_ratio == 1.0);
  CHECK(bins[1].doppler_hz == 0.0);
  CHECK(bins[1].power_ratio == 9.0);
  CHECK(bins[2].doppler_hz == 1000.0);
  CHECK(bins[2].power_ratio == 5.0);
  CHECK(doppler_spectrum({}, 10.0).empty());
}

TEST_CASE("a shift on the border of two bins belongs to the upper one, on both sides of zero") {
  for (int n = -2000; n <= 2000; ++n) {
    for (const double bin_hz : {8.0, 0.1, 3.7}) {
      const double border_hz = (n - 0.5) * bin_hz;
      const double below_hz = std::nextafter(border_hz, -1e9);
      CHECK(doppler_spectrum(std::vector{shifted(border_hz)}, bin_hz).at(0).doppler_hz == n * bin_hz);
      CHECK(doppler_spectrum(std::vector{shifted(below_hz)}, bin_hz).at(0).doppler_hz == (n - 1) * bin_hz);
    }
  }
}

TEST_CASE("the bins ascend and hold all the power, and no sample is further from its bin than half the width") {
  Draw draw(41);
  const auto samples = power_samples(drawn_paths(draw, 500, 1e-6, 1e-6));
  for (const double bin_hz : {0.01, 1.0, 37.0, 1e5}) {
    double sum = 0.0, first = 0.0, last_hz = -1e9;
    for (const DopplerBin& bin : doppler_spectrum(samples, bin_hz)) {
      CHECK(bin.doppler_hz > last_hz);
      last_hz = bin.doppler_hz;
      sum += bin.power_ratio;
      first += bin.power_ratio * bin.doppler_hz;
    }
    CHECK(sum == doctest::Approx(total_power(samples)).epsilon(1e-13).scale(0.0));
    CHECK(std::abs(first / sum - power_moments(samples)->mean_doppler_hz) <= 0.5 * bin_hz);
  }
}

TEST_CASE("waves from all around a moving receiver: Clarke's spectrum in every bin") {
  // Shifts f_m·cos α with α uniform have the density 1/(π·√(f_m² − f²)); between a and b there is the share
  // (arcsin(b/f_m) − arcsin(a/f_m))/π.
  const double largest_hz = 1000.0, bin_hz = 80.0;
  const int directions = 100'000;
  std::vector<PowerSample> ring;
  for (int i = 0; i < directions; ++i) {
    ring.push_back(shifted(largest_hz * std::cos(2.0 * pi * (i + 0.5) / directions), 1.0 / directions));
  }
  const auto share_below = [&](double doppler_hz) {
    return 0.5 + std::asin(std::clamp(doppler_hz / largest_hz, -1.0, 1.0)) / pi;
  };
  const auto bins = doppler_spectrum(ring, bin_hz);
  CHECK(bins.size() == 25);  // −12 … 12: the outermost end at 1000 Hz
  double total = 0.0;
  for (const DopplerBin& bin : bins) {
    const double share = share_below(bin.doppler_hz + 0.5 * bin_hz) - share_below(bin.doppler_hz - 0.5 * bin_hz);
    // Each border of a bin cuts the ring at two places, each by less than one direction.
    CHECK(std::abs(bin.power_ratio - share) <= 4.0 / directions);
    total += bin.power_ratio;
  }
  CHECK(total == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("widths without sense are refused") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bin_hz : {0.0, -1.0, infinity, std::nan("")}) {
    CHECK_THROWS_AS(doppler_spectrum(std::vector{shifted(5.0)}, bin_hz), std::invalid_argument);
  }
  CHECK_THROWS_AS(doppler_spectrum(std::vector{shifted(5e3)}, 1e-13), std::invalid_argument);
}

}  // namespace test_doppler_spectrum
