#pragma once
/// How close a straight segment comes to another one, to a convex polygon, to a box.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle.hpp"

namespace dcem {

/// A straight piece of a line.
struct Segment {
  Vec3 from_m{0.0}, to_m{0.0};
};

/// Shortest distance between two segments. Where the lines are closest may lie beyond an end; then one of the four ends
/// is closest. Nearly parallel ones are closest at an end, too, to rounding.
inline double distance_between_m(const Segment& one, const Segment& other) {
  const Vec3 u = one.to_m - one.from_m, v = other.to_m - other.from_m, w = one.from_m - other.from_m;
  const double a = glm::dot(u, u), b = glm::dot(u, v), c = glm::dot(v, v), d = glm::dot(u, w), e = glm::dot(v, w);
  const double cross = a * c - b * b;
  if (cross > 1e-12 * a * c) {
    const double s = (b * e - c * d) / cross, t = (a * e - b * d) / cross;
    if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) return glm::length(w + s * u - t * v);
  }
  return std::min({distance_to_segment_m(one.from_m, other.from_m, other.to_m),
                   distance_to_segment_m(one.to_m, other.from_m, other.to_m),
                   distance_to_segment_m(other.from_m, one.from_m, one.to_m),
                   distance_to_segment_m(other.to_m, one.from_m, one.to_m)});
}

/// Whether the foot of a point along the normal of a convex polygon lies in it.
inline bool is_above(std::span<const Vec3> corners_m, const Vec3& normal, const Vec3& point_m) {
  bool left = false, right = false;
  for (std::size_t index = 0; index < corners_m.size(); ++index) {
    const Vec3 &from = corners_m[index], &to = corners_m[index + 1 == corners_m.size() ? 0 : index + 1];
    const double side = glm::dot(normal, glm::cross(to - from, point_m - from));
    left = left || side > 0.0;
    right = right || side < 0.0;
  }
  return !(left && right);
}

/// Shortest distance between a segment and a convex flat polygon, of which `normal` is a normal of unit length: 0 where
/// they cross, otherwise that to a side or that of an end above the polygon.
inline double distance_to_polygon_m(const Segment& segment, std::span<const Vec3> corners_m, const Vec3& normal) {
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t index = 0; index < corners_m.size(); ++index) {
    const Vec3& to = corners_m[index + 1 == corners_m.size() ? 0 : index + 1];
    least_m = std::min(least_m, distance_between_m(segment, {corners_m[index], to}));
  }
  if (corners_m.size() < 3) return least_m;
  const double from = glm::dot(normal, segment.from_m - corners_m[0]);
  const double to = glm::dot(normal, segment.to_m - corners_m[0]);
  if ((from > 0.0) != (to > 0.0) &&
      is_above(corners_m, normal, segment.from_m + from / (from - to) * (segment.to_m - segment.from_m))) {
    return 0.0;
  }
  if (is_above(corners_m, normal, segment.from_m)) least_m = std::min(least_m, std::abs(from));
  if (is_above(corners_m, normal, segment.to_m)) least_m = std::min(least_m, std::abs(to));
  return least_m;
}

/// Whether a segment meets a box; holds for every box around one for which it holds.
inline bool meets_box(const Segment& segment, const Aabb<double>& box) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double start = segment.from_m[axis], way = segment.to_m[axis] - start;
    if (way == 0.0) {
      if (start < box.min[axis] || start > box.max[axis]) return false;
      continue;
    }
    const double one = (box.min[axis] - start) / way, two = (box.max[axis] - start) / way;
    first = std::max(first, std::min(one, two));
    last = std::min(last, std::max(one, two));
  }
  return first <= last + 1e-9;
}

}  // namespace dcem
