#pragma once
/// One cone for the images of several points in a mirror.
#include <cmath>
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

}  // namespace dcem
