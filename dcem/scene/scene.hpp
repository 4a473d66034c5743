#pragma once
/// The world: materials, bodies and devices. The only state that changes from frame to frame.
///
/// Body 0 is the standing scenery, every object is a body of its own.
#include <algorithm>
#include <array>
#include <cmath>
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
#include "dcem/em/surface/material.hpp"
#include "dcem/geometry/surfaces/facet_builder.hpp"
#include "dcem/scene/device.hpp"
#include "dcem/world/frame.hpp"
#include "dcem/world/world_geometry.hpp"

namespace dcem {

/// The standing scenery, an object, or a slot of a body pool, which objects of one shape take in turn.
struct Body {
  std::string id;    ///< empty for the scenery and for slots
  Motion motion;     ///< of an object
  SurfaceMesh mesh;  ///< in local coordinates
  bool is_slot = false;
};

/// A device at an instant.
struct DeviceState {
  Vec3 position_m{0.0};
  Vec3 velocity_mps{0.0};
  /// The object that does not exist for this device's links: the one it rides on.
  std::optional<BodyId> ignored_body;
  bool present = true;  ///< false while the object it rides on is not there
  /// The axes of its antenna in the world, as columns: those of the object it rides on, or of its own pose, times the
  /// antenna's orientation.
  Mat3 rotation{1.0};
};

class Scene {
 public:
  explicit Scene(SurfaceSettings settings = {}) : settings_(settings) {
    validate(settings);
    append({"", LinearMotion{}, {}});
  }

  // Building. Each function throws std::invalid_argument, naming what is wrong, and then has changed nothing.

  /// Adds a material; its name must be new.
  MaterialId add_material(Material material);
  /// The standing scenery; at most once, before any object.
  void set_scenery(const TriangleMesh& mesh);
  /// A rigid object in its own coordinates; its id must be new. Its materials must have been added.
  BodyId add_object(std::string id, const TriangleMesh& mesh, Motion motion);
  /// Slots for objects that come and go and all look like this mesh: each frame says which object is in which slot, by
  /// `BodyState::occupant`. So a day of traffic needs as many bodies as are on the road at a time. Empty until then.
  void add_body_pool(std::size_t count, const TriangleMesh& mesh);
  void add_transmitter(Device device);
  void add_receiver(Device device);

  // Time.

  /// Poses and velocities of all bodies at `time_s`, from their motions. Slots are empty.
  Frame frame_at(double time_s, std::size_t index = 0) const;
  /// Moves the bodies to where the frame says. Throws std::invalid_argument, having changed nothing, where a pose is
  /// not finite or the name of an object in a slot is empty, has a slash, or is there twice.
  ChangeSet apply(const Frame& frame);
  /// Where a device is in a frame, and how its antenna is turned.
  DeviceState device_state(const Device& device, const Frame& frame) const;

  // The world in the current frame.

  const SurfaceSettings& settings() const { return settings_; }
  std::span<const Material> materials() const { return materials_; }
  const Material& material(MaterialId id) const { return materials_[id.value]; }
  std::optional<MaterialId> find_material(const std::string& name) const;
  std::span<const Body> bodies() const { return bodies_; }
  const Body& body(BodyId id) const { return bodies_[id.value]; }
  /// An object by its id; an object in a slot while it is there in the current frame.
  std::optional<BodyId> find_body(const std::string& id) const;
  /// The id of an object, or of the object that is in a slot in the current frame; empty for the scenery.
  const std::string& body_name(BodyId id) const { return body(id).is_slot ? body_state(id).occupant : body(id).id; }
  std::size_t slot_count() const { return slot_count_; }
  const BodyState& body_state(BodyId id) const { return states_[id.value]; }
  std::span<const Device> transmitters() const { return transmitters_; }
  std::span<const Device> receivers() const { return receivers_; }

