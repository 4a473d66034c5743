#include "dcem/em/antenna/pattern_table.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "dcem/core/random.hpp"

namespace test_pattern_table {

using namespace dcem;

namespace {

constexpr double degree = pi / 180.0;

/// Gains that are linear in zenith, and in azimuth up to the seam.
PatternTable sloped(std::size_t azimuths, std::size_t zeniths) {
  std::vector<double> gains;
  for (std::size_t row = 0; row < zeniths; ++row) {
    for (std::size_t column = 0; column < azimuths; ++column) {
      const bool pole = row == 0 || row + 1 == zeniths;
      gains.push_back(3.0 - 0.5 * double(row) + (pole ? 0.0 : 0.25 * double(column)));
    }
  }
  return {azimuths, zeniths, gains};
}

}  // namespace

TEST_CASE("a table gives its nodes, whatever turn the azimuth is counted in") {
  const PatternTable table = sloped(8, 5);
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      for (const double turn_deg : {-360.0, 0.0, 360.0}) {
        const double azimuth = (45.0 * double(column) + turn_deg) * degree, zenith = 45.0 * double(row) * degree;
        // The angle is rounded by 1e-15, the slope is at most 0.25·7 dB in 45 degrees.
        CHECK(table.gain_dbi(azimuth, zenith) == doctest::Approx(table.node_dbi(column, row)).epsilon(1e-13));
      }
    }
  }
}

TEST_CASE("between nodes the gain is bilinear in dB") {
  const PatternTable table = sloped(8, 5);
  // A quarter of the way from azimuth 45 to 90 and a half from zenith 90 to 135: rows 2 and 3, columns 1 and 2, by
  // hand: (3 - 1.25) + 0.25·1.25.
  CHECK(table.gain_dbi(56.25 * degree, 112.5 * degree) == doctest::Approx(2.0625).epsilon(1e-14));
  // Across the seam, from column 7 to column 0: in row 2 from 3.75 to 2, half way.
  CHECK(table.gain_dbi(-22.5 * degree, 90.0 * degree) == doctest::Approx(2.875).epsilon(1e-14));
  CHECK(table.gain_dbi(337.5 * degree, 90.0 * degree) == doctest::Approx(2.875).epsilon(1e-14));
  // Between the pole and the first row the pole has one gain: a third of the way down in column 7.
  CHECK(table.gain_dbi(315.0 * degree, 15.0 * degree) == doctest::Approx(3.0 + (2.5 + 1.75 - 3.0) / 3).epsilon(1e-14));
}

TEST_CASE("the gain is continuous over the seam and has one value at each pole") {
  const PatternTable table = sloped(7, 6);
  RandomStream random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const double zenith = pi * random.uniform(), azimuth = 2.0 * pi * random.uniform();
    // Over 2e-9 rad the gain moves by its slope: 1.75 dB in a cell of 51 degrees.
    CHECK(std::abs(table.gain_dbi(-1e-9, zenith) - table.gain_dbi(1e-9, zenith)) < 1e-8);
    CHECK(std::abs(table.gain_dbi(pi, zenith) - table.gain_dbi(-pi, zenith)) < 1e-13);
    CHECK(table.gain_dbi(azimuth, 0.0) == 3.0);
    CHECK(table.gain_dbi(azimuth, pi) == 0.5);
  }
}

TEST_CASE("a constant table is constant to the last bit") {
  const PatternTable table(3, 4, std::vector<double>(12, 7.3));
  RandomStream random(11);
  for (int trial = 0; trial < 200; ++trial) {
    CHECK(table.gain_dbi(20.0 * random.uniform() - 10.0, pi * random.uniform()) == 7.3);
  }
}

TEST_CASE("where the nodes of a pole differ, it has the mean of their powers") {
  // 0 and 10 dBi are 1 and 10: the mean is 5.5, 7.4036 dBi by hand.
  const PatternTable table(2, 2, {0.0, 10.0, -3.0, -3.0});
  CHECK(table.node_dbi(0, 0) == doctest::Approx(7.403626894942439).epsilon(1e-14));
  CHECK(table.node_dbi(1, 0) == table.node_dbi(0, 0));
  CHECK(table.node_dbi(0, 1) == -3.0);
}

TEST_CASE("the pole straight down has one gain as well as that straight up") {
  const PatternTable table(2, 3, {-3.0, -3.0, 1.0, 2.0, 0.0, 10.0});
  CHECK(table.node_dbi(0, 2) == doctest::Approx(7.403626894942439).epsilon(1e-14));
  CHECK(table.node_dbi(1, 2) == table.node_dbi(0, 2));
  CHECK(table.gain_dbi(0.4, pi) == table.gain_dbi(-2.0, pi));
  CHECK(table.node_dbi(0, 1) == 1.0);  // between the poles each node keeps its own
  CHECK(table.node_dbi(1, 1) == 2.0);
}

TEST_CASE("tables that do not cover the sphere, and gains that are none, are refused") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(PatternTable(0, 2, {}), std::invalid_argument);
  CHECK_THROWS_AS(PatternTable(2, 1, {0.0, 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(PatternTable(2, 2, {0.0, 0.0, 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(PatternTable(2, 2, {0.0, 0.0, 0.0, 0.0, 0.0}), std::invalid_argument);
  for (const double bad : {std::nan(""), infinity, -infinity, 200.5, -201.0}) {
    CHECK_THROWS_AS(PatternTable(2, 2, {0.0, 0.0, bad, 0.0}), std::invalid_argument);
  }
  CHECK_NOTHROW(PatternTable(1, 2, {200.0, -200.0}));
}

}  // namespace test_pattern_table
