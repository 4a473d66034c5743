#pragma once
/// Moves quads from leaf to leaf where that makes the wide tree cheaper.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/wide/build/collapse.hpp"
#include "dcem/accel/wide/build/draft.hpp"

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
    std::optional<WideCollapse> plan(std::in_place, splits, items, costs);
    if (splits.empty() || plan->is_leaf(0) || !std::isfinite(splits.front().half_area_m2)) return;
    LeafOptimizer work(splits, items, *plan, costs);
    const double cost_m2 = plan->cost_m2();
    plan.reset();  // as large as all else here
    bool is_better = false;
    for (int pass = 0; pass < most_passes; ++pass) {
      const double gain_m2 = work.pass();
      is_better = is_better || gain_m2 > 0.0;
      if (!(gain_m2 > least_gain * cost_m2)) break;
    }
    if (is_better) work.tree_.store(splits, items);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Where a quad may go: a node, for a leaf of its own, or a leaf. `cost_m2`: what the sum grows by.
  struct Spot {
    double cost_m2;
    std::uint32_t entry;
    bool operator<(const Spot& other) const { return cost_m2 > other.cost_m2; }  // the cheapest on top
  };

  LeafOptimizer(std::span<const WideSplit> splits, std::span<const WideItem> items, const WideCollapse& plan,
                const WideCosts& costs)
      : costs_(costs), tree_(splits, items, plan, costs) {}

  /// Returns what the sum has lost.
  double pass() {
    double gain_m2 = 0.0;
    const std::uint32_t there = tree_.entry_count();
    for (std::uint32_t slot = 1; slot < there; ++slot) {
      if (!tree_.entry(slot).is_leaf || tree_.entry(slot).kind == WideItem::no_kind) continue;
      const WideDraft::Entry now = tree_.entry(slot);
      for (std::uint32_t lane = 0; lane < now.count; ++lane) gain_m2 += try_move(slot, now.held[lane]);
    }
    return gain_m2;
  }

  /// Moves a quad where the sum falls by it. Returns what it has lost.
  double try_move(std::uint32_t leaf, std::uint32_t item) {
    const std::uint32_t node = tree_.entry(leaf).parent;
    const bool alone = tree_.entry(leaf).count == 1;
    // A node that is left empty would be none.
    if (alone && tree_.entry(node).count == 1) return 0.0;
    tree_.entry(leaf).remove(item);
    if (alone) tree_.entry(node).remove(leaf);
    const double freed_m2 = -(alone ? tree_.fit(leaf) + tree_.fit_from(node) : tree_.fit_from(leaf));
    const Spot spot = cheapest_spot(tree_.item(item), tree_.entry(leaf).kind, freed_m2);
    if (spot.entry != none && spot.entry != leaf) {
      tree_.put(item, tree_.entry(leaf).kind, spot.entry);
      return freed_m2 - spot.cost_m2;
    }
    tree_.entry(leaf).add(item);
    if (alone) tree_.entry(node).add(leaf);
    tree_.fit(leaf);
    tree_.fit_from(alone ? node : tree_.entry(leaf).parent);
    return 0.0;
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
      if (!tree_.entry(node.entry).is_full() && node.cost_m2 + own_m2 < best.cost_m2) {
        best = {node.cost_m2 + own_m2, node.entry};
      }
      look_into(node, item, kind, best);
    }
    return best;
  }

  void look_into(const Spot& node, const WideItem& item, std::uint32_t kind, Spot& best) {
    const WideDraft::Entry& holder = tree_.entry(node.entry);
    for (std::uint32_t lane = 0; lane < holder.count; ++lane) {
      const WideDraft::Entry& below = tree_.entry(holder.held[lane]);
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

  WideCosts costs_;
  WideDraft tree_;
  std::vector<Spot> open_;
};

}  // namespace dcem
