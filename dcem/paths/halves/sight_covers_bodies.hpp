#pragma once
/// Bodies of sight.hpp: what hides what is behind it.
#include <algorithm>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/hiding_outlines.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/query/leg_filter.hpp"

namespace dcem {

/// Notes the part of an outline that is beyond the mirror, where one is looked through.
DCEM_INLINE void Sight::cover_beyond(std::span<const Vec3> corners_m, const Plane& plane, const Plane* sheet,
                                     ViewMap& map, const FaceSpan& faces) const {
  detail::InsetOutline beyond;
  if (beam_) {
    if (!beyond.assign(corners_m) || !beam_->cut_to_occluder(beyond)) return;
    corners_m = beyond.corners();
  }
  if (sheet == nullptr) return map.cover(corners_m, plane, faces);
  map.cover_sheet(corners_m, plane, *sheet, faces);
}

DCEM_INLINE void Sight::cover(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                              const HalfSettings& settings, ViewMap& map, const FaceSpan& faces) const {
  const WorldFacet& facet = scene.facet(id);
  const FacetOutline& outline = outlines.of(id);
  const Plane* const sheet = facet.transmits && settings.sheets > 0 ? &facet.plane : nullptr;
  if (sheet != nullptr && settings.sheets > detail::SheetLayers::most_crossed) return;
  if (least_distance_m(facet.plane) <= 2.0 * outline.lift_m) return;  // an end that touches it looks past it
  const double side = signed_distance_m(facet.plane, position_m());
  Plane plane = facet.plane;
  plane.point_m -= (side > 0.0 ? 1.0 : -1.0) * outline.stray_m * plane.normal;  // where it is farthest
  detail::for_each_hiding_outline(scene, outlines, id, [&](std::span<const Vec3> corners_m, const Plane* own) {
    if (own != nullptr && least_distance_m(*own) <= detail::hiding_triangle_m) return;
    cover_beyond(corners_m, own != nullptr ? *own : plane, sheet, map, faces);
  });
}

/// A leg takes parallel sheets for one that lie within the weld tolerance of each other, or stray as far as facets may.
/// A thousand of them on top of each other, or fifty fanned out, would be needed to join what is told apart.
DCEM_INLINE void Sight::count_sheets(const Scene& scene, const HalfSettings& settings, ViewMap& map) {
  const double pile_m = 1e3 * scene.settings().weld_tolerance_m + 2.0 * facet_reach_m(scene);
  map.count_sheets(std::clamp(settings.sheets, 1, detail::SheetLayers::most_crossed), pile_m);
}

}  // namespace dcem
