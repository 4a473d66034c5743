#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dcem/accel/brute_force.hpp"
#include "dcem/accel/bvh.hpp"
#include "dcem/core/thread_pool.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_bvh {

using namespace dcem;
using dcem_test::Boxes;
using dcem_test::nearest_square;
using dcem_test::reported;

namespace {

/// Every kind of query on random rays and regions gives the same answer on both trees.
template <class Scalar>
void check_same_answers(const Bvh<Scalar>& tree, const BruteForce<Scalar>& oracle, const Boxes<Scalar>& boxes,
                        int trials, std::uint64_t seed) {
  RandomStream random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const auto ray = dcem_test::random_ray<Scalar>(random);
    const auto region = dcem_test::random_box<Scalar>(random);
    const auto low_enough = [&](const Aabb<Scalar>& box) { return box.min.x + 2 * box.min.y < region.max.z; };
    const auto is_blocker = [&](std::uint32_t primitive) {
      return !std::isnan(dcem_test::meet_square(boxes[primitive], 0, ray));
    };
    REQUIRE(nearest_square(tree, boxes, ray) == nearest_square(oracle, boxes, ray));
    REQUIRE(tree.any(ray, is_blocker) == oracle.any(ray, is_blocker));
    REQUIRE(reported([&](auto leaf) { tree.all(ray, leaf); }) == reported([&](auto leaf) { oracle.all(ray, leaf); }));
    const auto without_hits = [&](auto leaf) { tree.closest(ray, [&](std::uint32_t p, Scalar&) { leaf(p); }); };
    REQUIRE(reported(without_hits) == reported([&](auto leaf) { oracle.all(ray, leaf); }));
    REQUIRE(reported([&](auto leaf) { tree.overlapping(region, leaf); }) ==
            reported([&](auto leaf) { oracle.overlapping(region, leaf); }));
    REQUIRE(reported([&](auto leaf) { tree.visit(low_enough, leaf); }) ==
            reported([&](auto leaf) { oracle.visit(low_enough, leaf); }));
  }
}

template <class Scalar>
struct Pair {
  Boxes<Scalar> boxes;
  Bvh<Scalar> tree;
  BruteForce<Scalar> oracle;

  explicit Pair(Boxes<Scalar> given) : boxes(std::move(given)) {
    tree.build(boxes);
    oracle.build(boxes);
    REQUIRE(tree.validate(boxes) == "");
  }
  void check(int trials, std::uint64_t seed) const {
    REQUIRE(tree.validate(boxes) == "");
    REQUIRE(tree.bounds() == oracle.bounds());
    check_same_answers(tree, oracle, boxes, trials, seed);
  }
};

template <class Scalar>
void shift(Aabb<Scalar>& box, const Vector3<Scalar>& by) {
  box.min += by;
  box.max += by;
}

/// Groups of 0 … 60 primitives over all of `count`.
std::vector<std::uint32_t> random_objects(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<std::uint32_t> first;
  for (std::size_t next = 0; next < count; next += random.next() % 4 == 0 ? 0 : random.next() % 60) {
    first.push_back(static_cast<std::uint32_t>(next));
  }
  return first;
}

}  // namespace

TEST_CASE_TEMPLATE("every query gives the oracle's answer", Scalar, float, double) {
  for (const std::size_t count : {1U, 2U, 3U, 5U, 9U, 40U, 1000U}) {
    Pair<Scalar>(dcem_test::random_boxes<Scalar>(count, count)).check(count < 100 ? 500 : 3000, 100 + count);
  }
}

