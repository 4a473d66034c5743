#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "dcem/accel/wide/build/plan.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_traffic.hpp"

namespace test_rebuild_subtree {

using namespace dcem;
using dcem_test::check_answers;
using dcem_test::depth_below;
using dcem_test::nodes_of;
using dcem_test::WideTraffic;

namespace {

/// What must not change: leaves, their quads, and which entry is the root of an object.
bool same_leaves(const WideArrays& one, const WideArrays& other) {
  const std::size_t bytes = one.leaves.size() * sizeof(QuadLeaf);
  return one.leaves.size() == other.leaves.size() && std::memcmp(one.leaves.data(), other.leaves.data(), bytes) == 0 &&
         one.quad_of_triangle == other.quad_of_triangle && one.object_root == other.object_root;
}

bool same_nodes(const WideArrays& one, const WideArrays& other) {
  if (one.nodes.size() != other.nodes.size() || one.free_nodes != other.free_nodes) return false;
  for (const std::uint32_t node : nodes_of(one)) {
    if (one.nodes[node].child != other.nodes[node].child || one.nodes[node].bounds_m != other.nodes[node].bounds_m) {
      return false;
    }
  }
  return one.weighted_area_m2 == other.weighted_area_m2;
}

}  // namespace

TEST_CASE(
    "rebuilt_in_place anywhere in a drive: leaves and objects stay, all promises are kept, the same bits are hit") {
  for (const bool deforms : {false, true}) {
    WideTraffic traffic({60, 12.0, deforms, true, true}, deforms ? 2 : 1);
    WideBvh tree = traffic.built();
    RandomStream random(3);
    for (int frame = 0; frame < 60; ++frame) {
      CAPTURE(frame);
      traffic.step();
      traffic.refit(tree);
      const WideBvh before = tree;
      const std::vector<std::uint32_t> nodes = nodes_of(tree.arrays());
      const std::uint32_t node = nodes[random.next() % nodes.size()];
      const Aabb<float> box = tree.arrays().nodes[node].box();
      CHECK(tree.rebuild_subtree(node) > 0);
      CHECK(tree.arrays().nodes[node].box() == box);
      CHECK(same_leaves(tree.arrays(), before.arrays()));
      check_answers(tree, traffic, 15, random);
    }
  }
}

TEST_CASE("what is rebuilt_in_place counts its nodes, and so does the plan its levels") {
  WideTraffic traffic({200, 40.0, false, false, true}, 4);
  WideBvh tree = traffic.built();
  for (int frame = 0; frame < 30; ++frame) {
    traffic.step();
    traffic.refit(tree);
  }
  for (const std::uint32_t node : nodes_of(tree.arrays())) {
    // Earlier turns may have set this one free.
    if (node != 0 && tree.arrays().lane_of_node[node].is_none()) continue;
    const detail::WidePlan plan(tree.arrays(), node, 1);
    const std::size_t made = tree.rebuild_subtree(node);
    std::uint32_t levels = 0;
    std::size_t nodes = 0;
    const auto count = [&](std::uint32_t at, std::uint32_t depth, const auto& self) -> void {
      ++nodes;
      levels = std::max(levels, depth);
      for (const WideChild child : tree.arrays().nodes[at].child) {
        const bool inner = !child.is_none() && !child.is_leaf();
        if (inner && tree.arrays().object_rooted_at_node[child.index()] == WideArrays::no_object) {
          self(child.index(), depth + 1, self);
        }
      }
    };
    count(node, 1, count);
    CHECK(made == nodes);
    CHECK(std::max(plan.levels(), 1U) == levels);
  }
  CHECK(tree.validate(traffic.boxes) == "");
}

TEST_CASE("where every object is a leaf, the root rebuilt_in_place is as good as a new tree") {
  WideTraffic traffic({0, 1.0, false, false, false}, 5);
  RandomStream random(6);
  dcem_test::WideMesh mesh;
  std::vector<std::uint32_t> first;
  const auto scatter = [&] {
    for (std::size_t vertex = 0; vertex < mesh.vertices.size(); vertex += 8) {
      const Vec3 by = dcem_test::random_in_cube(random, 300.0) * Vec3(1, 1, 0);
      const Vec3 from = mesh.vertices[vertex] * Vec3(1, 1, 0);
      for (std::size_t corner = 0; corner < 8; ++corner) mesh.vertices[vertex + corner] += by - from;
    }
  };
  std::vector<std::uint32_t> all;
  for (int object = 0; object < 2000; ++object) {
    first.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    mesh.append(dcem_test::box_mesh(Vec3(0), Vec3(4, 2, 1.5)));
  }
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) all.push_back(triangle);
  scatter();
  WideBvh tree, fresh;
  tree.build_objects(mesh.view(), mesh.boxes(), first);
  scatter();
  tree.refit(all, mesh.view(), mesh.boxes());
  fresh.build_objects(mesh.view(), mesh.boxes(), first);
  CHECK(tree.sah_cost() > 10.0 * fresh.sah_cost());
  tree.rebuild_subtree(0);
  // The same boxes in another order, rounded from another origin: ties may fall differently.
  CHECK(tree.sah_cost() == doctest::Approx(fresh.sah_cost()).epsilon(0.01));
  CHECK(tree.validate(mesh.boxes()) == "");
}

