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
  Complex value;
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
  double worst = 0.0;
  for (const TransitionRow& row : rows) {
    CAPTURE(row.x);
    const double error = difference(transition_function(row.x), row.value);
    CHECK(error <= 1e-12);
    worst = std::max(worst, error);
  }
  MESSAGE("largest relative error of F " << worst);
}

TEST_CASE("transition function: the small imaginary parts at large x keep their digits too") {
  for (const TransitionRow& row : rows) {
    if (row.x < 5.0 || row.x > 1e300) continue;  // the imaginary part itself is denormal beyond
    CAPTURE(row.x);
    CHECK(std::abs(transition_function(row.x).imag() / row.value.imag() - 1.0) <= 1e-12);
  }
}

TEST_CASE("transition function: the ends of its range") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(transition_function(infinity) == Complex(1.0, 0.0));
  CHECK(transition_function(0.0) == Complex(0.0, 0.0));
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
  }
}

TEST_CASE("transition function: the reduced form is that of the function, and finite at 0") {
  CHECK(std::abs(reduced_transition_function(0.0) - std::sqrt(pi) * unit_phasor(0.25 * pi)) <= 1e-15);
  for (const TransitionRow& row : rows) {
    if (row.x < 1e-100 || row.x > 1e100) continue;
    CAPTURE(row.x);
    CHECK(test::relative_difference(reduced_transition_function(row.x) * std::sqrt(row.x), row.value) <= 1e-12);
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
