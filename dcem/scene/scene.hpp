#pragma once
/// The world: materials, bodies and devices. The only state that changes from frame to frame.
///
/// Body 0 is the standing scenery, every object is a body of its own. All vertices, triangles and facets of all bodies
/// stand in common arrays, body after body, in world coordinates of the current frame, so a facet id or a triangle
/// index names one thing for as long as the scene lives.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/core/ids.hpp"
#include "dcem/em/material.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/facet_builder.hpp"
#include "dcem/scene/device.hpp"
#include "dcem/scene/frame.hpp"

namespace dcem {

/// A facet of the world in the current frame.
struct WorldFacet {
  Plane plane;
  MaterialId material;
  BodyId body;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_hull_point = 0, hull_point_count = 0;
  bool transmits = false;  ///< a leg may cross it; an opaque facet blocks
  bool present = true;     ///< false while its body is not there
};

/// The standing scenery or an object: where its parts stand in the common arrays.
struct Body {
  std::string id;  ///< empty for the scenery
  Motion motion;
  SurfaceMesh mesh;  ///< in local coordinates
  std::uint32_t first_vertex = 0, first_triangle = 0, first_facet = 0, first_hull_point = 0;
};

/// A device at an instant.
struct DeviceState {
  Vec3 position_m{0.0};
  Vec3 velocity_mps{0.0};
  /// The object that does not exist for this device's links: the one it rides on.
  std::optional<BodyId> ignored_body;
  bool present = true;  ///< false while the object it rides on is not there
};

class Scene {
 public:
  explicit Scene(SurfaceSettings settings = {}) : settings_(settings) { bodies_.push_back({"", LinearMotion{}, {}}); }

  // Building. Each function throws std::invalid_argument, naming what is wrong, and then has changed nothing.

  /// Adds a material; its name must be new.
  MaterialId add_material(Material material);
  /// The standing scenery; at most once, before any object.
  void set_scenery(const TriangleMesh& mesh);
  /// A rigid object in its own coordinates; its id must be new. Its materials must have been added.
  BodyId add_object(std::string id, const TriangleMesh& mesh, Motion motion);
  void add_transmitter(Device device);
  void add_receiver(Device device);

  // Time.

  /// Poses and velocities of all bodies at `time_s`, from their motions.
  Frame frame_at(double time_s, std::size_t index = 0) const;
  /// Moves the bodies to where the frame says.
  ChangeSet apply(const Frame& frame);
  /// Where a device is in a frame.
  DeviceState device_state(const Device& device, const Frame& frame) const;

  // The world in the current frame.

  const SurfaceSettings& settings() const { return settings_; }
  std::span<const Material> materials() const { return materials_; }
  const Material& material(MaterialId id) const { return materials_[id.value]; }
  std::optional<MaterialId> find_material(const std::string& name) const;
  std::span<const Body> bodies() const { return bodies_; }
  const Body& body(BodyId id) const { return bodies_[id.value]; }
  std::optional<BodyId> find_body(const std::string& id) const;
  const BodyState& body_state(BodyId id) const { return states_[id.value]; }
  std::span<const Device> transmitters() const { return transmitters_; }
  std::span<const Device> receivers() const { return receivers_; }

  std::span<const WorldFacet> facets() const { return facets_; }
  const WorldFacet& facet(FacetId id) const { return facets_[id.value]; }
  std::span<const Vec3> vertices_m() const { return vertices_m_; }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }
  FacetId facet_of_triangle(std::uint32_t triangle) const { return facet_of_triangle_[triangle]; }
  /// Which closed shell of its body a triangle belongs to, counted from 1; 0: none.
  std::uint32_t shell_of_triangle(std::uint32_t triangle) const { return shell_of_triangle_[triangle]; }
  std::span<const Vec3> hull_m(const WorldFacet& facet) const {
    return std::span(hull_points_m_).subspan(facet.first_hull_point, facet.hull_point_count);
  }
  std::array<Vec3, 3> corners_m(std::uint32_t triangle) const {
    const auto& index = triangles_[triangle];
    return {vertices_m_[index[0]], vertices_m_[index[1]], vertices_m_[index[2]]};
  }

  /// Boxes of all triangles, in the order of `triangles()`; empty for triangles of an absent body.
  std::span<const Aabb<double>> triangle_boxes() const { return boxes_; }
  /// Index of the first triangle of each body: the groups of the tree.
  std::vector<std::uint32_t> first_triangles() const;
  /// The triangles of a body as a range of indices [first, last).
  std::pair<std::uint32_t, std::uint32_t> triangle_range(BodyId id) const;

 private:
  void append(Body body);
  void place(BodyId id);
  std::vector<MaterialId> resolve_materials(const SurfaceMesh& mesh) const;
  void check_device(const Device& device, const std::unordered_set<std::string>& ids) const;

