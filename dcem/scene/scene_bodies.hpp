#pragma once
/// Bodies of scene.hpp: how a scene is put together, and how it moves.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/error.hpp"
#include "dcem/core/naming.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

DCEM_INLINE Scene::Scene(SurfaceSettings settings) : settings_(settings) {
  validate(settings);
  append({"", LinearMotion{}, {}});
}
DCEM_INLINE Scene::Scene(const Scene&) = default;
DCEM_INLINE Scene::Scene(Scene&&) noexcept = default;
DCEM_INLINE Scene& Scene::operator=(const Scene&) = default;
DCEM_INLINE Scene& Scene::operator=(Scene&&) noexcept = default;
DCEM_INLINE Scene::~Scene() = default;

DCEM_INLINE MaterialId Scene::add_material(Material material) {
  validate(material);
  if (find_material(material.name)) {
    throw std::invalid_argument("material '" + material.name + "' is there twice; expected a new name");
  }
  materials_.push_back(std::move(material));
  return MaterialId(materials_.size() - 1);
}

DCEM_INLINE std::optional<MaterialId> Scene::find_material(const std::string& name) const {
  for (std::size_t index = 0; index < materials_.size(); ++index) {
    if (materials_[index].name == name) return MaterialId(index);
  }
  return std::nullopt;
}

DCEM_INLINE std::optional<BodyId> Scene::find_body(const std::string& id) const {
  const auto found = body_by_id_.find(id);
  return found == body_by_id_.end() ? std::nullopt : std::optional(found->second);
}

DCEM_INLINE void Scene::set_scenery(const TriangleMesh& mesh) {
  if (bodies_.size() != 1 || !triangles().empty()) {
    throw std::invalid_argument("scene: the scenery is set once, before any object");
  }
  Body scenery{"", LinearMotion{}, build_surface_mesh(mesh, settings_)};
  resolve_materials(scenery.mesh);
  bodies_.clear();
  states_.clear();
  world_.clear();
  append(std::move(scenery));
  // It stands where it is: its hulls and edges are those of the world.
  std::vector<Vec3>().swap(bodies_.front().mesh.hull_points_m);
  std::vector<Wedge>().swap(bodies_.front().mesh.wedges);
}

DCEM_INLINE BodyId Scene::add_object(std::string id, const TriangleMesh& mesh, Motion motion) {
  const std::string name = "object '" + id + "'";
  if (id.empty() || id.find('/') != std::string::npos || find_body(id)) {
    throw std::invalid_argument(name + ": expected an id that is not empty, has no slash and is not there yet");
  }
  Body body{std::move(id), std::move(motion), {}};
  detail::naming(name, [&] {
    validate(body.motion);
    body.mesh = build_surface_mesh(mesh, settings_);
    resolve_materials(body.mesh);
  });
  body_by_id_.emplace(body.id, BodyId(bodies_.size()));
  append(std::move(body));
  return BodyId(bodies_.size() - 1);
}

DCEM_INLINE void Scene::add_body_pool(std::size_t count, const TriangleMesh& mesh) {
  Body body{"", LinearMotion{}, build_surface_mesh(mesh, settings_), true};
  resolve_materials(body.mesh);
  for (std::size_t index = 0; index < count; ++index) append(body);
  slot_count_ += count;
}

DCEM_INLINE std::vector<SurfaceMaterial> Scene::resolve_materials(const SurfaceMesh& mesh) const {
  std::vector<SurfaceMaterial> resolved(mesh.material_names.size());
  for (const Facet& facet : mesh.facets) {
    const std::string& name = mesh.material_names[facet.material];
    const std::optional<MaterialId> id = find_material(name);
    if (!id) throw std::invalid_argument("material '" + name + "' is used but not defined; add it first");
    const Material& surface = material(*id);
    resolved[facet.material] = {*id, transmits(surface), scatters(surface), is_foliage(surface)};
  }
  check_foliage_is_closed(mesh, resolved);
  return resolved;
}

