#pragma once
/// Sampled discovery: rays shot from the receiver propose sequences.
///
/// A sphere of rays, turned by a rotation drawn from (seed, receiver id, frame), leaves the receiver; each ray is
/// reflected at what it hits and, at a sheet, also goes straight on. The facets a ray was reflected at, in order, are a
/// sequence; each new one is handed on once. Where edges are wanted, the edges at the rim of what a ray meets are noted
/// as within reach. The number of rays does not depend on the transmitters.
///
/// Rays go together, a block of neighbours at a time and one leg after another: many questions at once are answered
/// faster.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"
#include "dcem/paths/discover/sequence_tree.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/query/surface_hits.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

struct LaunchSettings {
  std::uint32_t rays = 2000;
  int max_reflections = 2;
  int max_transmissions = 2;
};

template <typename Index>
class RayLauncher {
 public:
  RayLauncher(const SceneTracer<Index>& tracer, const LaunchSettings& settings)
      : tracer_(tracer), settings_(settings) {}

  /// From now on the edges that rays come by over at most so many mirrors are noted, by rules that say which edges
  /// count. Both outlive the launcher.
  void note_edges(EdgeReach& reach, const EdgeRules& rules, std::size_t most_mirrors) {
    reach_ = &reach;
    rules_ = &rules;
    most_mirrors_ = most_mirrors;
  }

  /// Calls `visit(sequence, images_m)` once for the direct path and for each sequence that a ray followed.
  template <typename Visit>
  void for_each_sequence(const LinkEnd& receiver, const Mat3& rotation, Visit&& visit) {
    ways_.begin(receiver.position_m);
    ignored_ = {receiver.ignored_body, std::nullopt};
    show(0, visit);
    if (settings_.max_reflections == 0 && reach_ == nullptr) return;
    const std::span<const Vec3> sphere = launch_directions(settings_.rays);
    for (std::size_t first = 0; first < sphere.size(); first += block_rays) {
      launch(receiver, rotation, sphere.subspan(first, std::min(block_rays, sphere.size() - first)), visit);
      while (!rays_on_their_way_.empty()) go_one_leg(visit);
    }
  }

  std::uint64_t rays() const { return rays_; }
  const TraversalCounters& traversal() const { return traversal_; }

 private:
  /// What one block asks and is told fits into the second cache.
  static constexpr std::size_t block_rays = 1024;

  struct FlyingRay {
    Vec3 origin_m, direction;
    std::uint32_t way;  ///< node of `ways_`
    int crossings_left;
  };
  struct LeavingRay {
    FlyingRay ray;
    FacetId from;  ///< the facet that it leaves
  };

  /// The rays of a block leave the receiver, and become those that go on from what they meet.
  template <typename Visit>
  void launch(const LinkEnd& receiver, const Mat3& rotation, std::span<const Vec3> block, Visit& visit) {
    directions_.clear();
    for (const Vec3& direction : block) directions_.push_back(rotation * direction);
    hits_.find_around(tracer_, receiver.position_m, directions_, {receiver.mounted_on, {}}, ignored_, traversal_);
    const auto ray_of = [&](std::size_t index) {
      return FlyingRay{receiver.position_m, directions_[index], 0, settings_.max_transmissions};
    };
    go_on_from_hits(ray_of, visit);
  }

  /// All rays on their way go to what they meet, and become those that go on from there.
  template <typename Visit>
  void go_one_leg(Visit& visit) {
    hits_.clear();
    for (const auto& [ray, from] : rays_on_their_way_) {
      const LegEnd start{{&from, 1}, {&tracer_.scene().facet(from).plane, nullptr}};
      hits_.add(tracer_.scene(), {ray.origin_m, ray.direction}, start, ignored_);
    }
    hits_.find(tracer_, traversal_);
    go_on_from_hits([&](std::size_t index) -> const FlyingRay& { return rays_on_their_way_[index].ray; }, visit);
  }

  /// Rays that have met something go on from there, or end; `ray_of(index)`: the one that met hit `index`.
  template <typename RayOf, typename Visit>
  void go_on_from_hits(RayOf ray_of, Visit& visit) {
    rays_ += hits_.size();
    next_rays_.clear();
    for (std::size_t index = 0; index < hits_.size(); ++index) {
      if (hits_.hit(index)) go_on(ray_of(index), *hits_.hit(index), visit);
    }
    std::swap(rays_on_their_way_, next_rays_);
  }

  /// What becomes of a ray where it meets a facet.
  template <typename Visit>
  void go_on(const FlyingRay& ray, const TriangleHit& hit, Visit& visit) {
    const FacetId mirror = tracer_.scene().facet_of_triangle(hit.triangle);
    const WorldFacet& facet = tracer_.scene().facet(mirror);
    const Vec3 point_m = ray.origin_m + hit.t * ray.direction;
    const std::size_t depth = ways_.depth(ray.way);
    const auto [way, is_new] = ways_.step(ray.way, mirror, facet.plane);
    if (is_new && reach_ != nullptr && depth <= most_mirrors_) note_edges_of(mirror, ray.way);
    if (facet.transmits && ray.crossings_left > 0) {
      next_rays_.push_back({{point_m, ray.direction, ray.way, ray.crossings_left - 1}, mirror});
    }
    if (depth == static_cast<std::size_t>(settings_.max_reflections)) return;
    if (is_new) show(way, visit);
    // After the last reflection a ray has only edges to find.
    const bool looks_for_edges = reach_ != nullptr && depth + 1 <= most_mirrors_;
    if (!looks_for_edges && depth + 1 >= static_cast<std::size_t>(settings_.max_reflections)) return;
    const Vec3 reflected = ray.direction - 2.0 * glm::dot(ray.direction, facet.plane.normal) * facet.plane.normal;
    next_rays_.push_back({{point_m, reflected, way, ray.crossings_left}, mirror});
  }

  template <typename Visit>
  void show(std::uint32_t way, Visit& visit) {
    ways_.unfold(way, sequence_, images_m_);
    visit(std::as_const(sequence_), std::as_const(images_m_));
  }

  void note_edges_of(FacetId facet, std::uint32_t way) {
    ways_.unfold(way, sequence_, images_m_);
    for (const WedgeId edge : tracer_.scene().wedges_of_facet(facet)) {
      if (diffracts(tracer_.scene().wedge(edge), *rules_) && !is_embedded(edge, *rules_)) reach_->add(sequence_, edge);
    }
  }

  const SceneTracer<Index>& tracer_;
  LaunchSettings settings_;
  EdgeReach* reach_ = nullptr;
  const EdgeRules* rules_ = nullptr;
  std::size_t most_mirrors_ = 0;
  SequenceTree ways_{Vec3(0.0)};
  std::vector<Vec3> directions_;
  std::vector<LeavingRay> rays_on_their_way_, next_rays_;
  SurfaceHits hits_;
  Sequence sequence_;
  std::vector<Vec3> images_m_;
  IgnoredBodies ignored_;
  std::uint64_t rays_ = 0;
  TraversalCounters traversal_;
};

}  // namespace dcem
