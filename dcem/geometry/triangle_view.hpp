#pragma once
/// Triangles over common vertices.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Triangles by the numbers of their corners among common vertices, metres.
struct TriangleView {
  std::span<const Vec3> vertices_m;
  std::span<const std::array<std::uint32_t, 3>> triangles;

  std::size_t size() const { return triangles.size(); }
  TriangleCorners corners_m(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {vertices_m[a], vertices_m[b], vertices_m[c]};
  }
};

}  // namespace dcem
