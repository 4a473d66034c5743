#pragma once
/// The first half of the way from a triangle soup to surfaces: welded vertices, and triangles without defects in an
/// order of their own.
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/surfaces/welding.hpp"
#include "dcem/geometry/triangle_mesh.hpp"

namespace dcem {

/// A triangle of welded vertices, ascending: winding carries no meaning.
struct CleanTriangle {
  std::array<std::uint32_t, 3> vertices{};
  std::uint32_t material = 0;  ///< index into the sorted material names
  friend auto operator<=>(const CleanTriangle&, const CleanTriangle&) = default;
};

/// Triangles sorted by their vertices; each set of three vertices stands there once.
struct CleanMesh {
  std::vector<std::string> material_names;  ///< sorted
  std::vector<Vec3> vertices_m;             ///< in lexicographic order
  std::vector<CleanTriangle> triangles;
  std::vector<Vec3> normals;     ///< unit length, per triangle
  std::vector<double> areas_m2;  ///< per triangle
  SurfaceReport report;          ///< what was found so far

  const Vec3& corner_m(std::uint32_t triangle, std::size_t corner) const {
    return vertices_m[triangles[triangle].vertices[corner]];
  }
};

/// Welds vertices, drops triangles without area and repeated ones (the material whose name comes first stays).
/// Throws std::invalid_argument on a vertex that is not finite, or an index out of range.
CleanMesh clean_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline void check_mesh(const TriangleMesh& mesh) {
  if (mesh.vertices_m.size() >= std::numeric_limits<std::uint32_t>::max() / 4 ||
      mesh.triangles.size() >= std::numeric_limits<std::uint32_t>::max() / 4) {
    throw std::invalid_argument("mesh: more than 2^30 vertices or triangles");
  }
  for (std::size_t index = 0; index < mesh.vertices_m.size(); ++index) {
    const Vec3& vertex = mesh.vertices_m[index];
    if (!dcem::is_finite(vertex) || glm::length(vertex) > 1e9) {
      throw std::invalid_argument("mesh: vertex " + std::to_string(index) +
                                  " is not a finite point within 1e9 m of the origin");
    }
  }
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const TriangleMesh::Triangle& triangle = mesh.triangles[index];
    for (const std::uint32_t vertex : triangle.vertices) {
      if (vertex >= mesh.vertices_m.size()) {
        throw std::invalid_argument("mesh: triangle " + std::to_string(index) + " names a vertex that does not exist");
      }
    }
    if (triangle.material >= mesh.material_names.size()) {
      throw std::invalid_argument("mesh: triangle " + std::to_string(index) + " names a material that does not exist");
    }
  }
}

/// The vertices that triangles use, and for each vertex its place among them: one that no triangle uses welds nothing
/// together.
struct UsedVertices {
  std::vector<Vec3> vertices_m;
  std::vector<std::uint32_t> place;
};

inline UsedVertices used_vertices(const TriangleMesh& mesh) {
  constexpr std::uint32_t unused = ~std::uint32_t{0};
  UsedVertices used;
  used.place.resize(mesh.vertices_m.size(), unused);
  used.vertices_m.reserve(mesh.vertices_m.size());
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle.vertices) {
      if (used.place[vertex] != unused) continue;
      used.place[vertex] = static_cast<std::uint32_t>(used.vertices_m.size());
      used.vertices_m.push_back(mesh.vertices_m[vertex]);
    }
  }
  return used;
}

/// Sorted names without repetition, and for each name handed in its index there.
inline std::pair<std::vector<std::string>, std::vector<std::uint32_t>> sorted_names(
    const std::vector<std::string>& names) {
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<std::uint32_t> index;
  for (const std::string& name : names) {
    index.push_back(static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), name) - sorted.begin()));
  }
  return {std::move(sorted), std::move(index)};
}

/// A triangle has no area where its height over its longest side is below a thousandth of the weld tolerance.
inline bool has_area(const Vec3& a, const Vec3& b, const Vec3& c, double weld_tolerance_m) {
  const double longest_m = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const double twice_area_m2 = glm::length(glm::cross(b - a, c - a));
  return twice_area_m2 > longest_m * std::max(1e-3 * weld_tolerance_m, 1e-12 * longest_m);
}

inline void drop_repeated(CleanMesh& clean) {
  std::sort(clean.triangles.begin(), clean.triangles.end());
  const auto last =
      std::unique(clean.triangles.begin(), clean.triangles.end(),
                  [](const auto& first, const auto& second) { return first.vertices == second.vertices; });
  clean.report.triangles_repeated = static_cast<std::size_t>(clean.triangles.end() - last);
  clean.triangles.erase(last, clean.triangles.end());
}

inline void compute_normals(CleanMesh& clean) {
  clean.areas_m2.reserve(clean.triangles.size());
  clean.normals.reserve(clean.triangles.size());
  for (std::uint32_t triangle = 0; triangle < clean.triangles.size(); ++triangle) {
    const Vec3 &a = clean.corner_m(triangle, 0), &b = clean.corner_m(triangle, 1), &c = clean.corner_m(triangle, 2);
    const Vec3 scaled = glm::cross(b - a, c - a);
    clean.areas_m2.push_back(0.5 * glm::length(scaled));
    clean.normals.push_back(glm::normalize(scaled));
  }
}

}  // namespace detail

inline CleanMesh clean_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings) {
  detail::check_mesh(mesh);
  CleanMesh clean;
  std::vector<std::uint32_t> material;
  std::tie(clean.material_names, material) = detail::sorted_names(mesh.material_names);
  const detail::UsedVertices used = detail::used_vertices(mesh);
  WeldedVertices welded = weld(used.vertices_m, settings.weld_tolerance_m);
  clean.vertices_m = std::move(welded.vertices_m);
  clean.report.vertices_read = mesh.vertices_m.size();
  clean.report.vertices_welded = used.vertices_m.size() - clean.vertices_m.size();
  clean.report.triangles_read = mesh.triangles.size();
  clean.triangles.reserve(mesh.triangles.size());
  for (const TriangleMesh::Triangle& read : mesh.triangles) {
    CleanTriangle triangle{{}, material[read.material]};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangle.vertices[corner] = welded.new_index[used.place[read.vertices[corner]]];
    }
    std::sort(triangle.vertices.begin(), triangle.vertices.end());
    const auto& [a, b, c] = triangle.vertices;
    if (detail::has_area(clean.vertices_m[a], clean.vertices_m[b], clean.vertices_m[c], settings.weld_tolerance_m)) {
      clean.triangles.push_back(triangle);
    } else {
      ++clean.report.triangles_without_area;
    }
  }
  detail::drop_repeated(clean);
  detail::compute_normals(clean);
  return clean;
}

}  // namespace dcem
