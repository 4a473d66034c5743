#pragma once
/// What edges see: rays that leave the edges within reach of an end note the mirrors that they meet, for paths with a
/// mirror between two edges.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "dcem/core/random.hpp"
#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/query/surface_hits.hpp"

namespace dcem {

/// Of the rays of an end, so many leave each edge: a share of the sphere, and never fewer than a few.
inline constexpr std::uint32_t rays_per_ray_of_an_edge = 32, least_rays_of_an_edge = 8;

inline std::uint32_t rays_of_an_edge(std::uint32_t rays) {
  return std::max(least_rays_of_an_edge, rays / rays_per_ray_of_an_edge);
}

/// What turns the spheres of all edges in a frame: an edge has the same rays whichever end reaches it.
struct EdgeSphereKey {
  std::uint64_t seed = 1;
  std::size_t frame = 0;
};

/// Sends rays from edges.
template <typename Index>
class EdgeView {
 public:
  EdgeView(const SceneTracer<Index>& tracer, const LinkEnd& end) : tracer_(tracer) {
    ignored_ = {end.ignored_body, std::nullopt};
  }

  /// From every edge of `reach` that a chain with a mirror behind it may begin with, `rays` rays.
  void look(EdgeReach& reach, const ChainLimits& limits, const EdgeSphereKey& key, std::uint32_t rays) {
    if (limits.max_diffractions < 2 || limits.max_reflections < 1 || limits.max_interactions < 3) return;
    const std::size_t most_mirrors = std::min(limits.max_reflections - 1, limits.max_interactions - 3);
    for (const EdgeReach::Edge& edge : reach.edges()) {
      const bool fits = std::any_of(edge.mirrors.begin(), edge.mirrors.end(),
                                    [&](const auto& mirrors) { return mirrors.size() <= most_mirrors; });
      if (fits && tracer_.scene().wedge(edge.id).present) look_from(edge.id, reach, key, rays);
    }
  }

  std::uint64_t rays() const { return rays_; }
  const TraversalCounters& traversal() const { return traversal_; }

 private:
  void look_from(WedgeId id, EdgeReach& reach, const EdgeSphereKey& key, std::uint32_t rays) {
    const WorldWedge& wedge = tracer_.scene().wedge(id);
    const std::array<const Plane*, 2> planes{&tracer_.scene().facet(wedge.facets[0]).plane,
                                             &tracer_.scene().facet(wedge.facets[1]).plane};
    RandomStream random(hash_values(key.seed, id.value, key.frame));
    const Mat3 rotation = random_rotation(random);
    double share = random.uniform();  // of the edge: a sequence that fills it evenly, whatever the number of rays
    hits_.clear();
    for (const Vec3& direction : launch_directions(rays)) {
      const Vec3 turned = rotation * direction;
      share += 0.5 * (std::sqrt(5.0) - 1.0);
      share -= std::floor(share);
      if (!in_exterior(wedge.edge, turned)) continue;
      hits_.add(tracer_.scene(), {glm::mix(wedge.edge.start_m, wedge.edge.end_m, share), turned},
                {wedge.facets, planes}, ignored_);
    }
    hits_.find(tracer_, traversal_);
    rays_ += hits_.size();
    for (std::size_t index = 0; index < hits_.size(); ++index) {
      if (hits_.hit(index)) reach.note_view(id, tracer_.scene().facet_of_triangle(hits_.hit(index)->triangle));
    }
  }

  const SceneTracer<Index>& tracer_;
  IgnoredBodies ignored_;
  SurfaceHits hits_;
  std::uint64_t rays_ = 0;
  TraversalCounters traversal_;
};

}  // namespace dcem
