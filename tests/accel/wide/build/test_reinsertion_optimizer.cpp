#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "dcem/accel/wide/build/leaf_optimizer.hpp"
#include "dcem/accel/wide/build/reinsertion_optimizer.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/random_boxes.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_reinsertion_optimizer {

using namespace dcem;
using namespace dcem_test;

namespace {

/// A binary tree and the items in its order.
struct Binary {
  std::vector<WideItem> items;
  std::vector<WideSplit> splits;

  Binary(std::vector<WideItem> list, std::uint32_t leaf_limit) : items(std::move(list)) {
    splits = WideBinner().build(items, leaf_limit, 1);
  }
  double cost_m2(const WideCosts& costs = {}) const { return WideCollapse(splits, items, costs).cost_m2(); }
  double sum_m2() const {
    double sum = 0.0;
    for (const WideSplit& split : splits) sum += split.is_leaf() ? 0.0 : static_cast<double>(split.half_area_m2);
    return sum;
  }
  std::uint32_t levels() const { return detail::depth_of_tree(splits); }
};

WideItem item_at(const Vec3& low, const Vec3& high, std::uint32_t index, std::uint32_t kind) {
  WideItem item{Float4{}, Float4{}, index, kind};
  for (int axis = 0; axis < 3; ++axis) {
    item.low[axis] = static_cast<float>(low[axis]);
    item.high[axis] = static_cast<float>(high[axis]);
  }
  return item;
}

std::vector<WideItem> random_items(std::size_t count, std::uint32_t kinds, std::uint64_t seed) {
  std::vector<WideItem> items;
  for (const Aabb<double>& box : random_boxes<double>(count, seed)) {
    const auto index = static_cast<std::uint32_t>(items.size());
    items.push_back(item_at(box.min, box.max, index, kinds == 0 ? WideItem::no_kind : index % kinds));
  }
  return items;
}

/// What is known to be hard for trees of boxes. The number of items as asked for.
std::vector<WideItem> hard_items(const std::string& what, std::uint32_t count) {
  std::vector<WideItem> items;
  for (std::uint32_t index = 0; index < count; ++index) {
    Vec3 low(0.0), high(0.0);
    if (what == "exponentially spaced") {
      low = Vec3(std::pow(1.7, static_cast<double>(index % 60)), 0.0, 0.0);
      high = low * 1.01 + Vec3(0.0, 0.01, 0.01);
    } else if (what == "nested") {
      high = Vec3(std::pow(1.3, static_cast<double>(index % 100)));
      low = -high;
    } else if (what == "a large one among small ones" && index == 0) {
      low = Vec3(-1e4, -1e4, 0.0);
      high = Vec3(1e4, 1e4, 0.0);
    } else if (what == "a large one among small ones") {
      low = Vec3(index % 17, index % 23, 0.0);
      high = low + Vec3(1.0, 0.0, 3.0);
    } else if (what == "not finite when multiplied") {
      low = Vec3(1e25 * index, 1e25 * (index % 7), 0.0);
      high = low * 2.0 + Vec3(1e25);
    } else if (what == "empty boxes and others" && index % 2 == 1) {
      low = Vec3(100.0 + index);
      high = low + Vec3(1.0);
    }  // the rest, and "one point": a point at 0, as an empty box is
    items.push_back(item_at(low, high, index, 0));
  }
  return items;
}

/// The promises of a tree that a collapse and the builder rely on, found out from the items alone.
void check_tree(const Binary& binary, std::size_t count, std::uint32_t leaf_limit) {
  REQUIRE(binary.items.size() == count);
  std::vector<int> seen(count, 0);
  for (const WideItem& item : binary.items) ++seen[item.index];
  REQUIRE(std::ranges::all_of(seen, [](int times) { return times == 1; }));
  REQUIRE(binary.splits.front().first == 0);
  REQUIRE(binary.splits.front().count == count);
  for (std::uint32_t slot = 0; slot < binary.splits.size(); ++slot) {
    const WideSplit& split = binary.splits[slot];
    const auto own = std::span(binary.items).subspan(split.first, split.count);
    const double area = static_cast<double>(detail::box_around(own).half_area());
    if (std::isfinite(area)) REQUIRE(std::abs(static_cast<double>(split.half_area_m2) - area) <= 1e-5 * area);
    if (split.is_leaf()) {
      REQUIRE(split.count >= 1);
      REQUIRE(split.count <= leaf_limit);
      for (const WideItem& item : own) {
        if (own.size() > 1) REQUIRE((item.kind == own.front().kind && item.kind != WideItem::no_kind));
      }
      continue;
    }
    REQUIRE(std::min(split.left, split.right) > slot);
    const WideSplit &left = binary.splits[split.left], &right = binary.splits[split.right];
    REQUIRE(left.first == split.first);
    REQUIRE(right.first == split.first + left.count);
    REQUIRE(left.count + right.count == split.count);
  }
  REQUIRE(binary.levels() <= detail::wide_build_depth_limit);
}

bool is_same(const Binary& one, const Binary& other) {
  return std::ranges::equal(one.splits, other.splits,
                            [](const WideSplit& a, const WideSplit& b) {
                              return a.left == b.left && a.right == b.right && a.first == b.first &&
                                     a.count == b.count && a.half_area_m2 == b.half_area_m2;
                            }) &&
         std::ranges::equal(one.items, other.items, {}, &WideItem::index, &WideItem::index);
}

/// A row of 64 small things and a wrong tree over them: at every depth its halves hold every other one.
Binary interleaved() {
  constexpr std::uint32_t count = 64;
  std::vector<WideItem> items;
  for (std::uint32_t place = 0; place < count; ++place) {
    std::uint32_t index = 0;
    for (std::uint32_t bit = 0; bit < 6; ++bit) index |= (place >> bit & 1U) << (5 - bit);
    const Vec3 low(index, 0.0, 0.0);
    items.push_back(item_at(low, low + Vec3(0.5), index, WideItem::no_kind));
  }
  Binary binary(items, 1);
  binary.items = items;
  // The same shape for any order of items: halves of halves.
  binary.splits.assign(1, {0.0F, 0, 0, 0, count});
  for (std::uint32_t slot = 0; slot < binary.splits.size(); ++slot) {
    const WideSplit split = binary.splits[slot];
    binary.splits[slot].half_area_m2 =
        detail::box_around(std::span<const WideItem>(items).subspan(split.first, split.count)).half_area();
    if (split.count == 1) continue;
    binary.splits[slot].left = static_cast<std::uint32_t>(binary.splits.size());
    binary.splits[slot].right = binary.splits[slot].left + 1;
    binary.splits.push_back({0.0F, 0, 0, split.first, split.count / 2});
    binary.splits.push_back({0.0F, 0, 0, split.first + split.count / 2, split.count - split.count / 2});
  }
  return binary;
}

WideBuildSettings with_quality(WideQuality quality) {
  WideBuildSettings settings;
  settings.quality = quality;
  return settings;
}

const std::vector<std::string> hard_ones{
    "exponentially spaced",      "nested", "one point", "a large one among small ones", "empty boxes and others",
    "not finite when multiplied"};

}  // namespace

