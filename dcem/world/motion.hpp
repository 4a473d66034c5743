#pragma once
/// How a body or a device moves: a pose with a constant velocity, or waypoints.
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

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/world/motion_bodies.hpp"
#endif
