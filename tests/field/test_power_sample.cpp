/// Moments of power over delay, Doppler shift and direction, against closed forms for two and three samples.
#include "dcem/field/power_sample.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "dcem/channel/link_statistics.hpp"
#include "tests/channel/channel_draws.hpp"

namespace test_power_sample {

using namespace dcem;
using namespace dcem::test;

namespace {

doctest::Approx close(double value) {
  return doctest::Approx(value).epsilon(1e-12).scale(0.0);  // some rounding of sums and logarithms
}

PowerSample at_zenith(double power_ratio, double departure_rad, double arrival_rad) {
  PowerSample sample;
  sample.power_ratio = power_ratio;
  sample.departure.zenith_rad = departure_rad;
  sample.arrival.zenith_rad = arrival_rad;
  return sample;
}

}  // namespace

TEST_CASE("where there is no power there are no moments, but the first delay is that of any sample") {
  CHECK_FALSE(power_moments({}).has_value());
  CHECK_FALSE(first_delay_s({}).has_value());
  const std::vector<PowerSample> dark{{0.0, 4e-8, 1.0, {}, {}}, {0.0, 3e-8, 1.0, {}, {}}};
  CHECK_FALSE(power_moments(dark).has_value());
  CHECK(first_delay_s(dark) == 3e-8);
  const std::vector<PowerSample> lit{{1e-9, 5e-8, 7.0, {}, {}}, {0.0, 2e-8, 1.0, {}, {}}};
  CHECK(power_moments(lit)->first_delay_s == 2e-8);
  CHECK(power_moments(lit)->mean_delay_s == close(5e-8));
  CHECK(power_moments(lit)->mean_doppler_hz == 7.0);
}

TEST_CASE("a path is its sample without the phase") {
  Draw draw(3);
  const PathContribution path = drawn_paths(draw, 1, 1e-7, 1e-6).front();
  const PowerSample sample = power_sample(path);
  CHECK(sample.power_ratio == path.power_ratio);
  CHECK(sample.delay_s == path.delay_s);
  CHECK(sample.doppler_hz == path.doppler_hz);
  CHECK(sample.departure.azimuth_rad == path.departure.azimuth_rad);
  CHECK(sample.departure.zenith_rad == path.departure.zenith_rad);
  CHECK(sample.arrival.azimuth_rad == path.arrival.azimuth_rad);
  CHECK(sample.arrival.zenith_rad == path.arrival.zenith_rad);
}

TEST_CASE("one sample: its values, no spread") {
  const std::vector<PowerSample> one{{2e-9, 3e-7, -40.0, {2.0, 0.5}, {-1.0, 2.5}}};
  const PowerMoments moments = *power_moments(one);
  CHECK(moments.power_ratio == 2e-9);
  CHECK(moments.first_delay_s == 3e-7);
  CHECK(moments.mean_delay_s == 3e-7);
  CHECK(moments.mean_doppler_hz == -40.0);
  CHECK(moments.rms_delay_spread_s == 0.0);
  CHECK(moments.rms_doppler_spread_hz == 0.0);
  for (const double spread_rad : {moments.azimuth_spread_departure_rad, moments.azimuth_spread_arrival_rad,
                                  moments.zenith_spread_departure_rad, moments.zenith_spread_arrival_rad}) {
    CHECK(spread_rad < 5e-8);  // the square root of twice the rounding of 1
  }
}

TEST_CASE("two samples: the spread is the geometric mean of their shares times their distance") {
  // Shares p and q = 1 − p at 0 and d: mean q·d, mean square q·d², variance q·d² − q²·d² = p·q·d².
  for (const double a : {1.0, 3.0, 40.0}) {
    const double b = 0.7;
    const std::vector<PowerSample> two{{a, 100e-9, 250.0, {}, {}}, {b, 160e-9, -150.0, {}, {}}};
    const PowerMoments moments = *power_moments(two);
    CHECK(moments.power_ratio == close(a + b));
    CHECK(moments.mean_delay_s == close((a * 100e-9 + b * 160e-9) / (a + b)));
    CHECK(moments.rms_delay_spread_s == close(std::sqrt(a * b) / (a + b) * 60e-9));
    CHECK(moments.mean_doppler_hz == close((a * 250.0 - b * 150.0) / (a + b)));
    CHECK(moments.rms_doppler_spread_hz == close(std::sqrt(a * b) / (a + b) * 400.0));
  }
}

TEST_CASE("three samples: moments of three weights") {
  // Shares 1/2, 1/4, 1/4. Delays 0, 8, 24 ns beyond 10 ns: mean 8, mean square 16 + 144 = 160, variance 96.
  // Shifts −40, 0, 160 Hz: mean 20, mean square 800 + 6400 = 7200, variance 6800.
  const std::vector<PowerSample> three{{2e-9, 10e-9, -40.0, {0.0, 0.4}, {pi, 1.0}},
                                       {1e-9, 18e-9, 0.0, {pi / 2, 0.4}, {-pi + 0.2, 1.3}},
                                       {1e-9, 34e-9, 160.0, {-pi / 2, 0.4 + pi / 2}, {pi - 0.2, 0.7}}};
  const PowerMoments moments = *power_moments(three);
  CHECK(moments.first_delay_s == 10e-9);
  CHECK(moments.mean_delay_s == close(18e-9));
  CHECK(moments.rms_delay_spread_s == close(std::sqrt(96.0) * 1e-9));
  CHECK(moments.mean_doppler_hz == close(20.0));
  CHECK(moments.rms_doppler_spread_hz == close(std::sqrt(6800.0)));
  // Departures: ½ + ¼j − ¼j = ½. Arrivals around ±π: ½ + ½·cos 0.2.
  CHECK(moments.azimuth_spread_departure_rad == close(std::sqrt(2.0 * std::log(2.0))));
  CHECK(moments.azimuth_spread_arrival_rad == close(std::sqrt(-2.0 * std::log(0.5 + 0.5 * std::cos(0.2)))));
  // Zeniths: |¾ + ¼j|² = 10/16; ½ + ½·cos 0.3.
  CHECK(moments.zenith_spread_departure_rad == close(std::sqrt(-std::log(10.0 / 16.0))));
  CHECK(moments.zenith_spread_arrival_rad == close(std::sqrt(-2.0 * std::log(0.5 + 0.5 * std::cos(0.3)))));
}

TEST_CASE("the spread of two zeniths has a closed form, and the ends are not mixed up") {
  // |p + q·e^{jd}|² = p² + q² + 2pq·cos d.
  const double p = 0.2, q = 0.8;
  const auto spread_rad = [&](double d) { return std::sqrt(-std::log(p * p + q * q + 2.0 * p * q * std::cos(d))); };
  const std::vector<PowerSample> two{at_zenith(p, 0.3, 2.0), at_zenith(q, 1.1, 0.5)};
  const PowerMoments moments = *power_moments(two);
  CHECK(moments.zenith_spread_departure_rad == close(spread_rad(0.8)));
  CHECK(moments.zenith_spread_arrival_rad == close(spread_rad(1.5)));
  CHECK(moments.azimuth_spread_departure_rad < 5e-8);
  CHECK(moments.azimuth_spread_arrival_rad < 5e-8);
}

TEST_CASE("a narrow spread of zeniths is their standard deviation") {
  Draw draw(11);
  std::vector<PowerSample> samples;
  double total = 0.0, first = 0.0, second = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double power = draw.magnitude(1e-3, 1.0), offset_rad = draw.between(-1e-3, 1e-3);
    samples.push_back(at_zenith(power, 1.2 + offset_rad, 1.2));
    total += power;
    first += power * offset_rad;
    second += power * offset_rad * offset_rad;
  }
  const double deviation_rad = std::sqrt(second / total - first * first / (total * total));
  // −2 ln|E e^{ja}| = σ² + terms of fourth order: a relative 1e-6 for angles of a milliradian.
  CHECK(power_moments(samples)->zenith_spread_departure_rad == doctest::Approx(deviation_rad).epsilon(1e-6).scale(0.0));
}

