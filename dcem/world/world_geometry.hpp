#pragma once
/// All bodies' vertices, triangles and facets in common arrays, body after body, in world coordinates of the current
/// frame: a facet id or a triangle index names one thing for as long as the scene lives.
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/world/frame.hpp"

namespace dcem {

/// A facet of the world in the current frame.
struct WorldFacet {
  Plane plane;
  MaterialId material;
  BodyId body;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_hull_point = 0, hull_point_count = 0;
  bool transmits = false;  ///< a leg may cross it; an opaque facet blocks
  bool present = true;     ///< false while its body is not there, and always for the skin of foliage
  bool scatters = false;   ///< diffuse power comes from it
  bool is_foliage = false;
};

/// A closed shell of foliage in the current frame: paths go through it as if it were not there, and are weakened by
/// their length inside.
struct FoliageShell {
  BodyId body;
  MaterialId material;
  std::vector<std::uint32_t> triangles;
  Aabb<double> box;  ///< empty while its body is not there
};

/// A diffracting edge of the world in the current frame.
struct WorldWedge {
  Wedge edge;                     ///< in world coordinates; `facets` are numbers within the body
  std::array<FacetId, 2> facets;  ///< face 0 and face n; of a free edge twice its only facet
  BodyId body;
  bool present = true;  ///< false while its body is not there
};

/// What a mesh's material index means in the scene.
struct SurfaceMaterial {
  MaterialId id;
  bool transmits = false;
  bool scatters = false;
  bool is_foliage = false;
};

class WorldGeometry {
 public:
  /// Appends a body in a state; bodies are numbered in the order in which they come.
  void append(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials, const BodyState& state);
  /// Moves a body to a state, from its local coordinates: a pose that comes back brings back the same bits.
  void place(BodyId id, const SurfaceMesh& mesh, const BodyState& state);
  /// Takes all bodies out.
  void clear() { *this = {}; }

  std::span<const WorldFacet> facets() const { return facets_; }
  std::span<const WorldWedge> wedges() const { return wedges_; }
  /// The wedges at the rim of a facet, ascending.
  std::span<const WedgeId> wedges_of_facet(FacetId facet) const {
    const std::uint32_t first = first_wedge_of_facet_[facet.value];
    return std::span(wedges_by_facet_).subspan(first, first_wedge_of_facet_[facet.value + 1] - first);
  }
  std::span<const Vec3> vertices_m() const { return vertices_m_; }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }
  FacetId facet_of_triangle(std::uint32_t triangle) const { return facet_of_triangle_[triangle]; }
  std::uint32_t shell_of_triangle(std::uint32_t triangle) const { return shell_of_triangle_[triangle]; }
  std::span<const Vec3> hull_m(const WorldFacet& facet) const {
    return std::span(hull_points_m_).subspan(facet.first_hull_point, facet.hull_point_count);
  }
  std::array<Vec3, 3> corners_m(std::uint32_t triangle) const {
    const auto& index = triangles_[triangle];
    return {vertices_m_[index[0]], vertices_m_[index[1]], vertices_m_[index[2]]};
  }
  /// Boxes of all triangles; empty for triangles of an absent body and of foliage.
  std::span<const Aabb<double>> triangle_boxes() const { return boxes_; }
  std::span<const FoliageShell> foliage() const { return foliage_; }

  /// Where a body's parts begin in the common arrays.
  struct First {
    std::uint32_t vertex = 0, triangle = 0, facet = 0, hull_point = 0, wedge = 0;
  };
  const First& first(BodyId id) const { return first_[id.value]; }
  std::size_t body_count() const { return first_.size(); }

 private:
  void append_facets(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials, const First& first);
  void append_triangles(const SurfaceMesh& mesh, const First& first);
  void append_wedges(const SurfaceMesh& mesh, const First& first);
  void append_foliage(const SurfaceMesh& mesh, const First& first);
  void place_boxes(const SurfaceMesh& mesh, const First& first, bool present);
  void place_foliage(BodyId id, bool present);

  std::vector<First> first_;
  std::vector<WorldFacet> facets_;
  std::vector<WorldWedge> wedges_;
  std::vector<WedgeId> wedges_by_facet_;
  std::vector<std::uint32_t> first_wedge_of_facet_{0};  ///< one more entry than facets
  std::vector<Vec3> vertices_m_, hull_points_m_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<FacetId> facet_of_triangle_;
  std::vector<std::uint32_t> shell_of_triangle_;
  std::vector<Aabb<double>> boxes_;
  std::vector<FoliageShell> foliage_;  ///< by body, then shell
};

// ---------------------------------------------------------------------------------------------------------------------

inline void WorldGeometry::append(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials,
                                  const BodyState& state) {
  const BodyId id(first_.size());
  first_.push_back({static_cast<std::uint32_t>(vertices_m_.size()), static_cast<std::uint32_t>(triangles_.size()),
                    static_cast<std::uint32_t>(facets_.size()), static_cast<std::uint32_t>(hull_points_m_.size()),
                    static_cast<std::uint32_t>(wedges_.size())});
  append_facets(mesh, materials, first_.back());
  append_triangles(mesh, first_.back());
  append_wedges(mesh, first_.back());
  append_foliage(mesh, first_.back());
  vertices_m_.insert(vertices_m_.end(), mesh.vertices_m.begin(), mesh.vertices_m.end());
  hull_points_m_.insert(hull_points_m_.end(), mesh.hull_points_m.begin(), mesh.hull_points_m.end());
  place(id, mesh, state);
}

