#pragma once
/// What the simulator asks of an index over triangles, whatever is inside.
///
/// All indices give the same answers, to the last bit: which triangle a ray meets and where is decided by exact_hit_t.
/// (But for triangles that are all but lines, thinner than 1e-12 of their length: where their plane is, rounding
/// decides.) `WideIndex` is the fast one, `BinaryIndex` the plain one, and `BruteForceIndex` asks every triangle.
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/tree_settings.hpp"
#include "dcem/accel/wide/settings.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle_view.hpp"

namespace dcem {

/// * `Index(settings)`: an index that knows less than a wide tree takes the settings that it knows.
/// * `build(mesh, boxes, object_first)`: triangles [object_first[i], object_first[i + 1]) are object i, the last object
///   ends with the triangles. A triangle with an empty box is not there; any other box is that around its corners.
/// * `update(mesh, boxes, moved)`: the triangles in `moved` have got these corners and boxes. It may take a
///   `ThreadPool*` as its last argument, whose threads share the work.
/// * `note_rays(spent, rays)`: what rays have spent since the last update; decides at most how the index is kept.
/// * `closest_hit(ray, filter, counters)`: the closest hit from t_min to t_max that passes the filter; of equally near
///   ones that on the triangle with the smallest number.
/// * `closest_hits(queries, hits, counters)`, `closest_hits(fan, hits, counters)`: the same for many rays.
/// * `occluded(ray, filter, counters)`: whether there is such a hit.
/// * `visit_hits(ray, filter, visit, counters)`: `visit(hit) -> bool` for each of them, in no promised order, until one
///   returns true; returns whether one did.
/// * `overlapping(box, visit, counters)`: `visit(triangle)` for triangles whose box has a point in common with a box.
/// * `visit(keep, visit, counters)`: `visit(triangle)` for triangles for whose box `keep(box) -> bool` holds; it must
///   hold for every box that contains a box for which it holds.
///
/// Counters, where given, are added to. Queries may run on several threads at once, edits may not. Edits throw
/// std::invalid_argument, before anything changes, for boxes that are not finite and for numbers out of range.
template <typename Index>
concept SpatialIndex = std::constructible_from<Index, const WideTreeSettings&> &&
    requires(Index& index, const Index& built, const TriangleView& mesh, std::span<const Aabb<double>> boxes,
             std::span<const std::uint32_t> numbers, const Ray<double>& ray, const HitFilter& filter,
             std::span<const RayQuery> queries, const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
             TraversalCounters* counters, bool (*visit_hit)(const TriangleHit&), void (*visit)(std::uint32_t),
             bool (*keep)(const Aabb<double>&)) {
  index.build(mesh, boxes, numbers);
  { index.update(mesh, boxes, numbers) } -> std::same_as<TreeUpdateReport>;
  index.note_rays(*counters, std::uint64_t{});
  { built.closest_hit(ray, filter, counters) } -> std::same_as<std::optional<TriangleHit>>;
  built.closest_hits(queries, hits, counters);
  built.closest_hits(fan, hits, counters);
  { built.occluded(ray, filter, counters) } -> std::same_as<bool>;
  { built.visit_hits(ray, filter, visit_hit, counters) } -> std::same_as<bool>;
  built.overlapping(boxes[0], visit, counters);
  built.visit(keep, visit, counters);
};

}  // namespace dcem
