#include "dcem/io/src/traffic/trace_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// The velocity of a vehicle that drives where it points.
RigidVelocity velocity_along(const Pose& pose, double speed_mps) {
  return {speed_mps * rotation_matrix(pose)[0], Vec3(0.0)};
}

}  // namespace

Placement vehicle_placement(const FcdVehicle& vehicle, double length_m) {
  Pose pose{Vec3(vehicle.x_m, vehicle.y_m, vehicle.z_m), degrees_to_radians(90.0 - vehicle.angle_deg),
            degrees_to_radians(-vehicle.slope_deg), 0.0};
  pose.position_m -= length_m / 2 * rotation_matrix(pose)[0];
  return {pose, velocity_along(pose, vehicle.speed_mps)};
}

TraceMotion::TraceMotion(const Traffic& traffic)
    : types_(traffic.types), reader_(traffic.trace, xml_chunk_bytes, traffic.degrees) {
  read_step();
}

const std::vector<DrivingVehicle>& TraceMotion::at(double time_s) {
  while (after_.time_s < time_s && read_step()) {
  }
  if (steps_ > 1 && after_.time_s > time_s) return between_steps(time_s);
  // This very instant, or before the first step or behind the last one: that the trace reaches so far, to the
  // tolerance, was seen when it was surveyed, and rounding may ask for a little more.
  if (std::abs(after_.time_s - time_s) > 2.0 * trace_tolerance_s) fail_changed(raw_.line);
  return after_.vehicles;
}

/// Steps may be closer together than the tolerance: the nearest of them counts.
const std::vector<DrivingVehicle>& TraceMotion::between_steps(double time_s) {
  const double before_s = time_s - before_.time_s, after_s = after_.time_s - time_s;
  if (std::min(before_s, after_s) <= trace_tolerance_s) return before_s < after_s ? before_.vehicles : after_.vehicles;
  interpolate(time_s);
  return between_;
}

bool TraceMotion::read_step() {
  if (!reader_.next(raw_)) return false;
  std::swap(before_, after_);
  ++steps_;
  after_.time_s = raw_.time_s;
  after_.vehicles.resize(raw_.vehicles.size());
  after_.speeds_mps.resize(raw_.vehicles.size());
  for (std::size_t index = 0; index < raw_.vehicles.size(); ++index) {
    const FcdVehicle& vehicle = raw_.vehicles[index];
    DrivingVehicle& driving = after_.vehicles[index];
    driving.id = vehicle.id;
    driving.type = type_index(vehicle);
    driving.placement = vehicle_placement(vehicle, types_[driving.type].size_m.x);
    after_.speeds_mps[index] = vehicle.speed_mps;
  }
  return true;
}

std::size_t TraceMotion::type_index(const FcdVehicle& vehicle) const {
  const auto found =
      std::lower_bound(types_.begin(), types_.end(), vehicle.type,
                       [](const Traffic::Type& type, const std::string& name) { return type.name < name; });
  if (found == types_.end() || found->name != vehicle.type) fail_changed(vehicle.line);
  return static_cast<std::size_t>(found - types_.begin());
}

/// Both steps are ordered by id: one walk through both finds who is in both. A vehicle that changes its type leaves as
/// the one and enters as the other.
void TraceMotion::interpolate(double time_s) {
  const double share = (time_s - before_.time_s) / (after_.time_s - before_.time_s);
  between_.clear();
  std::size_t to = 0;
  for (std::size_t from = 0; from < before_.vehicles.size(); ++from) {
    const DrivingVehicle& a = before_.vehicles[from];
    while (to < after_.vehicles.size() && after_.vehicles[to].id < a.id) ++to;
    if (to == after_.vehicles.size()) return;
    const DrivingVehicle& b = after_.vehicles[to];
    if (a.id != b.id || a.type != b.type) continue;
    const Pose &start = a.placement.pose, &end = b.placement.pose;
    const Pose pose{start.position_m + share * (end.position_m - start.position_m),
                    start.yaw_rad + share * shortest_arc_rad(start.yaw_rad, end.yaw_rad),
                    start.pitch_rad + share * shortest_arc_rad(start.pitch_rad, end.pitch_rad), 0.0};
    const double speed_mps = before_.speeds_mps[from] + share * (after_.speeds_mps[to] - before_.speeds_mps[from]);
    between_.push_back({a.id, a.type, {pose, velocity_along(pose, speed_mps)}});
  }
}

void TraceMotion::fail_changed(std::size_t line) const {
  throw InputError(reader_.file(), line,
                   "differs from when the scenario was loaded; expected a file that stays as it is");
}

}  // namespace dcem::io
