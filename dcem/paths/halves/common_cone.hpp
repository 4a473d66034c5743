#pragma once
/// One cone for the images of several points in a mirror.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/hull_sides.hpp"

namespace dcem {

/// What points see through a convex outline, as half spaces around an origin: see `for_each_common_side`.
inline void common_cone(std::span<const HullSide> outline, const Plane& plane, const Vec3& up,
                        std::span<const Vec3> points_m, const Vec3& origin_m, std::vector<HalfSpace>& result) {
  const auto add = [&](const Vec3& inwards, double offset_m) {
    const double length = glm::length(inwards);
    const Vec3 normal = inwards / length;
    // Points to be tested are in single precision, too, some of them far away.
    const double here_m = offset_m / length - glm::dot(normal, origin_m);
    result.push_back({static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
                      static_cast<float>(here_m - 1e-2 - 1e-6 * std::abs(here_m))});
  };
  result.clear();
  for_each_common_side(outline, plane, up, points_m, add);
  add(up, glm::dot(up, plane.point_m));  // last: it keeps more than the others do
}

/// What images in two mirrors may see through both. `images_m` are those in the first one, on one `side` (1 or −1) of
/// the second; `first` is what they see through the first one, last what is beyond it; no number that counts from
/// `origin_m` is larger than `reach_m`.
inline void common_cone_over_two(std::span<const HullSide> outline, const Plane& plane, double side,
                                 std::span<const Vec3> images_m, std::span<const HalfSpace> first, const Vec3& origin_m,
                                 double reach_m, std::vector<HalfSpace>& result) {
  common_cone(outline, plane, side * plane.normal, images_m, origin_m, result);
  add_mirrored(first.first(first.size() - 1), plane, origin_m, 1e-3 + 2e-6 * reach_m, result);
}

/// Points of which the convex body is what of that between `points_m` is on one `side` (1 or −1) of a plane and not in
/// it; none where there is no such part. Where the plane cuts it there are more than its corners, but none outside.
inline void span_beside(std::span<const Vec3> points_m, const Plane& plane, double side, std::vector<Vec3>& result_m) {
  const auto above_m = [&](const Vec3& point_m) { return side * signed_distance_m(plane, point_m); };
  result_m.clear();
  std::ranges::copy_if(points_m, std::back_inserter(result_m),
                       [&](const Vec3& point_m) { return above_m(point_m) > in_plane_guard_m; });
  if (result_m.empty() || result_m.size() == points_m.size()) return;
  const std::size_t whole = result_m.size();
  for (const Vec3& point_m : points_m) {
    const double below_m = above_m(point_m);
    if (below_m > in_plane_guard_m) continue;
    for (std::size_t from = 0; from < whole; ++from) {
      const double from_m = above_m(result_m[from]), share = from_m / (from_m - below_m);
      const Vec3 cut_m = result_m[from] + share * (point_m - result_m[from]);
      result_m.push_back(cut_m + side * in_plane_guard_m * plane.normal);
    }
  }
}

}  // namespace dcem
