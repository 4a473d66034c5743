#pragma once
/// The planes of a quad in double precision: where a ray meets it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/accel/wide/build/quads.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The plane of a triangle in double, from the triangle's own corners in their own order: the same whatever quad the
/// triangle is in, but for the sign of the normal. The normal is zero where there is no plane. All that a hit needs is
/// in one line of the caches.
struct alignas(64) TrianglePlane {
  /// Of a triangle that is no half of a pair.
  static constexpr float alone = -1.0F;

  Vec3 normal{0.0};   ///< of unit length
  Vec3 point_m{0.0};  ///< first corner of the triangle; far from zero an offset would be rounded too much
  std::uint32_t triangle = Quad::no_triangle;
  float least_slope_squared = alone;  ///< see is_steep

  /// The line of a ray meets it at height / slope.
  double height(const Ray<double>& ray) const { return glm::dot(normal, point_m - ray.origin); }
  double slope(const Ray<double>& ray) const { return glm::dot(normal, ray.direction); }
  /// Zero without a sign: which one it has would depend on the quad.
  double t_of(const Ray<double>& ray) const { return height(ray) / slope(ray) + 0.0; }

  bool is_alone() const { return least_slope_squared == alone; }
  /// Whether a ray that surely meets this half of a pair does so where it meets the plane. A ray along the quad, by
  /// less than some 0.06 degrees more than the halves are inclined to each other, may meet a fold in both or one plane
  /// far outside: then each triangle is asked by itself.
  bool is_steep(const Ray<double>& ray) const {
    const double along = slope(ray);
    // Below zero for a triangle alone, which every ray is steep to; what it is, no processor foresees.
    return along * along > static_cast<double>(least_slope_squared) * glm::dot(ray.direction, ray.direction);
  }
  /// From the squared difference of the two normals of a pair. |slope| ≥ |n₁ − n₀| + 10⁻³ on one of them leaves 10⁻³
  /// and the same sign on the other; (x + y)² ≤ 2 x² + 2 y².
  static float least_slope_squared_of(double difference_squared) {
    return static_cast<float>(2.001 * (difference_squared + 1e-6));
  }
};

/// What a hit on a quad needs. A pair is flat within a limit only, and bends when its vertices move; t must be that of
/// the triangle.
struct QuadPlanes {
  std::array<TrianglePlane, 2> side;

  bool is_pair() const { return side[1].triangle != Quad::no_triangle; }
  std::span<const TrianglePlane> sides() const { return {side.data(), is_pair() ? 2U : 1U}; }
};

}  // namespace dcem
