#include <doctest/doctest.h>

#include <vector>

#include "dcem/accel/sah_cost.hpp"

namespace test_sah_cost {

using namespace dcem;

TEST_CASE("the SAH cost of a tree of three nodes, by hand") {
  // Root 2 × 1 × 1 m, half surface 2·1 + 1·1 + 1·2 = 5 m²; leaves 1 × 1 × 1 m, half surface 3 m², 3 and 2 primitives.
  std::vector<BvhNode<double>> nodes(4);
  nodes[0] = {{Vec3(0), Vec3(2, 1, 1)}, 2, 0};
  nodes[2] = {{Vec3(0), Vec3(1)}, 0, 3};
  nodes[3] = {{Vec3(1, 0, 0), Vec3(2, 1, 1)}, 3, 2};
  SahSettings settings;
  settings.traversal_cost = 1.5;
  settings.intersection_cost = 2.0;
  // 1.5 · 5 + 2 · 3 · 3 + 2 · 2 · 3 = 37.5 m²; over 5 m²: 7.5.
  CHECK(weighted_area<double>(nodes, 0, settings) == doctest::Approx(37.5));
  CHECK(subtree_sah_cost<double>(nodes, 0, settings) == doctest::Approx(7.5));
  CHECK(subtree_sah_cost<double>(nodes, 2, settings) == doctest::Approx(6.0));
}

TEST_CASE("trees without surface cost nothing and are as good as new") {
  const std::vector<BvhNode<double>> nodes{{{Vec3(3), Vec3(3)}, 0, 4}};
  CHECK(subtree_sah_cost<double>(nodes, 0, {}) == 0.0);
  CHECK(BvhQuality{}.ratio() == 1.0);
  CHECK(BvhQuality{6.0, 4.0}.ratio() == 1.5);
}

}  // namespace test_sah_cost
