#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/accel/wide/update/rotation.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_traffic.hpp"

namespace test_rotation {

using namespace dcem;
using dcem_test::check_answers;
using dcem_test::depth_below;
using dcem_test::nodes_of;
using dcem_test::WideTraffic;
using Kind = detail::WideRotation::Kind;

namespace {

TrackedMeasures touched() {
  return {false, false, true};
}

Aabb<float> joined(const std::vector<Aabb<float>>& boxes) {
  Aabb<float> all;
  for (const Aabb<float>& box : boxes) all.extend(box);
  return all;
}

bool is_inner(const WideArrays& arrays, WideChild child) {
  return !child.is_none() && !child.is_leaf() && arrays.object_rooted_at_node[child.index()] == WideArrays::no_object;
}

std::vector<Aabb<float>> boxes_in(const WideNode& node) {
  std::vector<Aabb<float>> boxes;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if (!node.child[lane].is_none()) boxes.push_back(node.box(lane));
  }
  return boxes;
}

/// The most that one change around a node gains, found by trying all of them.
double best_gain(const WideArrays& arrays, std::uint32_t index, bool may_lower) {
  const WideNode& node = arrays.nodes[index];
  double best = 0.0;
  const auto area = [](const std::vector<Aabb<float>>& boxes) {
    return static_cast<double>(joined(boxes).half_area());
  };
  for (std::uint32_t from = 0; from < simd_lanes; ++from) {
    if (!is_inner(arrays, node.child[from])) continue;
    const std::vector<Aabb<float>> held = boxes_in(arrays.nodes[node.child[from].index()]);
    for (std::size_t entry = 0; entry < held.size(); ++entry) {
      std::vector<Aabb<float>> others = held;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(entry));
      const double lightened = area(held) - (others.size() == 1 ? 0.0 : area(others));
      for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
        const WideChild child = node.child[lane];
        if (lane == from) continue;
        if (child.is_none()) {
          best = std::max(best, lightened);
        } else if (is_inner(arrays, child)) {
          std::vector<Aabb<float>> taken = boxes_in(arrays.nodes[child.index()]);
          if (taken.size() == simd_lanes) continue;
          const double before = area(taken);
          taken.push_back(held[entry]);
          best = std::max(best, lightened - (area(taken) - before));
        } else if (may_lower) {
          std::vector<Aabb<float>> exchanged = others;
          exchanged.push_back(node.box(lane));
          best = std::max(best, area(held) - area(exchanged));
        }
      }
    }
  }
  return best;
}

std::vector<std::vector<std::uint32_t>> leaves_of_objects(const WideArrays& arrays) {
  std::vector<std::vector<std::uint32_t>> leaves(arrays.object_root.size());
  const auto collect = [&](WideChild child, std::vector<std::uint32_t>& found, const auto& self) -> void {
    if (child.is_none()) return;
    if (child.is_leaf()) {
      found.push_back(child.index());
      return;
    }
    for (const WideChild below : arrays.nodes[child.index()].child) self(below, found, self);
  };
  for (std::size_t object = 0; object < leaves.size(); ++object) {
    collect(arrays.object_root[object], leaves[object], collect);
    std::sort(leaves[object].begin(), leaves[object].end());
  }
  return leaves;
}

}  // namespace

TEST_CASE("rotated in every frame of a drive: all promises, whole objects, a smaller sum, the same bits") {
  for (const bool deforms : {false, true}) {
    for (const std::uint32_t most : {1U, 5U}) {
      WideTraffic traffic({80, 14.0, deforms, true, true}, most);
      WideBvh tree = traffic.built();
      tree.watch(touched());
      const auto objects = leaves_of_objects(tree.arrays());
      RandomStream random(2);
      std::size_t rotated = 0;
      for (int frame = 0; frame < 60; ++frame) {
        CAPTURE(frame);
        traffic.step();
        traffic.refit(tree);
        const double before_m2 = tree.arrays().weighted_area_m2;
        const std::size_t count = tree.rotate_touched(most);
        rotated += count;
        CHECK((count > 0 ? tree.arrays().weighted_area_m2 < before_m2 : tree.arrays().weighted_area_m2 == before_m2));
        REQUIRE(leaves_of_objects(tree.arrays()) == objects);
        check_answers(tree, traffic, 10, random);
      }
      CHECK(rotated > 30);
    }
  }
}