TEST_CASE_TEMPLATE("balls: the closest_hit distance is the oracle's", Scalar, float, double) {
  const Pair<Scalar> pair(dcem_test::random_boxes<Scalar>(600, 31));
  // The ball inside a box, with the smallest half side as radius, shrunk by more than the rounding of its intersection.
  const auto distance_to = [&](const auto& tree, const Ray<Scalar>& ray) {
    Scalar best = std::numeric_limits<Scalar>::infinity();
    tree.closest(ray, [&](std::uint32_t primitive, Scalar& t_max) {
      const Vector3<Scalar> extent = pair.boxes[primitive].extent();
      const Scalar radius = Scalar(0.49) * std::min({extent.x, extent.y, extent.z});
      const Vector3<Scalar> away = ray.origin - pair.boxes[primitive].center();
      const Scalar a = glm::dot(ray.direction, ray.direction);
      const Scalar b = glm::dot(away, ray.direction);
      const Scalar root = b * b - a * (glm::dot(away, away) - radius * radius);
      if (!(root > 0)) return;
      const Scalar t = (-b - std::sqrt(root)) / a;
      if (t >= ray.t_min && t < t_max) best = t_max = t;
    });
    return best;
  };
  RandomStream random(32);
  int hits = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const auto ray = dcem_test::random_ray<Scalar>(random);
    const Scalar expected = distance_to(pair.oracle, ray);
    REQUIRE(distance_to(pair.tree, ray) == expected);
    hits += std::isfinite(expected) ? 1 : 0;
  }
  CHECK(hits > 200);
}

TEST_CASE_TEMPLATE("ties on equal distance reach the callback whatever the tree", Scalar, float, double) {
  // A floor of squares at z = 0, each ten times over: every ray down meets ten or more at the same distance.
  Boxes<Scalar> boxes;
  for (int index = 0; index < 1000; ++index) {
    const Vector3<Scalar> corner(static_cast<Scalar>(index % 10), static_cast<Scalar>(index / 10 % 10), 0);
    boxes.push_back({corner, corner + Vector3<Scalar>(1, 1, 0)});
  }
  Pair<Scalar> pair(boxes);
  RandomStream random(41);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3<Scalar> from(static_cast<Scalar>(10 * random.uniform()), static_cast<Scalar>(10 * random.uniform()),
                               Scalar(3.3));
    const Ray<Scalar> ray{from, {Scalar(0.1), Scalar(-0.07), Scalar(-0.9)}};
    const auto ties = [&](const auto& tree) {
      std::vector<std::uint32_t> equal;
      Scalar best = std::numeric_limits<Scalar>::infinity();
      tree.closest(ray, [&](std::uint32_t primitive, Scalar& t_max) {
        const Scalar t = dcem_test::meet_square(boxes[primitive], 2, ray);
        if (!(t <= best)) return;
        if (t < best) equal.clear();
        best = t_max = t;
        equal.push_back(primitive);
      });
      std::ranges::sort(equal);
      return equal;
    };
    REQUIRE(ties(pair.tree) == ties(pair.oracle));
  }
}

TEST_CASE_TEMPLATE("degenerate boxes: identical, points, empty, far away", Scalar, float, double) {
  using V = Vector3<Scalar>;
  Pair<Scalar>(Boxes<Scalar>(500, {V(1), V(2)})).check(300, 51);
  Pair<Scalar>(Boxes<Scalar>(500, {V(3), V(3)})).check(300, 52);
  Pair<Scalar>(Boxes<Scalar>(20)).check(300, 53);
  auto mixed = dcem_test::random_boxes<Scalar>(400, 54);
  for (std::size_t index = 0; index < mixed.size(); index += 3) mixed[index] = {};
  mixed[1] = {V(1, 9, 1), V(2, 8, 2)};
  Pair<Scalar>(mixed).check(1000, 55);
  auto far = dcem_test::random_boxes<Scalar>(400, 56);
  for (auto& box : far) shift(box, V(10000, -10000, 0));
  Pair<Scalar> away(far);
  RandomStream random(57);
  for (int trial = 0; trial < 2000; ++trial) {
    auto ray = dcem_test::random_ray<Scalar>(random);
    ray.origin += V(10000, -10000, 0);
    REQUIRE(nearest_square(away.tree, far, ray) == nearest_square(away.oracle, far, ray));
    REQUIRE(reported([&](auto leaf) { away.tree.all(ray, leaf); }) ==
            reported([&](auto leaf) { away.oracle.all(ray, leaf); }));
  }
}

