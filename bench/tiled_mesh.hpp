#pragma once
/// A scene larger than the files at hand: copies of one side by side.
#include <array>
#include <cstdint>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle_mesh.hpp"

namespace dcem::bench {

/// N × N copies side by side.
inline TriangleMesh tiled(const TriangleMesh& mesh, int copies) {
  Aabb<double> bounds;
  for (const Vec3& vertex : mesh.vertices_m) bounds.extend(vertex);
  TriangleMesh result = mesh;
  result.vertices_m.clear();
  result.triangles.clear();
  for (int copy = 0; copy < copies * copies; ++copy) {
    const Vec3 shift_m(bounds.extent().x * (copy % copies), bounds.extent().y * (copy / copies), 0.0);
    const auto first = static_cast<std::uint32_t>(result.vertices_m.size());
    for (const Vec3& vertex : mesh.vertices_m) result.vertices_m.push_back(vertex + shift_m);
    for (auto triangle : mesh.triangles) {
      for (std::uint32_t& vertex : triangle.vertices) vertex += first;
      result.triangles.push_back(triangle);
    }
  }
  return result;
}

}  // namespace dcem::bench
