#pragma once
/// The legs of a path whose points are known: whether they are free, and what they cross.
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "dcem/paths/path.hpp"
#include "dcem/paths/query/foliage_length.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/solver_counters.hpp"

namespace dcem {

/// Points run from the transmitter, sequences from the receiver outwards. Holds scratch memory: one per thread.
template <typename Index>
class LegWalker {
 public:
  LegWalker(const SceneTracer<Index>& tracer, int max_transmissions)
      : tracer_(tracer), max_transmissions_(static_cast<std::size_t>(max_transmissions)) {}

  /// A leg of a way over known points between two devices in which a triangle stands for which `stops(triangle)` holds,
  /// counted from the transmitter; none where there is none. Legs in the middle are asked first.
  template <typename Stops>
  std::optional<std::size_t> stopped_leg(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                                         const std::vector<Vec3>& points_m, Stops&& stops,
                                         SolverCounters& counters) const {
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    for (std::size_t number = 1; number <= sequence.size() + 1; ++number) {
      const std::size_t leg = number % (sequence.size() + 1);  // that of the transmitter last
      const bool first = leg == 0, last = leg == sequence.size();
      const Stop before = first ? Stop{} : stop_at(sequence[sequence.size() - leg]);
      const Stop here = last ? Stop{} : stop_at(sequence[sequence.size() - 1 - leg]);
      const Vec3& from_m = first ? transmitter.position_m : points_m[leg - 1];
      const Vec3& to_m = last ? receiver.position_m : points_m[leg];
      if (!(glm::distance(from_m, to_m) > in_plane_guard_m)) continue;
      ++counters.legs;
      const bool stopped = tracer_.any_triangle_between(
          from_m, to_m, first ? LegEnd{transmitter.mounted_on, {}} : before.end(),
          last ? LegEnd{receiver.mounted_on, {}} : here.end(), ignored, stops, counters.traversal);
      if (stopped) return leg;
    }
    return std::nullopt;
  }

  /// The path over the points, with the sheets that its legs cross, until the next is followed; none where a leg is not
  /// free. `in_shadow`: of each point, for those on edges.
  const Path* follow(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                     const std::vector<Vec3>& points_m, const std::vector<bool>& in_shadow, SolverCounters& counters) {
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    // Most candidates die on a leg, and of several legs on one in the middle.
    if (is_blocked_between(sequence, points_m, ignored, counters)) return nullptr;
    path_.interactions.clear();
    path_.length_m = 0.0;
    path_.foliage.clear();
    std::size_t left = max_transmissions_;
    Vec3 from_m = transmitter.position_m;
    Stop before{}, here{};
    for (std::size_t leg = 0; leg <= sequence.size(); ++leg) {
      const bool last = leg == sequence.size();
      if (!last) here = stop_at(sequence[sequence.size() - 1 - leg]);
      const LegEnd start = leg == 0 ? LegEnd{transmitter.mounted_on, {}} : before.end();
      const LegEnd end = last ? LegEnd{receiver.mounted_on, {}} : here.end();
      const Vec3 to_m = last ? receiver.position_m : points_m[leg];
      const bool is_free = max_transmissions_ == 0 && leg > 0 && !last;  // then it was asked above
      if (!is_free && !is_open(from_m, to_m, start, end, ignored, left, counters)) return nullptr;
      walk(from_m, to_m, ignored);
      left -= crossings_.size();
      if (!last) {
        path_.interactions.push_back(
            interaction_at(sequence[sequence.size() - 1 - leg], points_m[leg], in_shadow[leg]));
      }
      from_m = to_m;
      before = here;
    }
    return &path_;
  }

 private:
  const Scene& scene() const { return tracer_.scene(); }
  const WorldFacet& facet(FacetId id) const { return scene().facet(id); }

  /// A place where legs begin and end: what they ignore there.
  struct Stop {
    std::array<FacetId, 2> facets;
    std::array<const Plane*, 2> planes;
    LegEnd end() const { return {facets, planes}; }
  };

  Stop stop_at(SequenceElement element) const {
    const std::array<FacetId, 2> facets =
        element.is_edge() ? scene().wedge(element.edge()).facets : std::array{element.mirror(), element.mirror()};
    return {facets, {&facet(facets[0]).plane, &facet(facets[1]).plane}};
  }

  /// Whether a leg has a direction, is not blocked, and crosses no more than `left` sheets: those are noted.
  bool is_open(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
               const IgnoredBodies& ignored, std::size_t left, SolverCounters& counters) {
    if (!(glm::distance(from_m, to_m) > in_plane_guard_m)) return false;
    ++counters.legs;
    return tracer_.follow_leg(from_m, to_m, start, end, ignored, left, crossings_, counters.traversal);
  }

  /// Whether something opaque stands between two points of interaction, where nothing transmits.
  bool is_blocked_between(const Sequence& sequence, const std::vector<Vec3>& points_m, const IgnoredBodies& ignored,
                          SolverCounters& counters) {
    if (max_transmissions_ > 0) return false;
    for (std::size_t leg = 1; leg < sequence.size(); ++leg) {
      const Stop start = stop_at(sequence[sequence.size() - leg]), end = stop_at(sequence[sequence.size() - 1 - leg]);
      if (!is_open(points_m[leg - 1], points_m[leg], start.end(), end.end(), ignored, 0, counters)) return true;
    }
    return false;
  }

  /// Adds a leg and the sheets noted to the path.
  void walk(const Vec3& from_m, const Vec3& to_m, const IgnoredBodies& ignored) {
    for (const Crossing& crossing : crossings_) {
      path_.interactions.push_back(
          {InteractionKind::transmission, crossing.facet, from_m + crossing.t * (to_m - from_m)});
    }
    path_.length_m += glm::distance(from_m, to_m);
    add_foliage_along(scene(), from_m, to_m, ignored, path_.foliage);
  }

  Interaction interaction_at(SequenceElement element, const Vec3& point_m, bool in_shadow) const {
    if (!element.is_edge()) return {InteractionKind::reflection, element.mirror(), point_m};
    return {InteractionKind::diffraction, scene().wedge(element.edge()).facets[0], point_m, element.edge(), in_shadow};
  }

  const SceneTracer<Index>& tracer_;
  std::size_t max_transmissions_;
  std::vector<Crossing> crossings_;
  Path path_;  ///< the one that is followed: most end on a leg
};

}  // namespace dcem
