#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "dcem/accel/binary/sah_builder.hpp"
#include "dcem/accel/wide/build/collapse.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_collapse {

using namespace dcem;

namespace {

constexpr std::uint32_t by_itself = WideItem::no_kind;

/// A binary tree of one item a leaf, and the kind of each item.
struct Binary {
  std::vector<BvhNode<double>> nodes;
  std::vector<std::uint32_t> kinds;  ///< by position

  Binary(std::size_t count, std::uint32_t kind_count, std::uint64_t seed) {
    const auto boxes = dcem_test::random_boxes<double>(count, seed);
    RandomStream random(seed);
    std::vector<BuildItem<double>> items;
    for (std::uint32_t index = 0; index < count; ++index) items.emplace_back(boxes[index], index);
    SahSettings settings;
    settings.leaf_limit = settings.leaf_maximum = 1;
    nodes = SahBuilder<double>(settings).build(items);
    // Kinds in regions, so that leaves of one kind can form.
    for (const BuildItem<double>& item : items) {
      const auto region = static_cast<std::uint32_t>(std::floor(std::abs(item.center.x)));
      const bool alone = kind_count > 1 && random.uniform() < 0.1;
      kinds.push_back(alone ? by_itself : region % kind_count);
    }
  }
  /// The same tree as the collapse reads it: slots keep their numbers.
  std::vector<WideSplit> splits() const {
    std::vector<WideSplit> result;
    for (const BvhNode<double>& node : nodes) {
      const auto area = static_cast<float>(node.box.half_area());
      result.push_back(node.is_leaf() ? WideSplit{area, 0, 0, node.first, node.count}
                                      : WideSplit{area, node.left(), node.right(), 0, 0});
    }
    return result;
  }
  std::vector<WideItem> items() const {
    std::vector<WideItem> result;
    for (const std::uint32_t kind : kinds) result.push_back({Float4{}, Float4{}, 0, kind});
    return result;
  }
  /// What a collapse reads must outlive it.
  struct Planned {
    std::vector<WideSplit> splits;
    WideCollapse plan;
    Planned(const Binary& binary, const WideCosts& costs)
        : splits(binary.splits()), plan(splits, binary.items(), costs) {}
  };
  double area(std::uint32_t slot) const { return nodes[slot].box.half_area(); }
  void leaves_below(std::uint32_t slot, std::vector<std::uint32_t>& positions) const {
    if (nodes[slot].is_leaf()) {
      positions.push_back(nodes[slot].first);
      return;
    }
    leaves_below(nodes[slot].left(), positions);
    leaves_below(nodes[slot].right(), positions);
  }
  /// Whether what is below may be one leaf.
  bool fits_leaf(std::uint32_t slot) const {
    std::vector<std::uint32_t> positions;
    leaves_below(slot, positions);
    if (positions.size() == 1) return true;
    return positions.size() <= 8 && kinds[positions[0]] != by_itself &&
           std::ranges::all_of(positions, [&](std::uint32_t one) { return kinds[one] == kinds[positions[0]]; });
  }
};

/// What the tree that the plan describes costs, its promises checked on the way.
double cost_of_plan(const Binary& binary, const WideCollapse& plan, const WideCosts& costs, std::uint32_t slot,
                    std::multiset<std::uint32_t>& found) {
  if (plan.is_leaf(slot)) {
    REQUIRE(binary.fits_leaf(slot));
    std::vector<std::uint32_t> positions;
    binary.leaves_below(slot, positions);
    found.insert(positions.begin(), positions.end());
    return costs.leaf * binary.area(slot);
  }
  double sum = costs.node * binary.area(slot);
  std::vector<std::uint32_t> entries;
  plan.for_each_entry(slot, [&](std::uint32_t entry) { entries.push_back(entry); });
  REQUIRE(entries.size() >= 2);
  REQUIRE(entries.size() <= 8);
  for (const std::uint32_t entry : entries) {
    REQUIRE(entry != slot);
    sum += cost_of_plan(binary, plan, costs, entry, found);
  }
  return sum;
}

/// The usual way: open the largest entry until there are eight; what fits into a leaf is one.
double cost_of_greedy(const Binary& binary, const WideCosts& costs, std::uint32_t slot) {
  if (binary.fits_leaf(slot)) return costs.leaf * binary.area(slot);
  std::vector<std::uint32_t> entries{binary.nodes[slot].left(), binary.nodes[slot].right()};
  while (entries.size() < 8) {
    std::uint32_t* largest = nullptr;
    for (std::uint32_t& entry : entries) {
      if (binary.fits_leaf(entry)) continue;
      if (largest == nullptr || binary.area(entry) > binary.area(*largest)) largest = &entry;
    }
    if (largest == nullptr) break;
    const std::uint32_t opened = *largest;
    *largest = binary.nodes[opened].left();
    entries.push_back(binary.nodes[opened].right());
  }
  double sum = costs.node * binary.area(slot);
  for (const std::uint32_t entry : entries) sum += cost_of_greedy(binary, costs, entry);
  return sum;
}

/// The least cost of all ways to show a subtree as exactly one entry, by trying every cut of up to `most` parts.
double least_cost(const Binary& binary, const WideCosts& costs, std::uint32_t slot) {
  // Cost of a forest of exactly `parts` entries below a slot, by plain recursion over the shares.
  const std::function<double(std::uint32_t, std::uint32_t)> forest = [&](std::uint32_t at, std::uint32_t parts) {
    if (parts == 1) return least_cost(binary, costs, at);
    if (binary.nodes[at].is_leaf()) return std::numeric_limits<double>::infinity();
    double best = std::numeric_limits<double>::infinity();
    for (std::uint32_t share = 1; share < parts; ++share) {
      best = std::min(best, forest(binary.nodes[at].left(), share) + forest(binary.nodes[at].right(), parts - share));
    }
    return best;
  };
  double best = std::numeric_limits<double>::infinity();
  if (binary.fits_leaf(slot)) best = costs.leaf * binary.area(slot);
  if (binary.nodes[slot].is_leaf()) return best;
  for (std::uint32_t parts = 2; parts <= 8; ++parts) {
    best = std::min(best, costs.node * binary.area(slot) + forest(slot, parts));
  }
  return best;
}

}  // namespace