/// A length inside is defined for shells that are closed all around, and of one foliage.
DCEM_INLINE void Scene::check_foliage_is_closed(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials) {
  std::vector<std::optional<std::uint32_t>> material_of_shell(mesh.shell_foot_m.size() + 1);
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const std::uint32_t shell = mesh.shell_of_triangle[triangle];
    const std::uint32_t material = mesh.facets[mesh.facet_of_triangle[triangle]].material;
    const std::uint32_t first = material_of_shell[shell].value_or(material);
    if (shell != 0) material_of_shell[shell] = first;
    if (!materials[material].is_foliage && !materials[first].is_foliage) continue;
    if (shell != 0 && !mesh.shell_stands[shell - 1] && first == material) continue;
    const std::uint32_t foliage = materials[material].is_foliage ? material : first;
    throw std::invalid_argument("material '" + mesh.material_names[foliage] +
                                "' is foliage on a surface that is not closed, shares an edge with another one, or is "
                                "of something else in part; expected closed shells of it alone");
  }
}

DCEM_INLINE void Scene::append(Body body) {
  const BodyState state{!body.is_slot, placement_at(body.motion, 0.0)};
  world_.append(body.mesh, resolve_materials(body.mesh), state);
  states_.push_back(state);
  bodies_.push_back(std::move(body));
}

DCEM_INLINE void Scene::check_device(const Device& device, const std::unordered_set<std::string>& ids) const {
  const std::string name = "device '" + device.id + "': ";
  if (device.id.empty()) throw std::invalid_argument("device: its id is empty; expected a name");
  if (ids.contains(device.id)) throw std::invalid_argument(name + "is there twice; expected a new id");
  detail::naming("device '" + device.id + "'", [&] { validate(device.antenna); });
  if (!std::isfinite(device.power_dbm)) throw std::invalid_argument(name + "power_dbm is not finite");
  if (!device.attachment) {
    detail::naming("device '" + device.id + "'", [&] { validate(device.motion); });
  } else if (!find_body(device.attachment->object) && slot_count_ == 0) {
    throw std::invalid_argument(name + "rides on '" + device.attachment->object + "', which is no object of the scene");
  } else if (!is_finite(device.attachment->offset_m)) {
    throw std::invalid_argument(name + "offset_m is not finite");
  }
}

DCEM_INLINE void Scene::add_transmitter(Device device) {
  check_device(device, transmitter_ids_);
  transmitter_ids_.insert(device.id);
  transmitters_.push_back(std::move(device));
}

DCEM_INLINE void Scene::add_receiver(Device device) {
  check_device(device, receiver_ids_);
  receiver_ids_.insert(device.id);
  receivers_.push_back(std::move(device));
}

DCEM_INLINE void Scene::add_transceiver(Device device) {
  device.is_transceiver = true;
  check_device(device, receiver_ids_);
  add_transmitter(device);
  add_receiver(std::move(device));
}

DCEM_INLINE std::vector<Device> Scene::take_receivers() {
  receiver_ids_.clear();
  return std::exchange(receivers_, {});
}

DCEM_INLINE std::vector<std::uint32_t> Scene::first_triangles() const {
  std::vector<std::uint32_t> first;
  for (std::size_t index = 0; index < bodies_.size(); ++index) first.push_back(world_.first(BodyId(index)).triangle);
  return first;
}

DCEM_INLINE std::pair<std::uint32_t, std::uint32_t> Scene::triangle_range(BodyId id) const {
  const std::uint32_t first = world_.first(id).triangle;
  return {first, first + static_cast<std::uint32_t>(body(id).mesh.triangles.size())};
}

DCEM_INLINE Frame Scene::frame_at(double time_s, std::size_t index) const {
  if (!std::isfinite(time_s)) throw std::invalid_argument("frame: its time is not finite");
  Frame frame{index, time_s, {}};
  for (const Body& body : bodies_) frame.bodies.push_back({!body.is_slot, placement_at(body.motion, time_s)});
  return frame;
}

DCEM_INLINE ChangeSet Scene::apply(const Frame& frame, ThreadPool* pool) {
  check_frame(frame);
  ChangeSet changes;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {  // the scenery stands
    if (frame.bodies[index] != states_[index]) take_over(BodyId(index), frame.bodies[index], changes);
  }
  const auto place = [&](std::size_t number) {
    const BodyId id = changes.moved[number];
    world_.place(id, body(id).mesh, states_[id.value]);
  };
  ThreadPool alone(1);
  (pool != nullptr ? *pool : alone).for_each_quick(changes.moved.size(), place);
  for (const BodyId id : changes.replaced) {  // after all have left their slots: objects may change slots
    if (body_state(id).present) body_by_id_[body_state(id).occupant] = id;
  }
  return changes;
}

