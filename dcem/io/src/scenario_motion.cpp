#include "dcem/core/units.hpp"
#include "dcem/io/src/scenario_parts.hpp"

namespace dcem::io {

namespace {

constexpr NumberRange any_angle_deg{-1e6, 1e6};
constexpr double fastest_mps = 299'792'458.0;

Pose read_pose(const JsonObject& object) {
  const auto angle_rad = [&](const char* key) { return degrees_to_radians(object.number(key, 0.0, any_angle_deg)); };
  return {object.at("position_m").vector3(farthest_coordinate_m), angle_rad("yaw_deg"), angle_rad("pitch_deg"),
          angle_rad("roll_deg")};
}

WaypointMotion read_waypoints(const JsonValue& value) {
  WaypointMotion motion;
  for (const JsonValue& element : value.elements()) {
    const JsonObject object = element.object({"t_s", "position_m", "yaw_deg", "pitch_deg", "roll_deg"});
    const double time_s = object.at("t_s").number(any_instant_s);
    if (!motion.waypoints.empty() && !(time_s > motion.waypoints.back().time_s)) {
      object.at("t_s").fail("not later than the waypoint before; expected increasing times");
    }
    motion.waypoints.push_back({time_s, read_pose(object)});
  }
  if (motion.waypoints.empty()) value.fail("no waypoint; expected at least one");
  return motion;
}

}  // namespace

Vec3 read_velocity_mps(const JsonObject& object) {
  const auto value = object.find("velocity_mps");
  if (!value) return Vec3(0.0);
  const Vec3 velocity_mps = value->vector3(fastest_mps);
  if (!(glm::length(velocity_mps) < fastest_mps)) value->fail("faster than light; expected metres per second");
  return velocity_mps;
}

Motion read_motion(const JsonValue& value, double reference_time_s) {
  const JsonObject object =
      value.object({"position_m", "yaw_deg", "pitch_deg", "roll_deg", "velocity_mps", "waypoints", "poses_csv"});
  if (object.has("poses_csv")) object.at("poses_csv").not_in_this_version("position_m or waypoints");
  if (object.exactly_one_of({"position_m", "waypoints"}) == "position_m") {
    return LinearMotion{read_pose(object), read_velocity_mps(object), reference_time_s};
  }
  for (const char* key : {"yaw_deg", "pitch_deg", "roll_deg", "velocity_mps"}) {
    if (object.has(key)) object.at(key).fail("does not go with waypoints; expected it in no place or in each waypoint");
  }
  return read_waypoints(object.at("waypoints"));
}

}  // namespace dcem::io
