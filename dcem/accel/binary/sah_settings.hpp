#pragma once
/// The dials of the surface-area heuristic (SAH).
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "dcem/accel/binary/node.hpp"

namespace dcem {

/// How a tree is built. Costs are relative: only their ratio matters.
struct SahSettings {
  /// Cost of visiting an inner node (no unit). Default 1.
  double traversal_cost = 1.0;
  /// Cost of one primitive, in the same scale (no unit). Default 0.5: its own box is tested first and mostly refuses.
  double intersection_cost = 0.5;
  /// Bins per axis over the range of the centres (number, 2 … 64). Default 32.
  std::uint32_t bins = 32;
  /// Ranges up to this many primitives try every split instead of bins (number, 0 … 64; 0 is off). Default 16.
  std::uint32_t sweep_limit = 16;
  /// A range of at most this many primitives may become a leaf (number, 1 … leaf_maximum). Default 4.
  std::uint32_t leaf_limit = 4;
  /// A range that no plane can divide becomes a leaf up to this size (number, leaf_limit … 8). Default 8.
  std::uint32_t leaf_maximum = maximum_leaf_size;
};

/// Throws std::invalid_argument for settings outside the ranges written above.
inline void require_valid_settings(const SahSettings& settings) {
  const auto positive = [](double cost) { return cost > 0.0 && std::isfinite(cost); };
  if (!positive(settings.traversal_cost) || !positive(settings.intersection_cost)) {
    throw std::invalid_argument("SAH costs must be positive and finite");
  }
  if (settings.bins < 2 || settings.bins > 64) throw std::invalid_argument("SAH bins must be 2 to 64");
  if (settings.sweep_limit > 64) throw std::invalid_argument("SAH sweep limit must be at most 64");
  if (settings.leaf_limit < 1 || settings.leaf_limit > settings.leaf_maximum ||
      settings.leaf_maximum > maximum_leaf_size) {
    throw std::invalid_argument("leaf sizes must satisfy 1 <= leaf_limit <= leaf_maximum <= 8");
  }
}

}  // namespace dcem
