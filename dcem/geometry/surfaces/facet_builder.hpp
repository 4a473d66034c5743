#pragma once
/// From a triangle soup to facets.
///
/// 1. Weld vertices. 2. Drop triangles without area, then repeated ones. 3. Find triangles that share an edge. 4. Join
/// those of one material that are coplanar. 5. Fit each set's plane; a set that bends too far falls back to its
/// triangles.
/// 6. Lay everything out facet by facet. 7. Collect the diffracting edges (`wedge_builder.hpp`). Cost: O(n log n) in
/// the number of triangles.
///
/// Source of the rules: `CONVENTIONS.md`, section "Facets".
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "dcem/geometry/surfaces/convex_hull.hpp"
#include "dcem/geometry/surfaces/disjoint_sets.hpp"
#include "dcem/geometry/surfaces/mesh_cleaning.hpp"
#include "dcem/geometry/surfaces/mesh_edges.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/surfaces/wedge_builder.hpp"

namespace dcem {

namespace detail {

/// Steps 3 to 6, on a clean mesh.
class FacetBuilder {
 public:
  FacetBuilder(CleanMesh mesh, const SurfaceSettings& settings)
      : mesh_(std::move(mesh)), settings_(settings), coplanar_(mesh_.triangles.size()) {
    const MeshEdges edges(mesh_);
    join_coplanar(edges);
    shells_ = enclosing_shells(mesh_, edges, settings_.weld_tolerance_m);
    surface_.shell_foot_m = shells_.foot_m;
    surface_.shell_stands = shells_.stands;
    surface_.report = mesh_.report;
    surface_.report.open_edges = open_edges_;
    surface_.report.crowded_edges = crowded_edges_;
    surface_.report.closed_shells = shells_.closed;
    surface_.report.standing_shells = shells_.standing;
  }

  SurfaceMesh build() {
    reserve();
    const std::vector<std::uint32_t> by_set = triangles_by_set();
    for (auto first = by_set.begin(); first != by_set.end();) {
      const std::uint32_t set = coplanar_.smallest(*first);
      const auto last =
          std::find_if(first, by_set.end(), [&](std::uint32_t other) { return coplanar_.smallest(other) != set; });
      add_set({first, last});
      first = last;
    }
    surface_.material_names = std::move(mesh_.material_names);
    surface_.vertices_m = std::move(mesh_.vertices_m);
    return std::move(surface_);
  }

 private:
  using Triangles = std::span<const std::uint32_t>;

  void reserve() {
    surface_.triangles.reserve(mesh_.triangles.size());
    surface_.facet_of_triangle.reserve(mesh_.triangles.size());
    surface_.shell_of_triangle.reserve(mesh_.triangles.size());
    // As many as there can be: what is not used of a large list takes no memory.
    surface_.facets.reserve(mesh_.triangles.size());
    surface_.hull_points_m.reserve(3 * mesh_.triangles.size());
  }

  /// The triangles, set by set: sets in the order of their first triangles, which stand first in them.
  std::vector<std::uint32_t> triangles_by_set() {
    std::vector<std::uint32_t> begins(mesh_.triangles.size(), 0), by_set(mesh_.triangles.size());
    for (std::uint32_t triangle = 0; triangle < by_set.size(); ++triangle) ++begins[coplanar_.smallest(triangle)];
    std::exclusive_scan(begins.begin(), begins.end(), begins.begin(), 0U);
    for (std::uint32_t triangle = 0; triangle < by_set.size(); ++triangle) {
      by_set[begins[coplanar_.smallest(triangle)]++] = triangle;
    }
    return by_set;
  }

  void join_coplanar(const MeshEdges& edges) {
    edges.for_each_place([&](auto first, auto last) {
      open_edges_ += last - first == 1;
      crowded_edges_ += last - first > 2;
      for (auto one = first; one != last; ++one) {
        for (auto other = one + 1; other != last; ++other) {
          if (coplanar(one->triangle, other->triangle)) coplanar_.join(one->triangle, other->triangle);
        }
      }
    });
  }

