#pragma once
/// Rigid placement of a body in the world, and its rigid motion at an instant.
#include "dcem/core/units.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Position of the local origin and three angles: world = position + Rz(yaw)·Ry(pitch)·Rx(roll)·local.
/// Yaw about z, then pitch about y (nose down positive), then roll about x; local x points forward, z up.
struct Pose {
  Vec3 position_m{0.0};
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// The rotation matrix of a pose; columns are the local axes in the world.
inline Mat3 rotation_matrix(const Pose& pose) {
  const double cy = std::cos(pose.yaw_rad), sy = std::sin(pose.yaw_rad);
  const double cp = std::cos(pose.pitch_rad), sp = std::sin(pose.pitch_rad);
  const double cr = std::cos(pose.roll_rad), sr = std::sin(pose.roll_rad);
  return Mat3(cy * cp, sy * cp, -sp,                                     // local x
              cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr,   // local y
              cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr);  // local z
}

/// Velocity of a rigid body: that of its local origin, and the rotation vector ω (right-handed, world axes).
struct RigidVelocity {
  Vec3 linear_mps{0.0};
  Vec3 angular_rad_per_s{0.0};

  friend bool operator==(const RigidVelocity&, const RigidVelocity&) = default;
};

/// Velocity of the material point that is at `point_m` now: v + ω × (point − origin).
inline Vec3 velocity_at(const RigidVelocity& velocity, const Vec3& origin_m, const Vec3& point_m) {
  return velocity.linear_mps + glm::cross(velocity.angular_rad_per_s, point_m - origin_m);
}

/// Rotation vector ω of a body whose yaw, pitch and roll change at the given rates:
/// ω = yaw'·z + pitch'·Rz·y + roll'·Rz·Ry·x.
inline Vec3 angular_velocity(const Pose& pose, double yaw_rate_rad_per_s, double pitch_rate_rad_per_s,
                             double roll_rate_rad_per_s) {
  const double cy = std::cos(pose.yaw_rad), sy = std::sin(pose.yaw_rad);
  return yaw_rate_rad_per_s * Vec3(0.0, 0.0, 1.0) + pitch_rate_rad_per_s * Vec3(-sy, cy, 0.0) +
         roll_rate_rad_per_s * rotation_matrix(pose)[0];
}

/// The difference of two angles in (−π, π]: half a turn goes to the left.
inline double shortest_arc_rad(double from_rad, double to_rad) {
  const double difference = std::remainder(to_rad - from_rad, 2.0 * pi);
  return difference == -pi ? pi : difference;
}

}  // namespace dcem