TEST_CASE("at most eight entries, leaves of one kind, every item once; no dearer than the greedy way") {
  std::uint64_t seed = 0;
  for (const std::size_t count : {1U, 2U, 8U, 9U, 17U, 100U, 3000U}) {
    for (const std::uint32_t kinds : {1U, 3U}) {
      for (const WideCosts& costs : {WideCosts{}, WideCosts{1.0, 0.3}, WideCosts{1.0, 4.0}}) {
        CAPTURE(count);
        const Binary binary(count, kinds, ++seed);
        const Binary::Planned planned(binary, costs);
        const WideCollapse& plan = planned.plan;
        std::multiset<std::uint32_t> found;
        const double cost = cost_of_plan(binary, plan, costs, 0, found);
        REQUIRE(found.size() == count);
        REQUIRE(std::set(found.begin(), found.end()).size() == count);
        // The plan counts in single precision.
        CHECK(cost <= cost_of_greedy(binary, costs, 0) * (1 + 1e-5));
      }
    }
  }
}

TEST_CASE("the plan of a small tree is the cheapest there is") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    const Binary binary(5 + seed % 8, 1 + static_cast<std::uint32_t>(seed % 3), 1000 + seed);
    for (const WideCosts& costs : {WideCosts{}, WideCosts{1.0, 0.4}, WideCosts{0.5, 2.0}}) {
      const Binary::Planned planned(binary, costs);
      const WideCollapse& plan = planned.plan;
      std::multiset<std::uint32_t> found;
      CHECK(cost_of_plan(binary, plan, costs, 0, found) == doctest::Approx(least_cost(binary, costs, 0)).epsilon(1e-5));
    }
  }
}

TEST_CASE("items by themselves never share a leaf, and what has no size still has at most eight entries") {
  std::vector<BuildItem<double>> items;
  for (std::uint32_t index = 0; index < 100; ++index) {
    items.emplace_back(index < 50 ? Aabb<double>{} : Aabb<double>{Vec3(1), Vec3(1)}, index);
  }
  SahSettings settings;
  settings.leaf_limit = settings.leaf_maximum = 1;
  Binary binary(1, 1, 1);
  binary.nodes = SahBuilder<double>(settings).build(items);
  for (const std::uint32_t kind : {by_itself, 0U}) {
    binary.kinds.assign(100, kind);
    const Binary::Planned planned(binary, {});
    const WideCollapse& plan = planned.plan;
    std::multiset<std::uint32_t> found;
    CHECK(cost_of_plan(binary, plan, {}, 0, found) == 0.0);
    CHECK(found.size() == 100);
  }
}

}  // namespace test_collapse
