#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/accel/bvh.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/io/inspection.hpp"

namespace dcem::io {
namespace {

using Polygon = std::vector<Vec2>;

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}

// The part of a polygon to the left of the line from `from` to `to`.
Polygon clipped(const Polygon& polygon, const Vec2& from, const Vec2& to) {
  Polygon inside;
  for (std::size_t index = 0; index < polygon.size(); ++index) {
    const Vec2 &here = polygon[index], &next = polygon[(index + 1) % polygon.size()];
    const double side_here = cross(to - from, here - from), side_next = cross(to - from, next - from);
    if (side_here >= 0.0) inside.push_back(here);
    if ((side_here > 0.0 && side_next < 0.0) || (side_here < 0.0 && side_next > 0.0)) {
      inside.push_back(here + (side_here / (side_here - side_next)) * (next - here));
    }
  }
  return inside;
}

double signed_area_m2(const Polygon& polygon) {
  double twice_m2 = 0.0;
  for (std::size_t index = 0; index < polygon.size(); ++index) {
    twice_m2 += cross(polygon[index], polygon[(index + 1) % polygon.size()]);
  }
  return 0.5 * twice_m2;
}

double perimeter_m(const Polygon& polygon) {
  double sum_m = 0.0;
  for (std::size_t index = 0; index < polygon.size(); ++index) {
    sum_m += glm::distance(polygon[index], polygon[(index + 1) % polygon.size()]);
  }
  return sum_m;
}

// Finds pairs of triangles of different facets through a tree of their boxes and compares them on their plane.
class OverlapSearch {
 public:
  OverlapSearch(const SurfaceMesh& mesh, const SurfaceSettings& settings) : mesh_(mesh), settings_(settings) {
    for (const auto& triangle : mesh.triangles) {
      Aabb<double> box;
      for (const std::uint32_t vertex : triangle) box.extend(mesh.vertices_m[vertex]);
      boxes_.push_back(inflated(box, dcem::detail::stray_tolerances * settings.planarity_tolerance_m));
      planes_.push_back(plane_of(triangle));
    }
  }

  std::size_t count_facet_pairs() const {
    Bvh<double> tree;
    tree.build(boxes_);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t one = 0; one < boxes_.size(); ++one) {
      tree.overlapping(boxes_[one], [&](std::uint32_t other) {
        if (other > one && overlap(one, other)) pairs.push_back(std::minmax(facet(one), facet(other)));
      });
    }
    std::sort(pairs.begin(), pairs.end());
    return static_cast<std::size_t>(std::unique(pairs.begin(), pairs.end()) - pairs.begin());
  }

 private:
  std::uint32_t facet(std::uint32_t triangle) const { return mesh_.facet_of_triangle[triangle]; }
  const Plane& plane(std::uint32_t triangle) const { return planes_[triangle]; }

  Plane plane_of(const std::array<std::uint32_t, 3>& triangle) const {
    const Vec3& first_m = mesh_.vertices_m[triangle[0]];
    const Vec3 across = glm::cross(mesh_.vertices_m[triangle[1]] - first_m, mesh_.vertices_m[triangle[2]] - first_m);
    return {first_m, glm::normalize(across)};
  }

  bool overlap(std::uint32_t one, std::uint32_t other) const {
    if (facet(one) == facet(other)) return false;
    if (std::abs(glm::dot(plane(one).normal, plane(other).normal)) <= dcem::detail::coplanar_cosine) return false;
    const PlaneBasis basis = plane_basis(plane(one).normal);
    const Polygon base = on_plane(one, plane(one).point_m, basis);
    Polygon common = on_plane(other, plane(one).point_m, basis);
    for (std::size_t side = 0; side < 3 && !common.empty(); ++side) {
      common = clipped(common, base[side], base[(side + 1) % 3]);
    }
    // Neighbours whose shared rim is rounded differently overlap in a sliver, which is no wider than the tolerance.
    const double sliver_m2 = 10.0 * settings_.weld_tolerance_m * perimeter_m(common);
    return std::abs(signed_area_m2(common)) > sliver_m2 && close(one, other, basis, common);
  }

  // Corners on the plane of a facet, counterclockwise.
  Polygon on_plane(std::uint32_t triangle, const Vec3& origin_m, const PlaneBasis& basis) const {
    Polygon corners;
    for (const std::uint32_t vertex : mesh_.triangles[triangle]) {
      const Vec3 from_origin_m = mesh_.vertices_m[vertex] - origin_m;
      corners.emplace_back(glm::dot(from_origin_m, basis.u), glm::dot(from_origin_m, basis.v));
    }
    if (signed_area_m2(corners) < 0.0) std::swap(corners[1], corners[2]);
    return corners;
  }

  bool close(std::uint32_t one, std::uint32_t other, const PlaneBasis& basis, const Polygon& common) const {
    // As far as the triangles of one facet may stray from its plane.
    const double limit_m = dcem::detail::stray_tolerances * settings_.planarity_tolerance_m;
    return std::all_of(common.begin(), common.end(), [&](const Vec2& corner) {
      const Vec3 point_m = plane(one).point_m + corner.x * basis.u + corner.y * basis.v;
      return std::abs(signed_distance_m(plane(other), point_m)) <= limit_m;
    });
  }

  const SurfaceMesh& mesh_;
  SurfaceSettings settings_;
  std::vector<Aabb<double>> boxes_;
  std::vector<Plane> planes_;  // of the triangles themselves: a facet may stray some tolerances from its mean plane
};

}  // namespace

std::size_t overlapping_facet_pairs(const SurfaceMesh& mesh, const SurfaceSettings& settings) {
  return OverlapSearch(mesh, settings).count_facet_pairs();
}

}  // namespace dcem::io
