#pragma once
/// What the engine sees in an OBJ file: surfaces, materials and defects. The answer of `dcem inspect`.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dcem/em/surface/material.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/surfaces/surface_settings.hpp"
#include "dcem/io/obj_reader.hpp"

namespace dcem::io {

struct InspectionSettings {
  ObjSettings obj;
  SurfaceSettings surfaces;
  /// Materials are evaluated here, Hz; absent: not at all.
  std::optional<double> frequency_hz;
  /// Edges between two facets count from this exterior angle on.
  double min_exterior_angle_deg = 190.0;
};

/// A material that triangles use.
struct InspectedMaterial {
  /// At the frequency of the settings, at normal incidence.
  struct Response {
    std::optional<double> relative_permittivity;  ///< ε', of dielectrics
    std::optional<double> conductivity_s_per_m;   ///< σ, of dielectrics
    double reflection_loss_db = 0.0;              ///< −20·log10|R|
    std::optional<double> penetration_loss_db;    ///< −20·log10|T|; absent where nothing passes
    bool extrapolated = false;                    ///< outside the frequencies of the ITU table
  };

  std::string name;
  std::size_t facets = 0;
  std::size_t triangles = 0;
  double area_m2 = 0.0;
  std::optional<Material> material;  ///< absent: neither `em_*` keys nor an `itu_*` name define it
  std::optional<Response> response;
};

struct InspectedFacet {
  std::string material;
  double area_m2 = 0.0;
  std::size_t triangles = 0;
  Plane plane;
};

/// Edges that can diffract: straight, each as long as its facets go on.
struct InspectedWedges {
  double min_exterior_angle_deg = 0.0;  ///< of the settings
  std::size_t wedges = 0;               ///< between two facets, from that angle on
  double wedge_length_m = 0.0;
  std::size_t free_edges = 0;  ///< rims of open sheets
  double free_edge_length_m = 0.0;
};

struct Inspection {
  std::string file;
  std::size_t triangles = 0;  ///< that are left after mending
  std::size_t facets = 0;
  InspectedWedges wedges;
  Aabb<double> box;
  SurfaceReport report;
  /// Pairs of facets that lie on top of each other over more than a sliver.
  std::size_t overlapping_facet_pairs = 0;
  std::vector<InspectedMaterial> materials;    ///< by name
  std::vector<InspectedFacet> largest_facets;  ///< at most ten, by area
  std::vector<std::string> warnings;           ///< of the reader, and what looks odd about size and orientation
};

/// Reads and mends the file. Materials without a definition are reported, not refused. O(n log n) in triangles, apart
/// from the pairs that do overlap. Throws `InputError` as `read_obj` and `material_from_mtl` do.
Inspection inspect_obj(const std::filesystem::path& file, const InspectionSettings& settings = {});

/// Pairs of facets of a mesh that lie on top of each other: two of their triangles are parallel to within 0.1°, at most
/// five planarity tolerances apart wherever they overlap (as far as a facet itself may stray from its plane), and
/// overlap over a width of more than about ten weld tolerances.
std::size_t overlapping_facet_pairs(const SurfaceMesh& mesh, const SurfaceSettings& settings);

/// As JSON (an object, indented) and as a table for the console.
std::string inspection_json(const Inspection& inspection);
std::string inspection_table(const Inspection& inspection);

}  // namespace dcem::io
