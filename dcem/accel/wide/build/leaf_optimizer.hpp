#pragma once
/// Moves quads from leaf to leaf where that makes the wide tree cheaper.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/wide/build/binary_tree.hpp"
#include "dcem/accel/wide/build/collapse.hpp"

namespace dcem {

/// A binary tree knows nothing of leaves: those that a collapse makes are half empty, and hold what could be with
/// neighbours in another branch for less. This takes quads out of their leaves, one by one, and puts each where
/// Σ cost · surface of the wide tree grows least, by branch and bound: into a leaf of its kind with a free lane, or
/// into one of its own. Every move is weighed exactly, so the sum never rises.
class LeafOptimizer {
 public:
  static constexpr double least_gain = 1e-3;  ///< a pass that gains a smaller part of the sum is the last one
  static constexpr int most_visits = 16;      ///< nodes that one search looks into: boxes may all overlap

  /// Changes a binary tree, and the order of its items, so that its collapse shows the better leaves. A tree that would
  /// get deeper than detail::wide_build_depth_limit stays as it is.
  static void optimize(std::vector<WideSplit>& splits, std::span<WideItem> items, const WideCosts& costs,
                       int most_passes) {
    const WideCollapse plan(splits, items, costs);
    if (splits.empty() || plan.is_leaf(0) || !std::isfinite(splits.front().half_area_m2)) return;
    LeafOptimizer work(splits, items, plan, costs);
    bool is_better = false;
    for (int pass = 0; pass < most_passes; ++pass) {
      const double gain_m2 = work.pass();
      is_better = is_better || gain_m2 > 0.0;
      if (!(gain_m2 > least_gain * plan.cost_m2())) break;
    }
    if (is_better) work.store(splits, items);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// A wide node, or a leaf.
  struct Entry {
    detail::FloatBox box;
    float half_area_m2 = 0.0F;
    float cost = 0.0F;  ///< of a visit; 0 for the root, which is always visited
    std::uint32_t parent = 0;
    std::uint32_t count = 0;
    std::array<std::uint32_t, simd_lanes> held{};  ///< entries, or items of a leaf
    bool is_leaf = false;
    std::uint32_t kind = WideItem::no_kind;

    bool is_full() const { return count == simd_lanes; }
    void add(std::uint32_t one) { held[count++] = one; }
    void remove(std::uint32_t one) {
      const auto end = held.begin() + count;
      std::copy(std::find(held.begin(), end, one) + 1, end, std::find(held.begin(), end, one));
      --count;
    }
    double weight_m2() const { return static_cast<double>(cost) * static_cast<double>(half_area_m2); }
  };
  /// Where a quad may go: a node, for a leaf of its own, or a leaf. `cost_m2`: what the sum grows by.
  struct Spot {
    double cost_m2;
    std::uint32_t entry;
    bool operator<(const Spot& other) const { return cost_m2 > other.cost_m2; }  // the cheapest on top
  };

  LeafOptimizer(std::span<const WideSplit> splits, std::span<const WideItem> items, const WideCollapse& plan,
                const WideCosts& costs)
      : costs_(costs), items_(items.begin(), items.end()) {
    entries_.emplace_back();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, 0}};  // slot, entry
    while (!open.empty()) {
      const auto [slot, entry] = open.back();
      open.pop_back();
      if (entry != 0 && plan.is_leaf(slot)) {
        fill_leaf(entry, splits[slot]);
        continue;
      }
      plan.for_each_entry(slot, [&, above = entry](std::uint32_t below) {
        const std::uint32_t added = add_entry(above, costs_.node);
        entries_[above].add(added);
        open.emplace_back(below, added);
      });
    }
    for (std::uint32_t entry = entry_count(); entry-- > 0;) fit(entry);
  }

  std::uint32_t entry_count() const { return static_cast<std::uint32_t>(entries_.size()); }

  std::uint32_t add_entry(std::uint32_t parent, double cost) {
    entries_.emplace_back();
    entries_.back().parent = parent;
    entries_.back().cost = static_cast<float>(cost);
    return entry_count() - 1;
  }

  void fill_leaf(std::uint32_t entry, const WideSplit& split) {
    Entry& leaf = entries_[entry];
    leaf.is_leaf = true;
    leaf.cost = static_cast<float>(costs_.leaf);
    leaf.kind = items_[split.first].kind;
    for (std::uint32_t item = split.first; item < split.first + split.count; ++item) leaf.add(item);
  }

  /// Makes the box of an entry tight. Returns by how much the sum has grown.
  double fit(std::uint32_t slot) {
    Entry& entry = entries_[slot];
    const double before_m2 = entry.weight_m2();
    entry.box = {};
    for (std::uint32_t lane = 0; lane < entry.count; ++lane) {
      const std::uint32_t held = entry.held[lane];
      entry.is_leaf ? entry.box.extend(items_[held].low, items_[held].high) : entry.box.extend(entries_[held].box);
    }
    entry.half_area_m2 = entry.box.half_area();
    return entry.weight_m2() - before_m2;
  }
  /// The same for an entry and all above, as far up as boxes change.
  double fit_from(std::uint32_t slot) {
    double grown_m2 = 0.0;
    while (true) {
      const detail::FloatBox before = entries_[slot].box;
      grown_m2 += fit(slot);
      if (slot == 0 || entries_[slot].box == before) return grown_m2;
      slot = entries_[slot].parent;
    }
  }

