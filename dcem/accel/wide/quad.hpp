#pragma once
/// What the leaves of a wide tree hold: triangles, most of them in pairs; and the planes in which a ray meets them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/accel/exact_hit.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem {

/// One triangle, or two that share the edge from corner c to corner a.
struct Quad {
  static constexpr std::uint32_t no_triangle = 0xffffffffU;

  std::array<std::uint32_t, 2> triangle{no_triangle, no_triangle};
  /// Vertices: a, b, c of the first triangle, d of the second. A triangle alone has a in place of d.
  std::array<std::uint32_t, 4> corner{};
  /// Which of a, b, c is the first corner of the first triangle, and which of a, c, d of the second: 0, 1 or 2.
  std::array<std::uint32_t, 2> begin{};

  static Quad alone(std::uint32_t triangle, const std::array<std::uint32_t, 3>& vertices) {
    return {{triangle, no_triangle}, {vertices[0], vertices[1], vertices[2], vertices[0]}, {}};
  }
  bool is_none() const { return triangle[0] == no_triangle; }
  bool is_pair() const { return triangle[1] != no_triangle; }
  std::span<const std::uint32_t> triangles() const { return {triangle.data(), is_pair() ? 2U : 1U}; }
  /// The first corner of a triangle.
  std::uint32_t first_vertex(std::size_t side) const {
    return side == 0 || begin[1] == 0 ? corner[begin[side]] : corner[begin[1] + 1];
  }
};

/// The plane of a triangle, from its own corners in their own order: the same whatever quad the triangle is in, but for
/// the sign of the normal. All that a hit needs is in one line of the caches.
struct alignas(64) TrianglePlane : HitPlane {
  /// Of a triangle that is no half of a pair.
  static constexpr float alone = -1.0F;

  std::uint32_t triangle = Quad::no_triangle;
  float least_slope_squared = alone;  ///< see is_steep

  bool is_alone() const { return least_slope_squared == alone; }
  /// Whether a ray that certainly meets this half of a pair does so where it meets the plane. A ray along the quad, by
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
static_assert(sizeof(TrianglePlane) == 64);

/// What a hit on a quad needs. A pair is flat within a limit only, and bends when its vertices move; t must be that of
/// the triangle.
struct QuadPlanes {
  std::array<TrianglePlane, 2> side;

  bool is_pair() const { return side[1].triangle != Quad::no_triangle; }
  std::span<const TrianglePlane> sides() const { return {side.data(), is_pair() ? 2U : 1U}; }
};

}  // namespace dcem
