#pragma once
/// The planes of a patch in double precision: where a ray meets it.
#include <array>
#include <cstdint>

#include "dcem/accel/patches.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// A plane in double: normal · x = offset. The normal need not have unit length; it is zero where there is no plane.
struct PatchPlane {
  Vec3 normal{0.0};
  double offset = 0.0;

  /// The line of a ray meets it at height / slope.
  double height(const Ray<double>& ray) const { return offset - glm::dot(normal, ray.origin); }
  double slope(const Ray<double>& ray) const { return glm::dot(normal, ray.direction); }
};

/// What a hit on a patch needs: the planes of its two triangles, and which of them is met. A pair is flat to rounding
/// only, and t must be that of the triangle.
struct alignas(64) PatchPlanes {
  std::array<PatchPlane, 2> plane;
  PatchPlane
      divider;  ///< through the diagonal; triangle 1 lies where normal · x > offset. A triangle: normal 0, offset 0
  std::array<std::uint32_t, 2> triangle{Patch::no_triangle, Patch::no_triangle};

  /// Where the line of a ray that meets the patch does so, and in which of the triangles; t is not finite where the
  /// line lies in the plane.
  struct Meeting {
    double t;
    std::uint32_t side;
  };
  Meeting meet(const Ray<double>& ray) const {
    const double height = plane[0].height(ray), slope = plane[0].slope(ray);
    // Whether the point at t = height / slope is beyond the diagonal, multiplied by the slope.
    const double beyond = divider.slope(ray) * height - divider.height(ray) * slope;
    const std::uint32_t side = (beyond > 0.0) == (slope > 0.0) && beyond != 0.0 ? 1U : 0U;
    const PatchPlane& met = plane[side];
    return {met.height(ray) / met.slope(ray), side};
  }
};

}  // namespace dcem
