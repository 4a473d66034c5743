#include <doctest/doctest.h>

#include <limits>

#include "dcem/accel/brute_force.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_brute_force {

using namespace dcem;
using Primitives = std::vector<std::uint32_t>;

namespace {

/// Three unit cubes on the x axis, at 0, 10 and 20 m, and an empty box.
const dcem_test::Boxes<double> cubes{
    {Vec3(0), Vec3(1)}, {Vec3(10, 0, 0), Vec3(11, 1, 1)}, {}, {Vec3(20, 0, 0), Vec3(21, 1, 1)}};

BruteForce<double> oracle() {
  BruteForce<double> tree;
  tree.build(cubes);
  return tree;
}

}  // namespace

TEST_CASE("the oracle answers what can be seen by eye") {
  const auto tree = oracle();
  const Ray<double> along{Vec3(5, 0.5, 0.5), Vec3(1, 0, 0)};
  CHECK(dcem_test::reported([&](auto leaf) { tree.all(along, leaf); }) == Primitives{1, 3});
  const auto upto = segment_between(Vec3(5, 0.5, 0.5), Vec3(15, 0.5, 0.5));
  CHECK(dcem_test::reported([&](auto leaf) { tree.all(upto, leaf); }) == Primitives{1});
  const Aabb<double> region{Vec3(1), Vec3(10, 2, 2)};
  CHECK(dcem_test::reported([&](auto leaf) { tree.overlapping(region, leaf); }) == Primitives{0, 1});
  const auto right_of_11 = [](const Aabb<double>& box) { return box.max.x > 11.0; };
  CHECK(dcem_test::reported([&](auto leaf) { tree.visit(right_of_11, leaf); }) == Primitives{3});
}

TEST_CASE("the oracle stops at the first accepted blocker and narrows the ray at hits") {
  const auto tree = oracle();
  const Ray<double> along{Vec3(-5, 0.5, 0.5), Vec3(1, 0, 0)};
  Primitives asked;
  CHECK(tree.any(along, [&](std::uint32_t primitive) {
    asked.push_back(primitive);
    return primitive == 1;
  }));
  CHECK(asked == Primitives{0, 1});
  CHECK_FALSE(tree.any(along, [](std::uint32_t) { return false; }));
  asked.clear();
  TraversalCounters counters;
  tree.closest(
      along,
      [&](std::uint32_t primitive, double& t_max) {
        asked.push_back(primitive);
        t_max = 15.0;
      },
      &counters);
  CHECK(asked == Primitives{0, 1});
  CHECK(counters.primitives_tested == 2);
}

TEST_CASE("the oracle follows motion and notices what it was not told") {
  auto tree = oracle();
  auto moved = cubes;
  moved[3] = {Vec3(40), Vec3(41)};
  CHECK(tree.validate(cubes).empty());
  CHECK_FALSE(tree.validate(moved).empty());
  tree.refit(Primitives{3}, moved);
  CHECK(tree.validate(moved).empty());
  CHECK(tree.bounds() == Aabb<double>{Vec3(0), Vec3(41)});
  CHECK_THROWS_AS(tree.refit(Primitives{4}, moved), std::invalid_argument);
  moved[0].min.x = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(tree.refit_all(moved), std::invalid_argument);
  CHECK_THROWS_AS(tree.build(moved), std::invalid_argument);
}

}  // namespace test_brute_force
