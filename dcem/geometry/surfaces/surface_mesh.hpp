#pragma once
/// A mesh as propagation sees it: welded vertices, triangles without defects, and facets.
///
/// A facet is a maximal connected set of coplanar triangles of one material, so one wall is one mirror however it was
/// triangulated. Everything here is in an order that depends on the geometry and the material names alone, never on the
/// order in which the file lists its triangles.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/surfaces/surface_settings.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

/// A planar patch. Its triangles and the corners of its convex hull are contiguous ranges of the mesh's arrays.
struct Facet {
  Plane plane;                 ///< area-weighted mean of its triangles' planes
  std::uint32_t material = 0;  ///< index into `SurfaceMesh::material_names`
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_hull_point = 0, hull_point_count = 0;
};

/// What was found and mended while the mesh was built; every number is a count.
struct SurfaceReport {
  std::size_t vertices_read = 0;
  std::size_t vertices_welded = 0;  ///< vertices of triangles that disappeared into another one
  std::size_t triangles_read = 0;
  std::size_t triangles_without_area = 0;  ///< dropped
  std::size_t triangles_repeated = 0;      ///< dropped: the same three welded vertices as another triangle
  std::size_t open_edges = 0;              ///< edges of one triangle only
  std::size_t crowded_edges = 0;           ///< edges of more than two triangles
  std::size_t uneven_sets = 0;             ///< coplanar sets that bend too far and fell back to their triangles
  std::size_t closed_shells = 0;           ///< connected sets of triangles without an open or crowded edge
  std::size_t standing_shells = 0;         ///< the same but for open edges at their foot: houses without a floor
  std::size_t wedges = 0;                  ///< straight edges between two facets, of any angle
  std::size_t free_edges = 0;              ///< straight pieces of rims
};

struct SurfaceMesh {
  std::vector<std::string> material_names;  ///< sorted
  std::vector<Vec3> vertices_m;             ///< in lexicographic order
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> facet_of_triangle;
  /// Which enclosing shell a triangle belongs to, counted from 1; 0 where its connected set has crowded edges, or open
  /// ones elsewhere than at its foot.
  std::vector<std::uint32_t> shell_of_triangle;
  std::vector<double> shell_foot_m;  ///< lowest z of each enclosing shell; entry 0 is shell 1
  std::vector<bool> shell_stands;    ///< whether it is open at its foot; otherwise it is closed all around
  std::vector<Facet> facets;
  std::vector<Vec3> hull_points_m;  ///< corners of each facet's convex hull, on its plane, in order around it
  std::vector<Wedge> wedges;        ///< where two facets meet, then the free edges
  SurfaceReport report;
};

}  // namespace dcem
