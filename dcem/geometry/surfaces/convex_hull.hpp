#pragma once
/// Convex hull of points in a plane.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "dcem/geometry/plane.hpp"

namespace dcem {

/// Corners of the convex hull in counter-clockwise order, without points on its edges (Andrew's monotone chain, 1979).
/// Fewer than three corners come back where all points lie on a line.
inline std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  const auto turns_left = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
  };
  std::vector<Vec2> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && !turns_left(hull[hull.size() - 2], hull.back(), *first)) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();  // it starts the other chain
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

/// Hull of points near a plane, projected onto it: corners in order around the normal.
inline std::vector<Vec3> convex_hull_on_plane(const Plane& plane, const std::vector<Vec3>& points_m) {
  const PlaneBasis basis = plane_basis(plane.normal);
  std::vector<Vec2> flat;
  flat.reserve(points_m.size());
  for (const Vec3& point : points_m) {
    const Vec3 offset = point - plane.point_m;
    flat.emplace_back(glm::dot(offset, basis.u), glm::dot(offset, basis.v));
  }
  std::vector<Vec3> hull_m;
  for (const Vec2& corner : convex_hull(std::move(flat))) {
    hull_m.push_back(plane.point_m + corner.x * basis.u + corner.y * basis.v);
  }
  return hull_m;
}

}  // namespace dcem
