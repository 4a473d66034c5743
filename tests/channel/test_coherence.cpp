/// Coherence bandwidth and time, against closed forms of the correlation and against a search that takes every step.
#include "dcem/channel/coherence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/channel/channel_draws.hpp"

namespace test_coherence {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double step_s = 20e-9;

doctest::Approx close(double value) {
  return doctest::Approx(value).epsilon(1e-13).scale(0.0);  // some rounding of the sums, and their slope at the level
}

/// Samples at multiples of step_s, behind a common delay.
std::vector<PowerSample> taps(const std::vector<double>& powers, double first_s = 0.0) {
  std::vector<PowerSample> samples;
  for (const double power : powers) {
    PowerSample sample;
    sample.power_ratio = power;
    sample.delay_s = first_s + static_cast<double>(samples.size()) * step_s;
    samples.push_back(sample);
  }
  return samples;
}

/// θ = 2π·Δf·step_s.
double bandwidth_at_hz(double theta_rad) {
  return theta_rad / (2.0 * pi * step_s);
}

/// |R(Δf)|/R(0) in extended precision.
double correlation(const std::vector<PowerSample>& samples, double distance_hz) {
  std::complex<long double> sum;
  long double total = 0.0L;
  for (const PowerSample& sample : samples) {
    const long double angle = 2.0L * std::numbers::pi_v<long double> * distance_hz *
                              (static_cast<long double>(sample.delay_s) - samples.front().delay_s);
    sum += static_cast<long double>(sample.power_ratio) * std::complex<long double>(std::cos(angle), std::sin(angle));
    total += sample.power_ratio;
  }
  return static_cast<double>(std::abs(sum) / total);
}

double lower_bound_hz(const std::vector<PowerSample>& samples, double level) {
  return std::acos(level) / (2.0 * pi * power_moments(samples)->rms_delay_spread_s);
}

}  // namespace

TEST_CASE("two equal taps: arccos(level)/(pi times their distance), which is the lower bound itself") {
  // |R| = |cos(π·Δf·d)|.
  for (const double level : {0.01, 0.1, 0.5, 0.7, 0.9, 0.999}) {
    CAPTURE(level);
    const auto bandwidth_hz = coherence_bandwidth_hz(taps({3e-9, 3e-9}), level);
    REQUIRE(bandwidth_hz.has_value());
    CHECK(*bandwidth_hz == close(std::acos(level) / (pi * step_s)));
    CHECK(*bandwidth_hz == close(lower_bound_hz(taps({3e-9, 3e-9}), level)));
  }
  CHECK(coherence_bandwidth_hz(taps({1.0, 1.0})) == coherence_bandwidth_hz(taps({1.0, 1.0}), 0.5));
}

TEST_CASE("two unequal taps follow the law of cosines") {
  // |R|² = p² + q² + 2pq·cos θ, down to |p − q|.
  const double p = 0.6, q = 0.4;
  for (const double level : {0.21, 0.3, 0.5, 0.7, 0.95}) {
    CAPTURE(level);
    const double theta_rad = std::acos((level * level - p * p - q * q) / (2.0 * p * q));
    CHECK(*coherence_bandwidth_hz(taps({p, q}), level) == close(bandwidth_at_hz(theta_rad)));
    CHECK(*coherence_bandwidth_hz(taps({q, p}), level) == close(bandwidth_at_hz(theta_rad)));
  }
  CHECK_FALSE(coherence_bandwidth_hz(taps({p, q}), 0.19).has_value());
}

TEST_CASE("a dominant tap holds the correlation above twice its share minus one") {
  CHECK_FALSE(coherence_bandwidth_hz(taps({0.8, 0.2}), 0.5).has_value());
  CHECK_FALSE(coherence_bandwidth_hz(taps({0.1, 0.8, 0.1}), 0.5).has_value());
  CHECK(coherence_bandwidth_hz(taps({0.8, 0.2}), 0.61).has_value());
}

TEST_CASE("three symmetrical taps: one cosine") {
  // |R| = |b + 2a·cos θ| with the middle tap b; the first fall is where the sum itself falls to the level.
  for (const auto& [a, b] : {std::pair(0.25, 0.5), std::pair(0.4, 0.2), std::pair(0.3, 0.4)}) {
    for (const double level : {0.2, 0.5, 0.9}) {
      CAPTURE(level);
      const double theta_rad = std::acos((level - b) / (2.0 * a));
      CHECK(*coherence_bandwidth_hz(taps({a, b, a}), level) == close(bandwidth_at_hz(theta_rad)));
    }
  }
  CHECK(*coherence_bandwidth_hz(taps({0.25, 0.5, 0.25}), 0.5) == close(0.25 / step_s));
}

