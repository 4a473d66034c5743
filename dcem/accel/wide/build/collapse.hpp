#pragma once
/// Turns a binary tree into one of eight children a node, at the least cost.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/accel/wide/settings.hpp"
#include "dcem/core/simd.hpp"

namespace dcem {

/// Decides which binary nodes become wide nodes, which become leaves, and which vanish.
///
/// For every binary node the least cost of showing what is below it as at most i entries of some wide node, i = 1 … 8,
/// from the same of its children. One entry is a leaf (up to eight quads of one kind) or a wide node, which costs
/// its surface and what its own eight entries cost (Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs
/// through compressed wide BVHs", HPG 2017, section 3.2).
class WideCollapse {
 public:
  static constexpr std::uint32_t most = simd_lanes;

  WideCollapse() = default;
  WideCollapse(std::span<const WideSplit> nodes, std::span<const WideItem> items, const WideCosts& costs) {
    plan(nodes, items, costs);
  }

  /// Decides anew. `nodes` must outlive the questions.
  void plan(std::span<const WideSplit> nodes, std::span<const WideItem> items, const WideCosts& costs) {
    nodes_ = nodes;
    costs_ = costs;
    plans_.assign(nodes.size(), {});
    // Children stand behind their parents.
    for (std::size_t slot = nodes.size(); slot-- > 0;) {
      if (nodes[slot].is_leaf()) {
        plan_leaf(slot, items[nodes[slot].first].kind);
      } else {
        plan_inner(slot);
      }
    }
  }

  /// Whether the node, shown as one entry, is a leaf (or an item that is an entry by itself).
  bool is_leaf(std::uint32_t slot) const { return plans_[slot].leaf; }

  /// Σ cost · half surface over all that the root's entries are and hold; the root itself, as a node, is left out.
  double cost_m2() const { return plans_.empty() ? 0.0 : static_cast<double>(plans_.front().cost[most - 1]); }

  /// Calls `visit(slot)` for the entries of the wide node that stands for `slot`, at most eight.
  template <typename Visit>
  void for_each_entry(std::uint32_t slot, Visit&& visit) const {
    divide(slot, most, visit);
  }

  /// The same entries, the largest first: any-hit queries take the lanes as they come, and the largest box is the most
  /// likely to be in the way. Returns how many.
  std::size_t entries(std::uint32_t slot, std::array<std::uint32_t, most>& found) const {
    std::size_t count = 0;
    for_each_entry(slot, [&](std::uint32_t entry) {
      std::size_t place = count++;
      for (; place > 0 && nodes_[found[place - 1]].half_area_m2 < nodes_[entry].half_area_m2; --place) {
        found[place] = found[place - 1];
      }
      found[place] = entry;
    });
    return count;
  }

 private:
  struct Plan {
    std::array<float, most> cost{};         ///< [i − 1]: with at most i entries
    std::array<std::uint8_t, most> left{};  ///< [i − 1]: entries of the left child; 0: as with one entry less
    std::uint8_t count = 0;                 ///< items of one kind below, most + 1 when more or mixed
    bool leaf = false;
    std::uint32_t kind = WideItem::no_kind;
  };

  void plan_leaf(std::size_t slot, std::uint32_t kind) {
    Plan& own = plans_[slot];
    own.kind = kind;
    own.count = static_cast<std::uint8_t>(kind == WideItem::no_kind ? most + 1 : nodes_[slot].count);
    own.leaf = true;
    own.cost.fill(static_cast<float>(costs_.leaf) * nodes_[slot].half_area_m2);
  }

  void plan_inner(std::size_t slot) {
    const WideSplit& node = nodes_[slot];
    const Plan &left = plans_[node.left], &right = plans_[node.right];
    Plan& own = plans_[slot];
    own.kind = left.kind;
    const std::uint32_t count = std::uint32_t{left.count} + right.count;
    own.count = static_cast<std::uint8_t>(left.kind == right.kind ? std::min(count, most + 1) : most + 1);
    for (std::uint32_t entries = 2; entries <= most; ++entries) share_out(own, left, right, entries);
    const float as_node = static_cast<float>(costs_.node) * node.half_area_m2 + own.cost[most - 1];
    const float as_leaf = static_cast<float>(costs_.leaf) * node.half_area_m2;
    own.leaf = own.count <= most && as_leaf <= as_node;
    own.cost[0] = own.leaf ? as_leaf : as_node;
  }

  static void share_out(Plan& own, const Plan& left, const Plan& right, std::uint32_t entries) {
    float best = entries > 2 ? own.cost[entries - 2] : std::numeric_limits<float>::infinity();
    for (std::uint32_t share = 1; share < entries; ++share) {
      const float cost = left.cost[share - 1] + right.cost[entries - share - 1];
      if (!(cost < best) && (entries > 2 || share > 1)) continue;
      best = cost;
      own.left[entries - 1] = static_cast<std::uint8_t>(share);
    }
    own.cost[entries - 1] = best;
  }

  template <typename Visit>
  void divide(std::uint32_t slot, std::uint32_t entries, Visit& visit) const {
    const Plan& own = plans_[slot];
    while (entries > 1 && own.left[entries - 1] == 0) --entries;
    if (entries == 1) {
      visit(slot);
      return;
    }
    const std::uint32_t share = own.left[entries - 1];
    divide(nodes_[slot].left, share, visit);
    divide(nodes_[slot].right, entries - share, visit);
  }

  std::span<const WideSplit> nodes_;
  WideCosts costs_;
  std::vector<Plan> plans_;
};

}  // namespace dcem