  const WorldGeometry& world() const { return world_; }
  std::span<const WorldFacet> facets() const { return world_.facets(); }
  const WorldFacet& facet(FacetId id) const { return world_.facets()[id.value]; }
  std::span<const WorldWedge> wedges() const { return world_.wedges(); }
  const WorldWedge& wedge(WedgeId id) const { return world_.wedges()[id.value]; }
  /// The wedges at the rim of a facet.
  std::span<const WedgeId> wedges_of_facet(FacetId id) const { return world_.wedges_of_facet(id); }
  std::span<const Vec3> vertices_m() const { return world_.vertices_m(); }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return world_.triangles(); }
  std::array<Vec3, 3> corners_m(std::uint32_t triangle) const { return world_.corners_m(triangle); }
  FacetId facet_of_triangle(std::uint32_t triangle) const { return world_.facet_of_triangle(triangle); }
  /// Which enclosing shell of its body a triangle belongs to, counted from 1; 0: none.
  std::uint32_t shell_of_triangle(std::uint32_t triangle) const { return world_.shell_of_triangle(triangle); }
  /// Corners of a facet's convex hull, in order around it.
  std::span<const Vec3> hull_m(const WorldFacet& facet) const { return world_.hull_m(facet); }
  /// Boxes of all triangles, in the order of `triangles()`; empty for triangles of an absent body.
  std::span<const Aabb<double>> triangle_boxes() const { return world_.triangle_boxes(); }
  /// Facets that can reflect, block or let pass: all but the skins of foliage.
  std::size_t surface_count() const {
    const std::span<const WorldFacet> all = facets();
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const WorldFacet& facet) { return !facet.is_foliage; }));
  }
  /// Closed shells of foliage; empty boxes for those of an absent body.
  std::span<const FoliageShell> foliage() const { return world_.foliage(); }
  /// The number of a facet within its body: it does not change when other bodies come or go.
  std::uint32_t facet_number(FacetId id) const { return id.value - world_.first(facet(id).body).facet; }

  /// The number of a wedge within its body.
  std::uint32_t wedge_number(WedgeId id) const { return id.value - world_.first(wedge(id).body).wedge; }

  /// Index of the first triangle of each body: the groups of the tree.
  std::vector<std::uint32_t> first_triangles() const;
  /// The triangles of a body as a range of indices [first, last).
  std::pair<std::uint32_t, std::uint32_t> triangle_range(BodyId id) const;

 private:
  void append(Body body);
  void check_frame(const Frame& frame) const;
  void check_occupants(const Frame& frame) const;
  void take_over(BodyId id, const BodyState& state, ChangeSet& changes);
  std::optional<BodyId> find_in(const Frame& frame, const std::string& id) const;
  std::vector<SurfaceMaterial> resolve_materials(const SurfaceMesh& mesh) const;
  static void check_foliage_is_closed(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials);
  void check_device(const Device& device, const std::unordered_set<std::string>& ids) const;

  SurfaceSettings settings_;
  std::vector<Material> materials_;
  std::vector<Body> bodies_;
  std::vector<BodyState> states_;
  std::vector<Device> transmitters_, receivers_;
  std::unordered_set<std::string> transmitter_ids_, receiver_ids_;
  std::unordered_map<std::string, BodyId> body_by_id_;
  std::size_t slot_count_ = 0;
  WorldGeometry world_;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Does something, and puts `name` before the message where it throws std::invalid_argument.
template <typename Action>
void naming(const std::string& name, Action&& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(name + ": " + error.what());
  }
}

}  // namespace detail

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
  if (bodies_.size() != 1 || !triangles().empty()) {
    throw std::invalid_argument("scene: the scenery is set once, before any object");
  }
  Body scenery{"", LinearMotion{}, build_surface_mesh(mesh, settings_)};
  resolve_materials(scenery.mesh);
  bodies_.clear();
  states_.clear();
  world_.clear();
  append(std::move(scenery));
}

inline BodyId Scene::add_object(std::string id, const TriangleMesh& mesh, Motion motion) {
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

inline void Scene::add_body_pool(std::size_t count, const TriangleMesh& mesh) {
  Body body{"", LinearMotion{}, build_surface_mesh(mesh, settings_), true};
  resolve_materials(body.mesh);
  for (std::size_t index = 0; index < count; ++index) append(body);
  slot_count_ += count;
}

inline std::vector<SurfaceMaterial> Scene::resolve_materials(const SurfaceMesh& mesh) const {
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
inline void Scene::check_foliage_is_closed(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials) {
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

inline void Scene::append(Body body) {
  const BodyState state{!body.is_slot, placement_at(body.motion, 0.0)};
  world_.append(body.mesh, resolve_materials(body.mesh), state);
  states_.push_back(state);
  bodies_.push_back(std::move(body));
}

inline void Scene::check_device(const Device& device, const std::unordered_set<std::string>& ids) const {
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
  for (std::size_t index = 0; index < bodies_.size(); ++index) first.push_back(world_.first(BodyId(index)).triangle);
  return first;
}

inline std::pair<std::uint32_t, std::uint32_t> Scene::triangle_range(BodyId id) const {
  const std::uint32_t first = world_.first(id).triangle;
  return {first, first + static_cast<std::uint32_t>(body(id).mesh.triangles.size())};
}

}  // namespace dcem

#include "dcem/scene/scene_time.hpp"
