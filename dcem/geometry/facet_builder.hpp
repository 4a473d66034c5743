#pragma once
/// From a triangle soup to facets.
///
/// 1. Weld vertices. 2. Drop triangles without area, then repeated ones. 3. Find triangles that share an edge. 4. Join
/// those of one material that are coplanar. 5. Fit each set's plane; a set that bends too far falls back to its
/// triangles.
/// 6. Lay everything out facet by facet. Cost: O(n log n) in the number of triangles.
///
/// Source of the rules: `CONVENTIONS.md`, section "Facets".
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/geometry/convex_hull.hpp"
#include "dcem/geometry/surface_mesh.hpp"
#include "dcem/geometry/welding.hpp"

namespace dcem {

/// Builds the surfaces of a mesh. Throws std::invalid_argument on a vertex that is not finite, or an index out of
/// range.
SurfaceMesh build_surface_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings = {});

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Normals of one facet differ by less than this from triangle to triangle.
inline const double coplanar_cosine = std::cos(degrees_to_radians(0.1));

/// A coplanar set may stray this many planarity tolerances from its mean plane before it falls back to its triangles.
inline constexpr double stray_tolerances = 5.0;

inline void check_mesh(const TriangleMesh& mesh) {
  if (mesh.vertices_m.size() >= std::numeric_limits<std::uint32_t>::max() / 4 ||
      mesh.triangles.size() >= std::numeric_limits<std::uint32_t>::max() / 4) {
    throw std::invalid_argument("mesh: more than 2^30 vertices or triangles");
  }
  for (std::size_t index = 0; index < mesh.vertices_m.size(); ++index) {
    const Vec3& vertex = mesh.vertices_m[index];
    if (!is_finite(vertex) || glm::length(vertex) > 1e9) {
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

/// Works on triangles with welded vertices, sorted by vertices and material.
class FacetBuilder {
 public:
  FacetBuilder(const TriangleMesh& mesh, const SurfaceSettings& settings) : settings_(settings) {
    surface_.report.vertices_read = mesh.vertices_m.size();
    surface_.report.triangles_read = mesh.triangles.size();
    sort_material_names(mesh);
    weld_triangles(mesh);
    drop_repeated();
    compute_normals();
    collect_edges();
    join_coplanar();
    number_closed_shells();
  }

  SurfaceMesh build() {
    std::vector<std::vector<std::uint32_t>> sets(triangles_.size());
    for (std::uint32_t triangle = 0; triangle < triangles_.size(); ++triangle) {
      sets[coplanar_.smallest(triangle)].push_back(triangle);
    }
    for (const std::vector<std::uint32_t>& set : sets) {
      if (!set.empty()) add_set(set);
    }
    return std::move(surface_);
  }

 private:
  struct WeldedTriangle {
    std::array<std::uint32_t, 3> vertices;  // ascending: winding carries no meaning here
    std::uint32_t material;
    friend auto operator<=>(const WeldedTriangle&, const WeldedTriangle&) = default;
  };
  struct Edge {
    std::uint32_t a, b, triangle;
    bool same_place(const Edge& other) const { return a == other.a && b == other.b; }
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };

  void sort_material_names(const TriangleMesh& mesh) {
    surface_.material_names = mesh.material_names;
    std::sort(surface_.material_names.begin(), surface_.material_names.end());
    surface_.material_names.erase(std::unique(surface_.material_names.begin(), surface_.material_names.end()),
                                  surface_.material_names.end());
  }

  std::uint32_t sorted_material(const std::string& name) const {
    const auto found = std::lower_bound(surface_.material_names.begin(), surface_.material_names.end(), name);
    return static_cast<std::uint32_t>(found - surface_.material_names.begin());
  }

  void weld_triangles(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> new_material;
    for (const std::string& name : mesh.material_names) new_material.push_back(sorted_material(name));
    const WeldedVertices welded = weld(used_vertices(mesh), settings_.weld_tolerance_m);
    surface_.vertices_m = welded.vertices_m;
    for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
      WeldedTriangle triangle{
          {welded.new_index[3 * index], welded.new_index[3 * index + 1], welded.new_index[3 * index + 2]},
          new_material[mesh.triangles[index].material]};
      std::sort(triangle.vertices.begin(), triangle.vertices.end());
      if (has_area(triangle)) {
        triangles_.push_back(triangle);
      } else {
        ++surface_.report.triangles_without_area;
      }
    }
    surface_.report.vertices_welded = distinct_count(mesh) - welded.vertices_m.size();
  }

  /// The corners of all triangles: vertices that no triangle uses weld nothing together.
  static std::vector<Vec3> used_vertices(const TriangleMesh& mesh) {
    std::vector<Vec3> corners_m;
    corners_m.reserve(3 * mesh.triangles.size());
    for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle.vertices) corners_m.push_back(mesh.vertices_m[vertex]);
    }
    return corners_m;
  }

  static std::size_t distinct_count(const TriangleMesh& mesh) {
    std::vector<char> used(mesh.vertices_m.size(), 0);
    for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle.vertices) used[vertex] = 1;
    }
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), char{1}));
  }

  /// A triangle has no area where its height over its longest side is below a thousandth of the weld tolerance.
  bool has_area(const WeldedTriangle& triangle) const {
    const Vec3 &a = vertex(triangle, 0), &b = vertex(triangle, 1), &c = vertex(triangle, 2);
    const double longest_m = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const double twice_area_m2 = glm::length(glm::cross(b - a, c - a));
    return twice_area_m2 > longest_m * std::max(1e-3 * settings_.weld_tolerance_m, 1e-12 * longest_m);
  }

  const Vec3& vertex(const WeldedTriangle& triangle, std::size_t corner) const {
    return surface_.vertices_m[triangle.vertices[corner]];
  }

  void drop_repeated() {
    std::sort(triangles_.begin(), triangles_.end());
    const auto last = std::unique(triangles_.begin(), triangles_.end(), [](const auto& first, const auto& second) {
      return first.vertices == second.vertices;  // the material whose name comes first stays
    });
    surface_.report.triangles_repeated = static_cast<std::size_t>(triangles_.end() - last);
    triangles_.erase(last, triangles_.end());
  }

  void compute_normals() {
    for (const WeldedTriangle& triangle : triangles_) {
      const Vec3 &a = vertex(triangle, 0), &b = vertex(triangle, 1), &c = vertex(triangle, 2);
      const Vec3 scaled = glm::cross(b - a, c - a);
      areas_m2_.push_back(0.5 * glm::length(scaled));
      normals_.push_back(glm::normalize(scaled));
    }
  }

  void collect_edges() {
    for (std::uint32_t index = 0; index < triangles_.size(); ++index) {
      const auto& v = triangles_[index].vertices;
      edges_.insert(edges_.end(), {Edge{v[0], v[1], index}, Edge{v[0], v[2], index}, Edge{v[1], v[2], index}});
    }
    std::sort(edges_.begin(), edges_.end());
  }

  /// Calls `visit(first, last)` for each run of edges at one place.
  template <typename Visit>
  void for_each_edge(Visit&& visit) const {
    for (auto first = edges_.begin(); first != edges_.end();) {
      auto last = first;
      while (last != edges_.end() && last->same_place(*first)) ++last;
      visit(first, last);
      first = last;
    }
  }

  void join_coplanar() {
    coplanar_ = DisjointSets(triangles_.size());
    for_each_edge([&](auto first, auto last) {
      surface_.report.open_edges += last - first == 1;
      surface_.report.crowded_edges += last - first > 2;
      for (auto one = first; one != last; ++one) {
        for (auto other = one + 1; other != last; ++other) {
          if (coplanar(one->triangle, other->triangle)) coplanar_.join(one->triangle, other->triangle);
        }
      }
    });
  }

  bool coplanar(std::uint32_t one, std::uint32_t other) const {
    return triangles_[one].material == triangles_[other].material &&
           std::abs(glm::dot(normals_[one], normals_[other])) > coplanar_cosine &&
           stray_m(one, triangles_[other]) <= settings_.planarity_tolerance_m &&
           stray_m(other, triangles_[one]) <= settings_.planarity_tolerance_m;
  }

  /// How far the corners of `triangle` lie from the plane of triangle `base`; shared corners lie on it.
  double stray_m(std::uint32_t base, const WeldedTriangle& triangle) const {
    const Plane plane{vertex(triangles_[base], 0), normals_[base]};
    double largest_m = 0.0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      largest_m = std::max(largest_m, std::abs(signed_distance_m(plane, vertex(triangle, corner))));
    }
    return largest_m;
  }

  void number_closed_shells() {
    DisjointSets shells(triangles_.size());
    std::vector<char> leaky(triangles_.size(), 0);
    for_each_edge([&](auto first, auto last) {
      for (auto edge = first; edge != last; ++edge) {
        shells.join(first->triangle, edge->triangle);
        if (last - first != 2) leaky[edge->triangle] = 1;
      }
    });
    std::vector<char> shell_leaks(triangles_.size(), 0);
    for (std::uint32_t index = 0; index < triangles_.size(); ++index) {
      if (leaky[index]) shell_leaks[shells.smallest(index)] = 1;
    }
    shell_.resize(triangles_.size(), 0);
    for (std::uint32_t index = 0; index < triangles_.size(); ++index) {
      const std::uint32_t first = shells.smallest(index);
      if (shell_leaks[first]) continue;
      shell_[index] = first == index ? static_cast<std::uint32_t>(++surface_.report.closed_shells) : shell_[first];
    }
  }

  void add_set(const std::vector<std::uint32_t>& set) {
    const Plane plane = mean_plane(set);
    const double limit_m = stray_tolerances * settings_.planarity_tolerance_m;
    if (set.size() == 1 || largest_stray_m(plane, set) <= limit_m) {
      add_facet(plane, set);
      return;
    }
    ++surface_.report.uneven_sets;
    for (const std::uint32_t triangle : set) add_facet(mean_plane({triangle}), {triangle});
  }

  Plane mean_plane(const std::vector<std::uint32_t>& set) const {
    if (set.size() == 1) return {centroid_m(set.front()), normals_[set.front()]};
    const std::uint32_t largest = *std::max_element(
        set.begin(), set.end(), [&](std::uint32_t a, std::uint32_t b) { return areas_m2_[a] < areas_m2_[b]; });
    Vec3 normal(0.0), centre(0.0);
    double area_m2 = 0.0;
    for (const std::uint32_t triangle : set) {
      const double side = glm::dot(normals_[triangle], normals_[largest]) < 0.0 ? -1.0 : 1.0;
      normal += side * areas_m2_[triangle] * normals_[triangle];
      centre += areas_m2_[triangle] * (centroid_m(triangle) - centroid_m(largest));
      area_m2 += areas_m2_[triangle];
    }
    return {centroid_m(largest) + centre / area_m2, glm::normalize(normal)};
  }

  Vec3 centroid_m(std::uint32_t triangle) const {
    const WeldedTriangle& corners = triangles_[triangle];
    return vertex(corners, 0) +
           ((vertex(corners, 1) - vertex(corners, 0)) + (vertex(corners, 2) - vertex(corners, 0))) / 3.0;
  }

  double largest_stray_m(const Plane& plane, const std::vector<std::uint32_t>& set) const {
    double largest_m = 0.0;
    for (const std::uint32_t triangle : set) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        largest_m = std::max(largest_m, std::abs(signed_distance_m(plane, vertex(triangles_[triangle], corner))));
      }
    }
    return largest_m;
  }

  void add_facet(const Plane& plane, const std::vector<std::uint32_t>& set) {
    Facet facet{plane, triangles_[set.front()].material};
    facet.first_triangle = static_cast<std::uint32_t>(surface_.triangles.size());
    facet.triangle_count = static_cast<std::uint32_t>(set.size());
    std::vector<Vec3> corners_m;
    for (const std::uint32_t triangle : set) {
      surface_.triangles.push_back(triangles_[triangle].vertices);
      surface_.facet_of_triangle.push_back(static_cast<std::uint32_t>(surface_.facets.size()));
      surface_.shell_of_triangle.push_back(shell_[triangle]);
      for (std::size_t corner = 0; corner < 3; ++corner) corners_m.push_back(vertex(triangles_[triangle], corner));
    }
    const std::vector<Vec3> hull_m = convex_hull_on_plane(plane, corners_m);
    facet.first_hull_point = static_cast<std::uint32_t>(surface_.hull_points_m.size());
    facet.hull_point_count = static_cast<std::uint32_t>(hull_m.size());
    surface_.hull_points_m.insert(surface_.hull_points_m.end(), hull_m.begin(), hull_m.end());
    surface_.facets.push_back(facet);
  }

  SurfaceSettings settings_;
  SurfaceMesh surface_;
  std::vector<WeldedTriangle> triangles_;
  std::vector<Vec3> normals_;
  std::vector<double> areas_m2_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> shell_;
  DisjointSets coplanar_{0};
};

}  // namespace detail

inline SurfaceMesh build_surface_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings) {
  detail::check_mesh(mesh);
  return detail::FacetBuilder(mesh, settings).build();
}

}  // namespace dcem
