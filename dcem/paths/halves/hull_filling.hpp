#pragma once
/// Whether the triangles of a facet are its convex hull, without holes, dents or folds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/inset.hpp"

namespace dcem {

namespace detail {

/// Twice the area of a convex polygon.
inline double doubled_area_m2(std::span<const Vec3> corners_m) {
  double area_m2 = 0.0;
  for (std::size_t corner = 2; corner < corners_m.size(); ++corner) {
    area_m2 += glm::length(glm::cross(corners_m[corner - 1] - corners_m[0], corners_m[corner] - corners_m[0]));
  }
  return area_m2;
}

/// Twice the area that two triangles in a plane share.
inline double doubled_overlap_m2(const std::array<Vec3, 3>& one, const std::array<Vec3, 3>& other) {
  const Vec3 up = glm::cross(one[1] - one[0], one[2] - one[0]);
  InsetOutline shared;
  shared.assign(other);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vec3 inward = glm::cross(up, one[(corner + 1) % 3] - one[corner]);
    if (!shared.keep(inward, glm::dot(inward, one[corner]))) return 0.0;
  }
  return doubled_area_m2(shared.corners());
}

/// Whether both ends of an edge lie at one side of a convex outline.
inline bool is_at_rim(const std::array<Vec3, 2>& edge_m, std::span<const Vec3> hull_m, const Vec3& normal) {
  constexpr double at_m = 5e-6;  // less than what sides are moved in by at least
  for (std::size_t corner = 0; corner < hull_m.size(); ++corner) {
    const Vec3 &from = hull_m[corner], &to = hull_m[(corner + 1) % hull_m.size()];
    const Vec3 across = glm::cross(normal, to - from);
    const double reach_m2 = at_m * glm::length(across);
    const auto is_at = [&](const Vec3& end_m) { return std::abs(glm::dot(across, end_m - from)) <= reach_m2; };
    if (is_at(edge_m[0]) && is_at(edge_m[1])) return true;
  }
  return false;
}

}  // namespace detail

/// Whether triangles that fill a hull have no gap between them, however far they stray from its plane: each of their
/// edges is one of two triangles, with the same numbers, or lies at the rim.
inline bool are_joined(std::span<const std::array<Vec3, 3>> triangles_m, std::span<const Vec3> hull_m,
                       const Vec3& normal) {
  using Numbers = std::array<double, 6>;
  std::vector<Numbers> edges;
  for (const std::array<Vec3, 3>& corners_m : triangles_m) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3 &one = corners_m[corner], &other = corners_m[(corner + 1) % 3];
      const std::array<double, 3> a{one.x, one.y, one.z}, b{other.x, other.y, other.z};
      const auto& [first, last] = std::minmax(a, b);
      edges.push_back({first[0], first[1], first[2], last[0], last[1], last[2]});
    }
  }
  std::ranges::sort(edges);
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    for (last = first + 1; last < edges.size() && edges[last] == edges[first];) ++last;
    if (last - first == 2) continue;
    const Numbers& edge = edges[first];
    const std::array<Vec3, 2> ends_m{Vec3(edge[0], edge[1], edge[2]), Vec3(edge[3], edge[4], edge[5])};
    if (last - first > 2 || !detail::is_at_rim(ends_m, hull_m, normal)) return false;
  }
  return true;
}

/// Whether triangles in a plane, all corners of which lie in a convex hull, cover all of it: together they are as
/// large, and none lies on another one. Areas agree to rounding: a slit of a micrometre would not.
inline bool fills_hull(std::span<const std::array<Vec3, 3>> triangles_m, std::span<const Vec3> hull_m) {
  const double hull_m2 = detail::doubled_area_m2(hull_m), least_m2 = 1e-6 * std::min(1.0, hull_m2);
  double area_m2 = 0.0, overlap_m2 = 0.0;
  for (const auto& corners_m : triangles_m) area_m2 += detail::doubled_area_m2(corners_m);
  if (!(std::abs(hull_m2 - area_m2) <= least_m2)) return false;
  std::vector<Aabb<double>> boxes(triangles_m.size());
  for (std::size_t one = 0; one < triangles_m.size(); ++one) {
    for (const Vec3& corner_m : triangles_m[one]) boxes[one].extend(corner_m);
  }
  for (std::size_t one = 0; one < triangles_m.size() && overlap_m2 <= least_m2; ++one) {
    for (std::size_t other = one + 1; other < triangles_m.size(); ++other) {
      if (!boxes[one].overlaps(boxes[other])) continue;
      overlap_m2 += detail::doubled_overlap_m2(triangles_m[one], triangles_m[other]);
    }
  }
  return overlap_m2 <= least_m2;
}

}  // namespace dcem