  bool coplanar(std::uint32_t one, std::uint32_t other) const {
    return mesh_.triangles[one].material == mesh_.triangles[other].material &&
           std::abs(glm::dot(mesh_.normals[one], mesh_.normals[other])) > coplanar_cosine &&
           largest_stray_m({mesh_.corner_m(one, 0), mesh_.normals[one]}, Triangles(&other, 1)) <=
               settings_.planarity_tolerance_m &&
           largest_stray_m({mesh_.corner_m(other, 0), mesh_.normals[other]}, Triangles(&one, 1)) <=
               settings_.planarity_tolerance_m;
  }

  void add_set(Triangles set) {
    const Plane plane = mean_plane(set);
    const double limit_m = stray_tolerances * settings_.planarity_tolerance_m;
    if (set.size() == 1 || largest_stray_m(plane, set) <= limit_m) {
      add_facet(plane, set);
      return;
    }
    ++surface_.report.uneven_sets;
    for (const std::uint32_t& triangle : set) add_facet(mean_plane({&triangle, 1}), {&triangle, 1});
  }

  Plane mean_plane(Triangles set) const {
    if (set.size() == 1) return {centroid_m(set.front()), mesh_.normals[set.front()]};
    const std::uint32_t largest = *std::max_element(set.begin(), set.end(), [&](std::uint32_t a, std::uint32_t b) {
      return mesh_.areas_m2[a] < mesh_.areas_m2[b];
    });
    Vec3 normal(0.0), centre(0.0);
    double area_m2 = 0.0;
    for (const std::uint32_t triangle : set) {
      const double side = glm::dot(mesh_.normals[triangle], mesh_.normals[largest]) < 0.0 ? -1.0 : 1.0;
      normal += side * mesh_.areas_m2[triangle] * mesh_.normals[triangle];
      centre += mesh_.areas_m2[triangle] * (centroid_m(triangle) - centroid_m(largest));
      area_m2 += mesh_.areas_m2[triangle];
    }
    return {centroid_m(largest) + centre / area_m2, glm::normalize(normal)};
  }

  Vec3 centroid_m(std::uint32_t triangle) const {
    const Vec3 &a = mesh_.corner_m(triangle, 0), &b = mesh_.corner_m(triangle, 1), &c = mesh_.corner_m(triangle, 2);
    return a + ((b - a) + (c - a)) / 3.0;
  }

  double largest_stray_m(const Plane& plane, Triangles set) const {
    double largest_m = 0.0;
    for (const std::uint32_t triangle : set) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        largest_m = std::max(largest_m, std::abs(signed_distance_m(plane, mesh_.corner_m(triangle, corner))));
      }
    }
    return largest_m;
  }

  void add_facet(const Plane& plane, Triangles set) {
    Facet facet{plane, mesh_.triangles[set.front()].material};
    facet.first_triangle = static_cast<std::uint32_t>(surface_.triangles.size());
    facet.triangle_count = static_cast<std::uint32_t>(set.size());
    std::vector<Vec3> corners_m;
    for (const std::uint32_t triangle : set) {
      surface_.triangles.push_back(mesh_.triangles[triangle].vertices);
      surface_.facet_of_triangle.push_back(static_cast<std::uint32_t>(surface_.facets.size()));
      surface_.shell_of_triangle.push_back(shells_.shell_of_triangle[triangle]);
      for (std::size_t corner = 0; corner < 3; ++corner) corners_m.push_back(mesh_.corner_m(triangle, corner));
    }
    const std::vector<Vec3> hull_m = convex_hull_on_plane(plane, corners_m);
    facet.first_hull_point = static_cast<std::uint32_t>(surface_.hull_points_m.size());
    facet.hull_point_count = static_cast<std::uint32_t>(hull_m.size());
    surface_.hull_points_m.insert(surface_.hull_points_m.end(), hull_m.begin(), hull_m.end());
    surface_.facets.push_back(facet);
  }

  CleanMesh mesh_;
  SurfaceSettings settings_;
  SurfaceMesh surface_;
  DisjointSets coplanar_;
  EnclosingShells shells_;
  std::size_t open_edges_ = 0, crowded_edges_ = 0;
};

}  // namespace detail

}  // namespace dcem
