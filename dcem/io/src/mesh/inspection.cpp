#include "dcem/io/inspection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/checks/mesh_doubts.hpp"

namespace dcem::io {
namespace {

constexpr std::size_t largest_facet_count = 10;

double area_m2(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vec3& first = mesh.vertices_m[triangle[0]];
  return 0.5 * glm::length(glm::cross(mesh.vertices_m[triangle[1]] - first, mesh.vertices_m[triangle[2]] - first));
}

double area_m2(const SurfaceMesh& mesh, const Facet& facet) {
  double sum_m2 = 0.0;
  for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
    sum_m2 += area_m2(mesh, mesh.triangles[facet.first_triangle + index]);
  }
  return sum_m2;
}

InspectedMaterial::Response response_of(const Material& material, double frequency_hz) {
  const MaterialTable table({material}, frequency_hz, {.revision = 3, .allow_extrapolation = true});
  const SurfaceResponse at_normal = table.response(MaterialId{}, 1.0);
  InspectedMaterial::Response response;
  response.reflection_loss_db = -amplitude_ratio_to_db(std::abs(at_normal.reflection.te));
  const double passing = std::abs(at_normal.transmission.te);
  if (passing > 0.0) response.penetration_loss_db = -amplitude_ratio_to_db(passing);
  if (const std::optional<Complex> permittivity = table.permittivity(MaterialId{})) {
    response.relative_permittivity = permittivity->real();
    response.conductivity_s_per_m = -permittivity->imag() * 2.0 * pi * frequency_hz * vacuum_permittivity_f_per_m;
  }
  response.extrapolated = !table.extrapolated().empty();
  return response;
}

std::vector<InspectedMaterial> inspect_materials(const ObjFile& obj, const SurfaceMesh& mesh,
                                                 std::optional<double> frequency_hz) {
  std::vector<InspectedMaterial> materials(mesh.material_names.size());
  for (std::size_t index = 0; index < materials.size(); ++index) {
    InspectedMaterial& entry = materials[index];
    entry.name = mesh.material_names[index];
    const auto mtl = obj.materials.find(entry.name);
    entry.material = material_from_mtl(entry.name, mtl == obj.materials.end() ? nullptr : &mtl->second);
    if (entry.material && frequency_hz) entry.response = response_of(*entry.material, *frequency_hz);
  }
  for (const Facet& facet : mesh.facets) {
    InspectedMaterial& entry = materials[facet.material];
    ++entry.facets;
    entry.triangles += facet.triangle_count;
    entry.area_m2 += area_m2(mesh, facet);
  }
  std::erase_if(materials, [](const InspectedMaterial& entry) { return entry.facets == 0; });
  return materials;
}

std::vector<InspectedFacet> largest_facets(const SurfaceMesh& mesh) {
  std::vector<InspectedFacet> facets;
  for (const Facet& facet : mesh.facets) {
    facets.push_back({mesh.material_names[facet.material], area_m2(mesh, facet), facet.triangle_count, facet.plane});
  }
  std::stable_sort(facets.begin(), facets.end(), [](const auto& a, const auto& b) { return a.area_m2 > b.area_m2; });
  if (facets.size() > largest_facet_count) facets.resize(largest_facet_count);
  return facets;
}

InspectedWedges inspect_wedges(const SurfaceMesh& mesh, double min_exterior_angle_deg) {
  InspectedWedges result;
  result.min_exterior_angle_deg = min_exterior_angle_deg;
  for (const Wedge& wedge : mesh.wedges) {
    if (is_free(wedge)) {
      ++result.free_edges;
      result.free_edge_length_m += edge_length_m(wedge);
    } else if (wedge.exterior_angle_rad >= degrees_to_radians(min_exterior_angle_deg)) {
      ++result.wedges;
      result.wedge_length_m += edge_length_m(wedge);
    }
  }
  return result;
}

SurfaceMesh mended(const TriangleMesh& mesh, const std::string& file, const SurfaceSettings& settings) {
  try {
    return build_surface_mesh(mesh, settings);
  } catch (const std::invalid_argument& error) {
    throw InputError(file, error.what());
  }
}

}  // namespace

Inspection inspect_obj(const std::filesystem::path& file, const InspectionSettings& settings) {
  const ObjFile obj = read_obj(file, settings.obj);
  const SurfaceMesh mesh = mended(obj.mesh, file.string(), settings.surfaces);
  Inspection inspection;
  inspection.file = file.string();
  inspection.triangles = mesh.triangles.size();
  inspection.facets = mesh.facets.size();
  inspection.wedges = inspect_wedges(mesh, settings.min_exterior_angle_deg);
  for (const Vec3& vertex : mesh.vertices_m) inspection.box.extend(vertex);
  inspection.report = mesh.report;
  inspection.overlapping_facet_pairs = overlapping_facet_pairs(mesh, settings.surfaces);
  inspection.materials = inspect_materials(obj, mesh, settings.frequency_hz);
  inspection.largest_facets = largest_facets(mesh);
  inspection.warnings = obj.warnings;
  for (const std::string& doubt : mesh_doubts(obj.mesh))
    inspection.warnings.push_back(file.string() + ": the mesh " + doubt);
  return inspection;
}

}  // namespace dcem::io
