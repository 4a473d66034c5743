#pragma once
/// How far the points of a way may move while its ends do.
#include <algorithm>
#include <cmath>
#include <limits>

#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

/// How far a point may have moved: any way, or no more than a little aside of a straight line.
class Drift {
 public:
  Drift() = default;  ///< it stands
  explicit Drift(double most_m) : aside_m_(most_m), most_m_(most_m) {}
  /// There or back along a line; `direction` of length 1.
  Drift(double most_m, const Vec3& direction, double aside_m)
      : along_m_(most_m * direction), aside_m_(aside_m), most_m_(most_m) {}

  bool is_none() const { return most_m_ == 0.0; }
  bool is_known() const { return std::isfinite(most_m_); }
  double most_m() const { return most_m_; }
  /// By how much its distance from a plane may have changed.
  double off_m(const Plane& plane) const {
    return std::min(most_m_, std::abs(glm::dot(along_m_, plane.normal)) + aside_m_);
  }
  /// That of its image.
  Drift in(const Plane& mirror) const {
    Drift image = *this;
    image.along_m_ -= 2.0 * glm::dot(along_m_, mirror.normal) * mirror.normal;
    return image;
  }

 private:
  Vec3 along_m_{0.0};
  double aside_m_ = 0.0, most_m_ = 0.0;
};

/// How far the point at which a straight way crosses a plane moves, metres, while its ends, on two sides of the plane,
/// do; infinite where an end may pass the plane.
///
/// With the distances a and b of the ends from the plane the point is at the share λ = a/(a + b) of the way w. Where
/// the ends move by at most α and β it moves by at most max(α, β) + |w| |λ' − λ|, and λ' − λ = (b Δa − a Δb)/((a +
/// b)(a' + b')), in which the distances alone count: who moves along the plane turns nothing.
inline double crossing_reach_m(const Plane& plane, const Vec3& from_m, const Drift& from, const Vec3& to_m,
                               const Drift& to) {
  const double a = std::abs(signed_distance_m(plane, from_m)), b = std::abs(signed_distance_m(plane, to_m));
  const double from_off_m = from.off_m(plane), to_off_m = to.off_m(plane);
  if (!(a > from_off_m && b > to_off_m)) return std::numeric_limits<double>::infinity();
  const double sum = a + b, turned = (b * from_off_m + a * to_off_m) / (sum * (sum - from_off_m - to_off_m));
  return std::max(from.most_m(), to.most_m()) + glm::distance(from_m, to_m) * turned;
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

/// How far along each axis a point moves that stays in a plane, or on an edge, and moves by at most `moved_m`.
inline Vec3 spread_in(const Plane& plane, double moved_m) {
  const Vec3 squared = plane.normal * plane.normal;  // 1 − n² would say nothing close to an axis
  return moved_m * glm::sqrt(Vec3(squared.y + squared.z, squared.z + squared.x, squared.x + squared.y));
}
inline Vec3 spread_on(const Wedge& edge, double moved_m) {
  return moved_m * glm::abs(edge_direction(edge));
}

}  // namespace dcem