TEST_CASE("a tree of nothing answers nothing") {
  Bvh<double> tree;
  CHECK(tree.validate({}) == "");
  tree.build({});
  CHECK(tree.validate({}) == "");
  CHECK(tree.bounds().empty());
  CHECK(tree.depth() == 0);
  CHECK(tree.sah_cost() == 0.0);
  CHECK(tree.refit_all({}) == RefitReport{});
  CHECK_FALSE(tree.any({Vec3(0), Vec3(1)}, [](std::uint32_t) { return true; }));
  CHECK(reported([&](auto leaf) { tree.overlapping({Vec3(-1), Vec3(1)}, leaf); }).empty());
  tree.build_objects({}, std::vector<std::uint32_t>{0, 0});
  CHECK(tree.object_root(1) == no_node);
  CHECK(tree.validate({}) == "");
}

TEST_CASE("a region without end meets all boxes but the empty ones, an empty region none") {
  Boxes<double> boxes = dcem_test::random_boxes<double>(50, 61);
  boxes[7] = {};
  const Pair<double> pair(boxes);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(reported([&](auto leaf) { pair.tree.overlapping({Vec3(-infinity), Vec3(infinity)}, leaf); }).size() == 49);
  CHECK(reported([&](auto leaf) { pair.tree.overlapping({Vec3(5, 0, 0), Vec3(-5, 9, 9)}, leaf); }).empty());
}

TEST_CASE("boxes that are no boxes are refused, and the tree stays as it was") {
  Pair<double> pair(dcem_test::random_boxes<double>(100, 62));
  Boxes<double> bad = pair.boxes;
  bad[50].max.y = std::numeric_limits<double>::quiet_NaN();
  bad[51].max.y = std::numeric_limits<double>::infinity();
  for (const std::uint32_t primitive : {50U, 51U}) {
    CHECK_THROWS_AS(pair.tree.refit(std::vector{1U, primitive}, bad), std::invalid_argument);
    CHECK_THROWS_AS(pair.tree.rebuild_subtree(0, bad), std::invalid_argument);
  }
  CHECK_THROWS_AS(pair.tree.build(bad), std::invalid_argument);
  CHECK_THROWS_AS(pair.tree.refit_all(bad), std::invalid_argument);
  CHECK_THROWS_AS(pair.tree.refit(std::vector{100U}, pair.boxes), std::invalid_argument);
  CHECK_THROWS_AS(pair.tree.rebuild_subtree(1, pair.boxes), std::invalid_argument);
  CHECK_THROWS_AS(pair.tree.rebuild_subtree(99999, pair.boxes), std::invalid_argument);
  bad.pop_back();
  CHECK_THROWS_AS(pair.tree.refit_all(bad), std::invalid_argument);
  pair.check(50, 63);
}

TEST_CASE_TEMPLATE("after each frame of random motion a refitted tree gives the oracle's answers", Scalar, float,
                   double) {
  Pair<Scalar> pair(dcem_test::random_boxes<Scalar>(700, 71));
  RandomStream random(72);
  for (int frame = 0; frame < 200; ++frame) {
    std::vector<std::uint32_t> moved;
    for (std::size_t count = random.next() % 80; count > 0; --count) {
      const auto primitive = static_cast<std::uint32_t>(random.next() % pair.boxes.size());
      moved.push_back(primitive);
      if (random.uniform() < 0.1) pair.boxes[primitive] = {};
      if (random.uniform() < 0.5) shift(pair.boxes[primitive], dcem_test::random_point<Scalar>(random, 0.5));
      if (random.uniform() < 0.1) pair.boxes[primitive] = dcem_test::random_box<Scalar>(random);
    }
    pair.tree.refit(moved, pair.boxes);
    pair.oracle.refit(moved, pair.boxes);
    pair.check(20, 1000 + static_cast<std::uint64_t>(frame));
  }
  CHECK(pair.tree.quality().ratio() > 1.0);
}

