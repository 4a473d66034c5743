#pragma once
/// How a `Scene` goes from frame to frame; included by scene.hpp.
#include "dcem/scene/scene.hpp"

namespace dcem {

inline Frame Scene::frame_at(double time_s, std::size_t index) const {
  if (!std::isfinite(time_s)) throw std::invalid_argument("frame: its time is not finite");
  Frame frame{index, time_s, {}};
  for (const Body& body : bodies_) frame.bodies.push_back({!body.is_slot, placement_at(body.motion, time_s)});
  return frame;
}

inline ChangeSet Scene::apply(const Frame& frame) {
  check_frame(frame);
  ChangeSet changes;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {  // the scenery stands
    if (frame.bodies[index] != states_[index]) take_over(BodyId(index), frame.bodies[index], changes);
  }
  for (const BodyId id : changes.replaced) {  // after all have left their slots: objects may change slots
    if (body_state(id).present) body_by_id_[body_state(id).occupant] = id;
  }
  return changes;
}

inline void Scene::take_over(BodyId id, const BodyState& state, ChangeSet& changes) {
  const BodyState before = std::exchange(states_[id.value], state);
  if (before.occupant != state.occupant) {
    changes.replaced.push_back(id);
    if (const auto known = body_by_id_.find(before.occupant); known != body_by_id_.end() && known->second == id) {
      body_by_id_.erase(known);
    }
  }
  if (!before.present && !state.present) return;
  if (before.present == state.present && before.placement.pose == state.placement.pose) return;
  world_.place(id, body(id).mesh, state);
  changes.moved.push_back(id);
}

inline void Scene::check_frame(const Frame& frame) const {
  if (frame.bodies.size() != bodies_.size()) {
    throw std::invalid_argument("frame: expected one state per body of the scene");
  }
  bool occupants_changed = false;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {
    const BodyState& state = frame.bodies[index];
    if (state == states_[index]) continue;
    const std::string& name = bodies_[index].is_slot ? state.occupant : bodies_[index].id;
    detail::naming("object '" + name + "'", [&] { validate(state.placement); });
    if (state.occupant.empty() == (bodies_[index].is_slot && state.present)) {
      throw std::invalid_argument("frame: expected an object name for each slot in use, and for nothing else");
    }
    occupants_changed = occupants_changed || state.occupant != states_[index].occupant;
  }
  if (occupants_changed) check_occupants(frame);
}

/// No name is there twice.
inline void Scene::check_occupants(const Frame& frame) const {
  std::unordered_set<std::string> names;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {
    const std::string& name = bodies_[index].is_slot ? frame.bodies[index].occupant : bodies_[index].id;
    if (name.empty()) continue;
    if (name.find('/') != std::string::npos || !names.insert(name).second) {
      throw std::invalid_argument("object '" + name + "': expected an id without slash that is there once");
    }
  }
}

/// The body that has a name in a frame, which need not be the current one.
inline std::optional<BodyId> Scene::find_in(const Frame& frame, const std::string& id) const {
  const auto is_it = [&](BodyId body) {
    return !bodies_[body.value].is_slot || frame.bodies[body.value].occupant == id;
  };
  if (const std::optional<BodyId> now = find_body(id); now && is_it(*now)) return now;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {
    if (bodies_[index].is_slot && frame.bodies[index].occupant == id) return BodyId(index);
  }
  return std::nullopt;
}

inline DeviceState Scene::device_state(const Device& device, const Frame& frame) const {
  const Mat3 mounting = rotation_matrix(device.antenna.orientation);
  if (!device.attachment) {
    const Placement placement = placement_at(device.motion, frame.time_s);
    return {placement.pose.position_m, placement.velocity.linear_mps, std::nullopt, true,
            rotation_matrix(placement.pose) * mounting};
  }
  DCEM_ASSERT(frame.bodies.size() == bodies_.size());
  const std::optional<BodyId> body = find_in(frame, device.attachment->object);
  DCEM_ASSERT(body.has_value() || slot_count_ > 0);
  if (!body) return {Vec3(0.0), Vec3(0.0), std::nullopt, false, mounting};
  const BodyState& state = frame.bodies[body->value];
  const Pose& pose = state.placement.pose;
  const Mat3 turned = rotation_matrix(pose);
  const Vec3 position_m = pose.position_m + turned * device.attachment->offset_m;
  return {position_m, velocity_at(state.placement.velocity, pose.position_m, position_m),
          device.attachment->sees_own_body ? std::nullopt : body, state.present, turned * mounting};
}

}  // namespace dcem
