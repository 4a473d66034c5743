#pragma once
/// Sampled discovery: rays shot from the receiver propose sequences.
///
/// A sphere of rays, turned by a rotation drawn from (seed, receiver id, frame), leaves the receiver; each ray is
/// reflected at what it hits and, at a sheet, also goes straight on. The facets a ray was reflected at, in order, are a
/// sequence; each new one is handed on once. Where edges are wanted, the edges at the rim of what a ray meets are noted
/// as within reach. The number of rays does not depend on the transmitters.
#include <array>
#include <cstdint>
#include <vector>

#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/edge_rules.hpp"
#include "dcem/paths/solve/image_method.hpp"

namespace dcem {

struct LaunchSettings {
  std::uint32_t rays = 2000;
  int max_reflections = 2;
  int max_transmissions = 2;
};

template <typename Tree>
class RayLauncher {
 public:
  RayLauncher(const SceneTracer<Tree>& tracer, const LaunchSettings& settings) : tracer_(tracer), settings_(settings) {}

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
    table_ = {};
    sequence_.clear();
    images_m_.assign(1, receiver.position_m);
    ignored_ = {receiver.ignored_body, std::nullopt};
    visit(sequence_, images_m_);
    if (settings_.max_reflections == 0 && reach_ == nullptr) return;
    for (const Vec3& direction : launch_directions(settings_.rays)) {
      shoot(receiver.position_m, rotation * direction, LegEnd{receiver.mounted_on, {}}, settings_.max_transmissions,
            visit);
    }
  }

  std::uint64_t rays() const { return rays_; }
  const TraversalCounters& traversal() const { return traversal_; }

 private:
  template <typename Visit>
  void shoot(const Vec3& origin_m, const Vec3& direction, const LegEnd& start, int crossings_left, Visit&& visit) {
    ++rays_;
    const Ray<double> ray{origin_m, direction};
    const std::optional<SurfaceHit> hit = tracer_.closest_hit(ray, start, ignored_, traversal_);
    if (!hit) return;
    const FacetId mirror = hit->facet;
    const WorldFacet& facet = tracer_.scene().facet(mirror);
    const LegEnd here{{&mirror, 1}, {&facet.plane, nullptr}};
    const Vec3 point_m = ray.at(hit->t);
    if (reach_ != nullptr && sequence_.size() <= most_mirrors_) note_edges_of(mirror);
    if (facet.transmits && crossings_left > 0) shoot(point_m, direction, here, crossings_left - 1, visit);
    if (sequence_.size() == static_cast<std::size_t>(settings_.max_reflections)) return;
    sequence_.push_back(mirror);
    append_image(images_m_, facet.plane);
    if (table_.insert(sequence_)) visit(sequence_, images_m_);
    // After the last reflection a ray has only edges to find.
    const bool looks_for_edges = reach_ != nullptr && sequence_.size() <= most_mirrors_;
    if (looks_for_edges || sequence_.size() < static_cast<std::size_t>(settings_.max_reflections)) {
      const Vec3 reflected = direction - 2.0 * glm::dot(direction, facet.plane.normal) * facet.plane.normal;
      shoot(point_m, reflected, here, crossings_left, visit);
    }
    images_m_.pop_back();
    sequence_.pop_back();
  }

  void note_edges_of(FacetId facet) {
    for (const WedgeId edge : tracer_.scene().wedges_of_facet(facet)) {
      if (diffracts(tracer_.scene().wedge(edge), *rules_) && !is_embedded(edge, *rules_)) reach_->add(sequence_, edge);
    }
  }

  const SceneTracer<Tree>& tracer_;
  LaunchSettings settings_;
  EdgeReach* reach_ = nullptr;
  const EdgeRules* rules_ = nullptr;
  std::size_t most_mirrors_ = 0;
  SequenceTable table_;
  Sequence sequence_;
  std::vector<Vec3> images_m_;
  IgnoredBodies ignored_;
  std::uint64_t rays_ = 0;
  TraversalCounters traversal_;
};

}  // namespace dcem
