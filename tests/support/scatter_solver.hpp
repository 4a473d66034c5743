#pragma once
/// Paths that one point of a surface scatters: from the transmitter to the point and on to the receiver, whatever the
/// angles.
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/paths/path.hpp"
#include "dcem/paths/query/foliage_length.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/solve/path_solver.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
template <typename Index>
class ScatterSolver {
 public:
  ScatterSolver(const SceneTracer<Index>& tracer, int max_transmissions)
      : tracer_(tracer), max_transmissions_(static_cast<std::size_t>(max_transmissions)) {}

  /// Whether a facet can scatter between two ends at all: both on one side of it, neither mounted on it.
  bool may_scatter(const LinkEnd& transmitter, const LinkEnd& receiver, FacetId id) const {
    const WorldFacet& facet = tracer_.scene().facet(id);
    if (!facet.present || !facet.scatters) return false;
    if (transmitter.ignored_body == facet.body || receiver.ignored_body == facet.body) return false;
    const double from_m = signed_distance_m(facet.plane, transmitter.position_m);
    const double to_m = signed_distance_m(facet.plane, receiver.position_m);
    if (std::abs(from_m) <= in_plane_guard_m || std::abs(to_m) <= in_plane_guard_m || (from_m > 0.0) != (to_m > 0.0)) {
      return false;
    }
    const auto mounted = [&](const LinkEnd& end) {
      return std::binary_search(end.mounted_on.begin(), end.mounted_on.end(), id);
    };
    return !mounted(transmitter) && !mounted(receiver);
  }

  /// The path over a point of a facet that may_scatter(). False where a leg is blocked or crosses too many sheets, or
  /// where another facet lies there in the same plane and stands for this one.
  bool solve(const LinkEnd& transmitter, const LinkEnd& receiver, FacetId facet, const Vec3& point_m, Path& path) {
    path.interactions.clear();
    path.foliage.clear();
    path.length_m = 0.0;
    left_ = max_transmissions_;
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    const Plane* plane = &tracer_.scene().facet(facet).plane;
    const std::array<FacetId, 1> facets{facet};
    const LegEnd here{facets, {plane, plane}};
    if (!walk(transmitter.position_m, point_m, {transmitter.mounted_on, {}}, here, ignored, path)) return false;
    path.interactions.push_back({InteractionKind::scattering, facet, point_m});
    if (!walk(point_m, receiver.position_m, here, {receiver.mounted_on, {}}, ignored, path)) return false;
    return stands_for_all(facet, point_m, ignored);
  }

  const SolverCounters& counters() const { return counters_; }

 private:
  bool walk(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end, const IgnoredBodies& ignored,
            Path& path) {
    ++counters_.legs;
    if (!tracer_.follow_leg(from_m, to_m, start, end, ignored, left_, crossings_, counters_.traversal)) return false;
    for (const Crossing& crossing : crossings_) {
      path.interactions.push_back(
          {InteractionKind::transmission, crossing.facet, from_m + crossing.t * (to_m - from_m)});
    }
    left_ -= crossings_.size();
    path.length_m += glm::distance(from_m, to_m);
    add_foliage_along(tracer_.scene(), from_m, to_m, ignored, path.foliage);
    return true;
  }

  /// Of patches that overlap in one plane the one whose material's name comes first scatters, as it reflects.
  bool stands_for_all(FacetId facet, const Vec3& point_m, const IgnoredBodies& ignored) {
    const double tolerance_m = tracer_.scene().settings().weld_tolerance_m;
    const auto near = tracer_.facets_near(point_m, tolerance_m, ignored, counters_.traversal);
    return std::none_of(near.begin(), near.end(), [&](FacetId other) {
      return other != facet && tracer_.parallel(other, facet) && tracer_.precedes(other, facet);
    });
  }

  const SceneTracer<Index>& tracer_;
  std::size_t max_transmissions_;
  std::size_t left_ = 0;  ///< sheets that may still be crossed
  SolverCounters counters_;
  std::vector<Crossing> crossings_;
};

}  // namespace dcem
