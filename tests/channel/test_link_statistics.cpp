/// Statistics of a link with two and three taps, against closed forms.
#include "dcem/channel/link_statistics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace test_link_statistics {

using namespace dcem;

namespace {

constexpr InteractionKind R = InteractionKind::reflection, T = InteractionKind::transmission,
                          D = InteractionKind::diffraction;

struct Tap {
  Complex amplitude;
  double delay_s;
  std::vector<InteractionKind> kinds;
  double arrival_rad = 0.0, departure_rad = 0.0, doppler_hz = 0.0;
};

PathContribution contribution(const Tap& tap) {
  PathContribution c;
  c.amplitude = tap.amplitude;
  c.ports(0, 0) = tap.amplitude;
  c.power_ratio = std::norm(tap.amplitude);
  c.delay_s = tap.delay_s;
  c.doppler_hz = tap.doppler_hz;
  c.arrival.azimuth_rad = tap.arrival_rad;
  c.departure.azimuth_rad = tap.departure_rad;
  for (const InteractionKind kind : tap.kinds) c.path.interactions.push_back({kind, FacetId(0), Vec3(0.0)});
  return c;
}

LinkStatistics statistics(const std::vector<Tap>& taps, double power_dbm = 0.0) {
  std::vector<PathContribution> paths;
  for (const Tap& tap : taps) paths.push_back(contribution(tap));
  return link_statistics(paths, power_dbm, !taps.empty() && taps.front().kinds.empty());
}

doctest::Approx close(double value) {
  return doctest::Approx(value).epsilon(1e-12).scale(0.0);  // some rounding of logarithms
}

}  // namespace

TEST_CASE("a link without paths has a flag, a zero and nothing else") {
  for (const bool free : {false, true}) {
    const LinkStatistics s = link_statistics({}, 20.0, free);
    CHECK(s.line_of_sight == free);
    CHECK(s.path_count == 0);
    for (const auto& value :
         {s.power_dbm, s.power_incoherent_dbm, s.power_los_dbm, s.power_reflected_dbm, s.power_transmitted_dbm,
          s.power_diffracted_dbm, s.path_gain_db, s.first_delay_s, s.mean_delay_s, s.rms_delay_spread_s, s.k_factor_db,
          s.azimuth_spread_arrival_rad, s.azimuth_spread_departure_rad, s.mean_doppler_hz, s.rms_doppler_spread_hz}) {
      CHECK_FALSE(value.has_value());
    }
  }
}

TEST_CASE("one path: its power, no spread, no K factor") {
  const LinkStatistics s = statistics({{Complex(0.6e-4, -0.8e-4), 1e-7, {}, 2.0, -1.0, 33.0}}, 30.0);
  CHECK(s.power_dbm == close(-50.0));
  CHECK(s.power_incoherent_dbm == close(-50.0));
  CHECK(s.power_los_dbm == close(-50.0));
  CHECK(s.path_gain_db == close(-80.0));
  CHECK_FALSE(s.power_reflected_dbm.has_value());
  CHECK_FALSE(s.power_transmitted_dbm.has_value());
  CHECK_FALSE(s.power_diffracted_dbm.has_value());
  CHECK_FALSE(s.k_factor_db.has_value());
  CHECK(s.first_delay_s == 1e-7);
  CHECK(s.mean_delay_s == close(1e-7));
  CHECK(s.rms_delay_spread_s == 0.0);
  CHECK(s.mean_doppler_hz == close(33.0));
  CHECK(s.rms_doppler_spread_hz == 0.0);
  CHECK(*s.azimuth_spread_arrival_rad < 1e-7);  // sqrt of the rounding of 1
}

TEST_CASE("two taps: spread sqrt(p q) times their distance, K their ratio") {
  // Powers 3 and 1 (arbitrary units 1e-10), delays 100 and 140 ns: p = 3/4, q = 1/4, mean 110 ns, spread sqrt(3)/4·40
  // ns.
  const double a = std::sqrt(3e-10), b = std::sqrt(1e-10);
  const LinkStatistics s =
      statistics({{Complex(a, 0), 100e-9, {}, 0.0, 0.3, 100.0}, {Complex(0, b), 140e-9, {T, R}, 1.0, 0.3, -300.0}});
  CHECK(s.mean_delay_s == close(110e-9));
  CHECK(s.rms_delay_spread_s == close(std::sqrt(3.0) / 4.0 * 40e-9));
  CHECK(s.k_factor_db == close(4.771212547196624));  // 10·log10(3)
  CHECK(std::abs(*s.mean_doppler_hz) < 1e-12);       // of shifts of hundreds
  CHECK(s.rms_doppler_spread_hz == close(std::sqrt(3.0) / 4.0 * 400.0));
  CHECK(s.power_incoherent_dbm == close(-93.97940008672037));  // 4e-10
  CHECK(s.power_dbm == close(-93.97940008672037));             // in quadrature: the same
  CHECK(s.power_reflected_dbm == close(-100.0));               // a path with R and T is reflected
  CHECK_FALSE(s.power_transmitted_dbm.has_value());
  // |3/4 + 1/4·e^(j)|² = (9 + 1 + 6·cos 1)/16.
  CHECK(s.azimuth_spread_arrival_rad == close(std::sqrt(-std::log((10.0 + 6.0 * std::cos(1.0)) / 16.0))));
  CHECK(*s.azimuth_spread_departure_rad < 1e-7);
}

