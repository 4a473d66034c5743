#pragma once
/// Legs along a face: from one of its edges to another over the face itself, as over a flat roof or along a wall.
#include <optional>

#include "dcem/scene/scene.hpp"

namespace dcem {

/// The face that two edges have in common; none for rims of sheets, which have two sides.
inline std::optional<FacetId> common_face(const WorldWedge& one, const WorldWedge& other) {
  if (is_free(one.edge) || is_free(other.edge)) return std::nullopt;
  for (const FacetId facet : one.facets) {
    if (facet == other.facets[0] || facet == other.facets[1]) return facet;
  }
  return std::nullopt;
}

/// Azimuth about an edge of a direction that points away from it; exactly that of the face for a leg along it.
inline double azimuth_rad(const WorldWedge& wedge, const Vec3& away, std::optional<FacetId> along) {
  if (!along) return azimuth_rad(wedge.edge, away);
  return *along == wedge.facets[0] ? 0.0 : wedge.edge.exterior_angle_rad;
}

/// Whether a segment between two points of a facet's plane lies on the facet all the way, but for gaps of
/// `tolerance_m`: not over a courtyard, nor over a window of another material.
bool lies_on_facet(const Scene& scene, FacetId id, const Vec3& from_m, const Vec3& to_m, double tolerance_m);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/solve/face_leg_bodies.hpp"
#endif
