#pragma once
/// Where the rays of one diffraction stand about the edge: azimuths, angle to the edge, and the edge-fixed bases in
/// which the diffraction matrix is written (Kouyoumjian & Pathak 1974).
///   φ̂' = −e × s'/|e × s'|,  β̂0' = φ̂' × s',   φ̂ = e × s/|e × s|,  β̂0 = φ̂ × s
/// s' and s are the propagation directions before and after, so φ̂' and φ̂ are the directions of growing azimuth where
/// the source and the observer stand. Straight on (s = s') β̂0 = −β̂0' and φ̂ = −φ̂'. Turning e about changes the sign of
/// all four vectors, of the azimuths too, and of no field.
#include <cmath>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/utd.hpp"

namespace dcem {

/// The four unit vectors at the head of this file.
struct EdgeBases {
  Vec3 incident_beta, incident_phi;      ///< β̂0', φ̂'
  Vec3 diffracted_beta, diffracted_phi;  ///< β̂0, φ̂
};

/// `edge` e, `incident` s' and `diffracted` s of unit length, neither ray along the edge.
inline EdgeBases edge_bases(const Vec3& edge, const Vec3& incident, const Vec3& diffracted) {
  const Vec3 incident_phi = -glm::normalize(glm::cross(edge, incident));
  const Vec3 diffracted_phi = glm::normalize(glm::cross(edge, diffracted));
  return {glm::cross(incident_phi, incident), incident_phi, glm::cross(diffracted_phi, diffracted), diffracted_phi};
}

/// Components (β0', φ') of a field that arrives at the edge.
inline ComplexVector2 incident_components(const EdgeBases& bases, const ComplexVector3& field) {
  return {dot(field, bases.incident_beta), dot(field, bases.incident_phi)};
}

/// The field with the components (β0, φ) that leaves the edge.
inline ComplexVector3 diffracted_field(const EdgeBases& bases, const ComplexVector2& components) {
  return scaled(bases.diffracted_beta, components[0]) + scaled(bases.diffracted_phi, components[1]);
}

/// Field just after the edge, in Cartesian coordinates; without spreading and phase.
inline ComplexVector3 diffract(const ComplexVector3& field, const EdgeBases& bases, const ComplexMatrix2& matrix) {
  return diffracted_field(bases, matrix * incident_components(bases, field));
}

/// How a wedge lies: the three are unit vectors at right angles with edge = face_direction × face_normal.
struct WedgeFrame {
  Vec3 edge;            ///< e: azimuth grows about it, out of face 0 through the exterior
  Vec3 face_direction;  ///< in face 0, across the edge, from the edge into the face: azimuth 0
  Vec3 face_normal;     ///< normal of face 0 on its exterior side: azimuth π/2
};

/// The frame of a wedge from face 0: a unit vector that leads from the edge into the face (its part along the edge is
/// taken off) and the unit normal of the face that points to the exterior; e follows from them.
inline WedgeFrame wedge_frame(const Vec3& face_direction, const Vec3& face_normal) {
  const Vec3 edge = glm::normalize(glm::cross(face_direction, face_normal));
  return {edge, glm::cross(face_normal, edge), face_normal};
}

/// Azimuth in 0…nπ of a direction seen from the edge. A direction inside the wedge counts as along the nearer face:
/// rounding can put there what lies in a face.
inline double azimuth_about_edge_rad(const WedgeFrame& frame, double exterior_angle_over_pi, const Vec3& direction) {
  const double azimuth = std::atan2(glm::dot(direction, frame.face_normal), glm::dot(direction, frame.face_direction));
  const double turned = azimuth < 0.0 ? azimuth + 2.0 * pi : azimuth;
  const double end = exterior_angle_over_pi * pi;
  if (turned <= end) return turned;
  return turned > 0.5 * (end + 2.0 * pi) ? 0.0 : end;
}

/// The angles of a diffraction from the propagation directions before and after (unit length).
inline WedgeAngles wedge_angles(const WedgeFrame& frame, double exterior_angle_over_pi, const Vec3& incident,
                                const Vec3& diffracted) {
  return {exterior_angle_over_pi, azimuth_about_edge_rad(frame, exterior_angle_over_pi, -incident),
          azimuth_about_edge_rad(frame, exterior_angle_over_pi, diffracted),
          std::atan2(glm::length(glm::cross(incident, frame.edge)), glm::dot(incident, frame.edge))};
}

}  // namespace dcem
