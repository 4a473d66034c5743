#pragma once
/// What many rays meet first: asked together, because an index answers that faster than one question after another.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// Rays, and then where each of them meets something first. The memory is kept from batch to batch.
class SurfaceHits {
 public:
  void clear() {
    filters_.clear();
    queries_.clear();
    hits_.clear();
  }
  /// A ray that leaves a place; what is named in `start` must stay until the hits are known.
  void add(const Scene& scene, const Ray<double>& ray, const LegEnd& start, const IgnoredBodies& ignored) {
    filters_.emplace_back(scene, ray, start, ignored);
    queries_.push_back({ray, {}});
  }

  /// Asks for all rays at once, and adds to the counters. The answers are those of `SceneTracer::closest_hit`.
  template <typename Index>
  void find(const SceneTracer<Index>& tracer, TraversalCounters& counters) {
    for (std::size_t ray = 0; ray < queries_.size(); ++ray) queries_[ray].filter = filters_[ray].hit_filter();
    hits_.resize(queries_.size());
    tracer.index().closest_hits(queries_, hits_, &counters);
  }

  /// The same for rays that leave one place in these directions, instead of `clear`, `add` and `find`. Faster where
  /// nothing is ignored at their start: from where on a hit is sure to count depends on the direction only where
  /// something is.
  template <typename Index>
  void find_around(const SceneTracer<Index>& tracer, const Vec3& from_m, std::span<const Vec3> directions,
                   const LegEnd& start, const IgnoredBodies& ignored, TraversalCounters& counters) {
    clear();
    if (start.facets.empty() && start.planes[0] == nullptr && start.planes[1] == nullptr) {
      const LegFilter filter(tracer.scene(), {from_m, Vec3(0.0)}, LegEnd{}, ignored);
      hits_.resize(directions.size());
      tracer.index().closest_hits(RayFan{from_m, directions, filter.hit_filter()}, hits_, &counters);
      return;
    }
    for (const Vec3& direction : directions) add(tracer.scene(), {from_m, direction}, start, ignored);
    find(tracer, counters);
  }

  /// How many rays have been asked for.
  std::size_t size() const { return hits_.size(); }
  const std::optional<TriangleHit>& hit(std::size_t index) const { return hits_[index]; }

 private:
  std::vector<LegFilter> filters_;
  std::vector<RayQuery> queries_;
  std::vector<std::optional<TriangleHit>> hits_;
};

}  // namespace dcem
