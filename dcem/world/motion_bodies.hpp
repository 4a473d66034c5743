#pragma once
/// Bodies of motion.hpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dcem/core/build_mode.hpp"
#include "dcem/world/motion.hpp"

namespace dcem {

namespace detail {

DCEM_INLINE bool is_finite_pose(const Pose& pose) {
  return dcem::is_finite(pose.position_m) && std::isfinite(pose.yaw_rad) && std::isfinite(pose.pitch_rad) &&
         std::isfinite(pose.roll_rad);
}

DCEM_INLINE Placement placement_between(const WaypointMotion::Waypoint& from, const WaypointMotion::Waypoint& to,
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

DCEM_INLINE Placement placement_at(const LinearMotion& motion, double time_s) {
  Pose pose = motion.pose;
  pose.position_m += (time_s - motion.reference_time_s) * motion.velocity_mps;
  return {pose, {motion.velocity_mps, Vec3(0.0)}};
}

DCEM_INLINE Placement placement_at(const WaypointMotion& motion, double time_s) {
  const auto& points = motion.waypoints;
  if (points.size() == 1 || time_s < points.front().time_s) return {points.front().pose, {}};
  if (time_s > points.back().time_s) return {points.back().pose, {}};
  const auto after = std::upper_bound(points.begin(), points.end(), time_s,
                                      [](double t, const auto& point) { return t < point.time_s; });
  const auto to = after == points.end() ? after - 1 : after;  // the last instant is held by the last segment
  return placement_between(*(to - 1), *to, time_s);
}

DCEM_INLINE void validate(const LinearMotion& motion) {
  if (!is_finite_pose(motion.pose) || !dcem::is_finite(motion.velocity_mps) ||
      !std::isfinite(motion.reference_time_s)) {
    throw std::invalid_argument("motion: a number is not finite");
  }
}

DCEM_INLINE void validate(const WaypointMotion& motion) {
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

DCEM_INLINE void validate(const Placement& placement) {
  if (!detail::is_finite_pose(placement.pose) || !is_finite(placement.velocity.linear_mps) ||
      !is_finite(placement.velocity.angular_rad_per_s)) {
    throw std::invalid_argument("pose: a number is not finite");
  }
}

DCEM_INLINE void validate(const Motion& motion) {
  std::visit([](const auto& kind) { detail::validate(kind); }, motion);
}

DCEM_INLINE Placement placement_at(const Motion& motion, double time_s) {
  return std::visit([&](const auto& kind) { return detail::placement_at(kind, time_s); }, motion);
}

}  // namespace dcem
