#pragma once
/// How a body or a device moves: a pose with a constant velocity, or waypoints.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "dcem/geometry/pose.hpp"

namespace dcem {

/// A pose that holds at `reference_time_s` and moves from there with a constant velocity, without turning.
struct LinearMotion {
  Pose pose;
  Vec3 velocity_mps{0.0};
  double reference_time_s = 0.0;
};

/// Poses at given instants: linear in position, shortest arc in each angle, held before the first and after the last.
struct WaypointMotion {
  struct Waypoint {
    double time_s = 0.0;
    Pose pose;
  };
  std::vector<Waypoint> waypoints;  ///< at least one, times strictly increasing
};

using Motion = std::variant<LinearMotion, WaypointMotion>;

/// Where a body is and how it moves at one instant.
struct Placement {
  Pose pose;
  RigidVelocity velocity;

  friend bool operator==(const Placement&, const Placement&) = default;
};

/// Throws std::invalid_argument where a number is not finite.
void validate(const Placement& placement);

/// Throws std::invalid_argument where a number is not finite, a waypoint is missing or times do not increase.
void validate(const Motion& motion);

/// Placement at `time_s`. With waypoints the velocity is the slope of the segment that starts at or holds the instant,
/// and zero where the pose is held.
Placement placement_at(const Motion& motion, double time_s);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline bool is_finite_pose(const Pose& pose) {
  return dcem::is_finite(pose.position_m) && std::isfinite(pose.yaw_rad) && std::isfinite(pose.pitch_rad) &&
         std::isfinite(pose.roll_rad);
}

/// The difference of two angles in (−π, π]: half a turn goes to the left.
inline double shortest_arc_rad(double from_rad, double to_rad) {
  const double difference = std::remainder(to_rad - from_rad, 2.0 * pi);
  return difference == -pi ? pi : difference;
}

inline Placement placement_between(const WaypointMotion::Waypoint& from, const WaypointMotion::Waypoint& to,
                                   double time_s) {
  const double duration_s = to.time_s - from.time_s;
  const double share = (time_s - from.time_s) / duration_s;
  const bool arrived = time_s == to.time_s;  // then the pose is the waypoint's own, to the last bit
  const double yaw_arc = shortest_arc_rad(from.pose.yaw_rad, to.pose.yaw_rad);
  const double pitch_arc = shortest_arc_rad(from.pose.pitch_rad, to.pose.pitch_rad);
  const double roll_arc = shortest_arc_rad(from.pose.roll_rad, to.pose.roll_rad);
  const Pose between{from.pose.position_m + share * (to.pose.position_m - from.pose.position_m),
                     from.pose.yaw_rad + share * yaw_arc, from.pose.pitch_rad + share * pitch_arc,
                     from.pose.roll_rad + share * roll_arc};
  const Pose& pose = arrived ? to.pose : between;
  return {pose,
          {(to.pose.position_m - from.pose.position_m) / duration_s,
           angular_velocity(pose, yaw_arc / duration_s, pitch_arc / duration_s, roll_arc / duration_s)}};
}

inline Placement placement_at(const LinearMotion& motion, double time_s) {
  Pose pose = motion.pose;
  pose.position_m += (time_s - motion.reference_time_s) * motion.velocity_mps;
  return {pose, {motion.velocity_mps, Vec3(0.0)}};
}

inline Placement placement_at(const WaypointMotion& motion, double time_s) {
  const auto& points = motion.waypoints;
  if (points.size() == 1 || time_s < points.front().time_s) return {points.front().pose, {}};
  if (time_s > points.back().time_s) return {points.back().pose, {}};
  const auto after = std::upper_bound(points.begin(), points.end(), time_s,
                                      [](double t, const auto& point) { return t < point.time_s; });
  const auto to = after == points.end() ? after - 1 : after;  // the last instant is held by the last segment
  return placement_between(*(to - 1), *to, time_s);
}

inline void validate(const LinearMotion& motion) {
  if (!is_finite_pose(motion.pose) || !dcem::is_finite(motion.velocity_mps) ||
      !std::isfinite(motion.reference_time_s)) {
    throw std::invalid_argument("motion: a number is not finite");
  }
}

inline void validate(const WaypointMotion& motion) {
  if (motion.waypoints.empty()) throw std::invalid_argument("motion: no waypoint; at least one is needed");
  for (std::size_t index = 0; index < motion.waypoints.size(); ++index) {
    const auto& point = motion.waypoints[index];
    if (!std::isfinite(point.time_s) || !is_finite_pose(point.pose)) {
      throw std::invalid_argument("motion: waypoint " + std::to_string(index) + " has a number that is not finite");
    }
    if (index > 0 && !(point.time_s > motion.waypoints[index - 1].time_s)) {
      throw std::invalid_argument("motion: waypoint " + std::to_string(index) + " is not later than the one before it");
    }
  }
}

}  // namespace detail

inline void validate(const Placement& placement) {
  if (!detail::is_finite_pose(placement.pose) || !is_finite(placement.velocity.linear_mps) ||
      !is_finite(placement.velocity.angular_rad_per_s)) {
    throw std::invalid_argument("pose: a number is not finite");
  }
}

inline void validate(const Motion& motion) {
  std::visit([](const auto& kind) { detail::validate(kind); }, motion);
}

inline Placement placement_at(const Motion& motion, double time_s) {
  return std::visit([&](const auto& kind) { return detail::placement_at(kind, time_s); }, motion);
}

}  // namespace dcem