TEST_CASE("the change that is chosen is the best there is, and gains what it says") {
  WideTraffic traffic({150, 25.0, true, true, true}, 3);
  WideBvh tree = traffic.built();
  tree.watch(touched());
  std::size_t kinds[4] = {0, 0, 0, 0}, alone = 0;
  for (int frame = 0; frame < 40; ++frame) {
    traffic.step();
    // One object alone moves: where one change is carried out, the sum falls by what one of the nodes promises.
    WideBvh before = tree;
    before.rotate_touched(1);  // nothing waits any more
    const std::span<const std::uint32_t> first = std::span(traffic.moved).first(12);
    before.refit(first, traffic.mesh.view(), traffic.boxes);
    WideBvh after = before;
    if (after.rotate_touched(1) == 1) {
      const double fall_m2 = before.arrays().weighted_area_m2 - after.arrays().weighted_area_m2;
      const auto nodes = nodes_of(before.arrays());
      CHECK(std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
        return fall_m2 == doctest::Approx(best_gain(before.arrays(), node, true)).epsilon(1e-4);
      }));
      ++alone;
    }
    traffic.refit(tree);
    const WideArrays& arrays = tree.arrays();
    for (const std::uint32_t node : nodes_of(arrays)) {
      for (const std::uint32_t depth : {1U, detail::wide_edit_depth_limit}) {
        const detail::WideRotation found = detail::WideRotationSearch(arrays, node, depth).best();
        const double expected = best_gain(arrays, node, depth < detail::wide_edit_depth_limit);
        const double least = 1e-3 * static_cast<double>(arrays.nodes[node].box().half_area());
        ++kinds[static_cast<std::size_t>(found.kind)];
        // Differences of surfaces in single precision.
        const double rounding = 1e-6 * static_cast<double>(arrays.nodes[node].box().half_area());
        if (found.kind == Kind::none) {
          REQUIRE(expected <= least + rounding);
        } else {
          REQUIRE(static_cast<double>(found.gain_m2) == doctest::Approx(expected).epsilon(1e-6).scale(rounding * 1e6));
        }
      }
    }
    tree.rotate_touched(1);
    tree.reinsert_moved(1.1);
  }
  CHECK(alone > 0);
  for (const Kind kind : {Kind::none, Kind::up, Kind::exchange, Kind::over}) {
    CAPTURE(static_cast<int>(kind));
    CHECK(kinds[static_cast<std::size_t>(kind)] > 5);
  }
}

TEST_CASE("rotations mend: refit with them stays far below refit alone") {
  WideTraffic traffic({300, 60.0, false, false, true}, 4);
  WideBvh refitted = traffic.built(), rotated = traffic.built();
  rotated.watch(touched());
  for (int frame = 0; frame < 60; ++frame) {
    traffic.step();
    traffic.refit(refitted);
    traffic.refit(rotated);
    rotated.rotate_touched(1);
  }
  MESSAGE("SAH: refit " << refitted.sah_cost() << ", with rotations " << rotated.sah_cost() << ", new "
                        << traffic.built().sah_cost());
  CHECK(rotated.sah_cost() < 0.8 * refitted.sah_cost());
}

TEST_CASE("rotations come to an end, and where nothing was touched there are none") {
  WideTraffic traffic({200, 30.0, false, false, true}, 5);
  WideBvh tree = traffic.built();
  CHECK(tree.rotate_touched(8) == 0);
  traffic.step();
  traffic.refit(tree);
  CHECK(tree.rotate_touched(8) == 0);  // it was not asked to note anything
  tree.watch(touched());
  CHECK(tree.rotate_touched(8) == 0);
  for (int frame = 0; frame < 20; ++frame) {
    traffic.step();
    traffic.refit(tree);
  }
  int rounds = 0;
  while (tree.rotate_touched(8) > 0) REQUIRE(++rounds < 50);
  CHECK(rounds > 0);
  CHECK(tree.validate(traffic.boxes) == "");
}

TEST_CASE("2,000 frames of rotations and reinsertions: no deeper, no more nodes") {
  WideTraffic traffic({100, 25.0, true, true, true}, 6);
  WideBvh tree = traffic.built();
  tree.watch(touched());
  const std::uint32_t depth = depth_below(tree.arrays());
  std::size_t most_early = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    traffic.step();
    traffic.refit(tree);
    if (frame % 2 == 0) tree.reinsert_moved(1.1);
    tree.rotate_touched(3);
    if (frame <= 1000) most_early = tree.arrays().nodes.size();
    if (frame % 100 == 0) REQUIRE(tree.validate(traffic.boxes) == "");
    REQUIRE(depth_below(tree.arrays()) <= depth + 6);
  }
  CHECK(tree.arrays().nodes.size() <= most_early + most_early / 8);
  CHECK(tree.validate(traffic.boxes) == "");
}

TEST_CASE("objects at one point, without size, absent, or by the thousand can be rotated") {
  RandomStream random(7);
  for (const std::uint32_t objects : {0U, 1U, 9U, 3000U}) {
    CAPTURE(objects);
    WideTraffic traffic({objects, 12.0, false, false, objects != 9}, 8);
    WideBvh tree = traffic.built();
    tree.watch(touched());
    const auto follow = [&] {
      traffic.refit(tree);
      tree.rotate_touched(4);
      REQUIRE(tree.validate(traffic.boxes) == "");
    };
    traffic.place_all([](std::uint32_t) { return Vec3(1.0, 2.0, 3.0); });
    follow();
    traffic.set_absent(true);
    follow();
    traffic.place_all([](std::uint32_t object) { return Vec3(object % 50, object / 50, 0.0); });
    traffic.set_absent(false);
    follow();
    if (objects < 100) check_answers(tree, traffic, 5, random);
  }
  WideBvh empty;
  empty.watch(touched());
  CHECK(empty.rotate_touched(1) == 0);
}

}  // namespace test_rotation
