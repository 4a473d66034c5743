#pragma once
/// How trees are kept while a scene moves, and what that took.
#include <cstdint>
#include <stdexcept>

namespace dcem {

/// What is done in a frame in which something moved. Where nothing moved, nothing is done.
enum class TreePolicy : std::uint8_t {
  rebuild_always,  ///< a new tree over everything: the best tree and the highest price
  refit_only,      ///< boxes above what moved are made tight again; the tree's shape stays as it was built
  adaptive         ///< refit, and then rebuild the subtrees that are degraded
};

/// How a tree is kept, of whatever kind. The defaults need no knowledge of the scene: both limits compare a subtree
/// with itself.
struct TreeUpdateSettings {
  TreePolicy policy = TreePolicy::adaptive;
  /// A subtree is degraded when its Σ cost · surface is this many times what it was when it was built (no unit, above
  /// 1; infinity switches the measure off).
  double sah_growth_limit = 1.2;
  /// A subtree is degraded when the mean growth of its nodes' surface over their children's exceeds this (no unit,
  /// above 0; infinity switches the measure off). RT-DEFORM's 40 %.
  double deformation_limit = 0.4;
  /// Neither measure sees a tree that might be better than it ever was, as when objects gather. All above leaves and
  /// objects is therefore built anew whenever refits have visited this many times as many nodes as there are (no unit,
  /// above 0; infinity switches it off): in a binary tree the level above the objects, which adds about a quarter to
  /// the cost of the refits; in a wide tree everything above leaves and objects, where that makes Σ cost · surface
  /// fall, for the first time when something moves for the first time, which adds a fortieth.
  double renewal_ratio = 64.0;
};

/// Throws std::invalid_argument for limits outside the ranges written above.
inline void validate(const TreeUpdateSettings& settings) {
  if (!(settings.sah_growth_limit > 1.0)) throw std::invalid_argument("sah_growth_limit: expected a number above 1");
  if (!(settings.deformation_limit > 0.0)) throw std::invalid_argument("deformation_limit: expected a number above 0");
  if (!(settings.renewal_ratio > 0.0)) throw std::invalid_argument("renewal_ratio: expected a number above 0");
}

/// What keeping a tree took in one frame. Every node is kept, refit or rebuilt; one that was both counts as rebuilt. An
/// object that a wide tree put elsewhere counts as one rebuilt subtree of one node.
struct TreeUpdateReport {
  std::uint64_t nodes_kept = 0;
  std::uint64_t nodes_refit = 0;
  std::uint64_t nodes_rebuilt = 0;
  std::uint64_t subtrees_rebuilt = 0;  ///< the whole tree counts as one
  bool root_rebuilt = false;           ///< the whole tree was built anew, or the last part of all that can be in place
  double sah_cost = 0.0;               ///< after the frame's update, no unit
  double sah_cost_at_build = 0.0;      ///< after the last build of the whole tree, no unit
  // Of a wide tree:
  std::uint64_t reinserted = 0;  ///< objects that were put elsewhere
  std::uint64_t rotated = 0;     ///< children that changed their place by rotation; their nodes count as kept or refit
  std::uint64_t rebuilt_in_place = 0;  ///< subtrees that were built anew in place

  friend bool operator==(const TreeUpdateReport&, const TreeUpdateReport&) = default;
};

}  // namespace dcem
