#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "dcem/accel/binary/sah_builder.hpp"
#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/core/random.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_binner {

using namespace dcem;

namespace {

WideItem item_around(const Aabb<double>& box, std::uint32_t index, std::uint32_t kind) {
  WideItem item{Float4{}, Float4{}, index, kind};
  for (int axis = 0; axis < 3 && !box.empty(); ++axis) {
    item.low[axis] = static_cast<float>(box.min[axis]);
    item.high[axis] = static_cast<float>(box.max[axis]);
  }
  item.note_size();
  return item;
}

std::vector<WideItem> items_of(const dcem_test::Boxes<double>& boxes, std::uint32_t kinds) {
  std::vector<WideItem> items;
  for (std::uint32_t index = 0; index < boxes.size(); ++index) {
    items.push_back(item_around(boxes[index], index, kinds == 0 ? WideItem::no_kind : index % kinds));
  }
  return items;
}

double half_area_of(std::span<const WideItem> items) {
  Aabb<double> box;
  for (const WideItem& item : items) {
    box.extend(Vec3(item.low[0], item.low[1], item.low[2]));
    box.extend(Vec3(item.high[0], item.high[1], item.high[2]));
  }
  return box.half_area();
}

/// Walks the whole tree and checks each promise. Returns the number of levels.
std::uint32_t check_below(std::span<const WideSplit> nodes, std::span<const WideItem> items, std::uint32_t slot,
                          std::uint32_t leaf_limit, std::vector<int>& seen) {
  const WideSplit& node = nodes[slot];
  const auto own = items.subspan(node.first, node.count);
  REQUIRE(node.count > 0);
  // Boxes hold exactly their items; areas are summed in single precision.
  const double half_area_m2 = half_area_of(own);
  REQUIRE(std::abs(node.half_area_m2 - half_area_m2) <= 1e-5 * half_area_m2);
  if (node.is_leaf()) {
    REQUIRE(node.count <= leaf_limit);
    for (const WideItem& item : own) {
      ++seen[item.index];
      if (node.count > 1) REQUIRE((item.kind == own.front().kind && item.kind != WideItem::no_kind));
    }
    return 1;
  }
  REQUIRE(node.left > slot);
  REQUIRE(node.right > slot);
  REQUIRE(nodes[node.left].first == node.first);
  REQUIRE(nodes[node.right].first == node.first + nodes[node.left].count);
  REQUIRE(nodes[node.left].count + nodes[node.right].count == node.count);
  return 1 + std::max(check_below(nodes, items, node.left, leaf_limit, seen),
                      check_below(nodes, items, node.right, leaf_limit, seen));
}

double cost_below(std::span<const WideSplit> nodes) {
  return std::accumulate(nodes.begin(), nodes.end(), 0.0, [](double sum, const WideSplit& node) {
    return sum + static_cast<double>(node.half_area_m2);
  });
}

}  // namespace

