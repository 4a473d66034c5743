#pragma once
/// Tests between a triangle and a ray, a point in its plane, or a point in space.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "dcem/core/constants.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

using TriangleCorners = std::array<Vec3, 3>;

/// A ray prepared for the watertight test of Woop, Benthin and Wald (Journal of Computer Graphics Techniques 2(1),
/// 2013): space is sheared so that the ray runs along one axis, and the same three products decide for both triangles
/// of a shared edge. A ray through an edge or a corner meets at least one of the triangles there, never none; here it
/// meets all of them (edges belong to the triangle). The same goes for triangles that have no corner in common, but
/// sides on one vertical line with the same x and y, where the ray is no steeper than `steepest`: sheared along x or y,
/// all corners on the line have one and the same coordinate, and its sign decides. Needs a*b − c*d evaluated without
/// contraction.
class WatertightRay {
 public:
  /// Space is sheared along z where the ray's direction has so many times as much of z as of x and of y.
  static constexpr double steepest = 4.0;

  /// Precondition: the direction's length is at least 1e-150.
  explicit WatertightRay(const Ray<double>& ray) : origin_(ray.origin) {
    const Vec3 size = glm::abs(ray.direction);
    const double level = std::max(size.x, size.y);
    z_ = size.z > steepest * level ? 2 : size.x >= size.y ? 0 : 1;
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    shear_ = {ray.direction[x_] / ray.direction[z_], ray.direction[y_] / ray.direction[z_], 1.0 / ray.direction[z_]};
  }

  /// Parameter t of the point where the line of the ray meets the triangle, in units of the direction; it may be
  /// negative or beyond t_max. Absent where the line passes by, or lies in the plane of the triangle.
  std::optional<double> intersect(const TriangleCorners& corners) const {
    const Vec3 a = sheared(corners[0]), b = sheared(corners[1]), c = sheared(corners[2]);
    const double u = c.x * b.y - c.y * b.x;
    const double v = a.x * c.y - a.y * c.x;
    const double w = b.x * a.y - b.y * a.x;
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return std::nullopt;
    const double determinant = u + v + w;
    if (determinant == 0.0) return std::nullopt;
    return (u * a.z + v * b.z + w * c.z) / determinant;
  }

 private:
  Vec3 sheared(const Vec3& corner) const {
    const Vec3 offset = corner - origin_;
    return {offset[x_] - shear_.x * offset[z_], offset[y_] - shear_.y * offset[z_], shear_.z * offset[z_]};
  }

  Vec3 origin_;
  Vec3 shear_{0.0};
  int x_ = 0, y_ = 1, z_ = 2;
};

/// How the foot of a point along `normal` lies to a triangle.
struct TriangleContact {
  /// In the triangle, its edges included. The corners must come in the same order of their vertex indices wherever two
  /// triangles share an edge (ascending): then both evaluate the same number, and no point falls between them.
  bool contains = false;
  /// The share of a full turn around the foot that the triangle covers, radians: 2π inside, π on an edge, the angle of
  /// the corner on a corner, 0 outside.
  double covered_rad = 0.0;
};

namespace detail {

inline double corner_angle_rad(const Vec3& corner, const Vec3& one, const Vec3& other) {
  const Vec3 a = one - corner, b = other - corner;
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace detail

/// Points closer than `rim_m` to an edge or a corner are on it.
inline TriangleContact contact(const TriangleCorners& corners, const Vec3& normal, const Vec3& point_m, double rim_m) {
  const auto side = [&](const Vec3& from, const Vec3& to) {
    return glm::dot(normal, glm::cross(to - from, point_m - from));
  };
  const double ab = side(corners[0], corners[1]), bc = side(corners[1], corners[2]), ca = -side(corners[0], corners[2]);
  TriangleContact result;
  result.contains = (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
  const double turn = ab + bc + ca >= 0.0 ? 1.0 : -1.0;
  const double from_ab_m = turn * ab / glm::distance(corners[0], corners[1]);
  const double from_bc_m = turn * bc / glm::distance(corners[1], corners[2]);
  const double from_ca_m = turn * ca / glm::distance(corners[2], corners[0]);
  if (std::min({from_ab_m, from_bc_m, from_ca_m}) < -rim_m) return result;
  const bool on_ab = from_ab_m <= rim_m, on_bc = from_bc_m <= rim_m, on_ca = from_ca_m <= rim_m;
  if (on_ab && on_ca) {
    result.covered_rad = detail::corner_angle_rad(corners[0], corners[1], corners[2]);
  } else if (on_ab && on_bc) {
    result.covered_rad = detail::corner_angle_rad(corners[1], corners[2], corners[0]);
  } else if (on_bc && on_ca) {
    result.covered_rad = detail::corner_angle_rad(corners[2], corners[0], corners[1]);
  } else {
    result.covered_rad = on_ab || on_bc || on_ca ? pi : 2.0 * pi;
  }
  return result;
}

/// Whether the foot of `point_m` along `normal` lies in the triangle, its edges included.
inline bool contains_projected(const TriangleCorners& corners, const Vec3& normal, const Vec3& point_m) {
  return contact(corners, normal, point_m, 0.0).contains;
}

inline double distance_to_segment_m(const Vec3& point_m, const Vec3& from_m, const Vec3& to_m) {
  const Vec3 along = to_m - from_m;
  const double length_squared = glm::dot(along, along);
  const double share =
      length_squared > 0.0 ? std::clamp(glm::dot(point_m - from_m, along) / length_squared, 0.0, 1.0) : 0.0;
  return glm::distance(point_m, from_m + share * along);
}

/// Shortest distance from a point to a triangle (its inside, edges and corners).
inline double distance_to_triangle_m(const TriangleCorners& corners, const Vec3& point_m) {
  const Vec3 scaled_normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = glm::length(scaled_normal);
  if (length > 0.0) {
    const Vec3 normal = scaled_normal / length;
    if (contains_projected(corners, normal, point_m)) return std::abs(glm::dot(normal, point_m - corners[0]));
  }
  return std::min({distance_to_segment_m(point_m, corners[0], corners[1]),
                   distance_to_segment_m(point_m, corners[1], corners[2]),
                   distance_to_segment_m(point_m, corners[2], corners[0])});
}

}  // namespace dcem
