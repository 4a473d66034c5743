#pragma once
/// Where a ray meets a triangle, decided in double precision: the one answer that every index over triangles gives, to
/// the last bit.
///
/// Whether the line of the ray meets the triangle, its edges included, is WatertightRay's to say; where, is that of the
/// triangle's plane. So t does not depend on what an index has computed before it asked.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "dcem/accel/hit_filter.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The plane of a triangle: a normal of unit length, zero where there is no plane, and the triangle's first corner. (An
/// offset from the origin of the world would be rounded too much far from there.)
struct HitPlane {
  Vec3 normal{0.0};
  Vec3 point_m{0.0};

  /// The line of a ray meets it at height / slope.
  double height(const Ray<double>& ray) const { return glm::dot(normal, point_m - ray.origin); }
  double slope(const Ray<double>& ray) const { return glm::dot(normal, ray.direction); }
  /// Zero without a sign: which one it has would depend on the way round of the corners.
  double t_of(const Ray<double>& ray) const { return height(ray) / slope(ray) + 0.0; }
};

namespace detail {

/// What is smaller, squared, is no length.
inline constexpr double least_length_squared = 1e-280;

/// 1 / √value for values from 1e-300 to 1e300: a guess from the exponent, good to 4 %, and four steps of Newton's
/// method, y ← y (1.5 − value y² / 2). The same operations as in the lanes of wide/update/leaf_numbers.hpp, and so the
/// same bits.
inline double reciprocal_root(double value) {
  double result = std::bit_cast<double>(std::int64_t{0x5fe6eb50c7b537a9} - (std::bit_cast<std::int64_t>(value) >> 1));
  for (int step = 0; step < 4; ++step) result = result * (1.5 - 0.5 * value * result * result);
  return result;
}

/// A ray along a plane meets it at a quotient of roundings: that counts only where the triangle is. Steeper rays, by
/// the measure by which single precision may be sure of a hit, are not asked.
inline bool is_beside(const HitPlane& plane, const TriangleCorners& corners_m, const Ray<double>& ray, double t) {
  const double slope = plane.slope(ray);
  if (slope * slope > 1e-12 * glm::dot(ray.direction, ray.direction)) return false;
  const Vec3 size = glm::abs(ray.direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto at = [&](const Vec3& corner_m) { return (corner_m[axis] - ray.origin[axis]) / ray.direction[axis]; };
  const auto [low, high] = std::minmax({at(corners_m[0]), at(corners_m[1]), at(corners_m[2])});
  return t < low || t > high;
}

inline bool is_in_range(double t, const Ray<double>& ray) {
  return t >= ray.t_min && t <= ray.t_max && std::isfinite(t);
}

/// The nearer of two hits; of those as near the one of the smaller number.
inline void take_nearer(const TriangleHit& hit, std::optional<TriangleHit>& best) {
  if (!best || hit.t < best->t || (hit.t == best->t && hit.triangle < best->triangle)) best = hit;
}

}  // namespace detail

inline HitPlane plane_of(const TriangleCorners& corners_m) {
  const Vec3 product = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
  const double squared = glm::dot(product, product);
  const double scale = squared > detail::least_length_squared ? detail::reciprocal_root(squared) : 0.0;
  return {product * scale, corners_m[0]};
}

/// Whether a ray leads anywhere; an infinite direction would meet every plane at t = 0.
inline bool has_direction(const Ray<double>& ray) {
  return is_finite(ray.direction) && ray.direction != Vec3(0.0);
}

/// Where a ray, which must have a direction, meets a triangle from t_min to t_max. `plane` is that of the corners,
/// `prepared` the ray.
inline std::optional<double> exact_hit_t(const HitPlane& plane, const TriangleCorners& corners_m,
                                         const WatertightRay& prepared, const Ray<double>& ray) {
  const double t = plane.t_of(ray);
  if (!detail::is_in_range(t, ray)) return std::nullopt;
  if (!prepared.intersect(corners_m) || detail::is_beside(plane, corners_m, ray, t)) return std::nullopt;
  return t;
}

}  // namespace dcem