DCEM_INLINE void Scene::take_over(BodyId id, const BodyState& state, ChangeSet& changes) {
  BodyState& now = states_[id.value];
  if (now.occupant != state.occupant) {
    changes.replaced.push_back(id);
    if (const auto known = body_by_id_.find(now.occupant); known != body_by_id_.end() && known->second == id) {
      body_by_id_.erase(known);
    }
  }
  const bool was_there = now.present;
  const bool is_as_before = was_there == state.present && now.placement.pose == state.placement.pose;
  now = state;  // in the room of what it was
  if ((!was_there && !state.present) || is_as_before) return;
  changes.moved.push_back(id);
}

DCEM_INLINE void Scene::check_frame(const Frame& frame) const {
  if (frame.bodies.size() != bodies_.size()) {
    throw std::invalid_argument("frame: expected one state per body of the scene");
  }
  bool occupants_changed = false;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {
    const BodyState& state = frame.bodies[index];
    if (state == states_[index]) continue;
    const std::string& name = bodies_[index].is_slot ? state.occupant : bodies_[index].id;
    detail::naming([&] { return "object '" + name + "'"; }, [&] { validate(state.placement); });
    if (state.occupant.empty() == (bodies_[index].is_slot && state.present)) {
      throw std::invalid_argument("frame: expected an object name for each slot in use, and for nothing else");
    }
    occupants_changed = occupants_changed || state.occupant != states_[index].occupant;
  }
  if (occupants_changed) check_occupants(frame);
}

/// No name is there twice.
DCEM_INLINE void Scene::check_occupants(const Frame& frame) const {
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
DCEM_INLINE std::optional<BodyId> Scene::find_in(const Frame& frame, const std::string& id) const {
  const auto is_it = [&](BodyId body) {
    return !bodies_[body.value].is_slot || frame.bodies[body.value].occupant == id;
  };
  if (const std::optional<BodyId> now = find_body(id); now && is_it(*now)) return now;
  for (std::size_t index = 1; index < bodies_.size(); ++index) {
    if (bodies_[index].is_slot && frame.bodies[index].occupant == id) return BodyId(index);
  }
  return std::nullopt;
}

DCEM_INLINE DeviceState Scene::device_state(const Device& device, const Frame& frame) const {
  if (!device.attachment) return state_on(device, std::nullopt, frame.bodies, frame.time_s);
  DCEM_ASSERT(frame.bodies.size() == bodies_.size());
  return state_on(device, find_in(frame, device.attachment->object), frame.bodies, frame.time_s);
}

DCEM_INLINE DeviceState Scene::device_state_now(const Device& device, double time_s) const {
  if (!device.attachment) return state_on(device, std::nullopt, states_, time_s);
  return state_on(device, find_body(device.attachment->object), states_, time_s);
}

DCEM_INLINE DeviceState Scene::state_on(const Device& device, std::optional<BodyId> body,
                                        std::span<const BodyState> states, double time_s) const {
  const Mat3 mounting = rotation_matrix(device.antenna.orientation);
  if (!device.attachment) {
    const Placement placement = placement_at(device.motion, time_s);
    return {placement.pose.position_m, placement.velocity.linear_mps, std::nullopt, true,
            rotation_matrix(placement.pose) * mounting};
  }
  DCEM_ASSERT(body.has_value() || slot_count_ > 0);
  if (!body) return {Vec3(0.0), Vec3(0.0), std::nullopt, false, mounting};
  const BodyState& state = states[body->value];
  const Pose& pose = state.placement.pose;
  const Mat3 turned = rotation_matrix(pose);
  const Vec3 position_m = pose.position_m + turned * device.attachment->offset_m;
  return {position_m, velocity_at(state.placement.velocity, pose.position_m, position_m),
          device.attachment->sees_own_body ? std::nullopt : body, state.present, turned * mounting};
}

}  // namespace dcem