TEST_CASE("every item is in one leaf, leaves share a kind, no tree is deeper than allowed") {
  for (const std::size_t count : {1U, 2U, 9U, 300U, 20'000U}) {
    for (const std::uint32_t kinds : {0U, 1U, 3U}) {
      for (const std::uint32_t leaf_limit : {1U, 8U}) {
        CAPTURE(count);
        std::vector<WideItem> items = items_of(dcem_test::random_boxes<double>(count, count + kinds), kinds);
        const auto nodes = WideBinner().build(items, leaf_limit, 1);
        std::vector<int> seen(count, 0);
        CHECK(check_below(nodes, items, 0, leaf_limit, seen) <= detail::wide_build_depth_limit);
        CHECK(std::ranges::all_of(seen, [](int times) { return times == 1; }));
      }
    }
  }
  std::vector<WideItem> none;
  CHECK(WideBinner().build(none, 8, 1).empty());
}

TEST_CASE("places that no plane divides are halved: equal boxes, a geometric row, empty boxes, infinite extents") {
  dcem_test::Boxes<double> equal(5000, {Vec3(1, 2, 3), Vec3(2, 3, 4)}), row, empty(100), huge;
  // Each box a thousandth of the way to the next: bins divide off one at a time.
  for (int step = 0; step < 3000; ++step) {
    const double at = 1e6 * std::pow(0.99, step);
    row.push_back({Vec3(at, 0, 0), Vec3(at, 0, 0)});
  }
  for (int step = 0; step < 100; ++step) huge.push_back({Vec3(-1e30 * step), Vec3(3e38)});
  for (const auto& boxes : {equal, row, empty, huge}) {
    std::vector<WideItem> items = items_of(boxes, 0);
    const auto nodes = WideBinner().build(items, 1, 1);
    std::uint32_t deepest = 0;
    std::vector<std::uint32_t> depth(nodes.size(), 1);
    std::size_t leaves = 0;
    for (std::size_t slot = 0; slot < nodes.size(); ++slot) {
      deepest = std::max(deepest, depth[slot]);
      if (nodes[slot].is_leaf()) {
        ++leaves;
        continue;
      }
      depth[nodes[slot].left] = depth[nodes[slot].right] = depth[slot] + 1;
    }
    CHECK(leaves == boxes.size());
    CHECK(deepest <= detail::wide_build_depth_limit);
  }
}

TEST_CASE("what is much larger than all else is divided off first, also where its centre lies among them") {
  constexpr std::size_t plates = 3, count = 3000;
  dcem_test::Boxes<double> boxes;
  RandomStream random(3);
  for (std::size_t plate = 0; plate < plates; ++plate) boxes.push_back({Vec3(0, 0, 0), Vec3(1000, 1000, 0)});
  while (boxes.size() < count) {
    const Vec3 low(400 + 200 * random.uniform(), 400 + 200 * random.uniform(), 0);
    boxes.push_back({low, low + Vec3(10, 10, 20 * random.uniform())});
  }
  std::vector<WideItem> items = items_of(boxes, 1), sizeless = items;
  for (WideItem& item : sizeless) item.high[3] = 0.0F;
  const auto nodes = WideBinner().build(items, 8, 1), others = WideBinner().build(sizeless, 8, 1);
  std::vector<std::uint32_t> sides{nodes[0].left, nodes[0].right};
  const auto holds_plates = [&](std::uint32_t slot) {
    const auto own = std::span(items).subspan(nodes[slot].first, nodes[slot].count);
    return own.size() == plates && std::ranges::all_of(own, [&](const WideItem& item) { return item.index < plates; });
  };
  CHECK(std::ranges::any_of(sides, holds_plates));
  // Divided by place, one side holds the plates and is as large as all, time and again.
  CHECK(cost_below(nodes) < 0.9 * cost_below(others));
}

TEST_CASE("the tree is the same for any number of threads") {
  const auto boxes = dcem_test::random_boxes<double>(30'000, 5);
  std::vector<WideItem> one = items_of(boxes, 2), many = one;
  const auto expected = WideBinner().build(one, 8, 1), found = WideBinner().build(many, 8, 4);
  REQUIRE(found.size() == expected.size());
  for (std::size_t slot = 0; slot < found.size(); ++slot) {
    REQUIRE(found[slot].left == expected[slot].left);
    REQUIRE(found[slot].first == expected[slot].first);
    REQUIRE(found[slot].count == expected[slot].count);
    REQUIRE(found[slot].half_area_m2 == expected[slot].half_area_m2);
  }
  for (std::size_t position = 0; position < one.size(); ++position)
    REQUIRE(one[position].index == many[position].index);
}

TEST_CASE("sixteen bins come close to the careful builder") {
  const auto boxes = dcem_test::random_boxes<double>(10'000, 9);
  std::vector<WideItem> items = items_of(boxes, 0);
  const double binned = cost_below(WideBinner().build(items, 1, 1));
  std::vector<BuildItem<double>> careful_items;
  for (std::uint32_t index = 0; index < boxes.size(); ++index) careful_items.emplace_back(boxes[index], index);
  SahSettings settings;
  settings.leaf_limit = settings.leaf_maximum = 1;
  double careful = 0.0;
  for (const auto& node : SahBuilder<double>(settings).build(careful_items)) careful += node.box.half_area();
  MESSAGE("sum of areas over the careful builder's: " << binned / careful);
  // 32 bins and full sweeps are worth a few percent; a broken choice of splits would cost tens.
  CHECK(binned < 1.1 * careful);
}

}  // namespace test_binner