  SurfaceSettings settings_;
  std::vector<Material> materials_;
  std::vector<Body> bodies_;
  std::vector<BodyState> states_{BodyState{}};
  std::vector<Device> transmitters_, receivers_;
  std::unordered_set<std::string> transmitter_ids_, receiver_ids_;
  std::unordered_map<std::string, BodyId> body_by_id_;

  std::vector<WorldFacet> facets_;
  std::vector<Vec3> vertices_m_, hull_points_m_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<FacetId> facet_of_triangle_;
  std::vector<std::uint32_t> shell_of_triangle_;
  std::vector<Aabb<double>> boxes_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline MaterialId Scene::add_material(Material material) {
  validate(material);
  if (find_material(material.name)) {
    throw std::invalid_argument("material '" + material.name + "' is there twice; expected a new name");
  }
  materials_.push_back(std::move(material));
  return MaterialId(materials_.size() - 1);
}

inline std::optional<MaterialId> Scene::find_material(const std::string& name) const {
  for (std::size_t index = 0; index < materials_.size(); ++index) {
    if (materials_[index].name == name) return MaterialId(index);
  }
  return std::nullopt;
}

inline std::optional<BodyId> Scene::find_body(const std::string& id) const {
  const auto found = body_by_id_.find(id);
  return found == body_by_id_.end() ? std::nullopt : std::optional(found->second);
}

inline void Scene::set_scenery(const TriangleMesh& mesh) {
  if (bodies_.size() != 1 || !triangles_.empty()) {
    throw std::invalid_argument("scene: the scenery is set once, before any object");
  }
  Body scenery{"", LinearMotion{}, build_surface_mesh(mesh, settings_)};
  resolve_materials(scenery.mesh);
  bodies_.clear();
  states_.clear();
  append(std::move(scenery));
}

inline BodyId Scene::add_object(std::string id, const TriangleMesh& mesh, Motion motion) {
  validate(motion);
  if (id.empty() || find_body(id)) {
    throw std::invalid_argument("object '" + id + "': expected an id that is not empty and not there yet");
  }
  Body body{std::move(id), std::move(motion), build_surface_mesh(mesh, settings_)};
  resolve_materials(body.mesh);
  body_by_id_.emplace(body.id, BodyId(bodies_.size()));
  append(std::move(body));
  return BodyId(bodies_.size() - 1);
}

inline std::vector<MaterialId> Scene::resolve_materials(const SurfaceMesh& mesh) const {
  std::vector<MaterialId> ids(mesh.material_names.size());
  for (const Facet& facet : mesh.facets) {
    const std::optional<MaterialId> id = find_material(mesh.material_names[facet.material]);
    if (!id) {
      throw std::invalid_argument("material '" + mesh.material_names[facet.material] +
                                  "' is used but not defined; add it first");
    }
    ids[facet.material] = *id;
  }
  return ids;
}

inline void Scene::append(Body body) {
  const BodyId id(bodies_.size());
  const std::vector<MaterialId> material_of = resolve_materials(body.mesh);
  body.first_vertex = static_cast<std::uint32_t>(vertices_m_.size());
  body.first_triangle = static_cast<std::uint32_t>(triangles_.size());
  body.first_facet = static_cast<std::uint32_t>(facets_.size());
  body.first_hull_point = static_cast<std::uint32_t>(hull_points_m_.size());
  for (const Facet& local : body.mesh.facets) {
    facets_.push_back({local.plane, material_of[local.material], id, body.first_triangle + local.first_triangle,
                       local.triangle_count, body.first_hull_point + local.first_hull_point, local.hull_point_count,
                       transmits(material(material_of[local.material])), true});
  }
  for (std::size_t index = 0; index < body.mesh.triangles.size(); ++index) {
    const auto& local = body.mesh.triangles[index];
    triangles_.push_back({body.first_vertex + local[0], body.first_vertex + local[1], body.first_vertex + local[2]});
    facet_of_triangle_.push_back(FacetId(body.first_facet + body.mesh.facet_of_triangle[index]));
    shell_of_triangle_.push_back(body.mesh.shell_of_triangle[index]);
  }
  vertices_m_.insert(vertices_m_.end(), body.mesh.vertices_m.begin(), body.mesh.vertices_m.end());
  hull_points_m_.insert(hull_points_m_.end(), body.mesh.hull_points_m.begin(), body.mesh.hull_points_m.end());
  boxes_.resize(triangles_.size());
  states_.push_back({true, placement_at(body.motion, 0.0)});
  bodies_.push_back(std::move(body));
  place(id);
}

inline void Scene::place(BodyId id) {
  const Body& body = bodies_[id.value];
  const BodyState& state = states_[id.value];
  const Mat3 rotation = rotation_matrix(state.placement.pose);
  const auto to_world = [&](const Vec3& local) { return state.placement.pose.position_m + rotation * local; };
  const bool stands = id == BodyId{};  // the scenery's coordinates are the world's, to the last bit
  for (std::size_t index = 0; index < body.mesh.vertices_m.size() && !stands; ++index) {
    vertices_m_[body.first_vertex + index] = to_world(body.mesh.vertices_m[index]);
  }
  for (std::size_t index = 0; index < body.mesh.hull_points_m.size() && !stands; ++index) {
    hull_points_m_[body.first_hull_point + index] = to_world(body.mesh.hull_points_m[index]);
  }
  for (std::size_t index = 0; index < body.mesh.facets.size(); ++index) {
    WorldFacet& facet = facets_[body.first_facet + index];
    const Plane& local = body.mesh.facets[index].plane;
    if (!stands) facet.plane = {to_world(local.point_m), rotation * local.normal};
    facet.present = state.present;
  }
  for (std::size_t index = 0; index < body.mesh.triangles.size(); ++index) {
    Aabb<double> box;
    const auto triangle = static_cast<std::uint32_t>(body.first_triangle + index);
    if (state.present) {
      for (const Vec3& corner : corners_m(triangle)) box.extend(corner);
    }
    boxes_[triangle] = box;
  }
}

inline Frame Scene::frame_at(double time_s, std::size_t index) const {
  Frame frame{index, time_s, {}};
  for (const Body& body : bodies_) frame.bodies.push_back({true, placement_at(body.motion, time_s)});
  return frame;
}

inline ChangeSet Scene::apply(const Frame& frame) {
  if (frame.bodies.size() != bodies_.size()) {
    throw std::invalid_argument("frame: expected one state per body of the scene");
  }
  ChangeSet changes;
  for (std::size_t index = 0; index < bodies_.size(); ++index) {
    const BodyState before = std::exchange(states_[index], frame.bodies[index]);
    const BodyState& now = states_[index];
    if (index == 0 || (before.present == now.present && before.placement.pose == now.placement.pose)) continue;
    place(BodyId(index));
    changes.moved.push_back(BodyId(index));
  }
  return changes;
}

inline DeviceState Scene::device_state(const Device& device, const Frame& frame) const {
  if (!device.attachment) {
    const Placement placement = placement_at(device.motion, frame.time_s);
    return {placement.pose.position_m, placement.velocity.linear_mps, std::nullopt, true};
  }
  const std::optional<BodyId> body = find_body(device.attachment->object);
  DCEM_ASSERT(body.has_value());
  const BodyState& state = frame.bodies[body->value];
  const Pose& pose = state.placement.pose;
  const Vec3 position_m = pose.position_m + rotation_matrix(pose) * device.attachment->offset_m;
  return {position_m, velocity_at(state.placement.velocity, pose.position_m, position_m),
          device.attachment->sees_own_body ? std::nullopt : body, state.present};
}

inline void Scene::check_device(const Device& device, const std::unordered_set<std::string>& ids) const {
  const std::string name = "device '" + device.id + "': ";
  if (device.id.empty()) throw std::invalid_argument("device: its id is empty; expected a name");
  if (ids.contains(device.id)) throw std::invalid_argument(name + "is there twice; expected a new id");
  validate(device.antenna);
  if (!std::isfinite(device.power_dbm)) throw std::invalid_argument(name + "power_dbm is not finite");
  if (!device.attachment) {
    validate(device.motion);
  } else if (!find_body(device.attachment->object)) {
    throw std::invalid_argument(name + "rides on '" + device.attachment->object + "', which is no object of the scene");
  } else if (!is_finite(device.attachment->offset_m)) {
    throw std::invalid_argument(name + "offset_m is not finite");
  }
}

inline void Scene::add_transmitter(Device device) {
  check_device(device, transmitter_ids_);
  transmitter_ids_.insert(device.id);
  transmitters_.push_back(std::move(device));
}

inline void Scene::add_receiver(Device device) {
  check_device(device, receiver_ids_);
  receiver_ids_.insert(device.id);
  receivers_.push_back(std::move(device));
}

inline std::vector<std::uint32_t> Scene::first_triangles() const {
  std::vector<std::uint32_t> first;
  for (const Body& body : bodies_) first.push_back(body.first_triangle);
  return first;
}

inline std::pair<std::uint32_t, std::uint32_t> Scene::triangle_range(BodyId id) const {
  const Body& body = bodies_[id.value];
  return {body.first_triangle, body.first_triangle + static_cast<std::uint32_t>(body.mesh.triangles.size())};
}

}  // namespace dcem
