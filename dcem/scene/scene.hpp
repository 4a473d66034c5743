#pragma once
/// The world: materials, bodies and devices. The only state that changes from frame to frame.
///
/// Body 0 is the standing scenery, every object is a body of its own.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/em/surface/material.hpp"
#include "dcem/geometry/triangle_view.hpp"
#include "dcem/scene/device.hpp"
#include "dcem/world/frame.hpp"
#include "dcem/world/world_geometry.hpp"

namespace dcem {

class ThreadPool;

/// The standing scenery, an object, or a slot of a body pool, which objects of one shape take in turn.
struct Body {
  std::string id;    ///< empty for the scenery and for slots
  Motion motion;     ///< of an object
  SurfaceMesh mesh;  ///< in local coordinates; of the scenery without hulls and edges, which are those of the world
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

  friend bool operator==(const DeviceState&, const DeviceState&) = default;
};

class Scene {
 public:
  explicit Scene(SurfaceSettings settings = {});
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

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
  /// A device that transmits and receives: it becomes the last transmitter and the last receiver. Two of them have one
  /// link, from the one with the lesser id; none has a link to itself.
  void add_transceiver(Device device);
  /// Takes all receivers out of the scene.
  std::vector<Device> take_receivers();

  // Time.

  /// Poses and velocities of all bodies at `time_s`, from their motions. Slots are empty.
  Frame frame_at(double time_s, std::size_t index = 0) const;
  /// Moves the bodies to where the frame says. Throws std::invalid_argument, having changed nothing, where a pose is
  /// not finite or the name of an object in a slot is empty, has a slash, or is there twice. Many bodies are moved by
  /// the threads of `pool`, where there is one.
  ChangeSet apply(const Frame& frame, ThreadPool* pool = nullptr);
  /// Where a device is in a frame, and how its antenna is turned.
  DeviceState device_state(const Device& device, const Frame& frame) const;
  /// The same in the current frame, whose instant is `time_s`.
  DeviceState device_state_now(const Device& device, double time_s) const;

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
  /// Valid until the scene changes.
  TriangleView triangle_view() const { return {vertices_m(), triangles()}; }
  FacetId facet_of_triangle(std::uint32_t triangle) const { return world_.facet_of_triangle(triangle); }
  /// Which enclosing shell of its body a triangle belongs to, counted from 1; 0: none.
  std::uint32_t shell_of_triangle(std::uint32_t triangle) const { return world_.shell_of_triangle(triangle); }
  /// Corners of a facet's convex hull, in order around it.
  std::span<const Vec3> hull_m(const WorldFacet& facet) const { return world_.hull_m(facet); }
  /// The box around these.
  Aabb<double> hull_box(const WorldFacet& facet) const {
    Aabb<double> box;
    for (const Vec3& corner_m : hull_m(facet)) box.extend(corner_m);
    return box;
  }
  /// Boxes of all triangles, in the order of `triangles()`; empty for triangles of an absent body.
  std::span<const Aabb<double>> triangle_boxes() const { return world_.triangle_boxes(); }
  /// Facets that can reflect, block or let pass: all but the skins of foliage.
  std::size_t surface_count() const {
    const std::span<const WorldFacet> all = facets();
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const WorldFacet& facet) { return !facet.is_foliage; }));
  }
  /// Whether any facet, there or not, lets anything pass.
  bool has_sheets() const { return world_.has_sheets(); }
  /// Closed shells of foliage; empty boxes for those of an absent body.
  std::span<const FoliageShell> foliage() const { return world_.foliage(); }
  /// The number of a facet within its body: it does not change when other bodies come or go.
  std::uint32_t facet_number(FacetId id) const { return id.value - world_.first(facet(id).body).facet; }

  /// The number of a wedge within its body.
  std::uint32_t wedge_number(WedgeId id) const { return id.value - world_.first(wedge(id).body).wedge; }

  /// Index of the first triangle of each body: the objects of an index over the triangles.
  std::vector<std::uint32_t> first_triangles() const;
  /// The triangles of a body as a range of indices [first, last).
  std::pair<std::uint32_t, std::uint32_t> triangle_range(BodyId id) const;

 private:
  void append(Body body);
  void check_frame(const Frame& frame) const;
  void check_occupants(const Frame& frame) const;
  void take_over(BodyId id, const BodyState& state, ChangeSet& changes);
  std::optional<BodyId> find_in(const Frame& frame, const std::string& id) const;
  DeviceState state_on(const Device& device, std::optional<BodyId> body, std::span<const BodyState> states,
                       double time_s) const;
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

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/scene/scene_bodies.hpp"
#endif