inline void WorldGeometry::append_facets(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials,
                                         const First& first) {
  const BodyId body(first_.size() - 1);
  for (const Facet& local : mesh.facets) {
    const SurfaceMaterial& material = materials[local.material];
    facets_.push_back({local.plane, material.id, body, first.triangle + local.first_triangle, local.triangle_count,
                       first.hull_point + local.first_hull_point, local.hull_point_count, material.transmits,
                       !material.is_foliage, material.scatters, material.is_foliage});
  }
}

inline void WorldGeometry::append_triangles(const SurfaceMesh& mesh, const First& first) {
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto& local = mesh.triangles[index];
    triangles_.push_back({first.vertex + local[0], first.vertex + local[1], first.vertex + local[2]});
    facet_of_triangle_.push_back(FacetId(first.facet + mesh.facet_of_triangle[index]));
    shell_of_triangle_.push_back(mesh.shell_of_triangle[index]);
  }
  boxes_.resize(triangles_.size());
}

inline void WorldGeometry::append_wedges(const SurfaceMesh& mesh, const First& first) {
  const BodyId body(first_.size() - 1);
  std::vector<std::vector<WedgeId>> of_facet(mesh.facets.size());
  for (const Wedge& local : mesh.wedges) {
    const WedgeId id(wedges_.size());
    const std::uint32_t one = local.facets[0], other = is_free(local) ? one : local.facets[1];
    wedges_.push_back({local, {FacetId(first.facet + one), FacetId(first.facet + other)}, body, true});
    of_facet[one].push_back(id);
    if (other != one) of_facet[other].push_back(id);
  }
  for (const std::vector<WedgeId>& ids : of_facet) {
    wedges_by_facet_.insert(wedges_by_facet_.end(), ids.begin(), ids.end());
    first_wedge_of_facet_.push_back(static_cast<std::uint32_t>(wedges_by_facet_.size()));
  }
}

inline void WorldGeometry::append_foliage(const SurfaceMesh& mesh, const First& first) {
  std::map<std::uint32_t, FoliageShell> shells;
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const WorldFacet& facet = facets_[first.facet + mesh.facet_of_triangle[index]];
    if (!facet.is_foliage) continue;
    FoliageShell& shell = shells[mesh.shell_of_triangle[index]];
    shell.body = facet.body;
    shell.material = facet.material;
    shell.triangles.push_back(first.triangle + index);
  }
  for (auto& [number, shell] : shells) foliage_.push_back(std::move(shell));
}

inline void WorldGeometry::place(BodyId id, const SurfaceMesh& mesh, const BodyState& state) {
  const First& first = first_[id.value];
  const Mat3 rotation = rotation_matrix(state.placement.pose);
  const auto to_world = [&](const Vec3& local) { return state.placement.pose.position_m + rotation * local; };
  const bool stands = id == BodyId{};  // the scenery's coordinates are the world's, to the last bit
  for (std::size_t index = 0; index < mesh.vertices_m.size() && !stands; ++index) {
    vertices_m_[first.vertex + index] = to_world(mesh.vertices_m[index]);
  }
  for (std::size_t index = 0; index < mesh.hull_points_m.size() && !stands; ++index) {
    hull_points_m_[first.hull_point + index] = to_world(mesh.hull_points_m[index]);
  }
  for (std::size_t index = 0; index < mesh.facets.size(); ++index) {
    WorldFacet& facet = facets_[first.facet + index];
    const Plane& local = mesh.facets[index].plane;
    if (!stands) facet.plane = {to_world(local.point_m), rotation * local.normal};
    facet.present = state.present && !facet.is_foliage;
  }
  for (std::size_t index = 0; index < mesh.wedges.size(); ++index) {
    WorldWedge& wedge = wedges_[first.wedge + index];
    const Wedge& local = mesh.wedges[index];
    if (!stands) {
      wedge.edge.start_m = to_world(local.start_m);
      wedge.edge.end_m = to_world(local.end_m);
      wedge.edge.tangent = rotation * local.tangent;
      wedge.edge.normal = rotation * local.normal;
    }
    const bool solid = !facets_[wedge.facets[0].value].is_foliage && !facets_[wedge.facets[1].value].is_foliage;
    wedge.present = state.present && solid;
  }
  place_boxes(mesh, first, state.present);
  place_foliage(id, state.present);
}

inline void WorldGeometry::place_boxes(const SurfaceMesh& mesh, const First& first, bool present) {
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto triangle = static_cast<std::uint32_t>(first.triangle + index);
    Aabb<double> box;
    if (present && !facets_[facet_of_triangle_[triangle].value].is_foliage) {
      for (const Vec3& corner : corners_m(triangle)) box.extend(corner);
    }
    boxes_[triangle] = box;
  }
}

inline void WorldGeometry::place_foliage(BodyId id, bool present) {
  for (FoliageShell& shell : foliage_) {
    if (shell.body != id) continue;
    shell.box = {};
    for (const std::uint32_t triangle : shell.triangles) {
      if (!present) break;
      for (const Vec3& corner : corners_m(triangle)) shell.box.extend(corner);
    }
  }
}

}  // namespace dcem