TEST_CASE("rebuilt_in_place twice the same way: the same tree, whatever the number of threads") {
  WideTraffic traffic({300, 40.0, true, true, true}, 7);
  WideBvh one = traffic.built();
  WideBuildSettings settings = one.settings();
  settings.threads = 2;
  WideBvh other;
  other.build_objects(traffic.mesh.view(), traffic.boxes, traffic.object_first, settings);
  for (int frame = 0; frame < 20; ++frame) {
    traffic.step();
    for (WideBvh* tree : {&one, &other}) {
      traffic.refit(*tree);
      tree->rebuild_subtree(frame % 3 == 0 ? 0 : nodes_of(tree->arrays())[static_cast<std::size_t>(frame)]);
    }
    REQUIRE(same_nodes(one.arrays(), other.arrays()));
  }
}

TEST_CASE("only if better: what a new plan would not improve stays as it is, what it improves gets the plan's sum") {
  WideTraffic traffic({300, 40.0, false, false, true}, 14);
  WideBvh tree = traffic.built();
  for (int frame = 0; frame < 40; ++frame) {
    traffic.step();
    traffic.refit(tree);
  }
  const WideBvh degraded = tree;
  const double planned_m2 = detail::WidePlan(tree.arrays(), 0, 1).weighted_area_m2(tree.arrays().costs);
  CHECK(tree.rebuild_subtree(0, 1.0) > 0);
  CHECK(tree.arrays().weighted_area_m2 < 0.8 * degraded.arrays().weighted_area_m2);
  // The sum of the whole tree has the objects' own nodes beside what was planned.
  double units_m2 = 0.0;
  for (const std::uint32_t node : nodes_of(tree.arrays())) {
    std::uint32_t above = node;
    while (above != 0 && tree.arrays().object_rooted_at_node[above] == WideArrays::no_object) {
      above = tree.arrays().lane_of_node[above].node();
    }
    if (above == 0) continue;
    const WideNode& held = tree.arrays().nodes[node];
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      if (!held.child[lane].is_none()) units_m2 += static_cast<double>(held.box(lane).half_area());
    }
  }
  CHECK(units_m2 > 0.0);
  CHECK(tree.arrays().weighted_area_m2 == doctest::Approx(planned_m2 + units_m2).epsilon(1e-6));
  const WideBvh kept = tree;
  WideBvh again = degraded;
  const double share = tree.arrays().weighted_area_m2 / degraded.arrays().weighted_area_m2;
  CHECK(again.rebuild_subtree(0, 0.9 * share) == 0);
  CHECK(same_nodes(again.arrays(), degraded.arrays()));
  CHECK(tree.rebuild_subtree(0, 1.0) == 0);
  CHECK(same_nodes(tree.arrays(), kept.arrays()));
  CHECK(tree.rebuild_subtree(0) > 0);
}

