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

#include "dcem/accel/brute_force.hpp"
#include "dcem/accel/bvh.hpp"

namespace dcem {

/// What is done in a frame in which something moved. Where nothing moved, nothing is done.
enum class TreePolicy {
  rebuild_always,  ///< a new tree over everything: the best tree and the highest price
  refit_only,      ///< boxes above what moved are made tight again; the tree's shape stays as it was built
  adaptive         ///< refit, and then rebuild the subtrees that are degraded
};

/// How a tree is kept. The defaults need no knowledge of the scene: both limits compare a subtree with itself.
struct TreeUpdateSettings {
  TreePolicy policy = TreePolicy::adaptive;
  /// A subtree is degraded when its Σ cost · surface is this many times what it was when it was built (no unit, above
  /// 1; infinity switches the measure off).
  double sah_growth_limit = 1.2;
  /// A subtree is degraded when the mean growth of its nodes' surface over their children's exceeds this (no unit,
  /// above 0; infinity switches the measure off). RT-DEFORM's 40 %.
  double deformation_limit = 0.4;
  /// Neither measure sees a tree that might be better than it ever was, as when objects gather. The level above the
  /// objects is therefore built anew whenever refits have visited this many times as many nodes as it has (no unit,
  /// above 0; infinity switches it off). At 64 that adds about a quarter to the cost of the refits.
  /// Of the wide tree: all above leaves and objects, nodes and leaves being counted, where that makes Σ cost · surface
  /// fall; for the first time when something moves for the first time. It adds a fortieth.
  double renewal_ratio = 64.0;
  /// Of the wide tree: an object that moved is hung elsewhere when the node around it has grown to more than this many
  /// times what it was when the object came there (no unit, at least 1; infinity switches it off).
  double reinsertion_growth = 1.1;
  /// Of the wide tree: in each frame one in this many of the objects that moved is hung anew in turn, whatever its node
  /// has grown (number; 0 switches it off).
  std::uint32_t reinsertion_turn = 50;
  /// Of the wide tree: around each node that motion has touched, at most so many entries change their place in a frame
  /// where Σ cost · surface falls (number; 0 switches rotations off).
  std::uint32_t rotations_per_node = 0;
  /// Of the wide tree: only in one frame of so many, of those in which something moved, rotations are done and the two
  /// measures are looked at, for all that has moved since (number, at least 1).
  std::uint32_t check_interval = 25;
  /// Of the wide tree: whether a subtree that is degraded by either measure is built anew in place, its leaves and
  /// objects untouched. Otherwise the whole tree is built anew when its SAH cost has grown by `sah_growth_limit`.
  bool subtree_rebuilds = true;
  /// Of the wide tree, with `subtree_rebuilds`: all above leaves and objects is built anew once rays have visited this
  /// many nodes more for each leaf than they would have at the steps per ray that followed the last time (number, above
  /// 0; infinity switches it off). Counts only where the updater is told what rays spend. 12 is about what building it
  /// takes: who has spent as much on rays buys it, and so never spends twice what the best moment would have cost.
  double subtree_rebuild_price = 12.0;
  /// Of the wide tree, with `subtree_rebuilds`: the whole tree is built anew, leaves included, when its SAH cost has
  /// grown to this many times what it was when last built whole (no unit, above 1; infinity switches it off). For what
  /// subtrees cannot mend: leaves whose triangles have drifted apart.
  double rebuild_growth_limit = 2.0;
};

/// Throws std::invalid_argument for limits outside the ranges written above.
inline void validate(const TreeUpdateSettings& settings) {
  if (!(settings.sah_growth_limit > 1.0)) throw std::invalid_argument("sah_growth_limit: expected a number above 1");
  if (!(settings.deformation_limit > 0.0)) throw std::invalid_argument("deformation_limit: expected a number above 0");
  if (!(settings.renewal_ratio > 0.0)) throw std::invalid_argument("renewal_ratio: expected a number above 0");
  if (!(settings.reinsertion_growth >= 1.0)) {
    throw std::invalid_argument("reinsertion_growth: expected a number of at least 1");
  }
  if (settings.check_interval < 1) throw std::invalid_argument("check_interval: expected at least 1");
  if (!(settings.subtree_rebuild_price > 0.0))
    throw std::invalid_argument("subtree_rebuild_price: expected a number above 0");
  if (!(settings.rebuild_growth_limit > 1.0)) {
    throw std::invalid_argument("rebuild_growth_limit: expected a number above 1");
  }
}

/// What keeping a tree took in one frame. Every node is kept, refit or rebuilt; one that was both counts as rebuilt. An
/// object that a wide tree hung elsewhere counts as one rebuilt subtree of one node.
struct TreeUpdateReport {
  std::uint64_t nodes_kept = 0;
  std::uint64_t nodes_refit = 0;
  std::uint64_t nodes_rebuilt = 0;
  std::uint64_t subtrees_rebuilt = 0;  ///< the whole tree counts as one
  bool root_rebuilt = false;           ///< the whole tree was built anew, or the last part of all that can be in place
  double sah_cost = 0.0;               ///< after the frame's tree_update, no unit
  double sah_cost_at_build = 0.0;      ///< after the last build of the whole tree, no unit
  // Of a wide tree:
  std::uint64_t reinserted = 0;  ///< objects that were hung elsewhere
  std::uint64_t rotated = 0;     ///< entries that changed their place by rotation; such nodes count as kept or refit
  std::uint64_t rebuilt_in_place = 0;  ///< subtrees that were built anew in place

  friend bool operator==(const TreeUpdateReport&, const TreeUpdateReport&) = default;
};

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

/// The oracle has no shape that could degradation.
template <std::floating_point Scalar>
class BruteForceUpdater {
 public:
  explicit BruteForceUpdater(const TreeUpdateSettings& settings = {}) { validate(settings); }

  TreeUpdateReport update(BruteForce<Scalar>& tree, std::span<const std::uint32_t> moved,
                          typename BruteForce<Scalar>::Boxes boxes) const {
    tree.refit(moved, boxes);
    TreeUpdateReport report;
    report.sah_cost = report.sah_cost_at_build = tree.sah_cost();
    return report;
  }
};

namespace detail {

template <typename Tree>
struct UpdaterOf;
template <std::floating_point Scalar>
struct UpdaterOf<Bvh<Scalar>> {
  using type = BvhUpdater<Scalar>;
};
template <std::floating_point Scalar>
struct UpdaterOf<BruteForce<Scalar>> {
  using type = BruteForceUpdater<Scalar>;
};

}  // namespace detail

/// The class that keeps a tree of a given type.
template <typename Tree>
using UpdaterOf = typename detail::UpdaterOf<Tree>::type;

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