TEST_CASE("three taps of shares 3/5, 1/5, 1/5: found just above the minimum of the correlation, not below") {
  // |R|² = 0.2 + 0.32·c + 0.48·c² with c = cos θ: smallest at c = −1/3, where it is 0.44/3. Down from c = 1, the level
  // is first met at the larger root.
  const double minimum = std::sqrt(0.44 / 3.0);
  for (const double surplus : {1e-9, 1e-7, 1e-5, 1e-3, 0.1, 0.5}) {
    CAPTURE(surplus);
    const double level = minimum + surplus;
    const double c = (-0.32 + std::sqrt(0.32 * 0.32 - 4.0 * 0.48 * (0.2 - level * level))) / (2.0 * 0.48);
    const auto bandwidth_hz = coherence_bandwidth_hz(taps({0.6, 0.2, 0.2}), level);
    REQUIRE(bandwidth_hz.has_value());
    // Near the minimum the slope vanishes with the root of the surplus, in both computations.
    const double tolerance = 1e-14 / std::sqrt(surplus) + 1e-13;
    CHECK(std::abs(*bandwidth_hz / bandwidth_at_hz(std::acos(c)) - 1.0) <= tolerance);
  }
  // A dip that stays 1e-8 above the level is passed, again and again.
  CHECK_FALSE(coherence_bandwidth_hz(taps({0.6, 0.2, 0.2}), minimum - 1e-8).has_value());
}

TEST_CASE("a profile that decays exponentially: the geometric series") {
  // P_n = r^n: |R(θ)|/R(0) = (1 − r)/|1 − r·e^{−jθ}|, so cos θ = (1 + r² − (1 − r)²/level²)/(2r).
  const double r = 0.8;
  std::vector<double> powers;
  for (double power = 1.0; power > 1e-18; power *= r) powers.push_back(power);
  for (const double level : {0.3, 0.5, 0.7, 0.9}) {
    CAPTURE(level);
    const double theta_rad = std::acos((1.0 + r * r - (1.0 - r) * (1.0 - r) / (level * level)) / (2.0 * r));
    CHECK(*coherence_bandwidth_hz(taps(powers), level) == doctest::Approx(bandwidth_at_hz(theta_rad)).epsilon(1e-12));
  }
}

TEST_CASE("waves from all around a moving receiver: the Bessel function of Clarke's model") {
  // Shifts f_m·cos α, equally many from everywhere: R(Δt) = J0(2π·f_m·Δt), and J0(1.5211440576687651…) = 1/2.
  // Sixty-four directions give the integral to far below the rounding.
  const double largest_hz = 730.0;
  std::vector<PowerSample> ring(64);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    ring[i].power_ratio = 1e-10;
    ring[i].doppler_hz = largest_hz * std::cos(2.0 * pi * (static_cast<double>(i) + 0.3) / 64.0);
  }
  CHECK(*coherence_time_s(ring) == close(1.5211440576687651 / (2.0 * pi * largest_hz)));
  CHECK_FALSE(coherence_bandwidth_hz(ring).has_value());  // one delay
}

TEST_CASE("two equal Doppler shifts, one each way: R is a cosine") {
  std::vector<PowerSample> two(2);
  two[0].power_ratio = two[1].power_ratio = 2e-12;
  two[0].doppler_hz = 1000.0;
  two[1].doppler_hz = -1000.0;
  CHECK(*coherence_time_s(two, 0.9) == close(std::acos(0.9) / (2.0 * pi * 1000.0)));
  for (PowerSample& sample : two) sample.doppler_hz += 5e4;  // a common shift turns R and leaves |R|
  CHECK(*coherence_time_s(two, 0.9) == close(std::acos(0.9) / (2.0 * pi * 1000.0)));
}

TEST_CASE("without power, without spread or with one sample there is no coherence bandwidth or time") {
  CHECK_FALSE(coherence_bandwidth_hz({}).has_value());
  CHECK_FALSE(coherence_bandwidth_hz(taps({0.0, 0.0})).has_value());
  CHECK_FALSE(coherence_bandwidth_hz(taps({1.0})).has_value());
  CHECK_FALSE(coherence_bandwidth_hz(taps({1.0, 0.0})).has_value());
  CHECK_FALSE(coherence_time_s(taps({1.0, 1.0})).has_value());
}

TEST_CASE("samples without power change nothing") {
  std::vector<PowerSample> samples = taps({0.0, 0.5, 0.0, 0.3, 0.2});
  const std::vector<PowerSample> lit{samples[1], samples[3], samples[4]};
  CHECK(*coherence_bandwidth_hz(samples) == *coherence_bandwidth_hz(lit));
}