  /// Returns what the sum has lost.
  double pass() {
    double gain_m2 = 0.0;
    const std::uint32_t there = entry_count();
    for (std::uint32_t slot = 1; slot < there; ++slot) {
      if (!entries_[slot].is_leaf || entries_[slot].kind == WideItem::no_kind) continue;
      const Entry now = entries_[slot];
      for (std::uint32_t lane = 0; lane < now.count; ++lane) gain_m2 += try_move(slot, now.held[lane]);
    }
    return gain_m2;
  }

  /// Moves a quad where the sum falls by it. Returns what it has lost.
  double try_move(std::uint32_t leaf, std::uint32_t item) {
    const std::uint32_t node = entries_[leaf].parent;
    const bool alone = entries_[leaf].count == 1;
    // A node that is left empty would be none.
    if (alone && entries_[node].count == 1) return 0.0;
    entries_[leaf].remove(item);
    if (alone) entries_[node].remove(leaf);
    const double freed_m2 = -(alone ? fit(leaf) + fit_from(node) : fit_from(leaf));
    const Spot spot = cheapest_spot(items_[item], entries_[leaf].kind, freed_m2);
    if (spot.entry != none && spot.entry != leaf) {
      put(item, entries_[leaf].kind, spot.entry);
      return freed_m2 - spot.cost_m2;
    }
    entries_[leaf].add(item);
    if (alone) entries_[node].add(leaf);
    fit(leaf);
    fit_from(alone ? node : entries_[leaf].parent);
    return 0.0;
  }

  void put(std::uint32_t item, std::uint32_t kind, std::uint32_t spot) {
    std::uint32_t leaf = spot;
    if (!entries_[spot].is_leaf) {
      leaf = add_entry(spot, costs_.leaf);
      entries_[leaf].is_leaf = true;
      entries_[leaf].kind = kind;
      entries_[spot].add(leaf);
    }
    entries_[leaf].add(item);
    fit(leaf);
    fit_from(entries_[leaf].parent);
  }

  /// Where the sum grows least, below `limit_m2` by more than roundings; none where there is no such place.
  Spot cheapest_spot(const WideItem& item, std::uint32_t kind, double limit_m2) {
    const double own_m2 = costs_.leaf * static_cast<double>(detail::FloatBox{item.low, item.high}.half_area());
    Spot best{limit_m2 * (1.0 - 1e-6), none};
    open_.assign(1, {0.0, 0});
    for (int visits = 0; !open_.empty() && visits < most_visits; ++visits) {
      std::pop_heap(open_.begin(), open_.end());
      const Spot node = open_.back();
      open_.pop_back();
      if (!(node.cost_m2 < best.cost_m2)) break;
      if (!entries_[node.entry].is_full() && node.cost_m2 + own_m2 < best.cost_m2) {
        best = {node.cost_m2 + own_m2, node.entry};
      }
      look_into(node, item, kind, best);
    }
    return best;
  }

  void look_into(const Spot& node, const WideItem& item, std::uint32_t kind, Spot& best) {
    const Entry& holder = entries_[node.entry];
    for (std::uint32_t lane = 0; lane < holder.count; ++lane) {
      const Entry& below = entries_[holder.held[lane]];
      if (below.is_leaf && (below.kind != kind || below.is_full())) continue;
      detail::FloatBox grown = below.box;
      grown.extend(item.low, item.high);
      const Spot spot{
          node.cost_m2 + static_cast<double>(below.cost) * static_cast<double>(grown.half_area()) - below.weight_m2(),
          holder.held[lane]};
      if (!(spot.cost_m2 < best.cost_m2)) continue;
      if (below.is_leaf) {
        best = spot;
      } else {
        open_.push_back(spot);
        std::push_heap(open_.begin(), open_.end());
      }
    }
  }

  /// The wide tree as a binary one: the entries of each node are joined in pairs, the smallest box around two first.
  void store(std::vector<WideSplit>& splits, std::span<WideItem> items) const {
    std::vector<std::uint32_t> order{0};  // parents first
    for (std::size_t at = 0; at < order.size(); ++at) {
      const Entry& entry = entries_[order[at]];
      if (!entry.is_leaf) order.insert(order.end(), entry.held.begin(), entry.held.begin() + entry.count);
    }
    std::vector<detail::BinaryNode> nodes;
    std::vector<WideItem> held;
    std::vector<std::uint32_t> made(entries_.size());  // the binary node of an entry
    for (std::size_t at = order.size(); at-- > 0;) {
      const Entry& entry = entries_[order[at]];
      if (entry.is_leaf) {
        made[order[at]] = add_leaf(entry, nodes, held);
        continue;
      }
      std::array<std::uint32_t, simd_lanes> parts;
      for (std::uint32_t lane = 0; lane < entry.count; ++lane) parts[lane] = made[entry.held[lane]];
      made[order[at]] = detail::join(std::span(parts).first(entry.count), nodes);
    }
    std::vector<WideItem> placed(items.size());
    std::vector<WideSplit> result = detail::in_order(nodes, made[0], held, placed);
    if (detail::depth_of_tree(result) > detail::wide_build_depth_limit) return;
    splits = std::move(result);
    std::copy(placed.begin(), placed.end(), items.begin());
  }

  std::uint32_t add_leaf(const Entry& leaf, std::vector<detail::BinaryNode>& nodes, std::vector<WideItem>& held) const {
    nodes.push_back({leaf.box, leaf.half_area_m2, 0, 0, static_cast<std::uint32_t>(held.size()), leaf.count});
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) held.push_back(items_[leaf.held[lane]]);
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }

  WideCosts costs_;
  std::vector<WideItem> items_;
  std::vector<Entry> entries_;  ///< the root is 0; leaves that lost everything stay, unused
  std::vector<Spot> open_;
};

}  // namespace dcem
