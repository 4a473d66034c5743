#pragma once
/// How a wide tree is built and kept.
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "dcem/accel/tree_settings.hpp"

namespace dcem {

/// What a wide tree costs; no unit, only the ratio matters.
struct WideCosts {
  double node = 1.0;  ///< visiting a node: eight boxes at once
  double leaf = 1.0;  ///< a leaf of up to eight quads at once
};

/// How long a build may take. Answers are the same.
enum class WideQuality {
  fast,  ///< what the splits give: for what is built again in every frame
  good,  ///< a third longer, 5 % fewer steps a ray
  high   ///< several times as long, 9 % fewer: scenery that stands still
};

/// How a wide tree is built.
struct WideBuildSettings {
  /// Relative costs of nodes and leaves, by which the binary tree is collapsed.
  WideCosts costs{};
  /// Two triangles become one quad where the fourth corner is no further from the plane of the others than this times
  /// the shared edge (no unit). Default 1e-3; negative switches pairing off.
  double pair_flatness = 1e-3;
  /// An object of at most this many quads owns a subtree that moves as a whole; a larger one, such as a city, is mixed
  /// with its surroundings (number). Default 512.
  std::uint32_t object_subtree_limit = 512;
  /// Splitting ends at this many quads of one object where it gains little (number, 1 … 8). Default 8; 1 leaves it to
  /// the collapse alone.
  std::uint32_t leaf_limit = 8;
  /// Threads of a build (number); 0: as many as the machine has. The tree does not depend on it. Default 1.
  unsigned threads = 1;
  /// How long a build may take. Default good.
  WideQuality quality = WideQuality::good;
  /// Whether the system is asked for huge pages where the tree is large (HugePageAllocator). Default true.
  bool huge_pages = true;
  /// Whether many items are divided by their size, too (WideItem::note_size). Default true.
  bool divide_by_size = true;
  /// Whether memory is asked for before it is needed: by rays in large trees, and for what moves. Default true.
  bool fetch_ahead = true;
};

/// Throws std::invalid_argument for settings outside the ranges written above.
inline void validate(const WideBuildSettings& settings) {
  const auto positive = [](double cost) { return cost >= 1e-9 && cost <= 1e9; };
  if (!positive(settings.costs.node) || !positive(settings.costs.leaf)) {
    throw std::invalid_argument("costs of a wide tree: expected numbers from 1e-9 to 1e9");
  }
  if (std::isnan(settings.pair_flatness)) throw std::invalid_argument("pair_flatness: expected a number");
  if (settings.leaf_limit < 1 || settings.leaf_limit > 8) {
    throw std::invalid_argument("leaf_limit: expected 1 to 8");
  }
}

/// How a wide tree is kept: what any tree can be told, and what this one can do beyond.
struct WideUpdateSettings : TreeUpdateSettings {
  /// An object that moved is put elsewhere when the node around it has grown to more than this many times what it was
  /// when the object came there (no unit, at least 1; infinity switches it off).
  double reinsertion_growth = 1.1;
  /// In each frame one in this many of the objects that moved is put anew in turn, whatever its node has grown (number;
  /// 0 switches it off).
  std::uint32_t reinsertion_turn = 50;
  /// Around each node that motion has touched, at most so many children change their place in a frame where
  /// Σ cost · surface falls (number; 0 switches rotations off).
  std::uint32_t rotations_per_node = 0;
  /// Only in one frame of so many, of those in which something moved, rotations are done and the two measures are
  /// looked at, for all that has moved since (number, at least 1).
  std::uint32_t check_interval = 25;
  /// Whether a subtree that is degraded by either measure is built anew in place, its leaves and objects untouched.
  /// Otherwise the whole tree is built anew when its SAH cost has grown by `sah_growth_limit`.
  bool subtree_rebuilds = true;
  /// With `subtree_rebuilds`: all above leaves and objects is built anew once rays have visited this many nodes more
  /// for each leaf than they would have at the steps per ray that followed the last time (number, above 0; infinity
  /// switches it off). Counts only where the updater is told what rays spend. 12 is about what building it takes: who
  /// has spent as much on rays buys it, and so never spends twice what the best moment would have cost.
  double subtree_rebuild_price = 12.0;
  /// With `subtree_rebuilds`: the whole tree is built anew, leaves included, when its SAH cost has grown to this many
  /// times what it was when last built whole (no unit, above 1; infinity switches it off). For what subtrees cannot
  /// mend: leaves whose triangles have drifted apart.
  double rebuild_growth_limit = 2.0;
};

/// Throws std::invalid_argument for numbers outside the ranges written above.
inline void validate(const WideUpdateSettings& settings) {
  validate(static_cast<const TreeUpdateSettings&>(settings));
  if (!(settings.reinsertion_growth >= 1.0)) {
    throw std::invalid_argument("reinsertion_growth: expected a number of at least 1");
  }
  if (settings.check_interval < 1) throw std::invalid_argument("check_interval: expected at least 1");
  if (!(settings.subtree_rebuild_price > 0.0)) {
    throw std::invalid_argument("subtree_rebuild_price: expected a number above 0");
  }
  if (!(settings.rebuild_growth_limit > 1.0)) {
    throw std::invalid_argument("rebuild_growth_limit: expected a number above 1");
  }
}

/// Everything that a wide tree can be told.
struct WideTreeSettings : WideUpdateSettings {
  WideBuildSettings build{};
};

inline void validate(const WideTreeSettings& settings) {
  validate(static_cast<const WideUpdateSettings&>(settings));
  validate(settings.build);
}

}  // namespace dcem
