#pragma once
/// A diffracting edge: a straight line where two facets meet, or the rim of an open sheet.
#include <array>
#include <cmath>
#include <cstdint>

#include "dcem/core/constants.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Stands for the second face of a free edge.
inline constexpr std::uint32_t no_facet = 0xffffffff;

/// Face 0 is the facet with the smaller number, face n the other one. The exterior is the side with more than π. The
/// edge runs from `start_m` to `end_m` so that tangent × normal points the same way (right-handed).
struct Wedge {
  Vec3 start_m{0.0}, end_m{0.0};
  /// Numbers in `SurfaceMesh::facets`, ascending: face 0 and face n. The second is `no_facet` for a free edge.
  std::array<std::uint32_t, 2> facets{no_facet, no_facet};
  double exterior_angle_rad = 2.0 * pi;  ///< n·π in (π, 2π]; exactly 2π for a free edge
  Vec3 tangent{1.0, 0.0, 0.0};           ///< unit length, in face 0, across the edge, from the edge into the face
  Vec3 normal{0.0, 1.0, 0.0};            ///< of face 0, unit length, on the exterior side
  /// How far the welded vertices of the mesh lie from this edge at most, metres: a vertex that touches the edge in the
  /// mesh is no further from it.
  double stray_m = 0.0;
};

/// An edge of one facet only.
inline bool is_free(const Wedge& wedge) {
  return wedge.facets[1] == no_facet;
}

/// Unit vector from start to end. From the two vectors of the frame: as exact for an edge of a millimetre as for one of
/// a kilometre.
inline Vec3 edge_direction(const Wedge& wedge) {
  return glm::cross(wedge.tangent, wedge.normal);
}

inline double edge_length_m(const Wedge& wedge) {
  return glm::distance(wedge.start_m, wedge.end_m);
}

/// How far along an edge from its start the foot of a point is.
inline double along_edge_m(const Wedge& wedge, const Vec3& point_m) {
  return glm::dot(point_m - wedge.start_m, edge_direction(wedge));
}

/// Azimuth about the edge of a direction that points away from it, in [0, 2π): 0 along face 0, counted through the
/// exterior, `exterior_angle_rad` along face n. `away` has any length; only its part across the edge counts. Along the
/// edge itself there is no azimuth, and the result is 0.
inline double azimuth_rad(const Wedge& wedge, const Vec3& away) {
  const double angle_rad = std::atan2(glm::dot(away, wedge.normal), glm::dot(away, wedge.tangent));
  if (angle_rad >= 0.0) return angle_rad;
  const double turned_rad = angle_rad + 2.0 * pi;
  return turned_rad < 2.0 * pi ? turned_rad : 0.0;  // a rounding below face 0
}

/// Whether a direction that points away from the edge lies strictly between face 0 and face n, in the exterior.
inline bool in_exterior(const Wedge& wedge, const Vec3& away) {
  const double angle_rad = azimuth_rad(wedge, away);
  return angle_rad > 0.0 && angle_rad < wedge.exterior_angle_rad;
}

}  // namespace dcem
