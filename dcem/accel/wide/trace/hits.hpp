#pragma once
/// Where a ray meets a quad, in double precision; included by wide_tree.hpp.
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

namespace detail {

/// A ray along a plane meets it at a quotient of roundings: that counts only where the triangle is. Rays that are
/// steeper, by the same measure as what single precision may be sure of, are not asked.
inline bool is_beside(const TrianglePlane& plane, const TriangleCorners& corners_m, const Ray<double>& ray, double t) {
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

/// Whether a ray leads anywhere; an infinite direction would meet every plane at t = 0.
inline bool WideBvh::has_direction(const Ray<double>& ray) {
  return is_finite(ray.direction) && ray.direction != Vec3(0.0);
}

/// The plane of the triangle in which a ray meets a quad; null where what is known does not tell.
[[gnu::always_inline]] inline const TrianglePlane* WideBvh::plane_met(const QuadPlanes& planes, const Ray<double>& ray,
                                                                      Known known) {
  const TrianglePlane& plane = planes.side[known == Known::second ? 1 : 0];
  if (known == Known::nothing || (known == Known::met && !plane.is_alone())) return nullptr;
  return plane.is_steep(ray) ? &plane : nullptr;
}

/// Where a ray meets a quad, and in which of its triangles; absent where it does not from t_min to t_max. Each
/// triangle is asked in double precision. Seldom needed, and kept out of the loops that need it seldom.
[[gnu::noinline]] inline std::optional<TriangleHit> WideBvh::hit_on(std::uint32_t quad, const Ray<double>& ray) const {
  const WatertightRay exact(ray);
  std::optional<TriangleHit> best;
  for (const TrianglePlane& plane : arrays_.planes[quad].sides()) {
    const TriangleHit hit{plane.t_of(ray), plane.triangle};
    if (!detail::is_in_range(hit.t, ray)) continue;
    const TriangleCorners corners_m = arrays_.corners_m(hit.triangle);
    if (!exact.intersect(corners_m) || detail::is_beside(plane, corners_m, ray, hit.t)) continue;
    detail::take_nearer(hit, best);
  }
  return best;
}

/// The triangles of a quad that a ray may meet.
inline std::span<const TrianglePlane> WideBvh::halves_to_ask(std::uint32_t quad, Known known) const {
  const std::span<const TrianglePlane> all = arrays_.planes[quad].side;
  if (known == Known::first) return all.first(1);
  return known == Known::second ? all.subspan(1, 1) : arrays_.planes[quad].sides();
}

/// Calls `visit(quad) -> bool` for quads of which something is there, until one returns true. Returns whether one
/// did.
template <typename Visit>
bool WideBvh::for_each_present_quad(Visit&& visit) const {
  for (std::uint32_t leaf = 0; leaf < arrays_.leaves.size(); ++leaf) {
    if (detail::any_lane(arrays_.leaves[leaf].lanes,
                         [&](std::uint32_t lane) { return visit(leaf * simd_lanes + lane); })) {
      return true;
    }
  }
  return false;
}

template <typename Considers>
bool WideBvh::is_considered(std::uint32_t quad, Considers& considers) const {
  if constexpr (std::is_same_v<std::remove_const_t<Considers>, EveryTriangle>) return true;
  return considers(arrays_.planes[quad].side[0].triangle);
}

/// Takes over where a ray meets a quad, if that is nearer. The answer is the same whatever is known.
[[gnu::always_inline]] inline void WideBvh::offer(std::uint32_t quad, const Ray<double>& ray, Known known,
                                                  std::optional<TriangleHit>& best) const {
  if (const TrianglePlane* plane = plane_met(arrays_.planes[quad], ray, known)) {
    const double t = plane->t_of(ray);
    if (detail::is_in_range(t, ray)) detail::take_nearer({t, plane->triangle}, best);
  } else if (const std::optional<TriangleHit> hit = hit_on(quad, ray)) {
    detail::take_nearer(*hit, best);
  }
}

}  // namespace dcem
