#pragma once
/// A straight line between two points that are known to within some distance, and what it surely stays apart from.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "dcem/geometry/segment_distance.hpp"
#include "dcem/paths/lifetime/vague_scene.hpp"

namespace dcem {

/// Far above rounding, far below what matters, metres.
inline constexpr double lifetime_guard_m = 1e-6;

/// A stretch of a line: from one share of it to another.
struct Share {
  double low = 0.0, high = 0.0;
};

/// The point at a share of the line is known to within the mean of both ends, weighted alike.
struct VagueLine {
  VaguePoint from, to;

  Vec3 at(double share) const { return from.at_m + share * (to.at_m - from.at_m); }
  double moved_m(double share) const { return from.moved_m + share * (to.moved_m - from.moved_m); }
  double most_moved_m(const Share& part) const { return std::max(moved_m(part.low), moved_m(part.high)); }
  Segment segment(const Share& part) const { return {at(part.low), at(part.high)}; }
};

/// Whether a stretch of a line stays farther than `more_m` from something, wherever its ends are;
/// `distance(segment) -> metres`. Where one end is known better than the other, stretches are looked at by themselves.
template <typename Distance>
bool stays_apart(const VagueLine& line, const Share& part, double more_m, Distance&& distance, int halvings = 4) {
  const double away_m = distance(line.segment(part)) - more_m - lifetime_guard_m;
  if (away_m > line.most_moved_m(part)) return true;
  if (halvings == 0 || !(away_m > std::min(line.moved_m(part.low), line.moved_m(part.high)))) return false;
  const double middle = 0.5 * (part.low + part.high);
  return stays_apart(line, {part.low, middle}, more_m, distance, halvings - 1) &&
         stays_apart(line, {middle, part.high}, more_m, distance, halvings - 1);
}

/// Where a line may cross a plane between two points that are a and b away from it, each known to within α and β: the
/// share a'/(a' + b') grows with a' and falls with b'.
inline Share crossing_share(double a_m, double a_moved_m, double b_m, double b_moved_m) {
  const double a_low = std::max(0.0, a_m - a_moved_m), a_high = std::max(0.0, a_m + a_moved_m);
  const double b_low = std::max(0.0, b_m - b_moved_m), b_high = std::max(0.0, b_m + b_moved_m);
  const double low = a_low + b_high, high = a_high + b_low;
  return {low > 0.0 ? a_low / low : 0.0, high > 0.0 ? a_high / high : 1.0};
}

/// Cuts a stretch down to where the line may touch any of some points and what lies between them, which may themselves
/// be `reach_m` away: its foot on the line as it is now is no farther than both together.
inline void cut_to_points(const VagueLine& line, std::span<const Vec3> points_m, double reach_m, Share& part) {
  const Vec3 way = line.to.at_m - line.from.at_m;
  const double length_m = glm::length(way);
  if (!(length_m > lifetime_guard_m)) return;
  double low = 1e300, high = -1e300;
  for (const Vec3& point_m : points_m) {
    const double share = glm::dot(point_m - line.from.at_m, way) / (length_m * length_m);
    low = std::min(low, share);
    high = std::max(high, share);
  }
  const double room = (std::max(line.from.moved_m, line.to.moved_m) + reach_m + lifetime_guard_m) / length_m;
  part.low = std::max(part.low, low - room);
  part.high = std::min(part.high, high + room);
}

/// How far a stretch of a line stays from a plane of a body, at least: 0 where it may cross it.
inline double least_off_m(const VagueScene& vague, const WorldFacet& facet, const VagueLine& line, const Share& part) {
  double least_m = 1e300, side = 0.0;
  for (const double share : {part.low, part.high}) {
    const VaguePoint point{line.at(share), line.most_moved_m(part)};
    const double off_m = signed_distance_m(facet.plane, point.at_m);
    if (side != 0.0 && (side > 0.0) != (off_m > 0.0)) return 0.0;
    side = off_m;
    least_m = std::min(least_m, std::abs(off_m) - vague.seen_moved_m(facet.body, point));
  }
  return std::max(0.0, least_m);
}

}  // namespace dcem
