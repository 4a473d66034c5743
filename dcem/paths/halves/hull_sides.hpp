#pragma once
/// The sides of convex outlines, and what points see through one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "dcem/geometry/plane.hpp"

namespace dcem {

/// A side of a facet's hull: points of the plane with normal·x ≥ offset are on the inner side.
struct HullSide {
  Vec3 normal{0.0};
  double offset_m = 0.0;
};

/// Calls `visit(normal, offset)` for planes normal·x ≥ offset, not of length 1, that what any of some points sees
/// through a convex outline is inside of. The points are on one side of the outline's plane and may be images in it;
/// `up` is the plane's normal away from them, or from their images.
///
/// With α the distance of a point inside a side of the outline, β that from its plane, it sees X, h beyond the plane,
/// inside that side where m·X − b + (α/β) h ≥ 0, m·x ≥ b being the side in the plane: the largest α/β of all points
/// serves all.
template <typename Visit>
void for_each_common_side(std::span<const HullSide> outline, const Plane& plane, const Vec3& up,
                          std::span<const Vec3> points_m, Visit&& visit) {
  for (const HullSide& side : outline) {
    double slope = -std::numeric_limits<double>::infinity();
    for (const Vec3& point_m : points_m) {
      const double inside_m = glm::dot(side.normal, point_m) - side.offset_m;
      slope = std::max(slope, inside_m / std::abs(signed_distance_m(plane, point_m)));
    }
    if (slope > 1e4 || side.normal == Vec3(0.0)) continue;  // hardly a bound
    visit(side.normal + slope * up, side.offset_m + slope * glm::dot(up, plane.point_m));
  }
}

}  // namespace dcem
