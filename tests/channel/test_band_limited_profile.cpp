/// The profile of a receiver of limited bandwidth: the transform of the frequency response, with all its energy.
#include "dcem/channel/band_limited_profile.hpp"

#include <doctest/doctest.h>

#include <complex>
#include <limits>
#include <vector>

#include "dcem/channel/frequency_response.hpp"
#include "tests/channel/channel_draws.hpp"

namespace test_band_limited_profile {

using namespace dcem;
using namespace dcem::test;

namespace {

using LongComplex = std::complex<long double>;

constexpr double bin_s = 0x1.0p-30;  // about a nanosecond; 1/bin_s is exact

double specular_power(const std::vector<BandLimitedTap>& taps) {
  double sum = 0.0;
  for (const BandLimitedTap& tap : taps) sum += tap.specular_power_ratio;
  return sum;
}

double diffuse_power(const std::vector<BandLimitedTap>& taps) {
  double sum = 0.0;
  for (const BandLimitedTap& tap : taps) sum += tap.diffuse_power_ratio;
  return sum;
}

PathContribution path_at(double delay_s, const Complex& amplitude) {
  PathContribution path;
  path.delay_s = delay_s;
  path.amplitude = path.ports(0, 0) = amplitude;
  path.power_ratio = std::norm(amplitude);
  return path;
}

/// (1/N) Σ exp(j2πkx/N) over k = −(N − 1)/2 … (N − 1)/2, in extended precision.
double dirichlet(int count, double x) {
  long double sum = 0.0L;
  for (int k = -(count / 2); k <= count / 2; ++k) {
    sum += std::cos(2.0L * std::numbers::pi_v<long double> * k * x / count);
  }
  return static_cast<double>(sum / count);
}

}  // namespace

TEST_CASE("a path between two taps spreads by the mean of the band's phasors") {
  for (const double fraction : {0.5, 0.25, -0.3, 1e-3, 0.999, 1e-12}) {
    CAPTURE(fraction);
    const auto taps = band_limited_profile(std::vector{path_at((100.0 + fraction) * bin_s, Complex(0, 2))}, {}, bin_s);
    const auto count = static_cast<int>(taps.size());
    REQUIRE(count % 2 == 1);
    for (const BandLimitedTap& tap : taps) {
      const double weight = dirichlet(count, tap.delay_s / bin_s - ((100.0 + fraction) * bin_s) / bin_s);
      CHECK(tap.specular_power_ratio == doctest::Approx(4.0 * weight * weight).epsilon(1e-12).scale(1e-6));
    }
  }
}

TEST_CASE("a path on a tap stays there") {
  const auto taps = band_limited_profile(std::vector{path_at(12345 * bin_s, Complex(3, 4))}, {}, bin_s);
  REQUIRE(taps.size() == 65);
  for (std::size_t n = 0; n < taps.size(); ++n) CHECK(taps[n].specular_power_ratio == (n == 32 ? 25.0 : 0.0));
  CHECK(taps[32].delay_s == 12345 * bin_s);
  // With a bin that is no power of two the product is rounded: 1e-16 of 12345 bins, squared.
  const auto rounded = band_limited_profile(std::vector{path_at(12345 * 1e-9, Complex(3, 4))}, {}, 1e-9);
  REQUIRE(rounded.size() == 65);
  CHECK(rounded[32].specular_power_ratio == doctest::Approx(25.0).epsilon(1e-15));
  CHECK(specular_power(rounded) - rounded[32].specular_power_ratio <= 25.0 * 1e-22);
}

TEST_CASE("the taps are the inverse transform of the frequency response") {
  Draw draw(51);
  const auto paths = drawn_paths(draw, 10, 1e-6, 1e-7);
  const auto taps = band_limited_profile(paths, {}, bin_s);
  const FrequencyGrid grid{30e9, 1.0 / bin_s, taps.size()};
  const auto response = frequency_response(paths, grid);
  const auto count = static_cast<long double>(taps.size());
  for (const BandLimitedTap& tap : taps) {
    LongComplex field;
    for (std::size_t k = 0; k < grid.points; ++k) {
      const long double steps = static_cast<long double>(k) - (count - 1.0L) / 2.0L;
      const long double angle = 2.0L * std::numbers::pi_v<long double> * steps / count * (tap.delay_s / bin_s);
      field += LongComplex(response[k]) * LongComplex(std::cos(angle), std::sin(angle));
    }
    const double power_ratio = static_cast<double>(std::norm(field / count));
    // The response's phases are good to 1e-12 after 1000 bins; the total bounds what they can add up to.
    CHECK(std::abs(tap.specular_power_ratio - power_ratio) <= 1e-12 * total_power(power_samples(paths)));
  }
}

TEST_CASE("energy is conserved: what the taps hold is the mean power over the band") {
  Draw draw(52);
  for (const double first_s : {0.0, 1e-7, 1e-4}) {  // up to 1e5 bins
    for (int repetition = 0; repetition < 8; ++repetition) {
      const auto paths = drawn_paths(draw, 1 + draw.below(40), first_s, 3e-7);
      const auto taps = band_limited_profile(paths, {}, bin_s);
      const auto response = frequency_response(paths, {30e9, 1.0 / bin_s, taps.size()});
      double mean = 0.0;
      for (const Complex& value : response) mean += std::norm(value) / static_cast<double>(response.size());
      CHECK(specular_power(taps) == doctest::Approx(mean).epsilon(1e-12).scale(0.0));
    }
  }
}

TEST_CASE("dual ports: the same, summed over receive and averaged over transmit ports") {
  Draw draw(53);
  const auto paths = drawn_dual_paths(draw, 25, 2e-6, 3e-7);
  const auto taps = band_limited_profile(paths, {}, bin_s);
  double mean = 0.0;
  for (const ComplexMatrix2& matrix : port_frequency_response(paths, {30e9, 1.0 / bin_s, taps.size()})) {
    mean += norm_squared(matrix) / 2.0 / static_cast<double>(taps.size());
  }
  CHECK(specular_power(taps) == doctest::Approx(mean).epsilon(1e-12).scale(0.0));
  const auto alone = band_limited_profile(std::span(paths).first(1), {}, bin_s);
  CHECK(specular_power(alone) == doctest::Approx(paths.front().power_ratio).epsilon(1e-12).scale(0.0));
}

TEST_CASE("diffuse power stays the same in sum, whatever the delays and the bin") {
  Draw draw(54);
  for (const double width_s : {bin_s, 1e-9, 3.3e-8, 1e-5}) {
    const auto samples = power_samples(drawn_paths(draw, 60, 1e-5, 1e-6));
    const auto taps = band_limited_profile({}, samples, width_s);
    CHECK(diffuse_power(taps) == doctest::Approx(total_power(samples)).epsilon(1e-12).scale(0.0));
    CHECK(specular_power(taps) == 0.0);
  }
}

TEST_CASE("diffuse power is what paths of that power bring on the average over their phases") {
  // Over the four phases 0, π/2, π, 3π/2 of each of two paths the mixed terms of |a + b|² cancel.
  Draw draw(55);
  auto paths = drawn_paths(draw, 2, 1e-6, 1e-8);
  const auto expected = band_limited_profile({}, power_samples(paths), bin_s);
  std::vector<double> mean(expected.size(), 0.0);
  for (int turn = 0; turn < 4; ++turn) {
    paths[1].ports(0, 0) *= Complex(0, 1);
    const auto taps = band_limited_profile(paths, {}, bin_s);
    REQUIRE(taps.size() == expected.size());
    for (std::size_t n = 0; n < taps.size(); ++n) mean[n] += 0.25 * taps[n].specular_power_ratio;
  }
  for (std::size_t n = 0; n < mean.size(); ++n) {
    CHECK(mean[n] == doctest::Approx(expected[n].diffuse_power_ratio).epsilon(1e-12).scale(0.0));
  }
}

TEST_CASE("paths and diffuse power stand side by side") {
  Draw draw(56);
  const auto paths = drawn_paths(draw, 5, 1e-6, 2e-7);
  auto samples = power_samples(drawn_paths(draw, 7, 1e-6, 2e-7));
  for (PowerSample& sample : samples) sample.delay_s = std::min(sample.delay_s, 1.15e-6);
  samples.front().delay_s = 1.4e-6;  // the last of all
  const auto both = band_limited_profile(paths, samples, bin_s);
  const auto response = frequency_response(paths, {30e9, 1.0 / bin_s, both.size()});
  double mean = 0.0;
  for (const Complex& value : response) mean += std::norm(value) / static_cast<double>(response.size());
  CHECK(specular_power(both) == doctest::Approx(mean).epsilon(1e-12).scale(0.0));
  CHECK(diffuse_power(both) == doctest::Approx(total_power(samples)).epsilon(1e-12).scale(0.0));
}

TEST_CASE("paths within a bin interfere: equal ones double the field, opposed ones leave nothing") {
  const Complex a(1e-5, 0);
  const double at_s = 40.3 * bin_s;
  CHECK(specular_power(band_limited_profile(std::vector{path_at(at_s, a), path_at(at_s, a)}, {}, bin_s)) ==
        doctest::Approx(4e-10).epsilon(1e-12).scale(0.0));
  CHECK(specular_power(band_limited_profile(std::vector{path_at(at_s, a), path_at(at_s, -a)}, {}, bin_s)) == 0.0);
}

TEST_CASE("whole bins more of delay move the profile and change nothing else") {
  Draw draw(57);
  auto paths = drawn_paths(draw, 15, 0.0, 1e-7);
  // Delays of few bits, so that the sums below are exact, and so is everything after them.
  for (PathContribution& path : paths) path.delay_s = std::ldexp(std::round(std::ldexp(path.delay_s, 50)), -50);
  const auto samples = power_samples(paths);
  const auto before = band_limited_profile(paths, samples, bin_s);
  for (const int bins : {1, 77, 100'000}) {
    auto moved = paths;
    for (PathContribution& path : moved) path.delay_s += bins * bin_s;
    const auto after = band_limited_profile(moved, power_samples(moved), bin_s);
    REQUIRE(after.size() == before.size());
    int different = 0;
    for (std::size_t n = 0; n < before.size(); ++n) {
      different += after[n].specular_power_ratio != before[n].specular_power_ratio;
      different += after[n].diffuse_power_ratio != before[n].diffuse_power_ratio;
      different += after[n].delay_s != before[n].delay_s + bins * bin_s;
    }
    CHECK(different == 0);
  }
}

TEST_CASE("the same with a bin that is no power of two, to the digits of the delays") {
  Draw draw(58);
  const double width_s = 1e-9;
  auto paths = drawn_paths(draw, 15, 2e-8, 1e-7);
  paths.push_back(path_at(2e-8, 1e-6));  // on the first tap
  const auto before = band_limited_profile(paths, {}, width_s);
  const double total = specular_power(before);
  for (PathContribution& path : paths) path.delay_s += 100'000 * width_s;
  const auto after = band_limited_profile(paths, {}, width_s);
  REQUIRE(after.size() == before.size());
  for (std::size_t n = 0; n < before.size(); ++n) {
    // A delay of 1e-4 s is rounded to 7e-21 s: 7e-12 of a bin.
    CHECK(std::abs(after[n].specular_power_ratio - before[n].specular_power_ratio) <= 1e-10 * total);
  }
}

TEST_CASE("the place between two taps keeps its digits after 100 000 bins") {
  Draw draw(59);
  const double width_s = 1e-9;
  for (int repetition = 0; repetition < 20; ++repetition) {
    const double delay_s = (1e5 + draw.between(0.2, 0.8)) * width_s;
    const auto taps = band_limited_profile(std::vector{path_at(delay_s, 1.0)}, {}, width_s);
    const long double pi_long = std::numbers::pi_v<long double>, count = static_cast<long double>(taps.size());
    const long double x = static_cast<long double>(delay_s) / width_s - 1e5L;  // known to 5e-15
    const long double weight = std::sin(pi_long * x) / (count * std::sin(pi_long * x / count));
    REQUIRE(taps[32].delay_s == 1e5 * width_s);
    CHECK(taps[32].specular_power_ratio ==
          doctest::Approx(static_cast<double>(weight * weight)).epsilon(1e-13).scale(0.0));
  }
}

TEST_CASE("the taps are the smallest odd number with a guard of 32 on both sides, at multiples of the bin") {
  const auto taps_of = [](double first, double last) {
    return band_limited_profile(std::vector{path_at(first * bin_s, 1.0), path_at(last * bin_s, 1.0)}, {}, bin_s);
  };
  CHECK(taps_of(50, 50).size() == 65);
  CHECK(taps_of(50, 51).size() == 67);  // 66 is even
  CHECK(taps_of(50, 52).size() == 67);
  CHECK(taps_of(50.4, 50.6).size() == 67);  // between 50 and 51
  CHECK(taps_of(49.6, 52.4).size() == 69);  // 49 … 53
  const auto taps = taps_of(10.5, 20.5);
  CHECK(taps.front().delay_s == -22 * bin_s);
  CHECK(taps.size() == 77);  // −22 … 53 are 76
  for (std::size_t n = 1; n < taps.size(); ++n) CHECK(taps[n].delay_s == taps[n - 1].delay_s + bin_s);
  CHECK(band_limited_profile({}, {}, bin_s).empty());
}

TEST_CASE("bins without sense are refused") {
  const std::vector<PathContribution> paths{path_at(1e-6, 1.0), path_at(2e-6, 1.0)};
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double width_s : {0.0, -1e-9, infinity, std::nan(""), 1e-13, 1e-30}) {
    CHECK_THROWS_AS(band_limited_profile(paths, {}, width_s), std::invalid_argument);
  }
}

}  // namespace test_band_limited_profile