TEST_CASE("spreads of azimuths do not change when everything turns about the vertical") {
  Draw draw(12);
  for (int repetition = 0; repetition < 50; ++repetition) {
    std::vector<PowerSample> samples = power_samples(drawn_paths(draw, 2 + draw.below(20), 1e-7, 1e-6));
    const PowerMoments before = *power_moments(samples);
    const double turn_rad = draw.between(-10.0, 10.0);
    for (PowerSample& sample : samples) {
      sample.departure.azimuth_rad = std::remainder(sample.departure.azimuth_rad + turn_rad, 2.0 * pi);
      sample.arrival.azimuth_rad = std::remainder(sample.arrival.azimuth_rad + turn_rad, 2.0 * pi);
    }
    const PowerMoments after = *power_moments(samples);
    // d(spread) = −d|sum|/(|sum|·spread): for drawn directions the two factors stay above 1e-2.
    CHECK(std::abs(after.azimuth_spread_departure_rad - before.azimuth_spread_departure_rad) <= 1e-12);
    CHECK(std::abs(after.azimuth_spread_arrival_rad - before.azimuth_spread_arrival_rad) <= 1e-12);
    CHECK(after.zenith_spread_arrival_rad == before.zenith_spread_arrival_rad);
    CHECK(after.rms_delay_spread_s == before.rms_delay_spread_s);
  }
}

