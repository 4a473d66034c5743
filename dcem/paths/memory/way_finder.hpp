#pragma once
/// The ways that sequences take between two ends, and what stops them.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/paths/solve/chain_points.hpp"
#include "dcem/paths/solve/leg_walker.hpp"

namespace dcem {

/// A sequence between ends that stand, and the way over it: from the transmitter to the receiver.
struct StandingWay {
  Sequence sequence;
  std::vector<Vec3> points_m;  ///< both ends among them
  Aabb<double> around;         ///< holds the way
};

/// What stops a way: a triangle, and the leg that it stands in, counted from the transmitter.
struct Blocker {
  std::uint32_t triangle = 0;
  std::uint32_t leg = 0;
};

/// Holds scratch memory: one per thread.
template <typename Index>
class WayFinder {
 public:
  WayFinder(const SceneTracer<Index>& tracer, int max_transmissions)
      : tracer_(tracer), legs_(tracer, max_transmissions) {}

  /// Works out the points of a way; false where there is none.
  bool aim(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence) {
    return points_.find(scene(), transmitter.position_m, receiver.position_m, sequence, nullptr);
  }

  /// The way over a sequence; none where there is none, or where the scenery stops it: as long as the ends and what the
  /// sequence is over stand, no path can take it.
  std::optional<StandingWay> find(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                                  SolverCounters& counters) {
    if (!aim(transmitter, receiver, sequence)) return std::nullopt;
    const auto stops = [&](std::uint32_t triangle) {
      const WorldFacet& facet = scene().facet(scene().facet_of_triangle(triangle));
      return facet.body == BodyId(0) && !facet.transmits;
    };
    if (legs_.stopped_leg(transmitter, receiver, sequence, points_.points_m(), stops, counters)) return std::nullopt;
    return way(transmitter, receiver, sequence);
  }

  /// Something opaque that stands in a way over known points, counted from the transmitter.
  std::optional<Blocker> blocker(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                                 const std::vector<Vec3>& points_m, SolverCounters& counters) const {
    std::uint32_t found = 0;
    const auto stops = [&](std::uint32_t triangle) {
      found = triangle;
      return !scene().facet(scene().facet_of_triangle(triangle)).transmits;
    };
    const auto leg = legs_.stopped_leg(transmitter, receiver, sequence, points_m, stops, counters);
    if (!leg) return std::nullopt;
    return Blocker{found, static_cast<std::uint32_t>(*leg)};
  }

 private:
  const Scene& scene() const { return tracer_.scene(); }
  StandingWay way(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence) const {
    StandingWay way{sequence, {transmitter.position_m}, {}};
    way.points_m.insert(way.points_m.end(), points_.points_m().begin(), points_.points_m().end());
    way.points_m.push_back(receiver.position_m);
    for (const Vec3& point_m : way.points_m) way.around.extend(point_m);
    return way;
  }

  const SceneTracer<Index>& tracer_;
  LegWalker<Index> legs_;
  ChainPoints points_;
};

}  // namespace dcem