TEST_CASE("thousands of rebuilt_in_place parts: no more nodes, no deeper, and the sum of areas stays right") {
  WideTraffic traffic({100, 25.0, true, true, true}, 8);
  WideBvh tree = traffic.built();
  RandomStream random(9);
  std::uint32_t deepest_early = 0, deepest_late = 0;
  std::size_t most_early = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    traffic.step();
    traffic.refit(tree);
    for (int part = 0; part < 4; ++part) {
      const std::vector<std::uint32_t> nodes = nodes_of(tree.arrays());
      tree.rebuild_subtree(nodes[random.next() % nodes.size()]);
    }
    if (frame <= 1000) most_early = tree.arrays().nodes.size();
    std::uint32_t& deepest = frame <= 1000 ? deepest_early : deepest_late;
    deepest = std::max(deepest, depth_below(tree.arrays()));
    if (frame % 100 == 0) REQUIRE(tree.validate(traffic.boxes) == "");
  }
  // It sways, by two levels or so between a thousand frames and the next, but does not grow.
  CHECK(deepest_late <= deepest_early + 5);
  CHECK(deepest_early <= 30);
  // Free nodes are used again: what grows is the largest number that one frame needed.
  CHECK(tree.arrays().nodes.size() <= most_early + most_early / 8);
  CHECK(tree.validate(traffic.boxes) == "");
}

TEST_CASE("what has been rebuilt_in_place has not grown: reinsertion leaves it where it is") {
  WideTraffic traffic({200, 40.0, false, false, true}, 10);
  WideBvh tree = traffic.built();
  for (int frame = 0; frame < 40; ++frame) traffic.step();
  WideTraffic last = traffic;
  last.place_all([&](std::uint32_t object) { return Vec3(object % 20, object / 20, 0.0) * 3.0; });
  last.refit(tree);
  WideBvh degraded = tree;
  CHECK(degraded.reinsert_moved(1.0, 0) > 50);
  tree.rebuild_subtree(0);
  CHECK(tree.reinsert_moved(1.0, 0) == 0);
}

TEST_CASE("objects at one point, without size, absent, alone, or by the thousand can be rebuilt_in_place") {
  RandomStream random(11);
  for (const std::uint32_t objects : {0U, 1U, 2U, 9U, 3000U}) {
    for (const bool has_ground : {false, true}) {
      CAPTURE(objects);
      WideTraffic traffic({objects, 12.0, false, false, has_ground}, 12);
      WideBvh tree = traffic.built();
      const auto follow = [&] {
        traffic.refit(tree);
        for (const std::uint32_t node : nodes_of(tree.arrays())) {
          if (node == 0 || !tree.arrays().lane_of_node[node].is_none()) tree.rebuild_subtree(node);
        }
        tree.rebuild_subtree(0);
        REQUIRE(tree.validate(traffic.boxes) == "");
      };
      traffic.place_all([](std::uint32_t) { return Vec3(1.0, 2.0, 3.0); });
      follow();
      traffic.set_absent(true);
      follow();
      traffic.set_absent(false);
      follow();
      for (Vec3& vertex : traffic.mesh.vertices) vertex = Vec3(0.3, -7.0, 1e6);
      traffic.boxes = traffic.mesh.boxes();
      traffic.moved.resize(traffic.mesh.triangles.size());
      for (std::uint32_t triangle = 0; triangle < traffic.moved.size(); ++triangle) traffic.moved[triangle] = triangle;
      follow();
      if (objects < 100) check_answers(tree, traffic, 5, random);
    }
  }
  WideBvh empty;
  empty.build({}, {});
  CHECK(empty.rebuild_subtree(0) == 0);
  CHECK(empty.validate({}) == "");
}

TEST_CASE("a node that does not exist or is not in use is refused") {
  WideTraffic traffic({100, 12.0, false, false, true}, 13);
  WideBvh tree = traffic.built();
  CHECK_THROWS_AS(tree.rebuild_subtree(static_cast<std::uint32_t>(tree.arrays().nodes.size())), std::invalid_argument);
  CHECK_THROWS_AS(tree.rebuild_subtree(WideArrays::no_object), std::invalid_argument);
  traffic.place_all([](std::uint32_t) { return Vec3(0.0); });
  traffic.refit(tree);
  tree.rebuild_subtree(0);
  traffic.place_all([](std::uint32_t object) { return Vec3(object, 0, 0); });
  traffic.refit(tree);
  tree.reinsert_moved(1.0);
  tree.rebuild_subtree(0);
  REQUIRE(!tree.arrays().free_nodes.empty());
  CHECK_THROWS_AS(tree.rebuild_subtree(tree.arrays().free_nodes.front()), std::invalid_argument);
  CHECK_THROWS_AS(WideBvh().rebuild_subtree(0), std::invalid_argument);
}

}  // namespace test_rebuild_subtree