TEST_CASE("a refit costs what moved") {
  Pair<double> pair(dcem_test::random_boxes<double>(1000, 81));
  CHECK(pair.tree.refit({}, pair.boxes) == RefitReport{});
  CHECK(pair.tree.refit_all(pair.boxes) == RefitReport{});
  CHECK(pair.tree.refit(std::vector{3U, 4U, 3U}, pair.boxes) == RefitReport{});
  for (std::uint32_t primitive = 0; primitive < 1000; ++primitive) {
    shift(pair.boxes[primitive], Vec3(100, 0, 0));
    const RefitReport out = pair.tree.refit(std::vector{primitive}, pair.boxes);
    CHECK(out.touched_nodes >= 1);
    CHECK(out.touched_nodes <= pair.tree.depth());
    CHECK(out.changed_nodes <= out.touched_nodes);
    shift(pair.boxes[primitive], Vec3(-100, 0, 0));
    CHECK(pair.tree.refit(std::vector{primitive}, pair.boxes).touched_nodes <= pair.tree.depth());
  }
  CHECK(pair.tree.validate(pair.boxes) == "");
}

TEST_CASE("a refit is exactly tight: motion there and back leaves every box as it was") {
  Pair<double> pair(dcem_test::random_boxes<double>(400, 82));
  const auto before = pair.tree.arrays().nodes;
  const Boxes<double> home = pair.boxes;
  for (auto& box : pair.boxes) shift(box, Vec3(3, -2, 1));
  pair.tree.refit_all(pair.boxes);
  CHECK(pair.tree.validate(pair.boxes) == "");
  const RefitReport back = pair.tree.refit_all(home);
  std::size_t live = 0;
  for_each_node(pair.tree.nodes(), 0, [&](std::uint32_t, std::uint32_t) { ++live; });
  CHECK(back == RefitReport{live, live, live});
  CHECK(std::ranges::equal(before, pair.tree.nodes(), {}, &BvhNode<double>::box, &BvhNode<double>::box));
  CHECK(pair.tree.quality().ratio() == doctest::Approx(1.0));
}

TEST_CASE_TEMPLATE("a rebuilt subtree heals the tree and leaves all other nodes alone", Scalar, float, double) {
  Pair<Scalar> pair(dcem_test::random_boxes<Scalar>(900, 91));
  RandomStream random(92);
  for (int round = 0; round < 60; ++round) {
    std::uint32_t node = 0;
    for (std::uint64_t steps = random.next() % 8; steps > 0 && !pair.tree.nodes()[node].is_leaf(); --steps) {
      node = pair.tree.nodes()[node].left() + static_cast<std::uint32_t>(random.next() % 2);
    }
    std::vector<bool> below(pair.tree.nodes().size(), false);
    for_each_node(pair.tree.nodes(), node, [&](std::uint32_t slot, std::uint32_t) { below[slot] = true; });
    // Boxes swap places below the node: its own box stays, its insides become bad.
    std::vector<std::uint32_t> held;
    for (std::uint32_t primitive = 0; primitive < 900; ++primitive) {
      if (below[pair.tree.arrays().leaf_of[primitive]]) held.push_back(primitive);
    }
    for (std::size_t index = 0; index + 1 < held.size(); index += 2) {
      std::swap(pair.boxes[held[index]], pair.boxes[held[index + 1]]);
    }
    pair.oracle.refit_all(pair.boxes);
    const auto before = pair.tree.arrays();
    const auto cost_before = pair.tree.sah_cost();
    if (round % 2 == 0) {
      pair.tree.refit_all(pair.boxes);
      REQUIRE(pair.tree.sah_cost() >= doctest::Approx(cost_before));
    }
    pair.tree.rebuild_subtree(node, pair.boxes);
    pair.check(20, 2000 + static_cast<std::uint64_t>(round));
    for (std::size_t slot = 0; slot < below.size(); ++slot) {
      if (below[slot] || before.parent[slot] == free_slot) continue;
      REQUIRE(pair.tree.nodes()[slot].box == before.nodes[slot].box);
      REQUIRE(pair.tree.nodes()[slot].first == before.nodes[slot].first);
      REQUIRE(pair.tree.nodes()[slot].count == before.nodes[slot].count);
      REQUIRE(pair.tree.arrays().parent[slot] == before.parent[slot]);
    }
  }
}