TEST_CASE("coherent power knows phases, incoherent power does not") {
  const Complex a(1e-5, 0);
  const LinkStatistics in_phase = statistics({{a, 1e-8, {}}, {a, 2e-8, {R}}});
  CHECK(in_phase.power_dbm == close(-100.0 + 6.020599913279624));
  CHECK(in_phase.power_incoherent_dbm == close(-100.0 + 3.010299956639812));
  const LinkStatistics opposed = statistics({{a, 1e-8, {}}, {-0.5 * a, 2e-8, {R}}});
  CHECK(opposed.power_dbm == close(-100.0 - 6.020599913279624));
  const LinkStatistics cancelled = statistics({{a, 1e-8, {}}, {-a, 2e-8, {R}}});
  CHECK_FALSE(cancelled.power_dbm.has_value());
  CHECK_FALSE(cancelled.path_gain_db.has_value());
  CHECK(cancelled.power_incoherent_dbm == close(-100.0 + 3.010299956639812));
  CHECK(cancelled.rms_delay_spread_s == close(5e-9));
}

TEST_CASE("three taps of three kinds: each power in its column, and the moments of three weights") {
  // Powers 4 : 2 : 2, delays 10, 20, 40 ns: mean (40+40+80)/8 = 20, mean square (400+800+3200)/8 = 550, spread
  // sqrt(150).
  const LinkStatistics s = statistics({{Complex(2e-5, 0), 10e-9, {}, pi, 0.0, 10.0},
                                       {Complex(1e-5, 1e-5), 20e-9, {T, T}, -pi + 0.2, pi / 2, 20.0},
                                       {Complex(0, std::sqrt(2e-10)), 40e-9, {R}, pi - 0.2, -pi / 2, 40.0}},
                                      10.0);
  CHECK(s.path_count == 3);
  CHECK(s.line_of_sight);
  CHECK(s.mean_delay_s == close(20e-9));
  CHECK(s.rms_delay_spread_s == close(std::sqrt(150.0) * 1e-9));
  CHECK(s.mean_doppler_hz == close(20.0));
  CHECK(s.rms_doppler_spread_hz == close(std::sqrt(150.0)));
  CHECK(s.power_los_dbm == close(-83.97940008672037));          // 4e-10 and 10 dBm
  CHECK(s.power_transmitted_dbm == close(-86.98970004336019));  // 2e-10
  CHECK(s.power_reflected_dbm == close(-86.98970004336019));
  CHECK(s.power_incoherent_dbm == close(-80.96910013008056));  // 8e-10
  CHECK(s.k_factor_db == doctest::Approx(0.0).epsilon(1e-12));
  // Circular: around ±π the spread of arrivals is small. |1/2 + 1/2·cos 0.2|; departures 0, ±π/2: |1/2|.
  CHECK(s.azimuth_spread_arrival_rad == close(std::sqrt(-2.0 * std::log(0.5 + 0.5 * std::cos(0.2)))));
  CHECK(s.azimuth_spread_departure_rad == close(std::sqrt(2.0 * std::log(2.0))));
}

TEST_CASE("a path with a diffraction counts as diffracted, whatever else it touches, and only there") {
  for (const std::vector<InteractionKind>& kinds : std::vector<std::vector<InteractionKind>>{
           {D}, {R, D}, {D, R}, {T, D}, {D, T}, {R, D, R}, {T, R, T, D}, {D, D}}) {
    const LinkStatistics s = statistics({{Complex(1e-5, 0), 10e-9, kinds}});
    CHECK(s.power_diffracted_dbm == close(-100.0));
    CHECK(s.power_incoherent_dbm == close(-100.0));
    CHECK_FALSE(s.power_reflected_dbm.has_value());
    CHECK_FALSE(s.power_transmitted_dbm.has_value());
    CHECK_FALSE(s.power_los_dbm.has_value());
  }
}

