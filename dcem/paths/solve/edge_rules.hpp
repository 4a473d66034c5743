#pragma once
/// Which edges diffract, and where around them.
#include <cmath>
#include <limits>
#include <span>

#include "dcem/core/units.hpp"
#include "dcem/world/world_geometry.hpp"

namespace dcem {

/// What is known of where third facets touch an edge (paths/query/edge_contacts.hpp), in metres from its start.
struct EdgeContact {
  /// Before the one and behind the other it is touched: no path is diffracted there.
  float touched_to_m = 0.0F, touched_from_m = std::numeric_limits<float>::infinity();
  /// From the one to the other nothing touches it.
  float free_from_m = 0.0F, free_to_m = -std::numeric_limits<float>::infinity();

  bool is_touched(double along_m) const { return along_m < touched_to_m || along_m > touched_from_m; }
  bool is_free(double along_m) const { return along_m >= free_from_m && along_m <= free_to_m; }
  bool is_touched_all_along() const { return touched_to_m >= touched_from_m; }
};

/// Of an edge that no path can use.
inline EdgeContact all_along_touched() {
  EdgeContact contact;
  contact.touched_to_m = contact.touched_from_m;
  return contact;
}

/// What touches what, where somebody has looked (paths/query/scene_contacts.hpp): work that is spared. It changes no
/// result.
struct KnownContacts {
  std::span<const EdgeContact> edges{};  ///< by edge; empty: nothing is known
  std::span<const char> stacked{};       ///< by facet: 0 where none lies on top of it; empty: nothing is known
};

struct EdgeRules {
  double min_exterior_angle_rad = degrees_to_radians(190.0);  ///< flatter edges do not diffract
  bool free_edges = false;                                    ///< the rims of open sheets diffract as half planes
  bool shadow_only = false;  ///< only where the wedge itself hides one neighbour from the other
  KnownContacts known{};
};

inline EdgeContact contact_at(WedgeId edge, const EdgeRules& rules) {
  return rules.known.edges.empty() ? EdgeContact{} : rules.known.edges[edge.value];
}

/// Whether it is known that no path can use an edge.
inline bool is_embedded(WedgeId edge, const EdgeRules& rules) {
  return contact_at(edge, rules).is_touched_all_along();
}

/// Whether it is known that nothing lies on top of a facet.
inline bool is_unstacked(FacetId facet, const EdgeRules& rules) {
  return !rules.known.stacked.empty() && rules.known.stacked[facet.value] == 0;
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