TEST_CASE("rebuilding a subtree whose box has grown refits its ancestors") {
  Pair<double> pair(dcem_test::random_boxes<double>(300, 93));
  const std::uint32_t leaf = pair.tree.arrays().leaf_of[17];
  shift(pair.boxes[17], Vec3(50, 50, 50));
  pair.oracle.refit_all(pair.boxes);
  pair.tree.rebuild_subtree(leaf, pair.boxes);
  pair.check(100, 94);
}

TEST_CASE("rebuilding the root is a whole build, in the same slots") {
  Pair<double> pair(dcem_test::random_boxes<double>(500, 95));
  const auto before = pair.tree.arrays().nodes;
  pair.tree.rebuild_subtree(0, pair.boxes);
  REQUIRE(pair.tree.nodes().size() == before.size());
  CHECK(std::ranges::equal(before, pair.tree.nodes(), {}, &BvhNode<double>::box, &BvhNode<double>::box));
}

TEST_CASE_TEMPLATE("objects own subtrees", Scalar, float, double) {
  auto boxes = dcem_test::random_boxes<Scalar>(900, 101);
  const auto objects = random_objects(boxes.size(), 102);
  Pair<Scalar> pair(boxes);
  pair.tree.build_objects(boxes, objects);
  pair.oracle.build_objects(boxes, objects);
  pair.check(1000, 103);
  REQUIRE(pair.tree.object_count() == objects.size());
  for (std::size_t object = 0; object < objects.size(); ++object) {
    const std::size_t end = object + 1 < objects.size() ? objects[object + 1] : boxes.size();
    const std::uint32_t root = pair.tree.object_root(object);
    CHECK((root == no_node) == (end == objects[object]));
    Aabb<Scalar> expected;
    for (std::size_t primitive = objects[object]; primitive < end; ++primitive) expected.extend(boxes[primitive]);
    if (root != no_node) CHECK(pair.tree.nodes()[root].box == expected);
  }
  CHECK_THROWS_AS(pair.tree.object_root(objects.size()), std::out_of_range);
}

TEST_CASE("objects survive motion, rebuilding of one of them and rebuilding above them") {
  auto boxes = dcem_test::random_boxes<double>(900, 111);
  const auto objects = random_objects(boxes.size(), 112);
  Pair<double> pair(boxes);
  pair.tree.build_objects(pair.boxes, objects);
  RandomStream random(113);
  for (int round = 0; round < 60; ++round) {
    const std::size_t object = random.next() % objects.size();
    const std::uint32_t root = pair.tree.object_root(object);
    if (root == no_node) continue;
    const std::size_t end = object + 1 < objects.size() ? objects[object + 1] : pair.boxes.size();
    std::vector<std::uint32_t> moved(end - objects[object]);
    std::iota(moved.begin(), moved.end(), objects[object]);
    const Vec3 by = dcem_test::random_point<double>(random, 5.0);
    for (const std::uint32_t primitive : moved) shift(pair.boxes[primitive], by);
    if (round % 3 == 0) {
      pair.tree.rebuild_subtree(root, pair.boxes);
      CHECK(pair.tree.object_root(object) == root);
    } else {
      pair.tree.refit(moved, pair.boxes);
    }
    if (round % 3 == 1) {
      const std::uint32_t above = pair.tree.arrays().parent[root];
      if (above != no_node) pair.tree.rebuild_subtree(above, pair.boxes);
    }
    pair.oracle.refit_all(pair.boxes);
    pair.check(30, 3000 + static_cast<std::uint64_t>(round));
  }
}

