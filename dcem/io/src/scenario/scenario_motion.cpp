#include <system_error>

#include "dcem/core/units.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/traffic/waypoint_speed.hpp"

namespace dcem::io {

namespace {

Pose read_pose(const JsonObject& object) {
  const auto angle_rad = [&](const char* key) { return degrees_to_radians(object.number(key, 0.0)); };
  return {object.at("position_m").vector3(), angle_rad("yaw_deg"), angle_rad("pitch_deg"), angle_rad("roll_deg")};
}

WaypointMotion read_waypoints(const JsonValue& value) {
  WaypointMotion motion;
  for (const JsonValue& element : value.elements()) {
    const JsonObject object = element.object();
    const double time_s = object.at("t_s").number();
    if (!motion.waypoints.empty() && !(time_s > motion.waypoints.back().time_s)) {
      object.at("t_s").fail("not later than the waypoint before; expected increasing times");
    }
    motion.waypoints.push_back({time_s, read_pose(object)});
    if (is_last_faster_than_light(motion)) {
      object.at("position_m").fail("faster than light from the waypoint before; expected less than 299792458 m/s");
    }
  }
  return motion;
}

}  // namespace

Vec3 read_velocity_mps(const JsonObject& object) {
  const auto value = object.find("velocity_mps");
  if (!value) return Vec3(0.0);
  const Vec3 velocity_mps = value->vector3();
  if (!(glm::length(velocity_mps) < speed_of_light_mps)) value->fail("faster than light; expected metres per second");
  return velocity_mps;
}

Motion MotionReader::read(const JsonValue& value, const std::string& id) {
  const JsonObject object = value.object();
  const std::string form = object.chosen("form");
  if (form == "position_m") return LinearMotion{read_pose(object), read_velocity_mps(object), reference_time_s_};
  for (const char* key : {"yaw_deg", "pitch_deg", "roll_deg", "velocity_mps"}) {
    if (!object.has(key)) continue;
    object.at(key).fail(form == "waypoints" ? "does not go with waypoints; expected it in no place or in each waypoint"
                                            : "does not go with poses_csv; expected no such key");
  }
  return form == "waypoints" ? read_waypoints(object.at("waypoints")) : read_poses(object.at("poses_csv"), id);
}

WaypointMotion MotionReader::read_poses(const JsonValue& name, const std::string& id) {
  const std::filesystem::path file = existing_file(name, folder_, "expected a table of poses");
  const auto known = files_.find(file.string());
  PosesCsv& poses = known != files_.end() ? known->second : files_.emplace(file.string(), file).first->second;
  if (const WaypointMotion* const motion = poses.take(id)) return *motion;
  const std::string nearest = poses.empty() ? "" : "; the nearest known one is " + in_quotes(poses.nearest_id(id));
  name.fail("no row of " + in_quotes(id) + " in " + in_quotes(name.text()) + "; expected at least one" + nearest);
}

void MotionReader::check_all_taken() const {
  for (const auto& [name, poses] : files_) poses.check_all_taken();
}

std::filesystem::path existing_file(const JsonValue& name, const std::filesystem::path& folder,
                                    const std::string& expectation) {
  const std::filesystem::path file = folder / name.text();
  if (const auto trouble = trouble_of_named(file)) {
    name.fail(in_quotes(name.text()) + " " + *trouble + "; " + expectation + ", relative to the scenario");
  }
  return file;
}

}  // namespace dcem::io
