#pragma once
/// Triangles as a file or a program hands them over: nothing welded, nothing checked, any order.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem {

struct TriangleMesh {
  struct Triangle {
    std::array<std::uint32_t, 3> vertices{};  ///< indices into `vertices_m`
    std::uint32_t material = 0;               ///< index into `material_names`
  };

  std::vector<Vec3> vertices_m;
  std::vector<Triangle> triangles;
  std::vector<std::string> material_names;
};

/// Index of a material name in a mesh; the name is added when it is new.
inline std::uint32_t material_index(TriangleMesh& mesh, const std::string& name) {
  for (std::uint32_t index = 0; index < mesh.material_names.size(); ++index) {
    if (mesh.material_names[index] == name) return index;
  }
  mesh.material_names.push_back(name);
  return static_cast<std::uint32_t>(mesh.material_names.size() - 1);
}

/// Adds the quadrilateral a, b, c, d (in order around it) as two triangles.
inline void add_quad(TriangleMesh& mesh, const std::array<Vec3, 4>& corners_m, const std::string& material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), corners_m.begin(), corners_m.end());
  const std::uint32_t index = material_index(mesh, material);
  mesh.triangles.push_back({{first, first + 1, first + 2}, index});
  mesh.triangles.push_back({{first, first + 2, first + 3}, index});
}

/// A closed box of the given size (along x, y, z; metres) that stands on z = 0 with its centre over the origin: six
/// faces, the bottom included.
inline TriangleMesh make_box(const Vec3& size_m, const std::string& material) {
  const double x = size_m.x / 2, y = size_m.y / 2, z = size_m.z;
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-x, -y, 0), Vec3(-x, y, 0), Vec3(x, y, 0), Vec3(x, -y, 0)}, material);
  add_quad(mesh, {Vec3(-x, -y, z), Vec3(x, -y, z), Vec3(x, y, z), Vec3(-x, y, z)}, material);
  add_quad(mesh, {Vec3(-x, -y, 0), Vec3(x, -y, 0), Vec3(x, -y, z), Vec3(-x, -y, z)}, material);
  add_quad(mesh, {Vec3(-x, y, 0), Vec3(-x, y, z), Vec3(x, y, z), Vec3(x, y, 0)}, material);
  add_quad(mesh, {Vec3(-x, -y, 0), Vec3(-x, -y, z), Vec3(-x, y, z), Vec3(-x, y, 0)}, material);
  add_quad(mesh, {Vec3(x, -y, 0), Vec3(x, y, 0), Vec3(x, y, z), Vec3(x, -y, z)}, material);
  return mesh;
}

}  // namespace dcem
