#pragma once
/// Keeps a tree fit while the scene moves: looks at what moved, and decides per subtree to keep, refit or rebuild.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/accel/bvh.hpp"
#include "dcem/accel/tree_settings.hpp"

namespace dcem {

/// Decides for one `Bvh`, whose objects are the objects of a scene.
template <std::floating_point Scalar>
class BvhUpdater {
 public:
  using Tree = Bvh<Scalar>;
  using Boxes = typename Tree::Boxes;

  explicit BvhUpdater(const TreeUpdateSettings& settings = {}) : settings_(settings) { validate(settings); }

  const TreeUpdateSettings& settings() const { return settings_; }

  /// Brings the tree up to date after the primitives in `moved` have got the boxes that stand in `boxes`.
  TreeUpdateReport update(Tree& tree, std::span<const std::uint32_t> moved, Boxes boxes);

  /// Whether a rebuild of the subtree is due by either measure. Two leaves under a node can be joined in one way only:
  /// such a node is never degraded.
  bool is_degraded(const SubtreeDegradation& degradation) const {
    return degradation.inner_nodes > 1 && (degradation.sah_growth() > settings_.sah_growth_limit ||
                                           degradation.deformation() > settings_.deformation_limit);
  }

 private:
  /// Whether so much has moved since the level above the objects was built that building it again is small change. A
  /// single object has no such level, and what it degrades by moving stiffly its own boxes show.
  bool needs_renewal(const Tree& tree) const {
    const double level_nodes = 2.0 * static_cast<double>(tree.object_count());
    return !tree.degradation(0).is_object_root && visited_since_renewal_ > settings_.renewal_ratio * level_nodes;
  }

  /// Asks what the last refit has visited, parents before children, so that the largest degraded subtree is built anew.
  void rebuild_degraded(Tree& tree, Boxes boxes, TreeUpdateReport& report);
  void rebuild(Tree& tree, std::uint32_t node, Boxes boxes, TreeUpdateReport& report);
  static std::uint64_t nodes_in_use(const Tree& tree) {
    return tree.primitive_count() == 0 ? 0 : tree.nodes().size() - 1 - 2 * tree.arrays().free_pairs.size();
  }

  TreeUpdateSettings settings_;
  std::vector<std::uint32_t> visited_;
  std::vector<bool> is_visited_;        ///< per slot
  double visited_since_renewal_ = 0.0;  ///< nodes that refits have visited since the root was built
};

// ---------------------------------------------------------------------------------------------------------------------

template <std::floating_point Scalar>
TreeUpdateReport BvhUpdater<Scalar>::update(Tree& tree, std::span<const std::uint32_t> moved, Boxes boxes) {
  TreeUpdateReport report;
  if (settings_.policy == TreePolicy::rebuild_always && !moved.empty()) {
    tree.rebuild(boxes);
    report.nodes_rebuilt = nodes_in_use(tree);
    report.subtrees_rebuilt = 1;
    report.root_rebuilt = true;
  } else {
    report.nodes_refit = tree.refit(moved, boxes).visited_nodes;
    if (settings_.policy == TreePolicy::adaptive) rebuild_degraded(tree, boxes, report);
  }
  report.nodes_kept = nodes_in_use(tree) - report.nodes_refit - report.nodes_rebuilt;
  report.sah_cost = tree.sah_cost();
  report.sah_cost_at_build = tree.quality().sah_at_build;
  return report;
}

template <std::floating_point Scalar>
void BvhUpdater<Scalar>::rebuild_degraded(Tree& tree, Boxes boxes, TreeUpdateReport& report) {
  visited_.assign(tree.last_refit().rbegin(), tree.last_refit().rend());  // parents before children
  is_visited_.resize(tree.nodes().size());
  for (const std::uint32_t slot : visited_) is_visited_[slot] = true;
  visited_since_renewal_ += static_cast<double>(visited_.size());
  const auto rebuild_where = [&](bool in_object) {
    for (const std::uint32_t slot : visited_) {
      // Slots that an earlier rebuild gave away again hold new nodes, which are not degraded.
      if (tree.arrays().parent[slot] == free_slot) continue;
      const bool due = is_degraded(tree.degradation(slot)) || (slot == 0 && needs_renewal(tree));
      if (due && tree.lies_in_object(slot) == in_object) rebuild(tree, slot, boxes, report);
    }
  };
  rebuild_where(true);  // before the level above: there the objects get other slots
  rebuild_where(false);
  for (const std::uint32_t slot : visited_) is_visited_[slot] = false;
}

template <std::floating_point Scalar>
void BvhUpdater<Scalar>::rebuild(Tree& tree, std::uint32_t node, Boxes boxes, TreeUpdateReport& report) {
  tree.for_each_in_level(node, [&](std::uint32_t slot) {
    if (is_visited_[slot]) --report.nodes_refit;
    is_visited_[slot] = false;
  });
  tree.rebuild_level(node, boxes);
  is_visited_.resize(tree.nodes().size());
  tree.for_each_in_level(node, [&](std::uint32_t) { ++report.nodes_rebuilt; });
  ++report.subtrees_rebuilt;
  if (node != 0) return;
  report.root_rebuilt = true;
  visited_since_renewal_ = 0.0;
}

}  // namespace dcem
