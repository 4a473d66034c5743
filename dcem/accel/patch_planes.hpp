#pragma once
/// The planes of a patch in double precision: where a ray meets it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/accel/patches.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The plane of a triangle in double, from the triangle's own corners in their own order: the same whatever patch the
/// triangle is in, but for the sign of the normal. The normal is zero where there is no plane.
struct PatchPlane {
  Vec3 normal{0.0};   ///< of unit length
  Vec3 point_m{0.0};  ///< first corner of the triangle; far from zero an offset would be rounded too much

  /// The line of a ray meets it at height / slope.
  double height(const Ray<double>& ray) const { return glm::dot(normal, point_m - ray.origin); }
  double slope(const Ray<double>& ray) const { return glm::dot(normal, ray.direction); }
};

/// What a hit on a patch needs: the planes of its two triangles, and which of them is met. A pair is flat within a
/// limit only, and bends when its vertices move; t must be that of the triangle.
struct alignas(64) PatchPlanes {
  std::array<PatchPlane, 2> plane;
  /// The diagonal as a line u x + v y = w, seen along the axis on which the first normal is longest; x and y follow
  /// that axis in turn and count from the first plane's point. Triangle 1 lies where u x + v y > w.
  double u = 0.0, v = 0.0, w = 0.0;
  std::array<std::uint32_t, 2> triangle{WidePatch::no_triangle, WidePatch::no_triangle};

  bool is_pair() const { return triangle[1] != WidePatch::no_triangle; }
  std::span<const std::uint32_t> triangles() const { return {triangle.data(), is_pair() ? 2U : 1U}; }
  double t_of(std::size_t side, const Ray<double>& ray) const {
    return plane[side].height(ray) / plane[side].slope(ray);
  }

  /// Which axis is left out of the diagonal.
  int axis() const {
    const Vec3 size = glm::abs(plane[0].normal);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  }

  /// Where the line of a ray that meets the patch does so, and in which of the triangles.
  struct Meeting {
    double t;
    std::uint32_t side;
    /// Whether that is so. A ray along the patch, by less than some 0.06 degrees, may meet a fold in both triangles or
    /// one plane far outside: then each triangle is asked by itself.
    bool is_sure;
  };
  Meeting meet(const Ray<double>& ray) const {
    const double height = plane[0].height(ray), slope = plane[0].slope(ray);
    if (!is_pair()) return {height / slope, 0, true};
    const double other_slope = plane[1].slope(ray);
    const bool is_sure = slope * other_slope > 1e-6 * glm::dot(ray.direction, ray.direction);
    // Whether the point at t = height / slope is beyond the diagonal, multiplied by the slope.
    const int x = (axis() + 1) % 3, y = (axis() + 2) % 3;
    const Vec3 from = ray.origin - plane[0].point_m;
    const double beyond = u * (ray.direction[x] * height + from[x] * slope) +
                          v * (ray.direction[y] * height + from[y] * slope) - w * slope;
    const std::uint32_t side = (beyond > 0.0) == (slope > 0.0) && beyond != 0.0 ? 1U : 0U;
    return {side == 0 ? height / slope : plane[1].height(ray) / other_slope, side, is_sure};
  }
};

}  // namespace dcem
