#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dcem/em/diffraction/double_transition.hpp"
#include "tests/reference/em_reference.hpp"

namespace test_double_transition {

using namespace dcem;

namespace {

struct DoubleTransitionRow {
  double first_root, second_root, correlation, complement;
  Complex value;
};

// tests/reference/utd_reference.py, 30 digits.
const std::vector<DoubleTransitionRow> rows{
#include "tests/reference/utd_double_transition.inc"
};

EdgeCoupling coupling_of(double correlation) {
  return {correlation, std::sqrt((1.0 - correlation) * (1.0 + correlation))};
}

const std::vector<double> roots{1e-6, 0.01, 0.3, 1.0, 1.9, 2.2, 4.0, 7.0, 30.0, 1e3};
const std::vector<double> correlations{-0.99999, -0.7, -0.1, 0.0, 0.2, 0.9, 0.999999};

}  // namespace

TEST_CASE("double transition function: 1e-9 of 30 digits") {
  REQUIRE(rows.size() == 120);
  double worst = 0.0;
  for (const DoubleTransitionRow& row : rows) {
    CAPTURE(row.first_root);
    CAPTURE(row.second_root);
    CAPTURE(row.correlation);
    const Complex got = double_transition_function(row.first_root, row.second_root, {row.correlation, row.complement});
    const double error = test::relative_difference(got, row.value);
    CHECK(error <= 1e-9);
    worst = std::max(worst, error);
  }
  MESSAGE("largest relative error of T " << worst);
}

TEST_CASE("double transition function: far edges have the product of the single ones") {
  for (const double first : roots)
    for (const double second : roots) {
      const Complex product = transition_function(first * first) * transition_function(second * second);
      CHECK(test::relative_difference(double_transition_function(first, second, {0.0, 1.0}), product) <= 1e-9);
    }
}

TEST_CASE("double transition function: the arc at grazing, 1 far from both boundaries, F far from one") {
  for (const double correlation : correlations) {
    const EdgeCoupling coupling = coupling_of(correlation);
    const Complex arc(0.0, 2.0 * coupling.complement * std::acos(-correlation));
    CHECK(test::relative_difference(reduced_double_transition(0.0, 0.0, coupling), arc) <= 1e-9);
    CHECK(test::relative_difference(reduced_double_transition(1e-13, 2e-13, coupling), arc) <= 1e-9);
    const double far = 1e7 / coupling.complement;
    CHECK(std::abs(double_transition_function(far, 1.3 * far, coupling) - 1.0) <= 1e-9);
    for (const double root : {0.01, 0.5, 2.0}) {
      const double own = root * coupling.complement;
      CHECK(std::abs(double_transition_function(far / coupling.complement, root, coupling) /
                         transition_function(own * own) -
                     1.0) <= 1e-6);
    }
  }
}

TEST_CASE("double transition function: across a boundary of one edge the other diffracts alone") {
  for (const double correlation : correlations)
    for (const double root : roots) {
      EdgeCoupling coupling = coupling_of(correlation);
      const Complex one_side = reduced_double_transition(0.0, root, coupling);
      coupling.correlation = -correlation;
      const Complex jump = one_side + reduced_double_transition(0.0, root, coupling);
      const Complex single = reduced_transition_function(0.0) * reduced_transition_function(root * root);
      CHECK(test::relative_difference(jump, 2.0 * coupling.complement * single) <= 1e-9);
    }
}

TEST_CASE("double transition function: symmetric to the last bit, and without a seam between its routes") {
  for (const double correlation : correlations) {
    const EdgeCoupling coupling = coupling_of(correlation);
    for (const double first : roots)
      for (const double second : roots)
        CHECK(reduced_double_transition(first, second, coupling) == reduced_double_transition(second, first, coupling));
  }
  // Γ at p² + t² = 9, t² = 12 and 30, p = t.
  const auto seam = [](double p, double t) {
    const Complex below = detail::corner_integral(p * (1.0 - 1e-13), t * (1.0 - 1e-13));
    const Complex above = detail::corner_integral(p * (1.0 + 1e-13), t * (1.0 + 1e-13));
    return test::relative_difference(below, above);
  };
  for (const double ratio : {-0.9, -1e-3, 1e-6, 0.2, 0.7, 1.0}) {
    CHECK(seam(3.0 * ratio / std::hypot(1.0, ratio), 3.0 / std::hypot(1.0, ratio)) <= 1e-9);
    CHECK(seam(3.0 / std::hypot(1.0, ratio), 3.0 * std::abs(ratio) / std::hypot(1.0, ratio)) <= 1e-9);
    for (const double squared : {12.0, 30.0}) CHECK(seam(ratio * std::sqrt(squared), std::sqrt(squared)) <= 1e-9);
  }
}

}  // namespace test_double_transition
