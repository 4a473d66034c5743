#pragma once
/// Bodies of sight.hpp: what hides what is behind it.
#include <algorithm>
#include <cmath>
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
  if (hides_as_whole(scene, outlines, id, settings)) return cover_as_whole(scene, outlines, id, settings, map, faces);
  const WorldFacet& facet = scene.facet(id);
  const FacetOutline& outline = outlines.of(id);
  const Plane* const sheet = facet.transmits && settings.sheets > 0 ? &facet.plane : nullptr;
  if (sheet != nullptr && settings.sheets > detail::SheetLayers::most_crossed) return;
  if (least_distance_m(facet.plane) <= 2.0 * outline.lift_m) return;  // an end that touches it looks past it
  const Plane plane = farthest_plane(facet, outline);
  detail::for_each_hiding_outline(scene, outlines, id, [&](std::span<const Vec3> corners_m, const Plane* own) {
    if (own != nullptr && least_distance_m(*own) <= detail::hiding_triangle_m) return;
    cover_beyond(corners_m, own != nullptr ? *own : plane, sheet, map, faces);
  });
}

DCEM_INLINE Plane Sight::farthest_plane(const WorldFacet& facet, const FacetOutline& outline) const {
  const double side = signed_distance_m(facet.plane, position_m()) > 0.0 ? 1.0 : -1.0;
  return {facet.plane.point_m - side * outline.stray_m * facet.plane.normal, facet.plane.normal};
}

/// The hull of a facet, and what is under it where nothing is seen there: as much as fills the pixels that its foot
/// runs through.
DCEM_INLINE std::span<const Vec3> Sight::deepened(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                                                  const ViewMap& map, detail::InsetOutline& deep) const {
  const std::span<const Vec3> hull_m = scene.hull_m(scene.facet(id));
  if (!hides_under_feet_ || !outlines.feet().stands(id)) return hull_m;
  constexpr double pixels = 2.5;
  double away_m = 0.0;
  for (const Vec3& corner_m : hull_m) {
    away_m = std::max(away_m, std::hypot(corner_m.x - position_m().x, corner_m.y - position_m().y));
  }
  return outlines.feet().deepened(id, hull_m, away_m * pixels * 2.0 / map.pixels(), deep);
}

/// By itself, and together with those that it meets.
DCEM_INLINE void Sight::cover_as_whole(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                                       const HalfSettings& settings, ViewMap& map, const FaceSpan& faces) const {
  const auto joined = [&](FacetId one, std::size_t side, detail::InsetOutline& deep) -> JoinedOutline {
    const WorldFacet& facet = scene.facet(one);
    const FacetOutline& outline = outlines.of(one);
    return {deepened(scene, outlines, one, map, deep), farthest_plane(facet, outline), side, 2.0 * outline.stray_m};
  };
  detail::InsetOutline own_deep, other_deep;
  const JoinedOutline alone = joined(id, 0, own_deep);
  const bool is_flat = outlines.of(id).stray_m <= detail::flat_facet_m && points_m_.size() == 1;
  map.cover(alone.corners_m, alone.plane, faces, is_flat ? 0.0 : alone.stray_m);
  for (const FacetJoint& joint : outlines.joints(id)) {
    if (!hides_as_whole(scene, outlines, joint.other, settings)) continue;
    const JoinedOutline other = joined(joint.other, joint.other_side, other_deep);
    map.cover_between({alone.corners_m, alone.plane, joint.own_side, alone.stray_m}, other, faces);
  }
}

/// A leg takes parallel sheets for one that lie within the weld tolerance of each other, or stray as far as facets may.
/// A thousand of them on top of each other, or fifty fanned out, would be needed to join what is told apart.
DCEM_INLINE void Sight::count_sheets(const Scene& scene, const HalfSettings& settings, ViewMap& map) {
  const double pile_m = 1e3 * scene.settings().weld_tolerance_m + 2.0 * facet_reach_m(scene);
  map.count_sheets(std::clamp(settings.sheets, 1, detail::SheetLayers::most_crossed), pile_m);
}

}  // namespace dcem
