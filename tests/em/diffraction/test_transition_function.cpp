#include <doctest/doctest.h>

#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "dcem/em/diffraction/transition_function.hpp"
#include "tests/reference/em_reference.hpp"
#include "tests/support/shared_data.hpp"

namespace test_transition_function {

using namespace dcem;

namespace {

struct TransitionRow {
  double x;
  Complex value, slope, curvature;
};

// tests/reference/utd_reference.py, 40 digits.
const std::vector<TransitionRow> rows{
#include "tests/reference/utd_transition.inc"
};

/// As test::relative_difference, but where the expected value has lost digits to the denormal range, in steps of it.
double difference(const Complex& got, const Complex& expected) {
  const double smallest = std::numeric_limits<double>::min();
  if (std::abs(expected) >= smallest) return test::relative_difference(got, expected);
  return std::abs(got - expected) <= 4.0 * std::numeric_limits<double>::denorm_min() ? 0.0 : 1.0;
}

}  // namespace

TEST_CASE("transition function: 1e-12 of 40 digits from 0 to the largest double") {
  REQUIRE(rows.size() > 200);
  double worst_value = 0.0;
  double worst_slope = 0.0;
  double worst_curvature = 0.0;
  for (const TransitionRow& row : rows) {
    CAPTURE(row.x);
    const TransitionValues got = transition_values(row.x);
    CHECK(difference(got.value, row.value) <= 1e-12);
    CHECK(difference(got.slope, row.slope) <= 1e-12);
    CHECK(difference(got.curvature, row.curvature) <= 1e-12);
    worst_value = std::max(worst_value, difference(got.value, row.value));
    worst_slope = std::max(worst_slope, difference(got.slope, row.slope));
    worst_curvature = std::max(worst_curvature, difference(got.curvature, row.curvature));
    CHECK(transition_function(row.x) == got.value);
    CHECK(slope_transition_function(row.x) == got.slope);
  }
  MESSAGE("largest relative error of F " << worst_value << ", F_s " << worst_slope << ", F_c " << worst_curvature);
}

TEST_CASE("transition function: the small imaginary parts at large x keep their digits too") {
  for (const TransitionRow& row : rows) {
    if (row.x < 5.0 || row.x > 1e300) continue;  // the imaginary part itself is denormal beyond
    CAPTURE(row.x);
    const TransitionValues got = transition_values(row.x);
    CHECK(std::abs(got.value.imag() / row.value.imag() - 1.0) <= 1e-12);
    CHECK(std::abs(got.slope.imag() / row.slope.imag() - 1.0) <= 1e-12);
  }
}

TEST_CASE("transition function: the ends of its range") {
  const double infinity = std::numeric_limits<double>::infinity();
  const TransitionValues far = transition_values(infinity);
  CHECK(far.value == Complex(1.0, 0.0));
  CHECK(far.slope == Complex(1.0, 0.0));
  CHECK(far.curvature == Complex(1.0, 0.0));
  CHECK(transition_function(0.0) == Complex(0.0, 0.0));
  CHECK(slope_transition_function(0.0) == Complex(0.0, 0.0));
  CHECK(transition_function(-1e-30) == Complex(0.0, 0.0));
  // √π·e^{jπ/4}√x with x the smallest double, 2^−1074: √(π/2)·2^−537.
  const double tiny = std::sqrt(0.5 * pi) * std::ldexp(1.0, -537);
  CHECK(test::relative_difference(transition_function(std::numeric_limits<double>::denorm_min()), {tiny, tiny}) <=
        1e-15);
}

TEST_CASE("transition function: no seam where one route hands over to the next") {
  for (const double seam : {4.0, 1e3, 1e17}) {
    CAPTURE(seam);
    const double above = std::nextafter(seam, 2.0 * seam);
    // The function itself changes by less than 1e-16 over one step.
    CHECK(test::relative_difference(transition_function(seam), transition_function(above)) <= 1e-14);
    CHECK(test::relative_difference(slope_transition_function(seam), slope_transition_function(above)) <= 5e-14);
  }
}

TEST_CASE("transition function: the reduced forms are those of the function, and finite at 0") {
  const auto at_zero = detail::reduced_transition(0.0);
  CHECK(std::abs(at_zero.value - std::sqrt(pi) * unit_phasor(0.25 * pi)) <= 1e-15);
  CHECK(at_zero.slope == Complex(0.0, 2.0));
  for (const TransitionRow& row : rows) {
    if (row.x < 1e-100 || row.x > 1e100) continue;
    CAPTURE(row.x);
    const auto reduced = detail::reduced_transition(row.x);
    CHECK(test::relative_difference(reduced.value * std::sqrt(row.x), row.value) <= 1e-12);
    CHECK(test::relative_difference(reduced.slope * row.x, row.slope) <= 1e-12);
    CHECK(test::relative_difference(reduced.curvature * std::sqrt(row.x) * row.x, row.curvature) <= 1e-12);
  }
}

TEST_CASE("transition function: the published table") {
  DCEM_NEEDS_SHARED();
  std::ifstream file(test::shared_path("itu/utd_transition_F.csv"));
  std::string line;
  int count = 0;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line[0] == 'x') continue;
    double x = 0.0;
    double real = 0.0;
    double imaginary = 0.0;
    REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &real, &imaginary) == 3);
    // Printed with eight decimals.
    CHECK(std::abs(transition_function(x) - Complex(real, imaginary)) <= 1e-8);
    ++count;
  }
  CHECK(count == 13);
}

}  // namespace test_transition_function