TEST_CASE("the deepest tree that can be built is walked in full") {
  Boxes<double> boxes;
  for (int index = 0; index < 450; ++index) {
    const Vec3 corner(std::ldexp(1.0, 45 - index));
    boxes.push_back({corner, corner * 1.5});
  }
  std::vector<std::uint32_t> objects;
  for (std::uint32_t first = 0; first < 450; first += 3) objects.push_back(first);
  for (const bool by_object : {false, true}) {
    Bvh<double> tree;
    if (by_object) {
      tree.build_objects(boxes, objects);
    } else {
      tree.build(boxes);
    }
    CHECK(tree.depth() > 32);
    CHECK(tree.validate(boxes) == "");
    CHECK(reported([&](auto leaf) { tree.all({Vec3(0), Vec3(1)}, leaf); }).size() == 450);
    std::size_t asked = 0;
    tree.closest({Vec3(1e15), Vec3(-1)}, [&](std::uint32_t, double&) { ++asked; });
    CHECK(asked == 450);
  }
}

TEST_CASE("counters count, add up, and show that the tree saves work") {
  const Pair<double> pair(dcem_test::random_boxes<double>(1000, 121));
  TraversalCounters tree;
  TraversalCounters oracle;
  RandomStream random(122);
  std::uint64_t calls = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto ray = dcem_test::random_ray<double>(random);
    pair.tree.all(
        ray, [&](std::uint32_t) { ++calls; }, &tree);
    pair.oracle.all(
        ray, [](std::uint32_t) {}, &oracle);
  }
  CHECK(tree.primitives_tested == calls);
  CHECK(tree.primitives_tested == oracle.primitives_tested);
  CHECK(tree.nodes_visited > 0);
  // 1000 primitives in leaves of up to four are some 700 nodes; a ray should meet few of them.
  CHECK(tree.nodes_visited < 100 * 350);
}

TEST_CASE("the larger child is the left one, and any-hit stops at once") {
  const Pair<double> pair(dcem_test::random_boxes<double>(500, 131));
  for_each_node(pair.tree.nodes(), 0, [&](std::uint32_t slot, std::uint32_t) {
    const auto& node = pair.tree.nodes()[slot];
    if (node.is_leaf()) return;
    CHECK(pair.tree.nodes()[node.left()].box.half_area() >= pair.tree.nodes()[node.right()].box.half_area());
  });
  TraversalCounters counters;
  CHECK(pair.tree.any(
      {Vec3(-20, -20, -20), Vec3(1)}, [](std::uint32_t) { return true; }, &counters));
  CHECK(counters.primitives_tested == 1);
}

TEST_CASE("from either end of a row, the closest_hit square is found among the first few") {
  Boxes<double> boxes;
  for (int index = 0; index < 1000; ++index) boxes.push_back({Vec3(index, 0, 0), Vec3(index, 1, 1)});
  Bvh<double> tree;
  tree.build(boxes);
  for (const double side : {-1.0, 1.0}) {
    const Ray<double> ray{Vec3(500 + 600 * side, 0.4, 0.6), Vec3(-side, 0, 0)};
    double closest_hit = 0.0;
    std::size_t asked = 0;
    tree.closest(ray, [&](std::uint32_t primitive, double& t_max) {
      ++asked;
      closest_hit = t_max = std::min(t_max, std::abs(ray.origin.x - primitive));
    });
    CHECK(closest_hit == (side < 0 ? 100.0 : 101.0));
    CHECK(asked <= maximum_leaf_size);
  }
}

TEST_CASE("queries on several threads give what one thread gives") {
  const Pair<double> pair(dcem_test::random_boxes<double>(800, 141));
  const auto answers = [&](unsigned threads) {
    std::vector<dcem_test::NearestSquare<double>> closest_hit(2000);
    parallel_for(closest_hit.size(), threads, [&](std::size_t index, unsigned) {
      RandomStream random(index);
      closest_hit[index] = nearest_square(pair.tree, pair.boxes, dcem_test::random_ray<double>(random));
    });
    return closest_hit;
  };
  CHECK(answers(1) == answers(4));
}

}  // namespace test_bvh
