#pragma once
/// Convex regions as a question to a tree: frusta, beams, slabs, anything between planes.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// All points on the side of every plane to which its normal points; without planes, all of space.
///
///   tree.visit(ConvexRegion::beam(source_m, window_m), [&](std::uint32_t triangle) { … });
///
/// gives every triangle whose box has a point in common with the region, and some beside it: a box that lies outside
/// near an edge of the region may be outside of no single plane. The planes themselves are rounded: what lies within
/// some 1e-9 of its distance from the border of a beam or a frustum may count either way.
class ConvexRegion {
 public:
  ConvexRegion() = default;
  explicit ConvexRegion(std::vector<Plane> planes) : planes_(std::move(planes)) {}

  /// What a point sees through a convex window, from the window on: one plane through the point and each edge, and the
  /// window's own. `window_m`: its corners in order, either way round. Edges too short to span a plane with the point
  /// are left out, which only widens the beam; a window of which no corner lies off the plane through the point has no
  /// beam worth the name, and gives a region that holds at least all of it.
  static ConvexRegion beam(const Vec3& apex_m, std::span<const Vec3> window_m) {
    ConvexRegion region;
    Vec3 centre_m(0.0), normal(0.0);
    for (const Vec3& corner_m : window_m) centre_m += corner_m / static_cast<double>(window_m.size());
    for (std::size_t index = 0; index < window_m.size(); ++index) {
      const Vec3 &from_m = window_m[index], &to_m = window_m[(index + 1) % window_m.size()];
      const Vec3 across = glm::cross(from_m - apex_m, to_m - apex_m);
      const double least = least_sine * glm::distance(from_m, apex_m) * glm::distance(to_m, apex_m);
      if (glm::length(across) > least) region.add(apex_m, across, centre_m);
      normal += glm::cross(from_m - centre_m, to_m - centre_m);
    }
    if (!window_m.empty()) region.add(centre_m, normal, centre_m + (centre_m - apex_m));
    return region;
  }

  /// A pyramid with its top at `eye_m`, as a camera or a sector antenna looks out: half angles to the sides of `ahead`,
  /// radians below π/2. `up` need not be across. From the eye on.
  static ConvexRegion frustum(const Vec3& eye_m, const Vec3& ahead, const Vec3& up, double half_width_rad,
                              double half_height_rad) {
    const Vec3 forward = glm::normalize(ahead), right = glm::normalize(glm::cross(forward, up));
    const Vec3 across = glm::cross(right, forward);
    const Vec3 x = std::tan(half_width_rad) * right, y = std::tan(half_height_rad) * across, middle = eye_m + forward;
    ConvexRegion region;
    const Vec3 corners_m[] = {middle - x - y, middle + x - y, middle + x + y, middle - x + y};
    for (std::size_t index = 0; index < 4; ++index) {
      region.add(eye_m, glm::cross(corners_m[index] - eye_m, corners_m[(index + 1) % 4] - eye_m), middle);
    }
    return region;
  }

  std::span<const Plane> planes() const { return planes_; }

  bool contains(const Vec3& point_m) const {
    return std::ranges::all_of(planes_, [&](const Plane& plane) { return signed_distance_m(plane, point_m) >= 0.0; });
  }

  /// Whether a box may have a point in common with the region: false only where one plane has all of it behind. Holds
  /// for every box around one for which it holds, as trees ask of `visit`.
  bool operator()(const Aabb<double>& box) const {
    return std::ranges::all_of(planes_, [&](const Plane& plane) { return !is_behind(box, plane); });
  }

 private:
  /// An edge that a point sees under a smaller angle gives no plane worth the name, radians.
  static constexpr double least_sine = 1e-7;

  /// `inside_m`: a point on the side that is kept.
  void add(const Vec3& point_m, const Vec3& across, const Vec3& inside_m) {
    const double length = glm::length(across);
    if (!(length > 0.0) || !std::isfinite(length)) return;
    const Vec3 normal = across / length;
    const double side = glm::dot(normal, inside_m - point_m);
    if (side < 0.0 || side > 0.0) planes_.push_back({point_m, side < 0.0 ? -normal : normal});
  }

  static bool is_behind(const Aabb<double>& box, const Plane& plane) {
    double farthest = 0.0, size = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = plane.normal[axis] * (box.min[axis] - plane.point_m[axis]);
      const double high = plane.normal[axis] * (box.max[axis] - plane.point_m[axis]);
      farthest += std::max(low, high);
      size += std::max(std::abs(low), std::abs(high));
    }
    // Five roundings of numbers that are no larger.
    return farthest < -0x1p-49 * size;
  }

  std::vector<Plane> planes_;
};

}  // namespace dcem
