#pragma once
/// Bodies of exact.hpp.
#include "dcem/accel/wide/trace/exact.hpp"

namespace dcem::detail {

/// Calls `visit(hit) -> bool` for the triangles of a quad that a ray meets, until one returns true. Returns whether one
/// did.
template <typename Visit>
bool any_hit_on(const WideArrays& tree, std::uint32_t quad, const Ray<double>& ray, Visit&& visit) {
  const WatertightRay prepared(ray);
  for (const TrianglePlane& plane : tree.planes[quad].sides()) {
    const auto t = exact_hit_t(plane, tree.corners_m(plane.triangle), prepared, ray);
    if (t && visit(TriangleHit{*t, plane.triangle})) return true;
  }
  return false;
}

/// Calls `visit(quad) -> bool` for quads of which something is there and that are not ignored, until one returns true.
template <typename Visit>
bool any_present_quad(const WideArrays& tree, const HitFilter& filter, Visit&& visit) {
  for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
    if (filter.ignores(tree.leaves[leaf].object)) continue;
    for (std::uint32_t lanes = tree.leaves[leaf].lanes; lanes != 0; lanes &= lanes - 1) {
      if (visit(leaf * simd_lanes + static_cast<std::uint32_t>(std::countr_zero(lanes)))) return true;
    }
  }
  return false;
}

[[gnu::noinline]] DCEM_INLINE std::optional<TriangleHit> quad_hit(const WideArrays& tree, std::uint32_t quad,
                                                                  const Ray<double>& ray, const HitFilter& filter) {
  std::optional<TriangleHit> best;
  any_hit_on(tree, quad, ray, [&](const TriangleHit& hit) {
    if (filter.passes(hit)) take_nearer(hit, best);
    return false;
  });
  return best;
}

[[gnu::noinline]] DCEM_INLINE bool visit_quad_hits(const WideArrays& tree, std::uint32_t quad, const Ray<double>& ray,
                                                   const HitFilter& filter, const HitVisitor& visitor) {
  return any_hit_on(tree, quad, ray, [&](const TriangleHit& hit) { return filter.passes(hit) && visitor(hit); });
}

[[gnu::noinline]] DCEM_INLINE std::optional<TriangleHit> closest_hit_of_all(const WideArrays& tree,
                                                                            const Ray<double>& ray,
                                                                            const HitFilter& filter,
                                                                            TraversalCounters& counters) {
  std::optional<TriangleHit> best;
  if (!has_direction(ray)) return best;
  any_present_quad(tree, filter, [&](std::uint32_t quad) {
    ++counters.primitives_tested;
    if (const auto hit = quad_hit(tree, quad, ray, filter)) take_nearer(*hit, best);
    return false;
  });
  return best;
}

[[gnu::noinline]] DCEM_INLINE bool visit_hits_of_all(const WideArrays& tree, const Ray<double>& ray,
                                                     const HitFilter& filter, const HitVisitor& visitor,
                                                     TraversalCounters& counters) {
  return has_direction(ray) && any_present_quad(tree, filter, [&](std::uint32_t quad) {
           ++counters.primitives_tested;
           return visit_quad_hits(tree, quad, ray, filter, visitor);
         });
}

}  // namespace dcem::detail
