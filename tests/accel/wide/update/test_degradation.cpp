#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_traffic.hpp"

namespace test_degradation {

using namespace dcem;
using dcem_test::nodes_of;
using dcem_test::WideTraffic;

namespace {

/// The measures of a node, counted from the arrays alone, in double precision.
struct Counted {
  double area_m2 = 0.0, ratio = 1.0;
  std::vector<std::uint32_t> inner;  ///< nodes of the level from this one on
};

double half_area(const Aabb<float>& box) {
  if (box.empty()) return 0.0;
  const Vec3 size = Vec3(box.max) - Vec3(box.min);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

Counted count(const WideBvh& tree, std::uint32_t node) {
  const WideArrays& arrays = tree.arrays();
  const WideNode& held = arrays.nodes[node];
  Counted result;
  result.inner.push_back(node);
  double children_m2 = 0.0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const WideChild child = held.child[lane];
    if (child.is_none()) continue;
    const double area_m2 = half_area(held.box(lane));
    children_m2 += area_m2;
    result.area_m2 += area_m2 * (child.is_leaf() ? arrays.costs.leaf : arrays.costs.node);
    if (child.is_leaf() || arrays.object_rooted_at_node[child.index()] != WideArrays::no_object) continue;
    const Counted below = count(tree, child.index());
    result.area_m2 += below.area_m2;
    result.inner.insert(result.inner.end(), below.inner.begin(), below.inner.end());
  }
  if (children_m2 > 0.0) result.ratio = half_area(held.box()) / children_m2;
  return result;
}

/// Single-precision surfaces: three products and two sums, each to 2^-24.
constexpr double rounding = 1e-6;

void check_sums(const WideBvh& tree) {
  for (const std::uint32_t node : nodes_of(tree.arrays())) {
    const Counted expected = count(tree, node);
    const Degradation& degradation = tree.degradation()[node];
    REQUIRE(degradation.inner_nodes == expected.inner.size());
    REQUIRE(std::abs(degradation.area_m2 - expected.area_m2) <= rounding * expected.area_m2);
    double growth = 0.0, scale = 0.0;
    for (const std::uint32_t inner : expected.inner) {
      const double relative = count(tree, inner).ratio / tree.degradation()[inner].area_ratio_at_build;
      growth += relative - 1.0;
      scale += relative;
    }
    REQUIRE(std::abs(degradation.ratio_growth_sum - growth) <= 4 * rounding * scale);
  }
}

TrackedMeasures both() {
  return {true, true, false};
}

}  // namespace

TEST_CASE("refits alone: both measures are those counted from the arrays, against the build") {
  for (const bool deforms : {false, true}) {
    WideTraffic traffic({100, 20.0, deforms, true, true}, 1);
    WideBvh tree = traffic.built();
    tree.watch(both());
    std::map<std::uint32_t, Counted> at_build;
    for (const std::uint32_t node : nodes_of(tree.arrays())) {
      at_build[node] = count(tree, node);
      CHECK(tree.degradation()[node].sah_growth() == 1.0);
      CHECK(tree.degradation()[node].deformation() == 0.0);
    }
    double worst = 1.0;
    for (int frame = 0; frame < 25; ++frame) {
      traffic.step();
      traffic.refit(tree);
      if (frame % 3 == 1) continue;  // what two refits have touched is measured at once
      tree.measure();
      check_sums(tree);
      for (const auto& [node, built] : at_build) {
        const Counted now = count(tree, node);
        if (built.area_m2 > 0.0) {
          const double growth_m2 = tree.degradation()[node].sah_growth() * built.area_m2;
          REQUIRE(std::abs(growth_m2 - now.area_m2) <= 4 * rounding * now.area_m2);
        }
        double growth = 0.0;
        for (const std::uint32_t inner : now.inner) growth += count(tree, inner).ratio / at_build[inner].ratio - 1.0;
        const double mean = growth / static_cast<double>(now.inner.size());
        // The mean of ratios, less 1.
        REQUIRE(tree.degradation()[node].deformation() == doctest::Approx(mean).epsilon(4 * rounding).scale(1.0));
        worst = std::max(worst, tree.degradation()[node].sah_growth());
      }
    }
    CHECK(worst > 1.5);
  }
}

TEST_CASE(
    "reinsertions, rotations and rebuilt_in_place parts: sums stay those of the arrays, what is new is not degraded") {
  WideTraffic traffic({100, 20.0, true, true, true}, 2);
  WideBvh tree = traffic.built();
  tree.watch({true, true, true});
  RandomStream random(3);
  std::size_t reinserted = 0, rotated = 0;
  for (int frame = 0; frame < 60; ++frame) {
    CAPTURE(frame);
    traffic.step();
    traffic.refit(tree);
    reinserted += tree.reinsert_moved(1.05);
    rotated += tree.rotate_touched(2);
    tree.measure();
    check_sums(tree);
    const std::vector<std::uint32_t> nodes = nodes_of(tree.arrays());
    const std::uint32_t node = nodes[random.next() % nodes.size()];
    tree.rebuild_subtree(node);
    check_sums(tree);
    for (const std::uint32_t inner : count(tree, node).inner) {
      REQUIRE(tree.degradation()[inner].sah_growth() == 1.0);
      REQUIRE(tree.degradation()[inner].deformation() == 0.0);
    }
  }
  CHECK(reinserted > 50);
  CHECK(rotated > 20);
  tree.rebuild(traffic.mesh.view(), traffic.boxes);
  check_sums(tree);
  for (const std::uint32_t node : nodes_of(tree.arrays())) CHECK(tree.degradation()[node].sah_growth() == 1.0);
}

TEST_CASE("a node that reinsertion makes is new, whatever its number stood for before") {
  WideTraffic traffic({100, 20.0, false, false, true}, 7);
  WideBvh tree = traffic.built();
  tree.watch(both());
  std::size_t made = 0;
  for (int frame = 0; frame < 100; ++frame) {
    traffic.step();
    traffic.refit(tree);
    tree.measure();
    const std::vector<std::uint32_t> free = tree.arrays().free_nodes;
    tree.reinsert_moved(1.0);
    tree.measure();
    for (const std::uint32_t node : free) {
      if (tree.arrays().lane_of_node[node].is_none()) continue;
      ++made;
      CHECK(tree.degradation()[node].sah_growth() == 1.0);
    }
  }
  CHECK(made > 10);
}

TEST_CASE("measured are the nodes on touched paths, children before parents, and nobody else") {
  WideTraffic traffic({300, 60.0, false, false, true}, 4);
  WideBvh tree = traffic.built();
  tree.watch(both());
  CHECK(tree.measure().empty());
  // One car moves by more than its box is rounded by.
  const std::uint32_t car = 10, first = traffic.object_first[car];
  for (std::uint32_t triangle = first; triangle < traffic.object_first[car + 1]; ++triangle) {
    for (const std::uint32_t vertex : traffic.mesh.triangles[triangle]) traffic.mesh.vertices[vertex].z += 0.01;
  }
  traffic.boxes = traffic.mesh.boxes();
  std::vector<std::uint32_t> moved;
  for (std::uint32_t triangle = first; triangle < traffic.object_first[car + 1]; ++triangle) moved.push_back(triangle);
  tree.refit(moved, traffic.mesh.view(), traffic.boxes);
  const WideArrays& arrays = tree.arrays();
  std::vector<std::uint32_t> path;
  for (NodeLane place = arrays.place_of(arrays.object_root[car]); !place.is_none();
       place = arrays.lane_of_node[place.node()]) {
    path.push_back(place.node());
  }
  const std::span<const std::uint32_t> measured = tree.measure();
  CHECK(std::vector<std::uint32_t>(measured.begin(), measured.end()) == path);
  CHECK(path.back() == 0);
  CHECK(tree.measure().empty());
}

TEST_CASE("what is not tracked is not noted; what is tracked anew counts as built now") {
  WideTraffic traffic({100, 20.0, false, false, true}, 5);
  WideBvh tree = traffic.built();
  const auto drive = [&] {
    for (int frame = 0; frame < 10; ++frame) {
      traffic.step();
      traffic.refit(tree);
    }
    return !tree.measure().empty();
  };
  CHECK(!drive());
  CHECK(tree.degradation().empty());
  tree.watch(both());
  CHECK(tree.degradation()[0].sah_growth() == 1.0);
  CHECK(drive());
  CHECK(tree.degradation()[0].sah_growth() > 1.01);
  tree.watch(both());  // nothing new
  CHECK(tree.degradation()[0].sah_growth() > 1.01);
  tree.watch({true, false, false});
  CHECK(drive());
  CHECK(tree.degradation()[0].deformation() == 0.0);
  tree.watch({});
  CHECK(!drive());
  CHECK(tree.degradation().empty());
}

TEST_CASE("from nothing to something the growth is infinite, from nothing to nothing it is none") {
  Degradation degradation;
  CHECK(degradation.sah_growth() == 1.0);
  degradation.area_at_build_m2 = 0.0;
  CHECK(degradation.sah_growth() == 1.0);
  degradation.area_m2 = 1.0;
  CHECK(degradation.sah_growth() == std::numeric_limits<double>::infinity());
  WideTraffic traffic({50, 10.0, false, false, false}, 6);
  traffic.set_absent(true);
  WideBvh tree = traffic.built();
  tree.watch(both());
  for (const bool absent : {false, true, false}) {
    traffic.set_absent(absent);
    traffic.refit(tree);
    tree.measure();
    check_sums(tree);
    for (const std::uint32_t node : nodes_of(tree.arrays())) {
      CHECK(std::isfinite(tree.degradation()[node].deformation()));
      CHECK(!std::isnan(tree.degradation()[node].sah_growth()));
    }
  }
}

}  // namespace test_degradation
