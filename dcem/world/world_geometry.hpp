#pragma once
/// All bodies' vertices, triangles and facets in common arrays, body after body, in world coordinates of the current
/// frame: a facet id or a triangle index names one thing for as long as the scene lives.
#include <array>
#include <cstdint>
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
  WorldGeometry();
  WorldGeometry(const WorldGeometry&);
  WorldGeometry(WorldGeometry&&) noexcept;
  WorldGeometry& operator=(const WorldGeometry&);
  WorldGeometry& operator=(WorldGeometry&&) noexcept;
  ~WorldGeometry();

  /// Appends a body in a state; bodies are numbered in the order in which they come.
  void append(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials, const BodyState& state);
  /// Moves a body to a state, from its local coordinates: a pose that comes back brings back the same bits.
  void place(BodyId id, const SurfaceMesh& mesh, const BodyState& state);
  /// Takes all bodies out.
  void clear();

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
  /// Whether any facet, there or not, lets anything pass.
  bool has_sheets() const { return has_sheets_; }

  /// Where a body's parts begin in the common arrays.
  struct First {
    std::uint32_t vertex = 0, triangle = 0, facet = 0, hull_point = 0, wedge = 0;
  };
  const First& first(BodyId id) const { return first_[id.value]; }
  std::size_t body_count() const { return first_.size(); }

 private:
  void make_room(const SurfaceMesh& mesh);
  void append_facets(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials, const First& first);
  void append_triangles(const SurfaceMesh& mesh, const First& first);
  void append_wedges(const SurfaceMesh& mesh, const First& first);
  void list_wedges_by_facet(const First& first);
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
  bool has_sheets_ = false;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/world/world_geometry_bodies.hpp"
#endif
