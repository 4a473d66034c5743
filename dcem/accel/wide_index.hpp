#pragma once
/// The wide tree as a `SpatialIndex`: with what keeps it fit.
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "dcem/accel/spatial_index.hpp"
#include "dcem/accel/wide/update/updater.hpp"
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

/// See `SpatialIndex`.
class WideIndex {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit WideIndex(const WideTreeSettings& settings = {}) : settings_(settings), updater_(settings) {
    validate(settings);
  }

  void build(const TriangleView& mesh, std::span<const Aabb<double>> boxes,
             std::span<const std::uint32_t> object_first) {
    tree_.build_objects(mesh, boxes, object_first, settings_.build);
  }
  TreeUpdateReport update(const TriangleView& mesh, std::span<const Aabb<double>> boxes,
                          std::span<const std::uint32_t> moved, ThreadPool* pool = nullptr) {
    return updater_.update(tree_, moved, mesh, boxes, pool);
  }
  void note_rays(const TraversalCounters& spent, std::uint64_t rays) { updater_.note_rays(spent, rays); }

  std::optional<TriangleHit> closest_hit(const Ray<double>& ray, const HitFilter& filter = {},
                                         TraversalCounters* counters = nullptr) const {
    return tree_.closest_hit(ray, filter, counters);
  }
  void closest_hits(std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    tree_.closest_hits(queries, hits, counters);
  }
  void closest_hits(const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    tree_.closest_hits(fan, hits, counters);
  }
  bool occluded(const Ray<double>& ray, const HitFilter& filter = {}, TraversalCounters* counters = nullptr) const {
    return tree_.occluded(ray, filter, counters);
  }
  template <typename Visit>
  bool visit_hits(const Ray<double>& ray, const HitFilter& filter, Visit&& visit,
                  TraversalCounters* counters = nullptr) const {
    return tree_.visit_hits(ray, filter, visit, counters);
  }
  template <typename Visit>
  void overlapping(const Aabb<double>& box, Visit&& visit, TraversalCounters* counters = nullptr) const {
    tree_.overlapping(box, visit, counters);
  }
  template <typename Keep, typename Visit>
  void visit(Keep&& keep, Visit&& visit, TraversalCounters* counters = nullptr) const {
    tree_.visit(keep, visit, counters);
  }

  const WideBvh& tree() const { return tree_; }
  const WideUpdater& updater() const { return updater_; }

 private:
  WideTreeSettings settings_;
  WideBvh tree_;
  WideUpdater updater_;
};

static_assert(SpatialIndex<WideIndex>);

}  // namespace dcem
