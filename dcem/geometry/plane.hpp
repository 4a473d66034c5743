#pragma once
/// An oriented plane, kept as a point and a unit normal: distances stay exact to rounding far from the origin.
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// An end this close to a mirror's plane has no reflection there, and a point this close to a rim is on it, metres: in
/// exact arithmetic it would be.
inline constexpr double in_plane_guard_m = 1e-9;

struct Plane {
  Vec3 point_m{0.0};
  Vec3 normal{0.0, 0.0, 1.0};  ///< unit length
};

/// Signed distance of `point_m`, positive on the side to which the normal points.
inline double signed_distance_m(const Plane& plane, const Vec3& point_m) {
  return glm::dot(plane.normal, point_m - plane.point_m);
}

/// Mirror image of a point. An isometry: the length of a reflected path is the distance from one end to the image of
/// the other.
inline Vec3 mirrored(const Plane& plane, const Vec3& point_m) {
  return point_m - 2.0 * signed_distance_m(plane, point_m) * plane.normal;
}

/// Any two unit vectors that span the plane: right-handed with the normal, and a function of the normal alone.
struct PlaneBasis {
  Vec3 u, v;
};

inline PlaneBasis plane_basis(const Vec3& normal) {
  const Vec3 size = glm::abs(normal);
  const Vec3 helper = size.x <= size.y && size.x <= size.z ? Vec3(1, 0, 0)
                      : size.y <= size.z                   ? Vec3(0, 1, 0)
                                                           : Vec3(0, 0, 1);
  const Vec3 u = glm::normalize(glm::cross(helper, normal));
  return {u, glm::cross(normal, u)};
}

}  // namespace dcem