TEST_CASE("a common delay costs the digits of the delays, no more, and powers count by their ratios") {
  // step_s behind a millisecond is known to 1e-19 s in 2e-8 s.
  const double near_hz = *coherence_bandwidth_hz(taps({0.5, 0.3, 0.2}));
  CHECK(*coherence_bandwidth_hz(taps({0.5, 0.3, 0.2}, 1e-3)) == doctest::Approx(near_hz).epsilon(2e-11));
  CHECK(*coherence_bandwidth_hz(taps({0.5e-15, 0.3e-15, 0.2e-15})) == close(near_hz));
}

TEST_CASE("a level outside 0 to 1 is refused") {
  for (const double level : {0.0, 1.0, -0.5, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_AS(coherence_bandwidth_hz(taps({1.0, 1.0}), level), std::invalid_argument);
    CHECK_THROWS_AS(coherence_time_s({}, level), std::invalid_argument);
  }
}

TEST_CASE("drawn channels: the level is met there, nowhere before, and not before the lower bound") {
  Draw draw(21);
  int found = 0, absent = 0;
  for (int repetition = 0; repetition < 80; ++repetition) {
    CAPTURE(repetition);
    auto samples = power_samples(drawn_paths(draw, 2 + draw.below(10), 1e-6, 1e-6));
    const double level = draw.between(0.1, 0.95);
    const auto bandwidth_hz = coherence_bandwidth_hz(samples, level);
    const double bound_hz = lower_bound_hz(samples, level);
    const double end_hz = bandwidth_hz.value_or(coherence_search_multiple * bound_hz);
    CHECK(end_hz >= bound_hz * (1.0 - 1e-12));
    if (bandwidth_hz) CHECK(std::abs(correlation(samples, end_hz) - level) <= 1e-12);
    // Steps of 1/500 of the standard deviation's inverse; a fall and rise between two of them is below 1e-6 in |R|².
    const double grid_hz = 0.002 / (2.0 * pi * power_moments(samples)->rms_delay_spread_s);
    int before = 0;
    for (double at_hz = grid_hz; at_hz < end_hz * (1.0 - 1e-9); at_hz += grid_hz) {
      before += correlation(samples, at_hz) <= level ? 1 : 0;
    }
    CHECK(before == 0);
    ++(bandwidth_hz ? found : absent);
  }
  CHECK(found > 30);
  CHECK(absent > 10);
}

TEST_CASE("a level a little above the deepest dip is met, however late that comes, and one a little below never") {
  constexpr double step = 0.01;  // in units of 1/(2π·spread): a dip between two steps is 2.5e-5 deeper in |R|² at most
  constexpr double little = 1e-3;    // far more than that in |R|
  constexpr double longest = 101.0;  // coherence_search_multiple · arccos(0)
  Draw draw(22);
  int late = 0;
  for (int repetition = 0; repetition < 60; ++repetition) {
    CAPTURE(repetition);
    auto samples = power_samples(drawn_paths(draw, 4 + draw.below(8), 1e-6, 1e-6));
    samples.front().power_ratio = draw.between(1.2, 2.0) * total_power(samples);  // so no dip is deeper than 0.09
    const double unit_hz = 1.0 / (2.0 * pi * power_moments(samples)->rms_delay_spread_s);
    std::vector<double> levels;
    for (double u = step; u < longest; u += step) levels.push_back(correlation(samples, u * unit_hz));
    const auto deepest_until = [&](double u) {
      const auto count = std::min(levels.size(), static_cast<std::size_t>(u / step));
      return std::min_element(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(count));
    };
    const auto end = [](double level) { return coherence_search_multiple * std::acos(level); };
    // Where the search ends hangs on the level: a dip before the end for a level above it counts.
    const auto dip = deepest_until(0.95 * end(*deepest_until(longest) + 0.05));
    const double dip_hz = static_cast<double>(dip - levels.begin() + 1) * step * unit_hz;
    REQUIRE(dip_hz < 0.99 * end(*dip + little) * unit_hz);
    const auto met_hz = coherence_bandwidth_hz(samples, *dip + little);
    REQUIRE(met_hz);
    CHECK(*met_hz < dip_hz);
    late += *met_hz > 0.5 * end(*dip + little) * unit_hz ? 1 : 0;
    const double below = *deepest_until(longest) - little;
    CHECK_FALSE(coherence_bandwidth_hz(samples, below));
  }
  CHECK(late > 5);
}

}  // namespace test_coherence
