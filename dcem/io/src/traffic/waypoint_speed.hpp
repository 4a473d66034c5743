#pragma once
/// What no waypoint may ask for.
#include "dcem/core/constants.hpp"
#include "dcem/world/motion.hpp"

namespace dcem::io {

/// Whether what follows the motion is faster than light on its way to the last waypoint.
inline bool is_last_faster_than_light(const WaypointMotion& motion) {
  if (motion.waypoints.size() < 2) return false;
  const WaypointMotion::Waypoint &last = motion.waypoints.back(), &before = motion.waypoints.end()[-2];
  const double way_m = glm::distance(before.pose.position_m, last.pose.position_m);
  return !(way_m < speed_of_light_mps * (last.time_s - before.time_s));
}

}  // namespace dcem::io
