#pragma once
/// Which edges diffract, and where around them.
#include <cmath>
#include <span>

#include "dcem/core/units.hpp"
#include "dcem/world/world_geometry.hpp"

namespace dcem {

struct EdgeRules {
  double min_exterior_angle_rad = degrees_to_radians(190.0);  ///< flatter edges do not diffract
  bool free_edges = false;                                    ///< the rims of open sheets diffract as half planes
  bool shadow_only = false;  ///< only where the wedge itself hides one neighbour from the other
  /// By edge: not 0 where it is known that no path can use it. Empty: nothing is known. Changes no result.
  std::span<const char> embedded{};
};

/// Whether it is known that no path can use an edge.
inline bool is_embedded(WedgeId edge, const EdgeRules& rules) {
  return !rules.embedded.empty() && rules.embedded[edge.value] != 0;
}

/// Whether a mirror's plane holds an edge: next to a diffraction such a mirror gives no path, that is in the wedge's
/// own reflection terms.
inline bool holds_edge(const Plane& plane, const Wedge& edge, double weld_tolerance_m) {
  const double tolerance_m = weld_tolerance_m + edge.stray_m;
  return std::abs(signed_distance_m(plane, edge.start_m)) <= tolerance_m &&
         std::abs(signed_distance_m(plane, edge.end_m)) <= tolerance_m;
}

inline bool diffracts(const WorldWedge& wedge, const EdgeRules& rules) {
  return wedge.present &&
         (is_free(wedge.edge) ? rules.free_edges : wedge.edge.exterior_angle_rad >= rules.min_exterior_angle_rad);
}

}  // namespace dcem