TEST_CASE("opposite directions of one power: a large spread, but a number") {
  std::vector<PowerSample> two(2);
  two[0].power_ratio = two[1].power_ratio = 1e-9;
  two[1].arrival.azimuth_rad = pi;
  const double spread_rad = power_moments(two)->azimuth_spread_arrival_rad;
  CHECK(std::isfinite(spread_rad));
  CHECK(spread_rad > 5.0);
  CHECK(spread_rad < 37.2);
}

TEST_CASE("a common delay, a common shift and a common factor change no spread") {
  Draw draw(13);
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::vector<PowerSample> samples = power_samples(drawn_paths(draw, 8, 0.0, 1e-6));
    const PowerMoments before = *power_moments(samples);
    for (PowerSample& sample : samples) {
      sample.power_ratio *= 0.25;
      sample.delay_s += 1e-3;
      sample.doppler_hz += 5e4;
    }
    const PowerMoments after = *power_moments(samples);
    CHECK(after.power_ratio == close(0.25 * before.power_ratio));
    // A delay of a millisecond is known to 1e-19 s.
    CHECK(std::abs(after.mean_delay_s - before.mean_delay_s - 1e-3) <= 1e-18);
    CHECK(std::abs(after.rms_delay_spread_s - before.rms_delay_spread_s) <= 1e-18);
    CHECK(std::abs(after.mean_doppler_hz - before.mean_doppler_hz - 5e4) <= 1e-9);
    CHECK(std::abs(after.rms_doppler_spread_hz - before.rms_doppler_spread_hz) <= 1e-9);
  }
}

TEST_CASE("the statistics of a link are these moments, to the last bit") {
  Draw draw(14);
  for (int repetition = 0; repetition < 200; ++repetition) {
    const auto paths = drawn_paths(draw, 1 + draw.below(30), 1e-7, 1e-6);
    const LinkStatistics statistics = link_statistics(paths, 0.0, false);
    const auto samples = power_samples(paths);
    const PowerMoments moments = *power_moments(samples);
    CHECK(statistics.first_delay_s == moments.first_delay_s);
    CHECK(statistics.mean_delay_s == moments.mean_delay_s);
    CHECK(statistics.rms_delay_spread_s == moments.rms_delay_spread_s);
    CHECK(statistics.mean_doppler_hz == moments.mean_doppler_hz);
    CHECK(statistics.rms_doppler_spread_hz == moments.rms_doppler_spread_hz);
    CHECK(statistics.azimuth_spread_departure_rad == moments.azimuth_spread_departure_rad);
    CHECK(statistics.azimuth_spread_arrival_rad == moments.azimuth_spread_arrival_rad);
  }
}

}  // namespace test_power_sample