TEST_CASE("reinsertion keeps every item once, children behind parents, tight areas, and the bound on levels") {
  for (const std::uint32_t count : {1U, 2U, 3U, 4U, 7U, 60U, 3'000U}) {
    for (const std::uint32_t kinds : {0U, 1U, 3U}) {
      for (const std::uint32_t leaf_limit : {1U, 8U}) {
        CAPTURE(count);
        CAPTURE(kinds);
        Binary binary(random_items(count, kinds, count + kinds), leaf_limit);
        const double before = binary.sum_m2();
        ReinsertionOptimizer::optimize(binary.splits, binary.items, 1);
        check_tree(binary, count, leaf_limit);
        CHECK(binary.sum_m2() <= before * (1.0 + 1e-6));
        if (count == 3'000U && kinds == 0) CHECK(binary.sum_m2() < 0.97 * before);
      }
    }
  }
}

TEST_CASE("regrouping keeps every item once, kinds apart, and never makes the wide tree dearer") {
  for (const std::uint32_t count : {1U, 2U, 9U, 60U, 3'000U}) {
    for (const std::uint32_t kinds : {0U, 1U, 3U}) {
      for (const double leaf : {0.3, 1.0, 4.0}) {
        CAPTURE(count);
        CAPTURE(kinds);
        const WideCosts costs{1.0, leaf};
        Binary binary(random_items(count, kinds, 7 * count + kinds), 8);
        const double before = binary.cost_m2(costs);
        LeafOptimizer::optimize(binary.splits, binary.items, costs, 10);
        check_tree(binary, count, simd_lanes);
        CHECK(binary.cost_m2(costs) <= before * (1.0 + 1e-6));
        if (count == 3'000U && kinds == 1 && leaf == 1.0) CHECK(binary.cost_m2(costs) < 0.98 * before);
      }
    }
  }
}

TEST_CASE("reinsertion finds its way out of a tree that puts neighbours far apart") {
  Binary binary = interleaved();
  const Binary best(binary.items, 1);
  REQUIRE(binary.sum_m2() > 2.0 * best.sum_m2());
  ReinsertionOptimizer::optimize(binary.splits, binary.items, 1);
  check_tree(binary, 64, 1);
  CHECK(binary.sum_m2() < 1.15 * best.sum_m2());
}

TEST_CASE("two half empty leaves side by side in two branches become one") {
  // A row of eight of one kind: every other one lies in the left branch, the rest in the right one. All else is by
  // itself and far away.
  std::vector<WideItem> items;
  for (std::uint32_t index = 0; index < 8; ++index) {
    const Vec3 low(0.1 * index, 0.0, 0.0);
    items.push_back(item_at(low, low + Vec3(0.1), index, 0));
  }
  for (std::uint32_t index = 8; index < 40; ++index) {
    const Vec3 low(index % 2 == 0 ? -50.0 : 50.0, index, index);
    items.push_back(item_at(low, low + Vec3(0.5), index, WideItem::no_kind));
  }
  std::vector<WideItem> order;
  for (std::uint32_t index = 0; index < 40; index += 2) order.push_back(items[index]);
  for (std::uint32_t index = 1; index < 40; index += 2) order.push_back(items[index]);
  Binary binary(items, 1);
  binary.items = order;
  const auto area = [&](std::uint32_t first, std::uint32_t count) {
    return detail::box_around(std::span<const WideItem>(order).subspan(first, count)).half_area();
  };
  binary.splits = {{area(0, 40), 1, 2, 0, 40}, {area(0, 20), 3, 4, 0, 20}, {area(20, 20), 5, 6, 20, 20}};
  const auto chain_below = [&](std::uint32_t slot, std::uint32_t first) {
    for (std::uint32_t left = 16; left > 1; --left, ++first) {
      const auto child = static_cast<std::uint32_t>(binary.splits.size());
      binary.splits[slot] = {area(first, left), child, child + 1, first, left};
      binary.splits.push_back({area(first, 1), 0, 0, first, 1});
      binary.splits.push_back({area(first + 1, left - 1), 0, 0, first + 1, left - 1});
      slot = child + 1;
    }
  };
  binary.splits.resize(7);
  binary.splits[3] = {area(0, 4), 0, 0, 0, 4};
  binary.splits[5] = {area(20, 4), 0, 0, 20, 4};
  chain_below(4, 4);
  chain_below(6, 24);
  check_tree(binary, 40, 4);
  const double before = binary.cost_m2();
  LeafOptimizer::optimize(binary.splits, binary.items, {}, 10);
  check_tree(binary, 40, 8);
  CHECK(binary.cost_m2() < before);
  const bool is_one_leaf =
      std::ranges::any_of(binary.splits, [](const WideSplit& split) { return split.is_leaf() && split.count == 8; });
  CHECK(is_one_leaf);
}

TEST_CASE("hard boxes: no tree is deeper than walks allow, nothing is lost, nothing gets dearer") {
  for (const std::string& what : hard_ones) {
    for (const std::uint32_t count : {1U, 2U, 5U, 64U, 2'000U}) {
      CAPTURE(what);
      CAPTURE(count);
      Binary binary(hard_items(what, count), 8);
      const double sum = binary.sum_m2(), cost = binary.cost_m2();
      ReinsertionOptimizer::optimize(binary.splits, binary.items, 1);
      check_tree(binary, count, 8);
      if (std::isfinite(sum)) CHECK(binary.sum_m2() <= sum * (1.0 + 1e-6));
      const double between = binary.cost_m2();
      LeafOptimizer::optimize(binary.splits, binary.items, {}, 10);
      check_tree(binary, count, 8);
      if (std::isfinite(cost)) CHECK(binary.cost_m2() <= between * (1.0 + 1e-6));
    }
  }
}

TEST_CASE("reinsertion gives a deep tree back rather than make it deeper than allowed") {
  // Nested shells, each in a leaf of a chain: as deep as the binner goes.
  std::vector<WideItem> items;
  for (std::uint32_t index = 0; index < 400; ++index) {
    const double size = std::pow(1.2, static_cast<double>(index % 120));
    const Vec3 low(size, static_cast<double>(index % 3), 0.0);
    items.push_back(item_at(low, low + Vec3(0.3 * size), index, WideItem::no_kind));
  }
  Binary binary(items, 1);
  REQUIRE(binary.levels() > 20);
  const double before = binary.sum_m2();
  for (int turn = 0; turn < 6; ++turn) {
    ReinsertionOptimizer::optimize(binary.splits, binary.items, 1);
    check_tree(binary, 400, 1);
  }
  CHECK(binary.sum_m2() <= before * (1.0 + 1e-6));
}

TEST_CASE("the better tree is the same for any number of threads") {
  for (const std::uint32_t kinds : {0U, 2U}) {
    Binary one(random_items(6'000, kinds, 5), 8);
    Binary other = one;
    ReinsertionOptimizer::optimize(one.splits, one.items, 1);
    ReinsertionOptimizer::optimize(other.splits, other.items, 3);
    CHECK(is_same(one, other));
    LeafOptimizer::optimize(one.splits, one.items, {}, 3);
    LeafOptimizer::optimize(other.splits, other.items, {}, 3);
    CHECK(is_same(one, other));
  }
}

TEST_CASE("a tree of high quality answers as the fast one does, to the last bit, and costs no more") {
  const std::vector<WideMesh> meshes{soup(1'500, 1), boxes_mesh(150, 2), bent_ground(30, 0.2, 3),     dirty_mesh(60, 4),
                                     soup(1, 5),     soup(2, 6),         ball(Vec3(3, 1, 2), 5.0, 16)};
  for (const WideMesh& mesh : meshes) {
    const std::vector<Aabb<double>> boxes = mesh.boxes();
    WideBvh fast, high;
    fast.build(mesh.view(), boxes, with_quality(WideQuality::fast));
    high.build(mesh.view(), boxes, with_quality(WideQuality::high));
    REQUIRE(fast.validate(boxes) == "");
    REQUIRE(high.validate(boxes) == "");
    // Not a theorem, since the fast build is regrouped as well from where it stands, but nothing else would be of use.
    CHECK(high.arrays().weighted_area_m2 <= fast.arrays().weighted_area_m2 * 1.02);
    RandomStream random(9);
    for (int ray_index = 0; ray_index < 3'000; ++ray_index) {
      const Ray<double> ray = any_ray(random, mesh, fast.bounds());
      const auto one = fast.closest_hit(ray), other = high.closest_hit(ray);
      REQUIRE(one.has_value() == other.has_value());
      if (one) REQUIRE((one->t == other->t && one->triangle == other->triangle));
      REQUIRE(fast.occluded(ray) == high.occluded(ray));
      if (ray_index % 10 == 0) REQUIRE(fault_of_closest(hits_on_line(mesh, ray), ray, other) == "");
    }
  }
}

TEST_CASE("objects, absent triangles and threads: a tree of high quality keeps its promises, also when built anew") {
  WideMesh mesh = boxes_mesh(60, 12);  // 12 triangles each
  mesh.absent.assign(mesh.triangles.size(), false);
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); triangle += 7) mesh.absent[triangle] = true;
  const std::vector<std::uint32_t> object_first{0, 360, 372, 384, 400, 600};
  const std::vector<Aabb<double>> boxes = mesh.boxes();
  std::vector<double> costs;
  for (const unsigned threads : {1U, 2U, 5U}) {
    WideBuildSettings settings = with_quality(WideQuality::high);
    settings.threads = threads;
    settings.object_subtree_limit = 100;
    WideBvh tree;
    tree.build_objects(mesh.view(), boxes, object_first, settings);
    REQUIRE(tree.validate(boxes) == "");
    tree.rebuild(mesh.view(), boxes);
    REQUIRE(tree.validate(boxes) == "");
    costs.push_back(tree.arrays().weighted_area_m2);
  }
  CHECK(costs[1] == costs[0]);
  CHECK(costs[2] == costs[0]);
}

}  // namespace test_reinsertion_optimizer
