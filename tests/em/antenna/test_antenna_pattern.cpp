#include "dcem/em/antenna/antenna_pattern.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "dcem/core/random.hpp"

namespace test_antenna_pattern {

using namespace dcem;

namespace {

constexpr double degree = pi / 180.0;

/// Nodes and weights of Gauss's rule on [-1, 1], by Newton's method on the Legendre polynomial.
struct GaussRule {
  std::vector<double> nodes, weights;

  explicit GaussRule(int count) {
    for (int index = 0; index < count; ++index) {
      double x = std::cos(pi * (index + 0.75) / (count + 0.5)), slope = 0.0;
      for (int step = 0; step < 20; ++step) {
        double before = 1.0, value = x;
        for (int order = 2; order <= count; ++order) {
          const double next = ((2 * order - 1) * x * value - (order - 1) * before) / order;
          before = value;
          value = next;
        }
        slope = count * (x * value - before) / (x * x - 1.0);
        x -= value / slope;
      }
      nodes.push_back(x);
      weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
    }
  }
};

/// Mean over the sphere of a pattern that does not depend on azimuth: half of the integral over z = cos θ.
double mean_over_zenith(const AntennaPattern& pattern) {
  const GaussRule rule(60);
  double sum = 0.0;
  for (std::size_t node = 0; node < rule.nodes.size(); ++node) {
    sum += rule.weights[node] * power_gain(pattern, 0.7, std::acos(rule.nodes[node]));
  }
  return 0.5 * sum;
}

/// Mean over the sphere by midpoints of `cells` zeniths and twice as many azimuths.
double mean_by_midpoints(const AntennaPattern& pattern, int cells) {
  double sum = 0.0;
  for (int row = 0; row < cells; ++row) {
    const double zenith = pi * (row + 0.5) / cells;
    for (int column = 0; column < 2 * cells; ++column) {
      sum += std::sin(zenith) * power_gain(pattern, pi * (column + 0.5) / cells - pi, zenith);
    }
  }
  return sum * pi / (4.0 * cells * cells);
}

/// Where a falling function passes a value.
double root(const std::function<double(double)>& falling, double value, double low, double high) {
  for (int step = 0; step < 80; ++step) {
    const double middle = 0.5 * (low + high);
    (falling(middle) > value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double gain_dbi(const AntennaPattern& pattern, double azimuth_deg, double zenith_deg) {
  return 10.0 * std::log10(power_gain(pattern, azimuth_deg * degree, zenith_deg * degree));
}

/// Cin(2π) by its series Σ (−1)^(k+1) x^2k/(2k·(2k)!).
double cin_of_a_turn() {
  const long double square = 4.0L * std::numbers::pi_v<long double> * std::numbers::pi_v<long double>;
  long double term = -1.0L, sum = 0.0L;
  for (int k = 1; k < 40; ++k) {
    term *= -square / ((2 * k - 1) * (2 * k));
    sum += term / (2 * k);
  }
  return static_cast<double>(sum);
}

const std::vector<AntennaPattern>& all_patterns() {
  static const std::vector<AntennaPattern> patterns{
      IsotropicPattern{}, HalfWaveDipole{}, Tr38901Element{},
      TabulatedPattern{std::make_shared<const PatternTable>(tabulated(HalfWaveDipole{}, 12, 19))}};
  return patterns;
}

}  // namespace

TEST_CASE("isotropic antenna and half-wave dipole radiate what they are fed, no more and no less") {
  CHECK(mean_over_zenith(IsotropicPattern{}) == doctest::Approx(1.0).epsilon(1e-14));
  // The integrand is analytic over [-1, 1] in cos θ: 60 nodes are exact to rounding.
  CHECK(mean_over_zenith(HalfWaveDipole{}) == doctest::Approx(1.0).epsilon(1e-13));
  CHECK(radiated_share(IsotropicPattern{}) == doctest::Approx(1.0).epsilon(1e-6));
  CHECK(radiated_share(HalfWaveDipole{}) == doctest::Approx(1.0).epsilon(1e-6));
}

TEST_CASE("the dipole's directivity is 4/Cin(2 pi), 2.15 dBi") {
  // The series alternates with terms up to 18: 1e-18·18 in long double.
  CHECK(half_wave_dipole_directivity == doctest::Approx(4.0 / cin_of_a_turn()).epsilon(1e-15));
  CHECK(gain_dbi(HalfWaveDipole{}, 0, 90) == doctest::Approx(2.15).epsilon(0.0005));  // as books have it: 2.15
}

TEST_CASE("the dipole's pattern is the textbook's, does not depend on azimuth and vanishes along the wire") {
  for (double zenith_deg = 1.0; zenith_deg < 180.0; zenith_deg += 1.0) {
    const long double theta = static_cast<long double>(zenith_deg) * std::numbers::pi_v<long double> / 180.0L;
    const long double field = std::cos(std::numbers::pi_v<long double> / 2.0L * std::cos(theta)) / std::sin(theta);
    const double expected = half_wave_dipole_directivity * static_cast<double>(field * field);
    for (const double azimuth_deg : {0.0, 77.0, -160.0}) {
      // The zenith is rounded at 4e-16 and the gain goes with the square of its sine: 2·4e-16/sin 1° = 5e-14 of it.
      CHECK(power_gain(HalfWaveDipole{}, azimuth_deg * degree, zenith_deg * degree) ==
            doctest::Approx(expected).epsilon(1e-13).scale(0.0));
    }
  }
  CHECK(power_gain(HalfWaveDipole{}, 0.0, 0.0) == 0.0);
  CHECK(power_gain(HalfWaveDipole{}, Vec3(0, 0, 3)) == 0.0);
  CHECK(power_gain(HalfWaveDipole{}, Vec3(0, 0, -3)) < 1e-30);  // π is rounded
  // Next to the wire the field goes as (π/4)·sin θ, but for sin²θ/4 of it.
  for (const double small : {1e-3, 1e-8, 1e-14}) {
    const double expected = half_wave_dipole_directivity * (pi / 4.0 * small) * (pi / 4.0 * small);
    CHECK(power_gain(HalfWaveDipole{}, 0.3, small) == doctest::Approx(expected).epsilon(1e-6).scale(0.0));
  }
  CHECK(power_gain(HalfWaveDipole{}, 0.3, 1e-100) == 0.0);  // along the wire, as far as a direction is known
  // Half-power beam width 78 degrees (Balanis, 4.6).
  const auto off_axis = [](double off_deg) { return power_gain(HalfWaveDipole{}, 0.0, (90.0 + off_deg) * degree); };
  CHECK(2.0 * root(off_axis, 0.5 * half_wave_dipole_directivity, 0, 80) == doctest::Approx(78.0).epsilon(0.005));
}

TEST_CASE("the 38.901 element: 8 dBi ahead, 65 degrees wide in both cuts, -22 dBi at its back") {
  const Tr38901Element element;
  CHECK(gain_dbi(element, 0, 90) == doctest::Approx(8.0).epsilon(1e-14));
  const auto horizontal = [&](double off_deg) { return gain_dbi(element, off_deg, 90); };
  const auto vertical = [&](double off_deg) { return gain_dbi(element, 0, 90 + off_deg); };
  for (const auto& cut : {std::function<double(double)>(horizontal), std::function<double(double)>(vertical)}) {
    const double right = root(cut, 5.0, 0, 80), left = root([&](double off_deg) { return cut(-off_deg); }, 5.0, 0, 80);
    CHECK(left + right == doctest::Approx(65.0).epsilon(1e-12));  // 3 dB down on either side
    CHECK(left == doctest::Approx(right).epsilon(1e-12));
  }
  CHECK(gain_dbi(element, 180, 90) == doctest::Approx(-22.0).epsilon(1e-14));
  CHECK(gain_dbi(element, -110, 20) == doctest::Approx(-22.0).epsilon(1e-14));
  // Both attenuations add up: 40 degrees aside and 20 up, by hand 12·(40² + 20²)/65² = 5.6805 dB.
  CHECK(gain_dbi(element, 40, 70) == doctest::Approx(8.0 - 5.680473372781065).epsilon(1e-13));
  CHECK(gain_dbi(element, 340, 90) == doctest::Approx(gain_dbi(element, -20, 90)).epsilon(1e-12));
  double highest = 0.0, lowest = 100.0;
  for (int row = 0; row <= 180; ++row) {
    for (int column = -180; column < 180; ++column) {
      const double gain = gain_dbi(element, column, row);
      highest = std::max(highest, gain);
      lowest = std::min(lowest, gain);
    }
  }
  CHECK(highest == doctest::Approx(8.0).epsilon(1e-14));
  CHECK(lowest == doctest::Approx(-22.0).epsilon(1e-14));
}

TEST_CASE("the 38.901 element radiates 0.6568 of its power, as its comment says") {
  // Midpoints at half and a quarter degree differ by 7e-9: the kinks of the minimum, halved four times by the step.
  const double midpoints = mean_by_midpoints(Tr38901Element{}, 720);
  CHECK(midpoints == doctest::Approx(0.6568).epsilon(1e-5));
  CHECK(radiated_share(Tr38901Element{}) == doctest::Approx(midpoints).epsilon(1e-7));
}

TEST_CASE("a table of a pattern agrees with it at its nodes, at the seam and at the poles") {
  const PatternTable table = tabulated(Tr38901Element{}, 72, 37);
  const TabulatedPattern pattern{std::make_shared<const PatternTable>(table)};
  for (int row = 1; row < 36; ++row) {
    for (int column = -36; column <= 36; ++column) {  // once more than around: the seam from both sides
      CHECK(gain_dbi(pattern, 5.0 * column, 5.0 * row) ==
            doctest::Approx(gain_dbi(Tr38901Element{}, 5.0 * column, 5.0 * row)).epsilon(1e-11));
    }
  }
  // A pole has one gain, the mean of the powers around it; the element's own depends on the azimuth there.
  double power = 0.0;
  for (int column = 0; column < 72; ++column) power += power_gain(Tr38901Element{}, 5.0 * column * degree, 0.0) / 72.0;
  for (const double azimuth_deg : {0.0, 90.0, -171.0}) {
    CHECK(power_gain(pattern, azimuth_deg * degree, 0.0) == doctest::Approx(power).epsilon(1e-12).scale(0.0));
  }
  // The poles of the dipole have no logarithm: the least gain of a table.
  CHECK(tabulated(HalfWaveDipole{}, 4, 7).node_dbi(2, 0) == -200.0);
}

TEST_CASE("between its nodes a table is as good as its steps: h²/8 times the second derivative in dB") {
  const TabulatedPattern pattern{std::make_shared<const PatternTable>(tabulated(HalfWaveDipole{}, 8, 91))};
  const auto gain = [](double zenith_deg) { return gain_dbi(HalfWaveDipole{}, 0, zenith_deg); };
  double worst_db = 0.0, bound_db = 0.0;
  for (double zenith_deg = 20.0; zenith_deg <= 160.0; zenith_deg += 0.1) {
    const double bend = gain(zenith_deg + 0.05) - 2.0 * gain(zenith_deg) + gain(zenith_deg - 0.05);
    bound_db = std::max(bound_db, 2.0 * 2.0 / 8.0 * std::abs(bend) / (0.05 * 0.05));
    worst_db = std::max(worst_db, std::abs(gain_dbi(pattern, 33, zenith_deg) - gain(zenith_deg)));
  }
  CHECK(worst_db <= bound_db);
  CHECK(worst_db > 0.5 * bound_db);  // the bound is not idle
}

TEST_CASE("a gain is finite and not negative in every direction, and the same for a direction and its angles") {
  RandomStream random(5);
  for (const AntennaPattern& pattern : all_patterns()) {
    for (int trial = 0; trial < 300; ++trial) {
      const double azimuth = pi * (2.0 * random.uniform() - 1.0);
      const double zenith = trial == 0 ? 0.0 : trial == 1 ? pi : std::acos(2.0 * random.uniform() - 1.0);
      const double gain = power_gain(pattern, azimuth, zenith);
      CHECK(std::isfinite(gain));
      CHECK(gain >= 0.0);
      if (trial < 2) continue;
      const Vec3 direction(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                           std::cos(zenith));
      CHECK(power_gain(pattern, 7.0 * direction) == doctest::Approx(gain).epsilon(1e-9).scale(0.0));
    }
  }
}

}  // namespace test_antenna_pattern
