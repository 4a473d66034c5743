#pragma once
/// Eight points in single precision, counted from an origin: one coordinate of all of them in a vector.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// Eight points.
struct LanePoints {
  Float8 x, y, z;

  explicit LanePoints(const Vec3& all)
      : x(static_cast<float>(all.x)), y(static_cast<float>(all.y)), z(static_cast<float>(all.z)) {}
  LanePoints(const Float8& x_of, const Float8& y_of, const Float8& z_of) : x(x_of), y(y_of), z(z_of) {}
  /// As many points as there are, counted from an origin; the last one fills the lanes that are left.
  LanePoints(std::span<const Vec3> points_m, const Vec3& origin_m) : x(0.0F), y(0.0F), z(0.0F) {
    std::array<std::array<float, simd_lanes>, 3> numbers;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const Vec3 point_m = points_m[std::min(lane, points_m.size() - 1)] - origin_m;
      for (int axis = 0; axis < 3; ++axis) {
        numbers[static_cast<std::size_t>(axis)][lane] = static_cast<float>(point_m[axis]);
      }
    }
    x = Float8(numbers[0]);
    y = Float8(numbers[1]);
    z = Float8(numbers[2]);
  }

  friend LanePoints operator-(const LanePoints& one, const LanePoints& other) {
    return {one.x - other.x, one.y - other.y, one.z - other.z};
  }
};

inline Float8 dot(const LanePoints& points, float x, float y, float z) {
  return points.x * x + points.y * y + points.z * z;
}

}  // namespace DCEM_ISA

}  // namespace dcem