TEST_CASE("diffracted power has a column of its own and counts against the line of sight") {
  // Powers 8, 4, 2, 1 and 1 times 1e-10.
  const LinkStatistics s = statistics({{Complex(std::sqrt(8e-10), 0), 10e-9, {}},
                                       {Complex(2e-5, 0), 20e-9, {R}},
                                       {Complex(0, std::sqrt(2e-10)), 25e-9, {T}},
                                       {Complex(0, 1e-5), 30e-9, {D}},
                                       {Complex(1e-5, 0), 40e-9, {R, D}}});
  CHECK(s.power_diffracted_dbm == close(-96.98970004336019));  // 2e-10
  CHECK(s.power_reflected_dbm == close(-93.97940008672037));   // 4e-10
  CHECK(s.power_transmitted_dbm == close(-96.98970004336019));
  CHECK(s.power_incoherent_dbm == close(-87.95880017344075));   // 16e-10
  CHECK(s.k_factor_db == doctest::Approx(0.0).epsilon(1e-12));  // 8 over 8
  CHECK(s.mean_delay_s == close((8 * 10e-9 + 4 * 20e-9 + 2 * 25e-9 + 30e-9 + 40e-9) / 16));
}

TEST_CASE("the delay spread keeps its digits far from the origin of delays") {
  // 1 ns apart after 1 ms of flight (300 km): τ² itself holds 1e-6 ns², the difference to the first delay all of it.
  const LinkStatistics s = statistics({{Complex(1e-6, 0), 1e-3, {}}, {Complex(1e-6, 0), 1e-3 + 1e-9, {R}}});
  const double apart_s = (1e-3 + 1e-9) - 1e-3;  // what the two delays really differ by
  CHECK(s.rms_delay_spread_s == doctest::Approx(apart_s / 2).epsilon(1e-9).scale(0.0));
}

TEST_CASE("opposite arrivals of one power: a large spread, but a number") {
  const LinkStatistics s = statistics({{Complex(1e-5, 0), 1e-8, {}, 0.0}, {Complex(1e-5, 0), 1e-8, {R}, pi}});
  CHECK(std::isfinite(*s.azimuth_spread_arrival_rad));
  CHECK(*s.azimuth_spread_arrival_rad > 5.0);
}

TEST_CASE("a path that brings nothing counts, and gives no moments") {
  const LinkStatistics s = statistics({{Complex(0, 0), 5e-8, {R}}});
  CHECK(s.path_count == 1);
  CHECK(s.first_delay_s == 5e-8);
  CHECK_FALSE(s.power_dbm.has_value());
  CHECK_FALSE(s.power_incoherent_dbm.has_value());
  CHECK_FALSE(s.mean_delay_s.has_value());
  CHECK_FALSE(s.rms_delay_spread_s.has_value());
  CHECK_FALSE(s.azimuth_spread_arrival_rad.has_value());
}

TEST_CASE("the first delay is the smallest, in whatever order the paths stand") {
  const LinkStatistics s = statistics({{Complex(1e-5, 0), 3e-8, {R}}, {Complex(1e-5, 0), 1e-8, {}}});
  CHECK(s.first_delay_s == 1e-8);
  CHECK(s.mean_delay_s == close(2e-8));
}

TEST_CASE("dual ports: fields add port by port, powers are summed over receive and averaged over transmit ports") {
  PathContribution direct, reflected;
  direct.ports = {{{{Complex(1e-5, 0), 0.0}, {0.0, Complex(-1e-5, 0)}}}};
  reflected.ports = {{{{Complex(1e-5, 0), Complex(0, 2e-5)}, {0.0, Complex(1e-5, 0)}}}};
  reflected.path.interactions.push_back({R, FacetId(0), Vec3(0.0)});
  for (PathContribution* path : {&direct, &reflected}) {
    path->transmit_ports = 2;
    path->has_amplitude = false;
    path->power_ratio = norm_squared(path->ports) / 2.0;
  }
  const std::vector<PathContribution> paths{direct, reflected};
  const LinkStatistics s = link_statistics(paths, 0.0, true);
  // Sum of ports: [2, 2j; 0, 0]·1e-5: 8e-10 over two transmit ports. Alone: 2e-10 and 6e-10, halved.
  CHECK(s.power_dbm == close(-93.97940008672037));
  CHECK(s.power_incoherent_dbm == close(-93.97940008672037));
  CHECK(s.power_los_dbm == close(-100.0));
  CHECK(s.k_factor_db == close(-4.771212547196624));
}

}  // namespace test_link_statistics
