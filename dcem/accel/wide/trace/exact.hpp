#pragma once
/// What double precision says of a ray and a quad: asked where single precision is undecided, or a filter
/// has to know where a triangle is met that it has not told. Seldom, and therefore kept out of the walks.
#include <bit>
#include <cstdint>
#include <optional>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/exact_hit.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem::detail {

/// The nearest hit on a quad that passes the filter.
std::optional<TriangleHit> quad_hit(const WideArrays& tree, std::uint32_t quad, const Ray<double>& ray,
                                    const HitFilter& filter);

/// Shows all hits on a quad that pass the filter. Returns whether the visitor wants no more.
bool visit_quad_hits(const WideArrays& tree, std::uint32_t quad, const Ray<double>& ray, const HitFilter& filter,
                     const HitVisitor& visitor);

/// The same for all quads of the tree, for rays that single precision does not follow.
std::optional<TriangleHit> closest_hit_of_all(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                                              TraversalCounters& counters);
bool visit_hits_of_all(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                       const HitVisitor& visitor, TraversalCounters& counters);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/accel/wide/trace/exact_bodies.hpp"
#endif
