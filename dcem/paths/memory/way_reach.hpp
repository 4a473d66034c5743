#pragma once
/// How far the points of a way may move while its ends do.
#include <algorithm>
#include <cmath>
#include <limits>

#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

/// How far the point at which a straight way crosses a plane moves, metres, while its ends `from_m` and `to_m`, on two
/// sides of the plane, move by at most `from_moved_m` and `to_moved_m`; infinite where an end may pass the plane.
///
/// With the distances a and b of the ends from the plane the point is at the share λ = a/(a + b) of the way w. Moved by
/// α and β it moves by at most max(α, β) + |w| |λ' − λ|, and λ' − λ = (b α − a β)/((a + b)(a' + b')).
inline double crossing_reach_m(const Plane& plane, const Vec3& from_m, double from_moved_m, const Vec3& to_m,
                               double to_moved_m) {
  const double a = std::abs(signed_distance_m(plane, from_m)), b = std::abs(signed_distance_m(plane, to_m));
  if (!(a > from_moved_m && b > to_moved_m)) return std::numeric_limits<double>::infinity();
  const double sum = a + b, turned = (b * from_moved_m + a * to_moved_m) / (sum * (sum - from_moved_m - to_moved_m));
  return std::max(from_moved_m, to_moved_m) + glm::distance(from_m, to_m) * turned;
}

/// How far the point that diffracts moves along an edge, metres, while one end stands and the other moves by at most
/// `moved_m`: as `edge_point_reach_m` has it for lanes.
inline double edge_reach_m(const Wedge& edge, const Vec3& standing_m, const Vec3& moving_m, double moved_m) {
  const Vec3 direction = edge_direction(edge);
  const auto beside = [&](const Vec3& point_m) {
    const Vec3 away_m = point_m - edge.start_m;
    const double place_m = glm::dot(away_m, direction);
    return Vec2(place_m, glm::length(away_m - place_m * direction));
  };
  const Vec2 own = beside(standing_m), other = beside(moving_m);
  const double least_m = own.y + other.y - moved_m;
  if (!(least_m > 1e-3)) return std::numeric_limits<double>::infinity();
  const double slope = (std::abs(other.x - own.x) + moved_m) / least_m;
  return moved_m * own.y / least_m * std::sqrt(1.0 + slope * slope);
}

}  // namespace dcem
