#pragma once
/// The convex outlines of a facet that hide what is behind them.
#include <array>
#include <cstdint>
#include <span>

#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::detail {

/// A triangle by itself hides from no closer.
inline constexpr double hiding_triangle_m = 0.01;

/// Calls `visit(corners_m, own)` for the hull of a facet that fills it, and otherwise for its triangles; `own`: the
/// plane of a triangle of a facet that is not flat, else null, and it lies in the facet's plane.
template <typename Visit>
void for_each_hiding_outline(const Scene& scene, const FacetOutlines& outlines, FacetId id, Visit&& visit) {
  const WorldFacet& facet = scene.facet(id);
  const FacetOutline& outline = outlines.of(id);
  const bool is_flat = outline.stray_m <= flat_facet_m;
  if (is_flat && outline.fills_hull) return visit(scene.hull_m(facet), nullptr);
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    const std::array<Vec3, 3> corners_m = scene.corners_m(facet.first_triangle + triangle);
    if (is_flat) {
      visit(std::span<const Vec3>(corners_m), nullptr);
      continue;
    }
    const Vec3 normal = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double size_m2 = glm::length(normal);
    if (!(size_m2 > 1e-6)) continue;  // a sliver's normal says little, and it hides little
    const Plane own{corners_m[0], normal / size_m2};
    visit(std::span<const Vec3>(corners_m), &own);
  }
}

}  // namespace dcem::detail
