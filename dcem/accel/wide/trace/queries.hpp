#pragma once
/// What one ray asks of a wide tree.
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/walk.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Whether what a ray needs next is far away as a rule: then it pays to ask for it ahead. Below, asking costs as much
/// as it gains.
inline bool fetches_ahead(const WideArrays& tree) {
  return tree.fetch_ahead && tree.leaves.size() * sizeof(QuadLeaf) > 8'000'000;
}

/// `alike`: as for the walk. Out of line: within the loop over many rays g++ keeps less of a walk in registers, which
/// costs a tenth.
template <bool alike>
[[gnu::flatten, gnu::noinline]] void closest_hit_of_one(const WideArrays& tree, const Ray<double>& ray,
                                                        const HitFilter& filter, std::optional<TriangleHit>& hit,
                                                        TraversalCounters& counters) {
  if (tree.nodes.empty()) return hit.reset();
  const WideRay wide(ray, tree.origin_m, tree.extent_m);
  if (!wide.usable()) {
    hit = closest_hit_of_all(tree, ray, filter, counters);
    return;
  }
  ClosestCandidates candidates;
  float reached = wide.t_max();
  const auto take = [&](std::uint32_t leaf, std::uint32_t met, const QuadHits& hits, float& limit)
      __attribute__((always_inline)) {
    candidates.take(tree, ray, filter, leaf, met, hits, limit, counters);
    reached = limit;
  };
  if (!alike && fetches_ahead(tree)) {
    walk_closest<true, false>(tree, wide, reached, take, counters);
  } else {
    walk_closest<false, alike>(tree, wide, reached, take, counters);
  }
  answer(candidates.decide(tree, ray, reached, counters), hit);
}

inline std::optional<TriangleHit> closest_hit(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                                              TraversalCounters& counters) {
  std::optional<TriangleHit> hit;
  closest_hit_of_one<false>(tree, ray, filter, hit, counters);
  return hit;
}

/// Out of line for the same reason: kinds side by side are slower.
template <RayKind kind>
[[gnu::flatten, gnu::noinline]] bool is_occluded(const WideArrays& tree, const Ray<double>& ray,
                                                 const HitFilter& filter, TraversalCounters& counters) {
  if (tree.nodes.empty()) return false;
  const WideRay wide(ray, tree.origin_m, tree.extent_m);
  if (!wide.usable()) return closest_hit_of_all(tree, ray, filter, counters).has_value();
  const auto take = [&](std::uint32_t leaf, std::uint32_t met, const QuadHits& hits) __attribute__((always_inline)) {
    if (filter.ignores(tree.leaves[leaf].object)) return false;
    alignas(32) std::array<float, simd_lanes> first, last;
    hits.first.store(first);
    hits.last.store(last);
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      ++counters.primitives_tested;
      const bool is_sure =
          filter.counts == nullptr || filter.is_sure(static_cast<double>(first[lane]), static_cast<double>(last[lane]));
      if (is_sure && hits.is_certain(lane) && static_cast<double>(last[lane]) < ray.t_max) return true;
      // Only from a surface so many hits are asked about that to know the side of the diagonal is worth working it out.
      const std::uint32_t quad = leaf * simd_lanes + lane;
      const bool is_met = kind == RayKind::from_surface
                              ? asked_hit_on(tree, quad, hits.certainty(lane), ray, filter).t < no_hit.t
                              : quad_hit(tree, quad, ray, filter).has_value();
      if (is_met) return true;
    }
    return false;
  };
  return walk_any<kind>(tree, wide, take, counters);
}

inline bool occluded(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                     TraversalCounters& counters) {
  constexpr double farthest = 1e30;  // what single precision counts up to
  constexpr float at_once = 1e-30F;  // in units of the direction: what a ray from a device meets counts from 0 on
  if (ray.t_max < farthest) return is_occluded<RayKind::segment>(tree, ray, filter, counters);
  return filter.sure_from > at_once ? is_occluded<RayKind::from_surface>(tree, ray, filter, counters)
                                    : is_occluded<RayKind::from_device>(tree, ray, filter, counters);
}

[[gnu::flatten]] inline bool visit_hits(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                                        const HitVisitor& visitor, TraversalCounters& counters) {
  if (tree.nodes.empty()) return false;
  const WideRay wide(ray, tree.origin_m, tree.extent_m);
  if (!wide.usable()) return visit_hits_of_all(tree, ray, filter, visitor, counters);
  const auto take = [&](std::uint32_t leaf, std::uint32_t met, const QuadHits&) __attribute__((always_inline)) {
    if (filter.ignores(tree.leaves[leaf].object)) return false;
    for (; met != 0; met &= met - 1) {
      const std::uint32_t quad = leaf * simd_lanes + static_cast<std::uint32_t>(std::countr_zero(met));
      ++counters.primitives_tested;
      if (visit_quad_hits(tree, quad, ray, filter, visitor)) return true;
    }
    return false;
  };
  return walk_any<RayKind::segment>(tree, wide, take, counters);
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
