#pragma once
/// Bodies of sight.hpp: how a `Sight` finds what may be seen, and what hides it.
#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/query/leg_filter.hpp"

namespace dcem {

DCEM_INLINE void collect_edges(const Scene& scene, std::span<const FacetId> facets, std::vector<WedgeId>& edges) {
  edges.clear();
  for (const FacetId facet : facets) {
    for (const WedgeId id : scene.wedges_of_facet(facet)) edges.push_back(id);
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

DCEM_INLINE void Sight::look_from(const LinkEnd& end) {
  map_.look_from(end.position_m);
  points_m_.assign(1, end.position_m);
  radius_m_ = 0.0;
  is_body_ = false;
  ignored_body_ = end.ignored_body;
  mounted_on_ = end.mounted_on;
  beam_.reset();
}

DCEM_INLINE void Sight::look_from(std::span<const Vec3> points_m) {
  Aabb<double> box;
  for (const Vec3& point_m : points_m) box.extend(point_m);
  take_points(points_m, points_m.size() == 1 ? points_m[0] : box.center());
  map_.look_from(middle_m_, offsets_m_);
  beam_.reset();
}

/// A side is moved in by the largest of quotients of two linear functions, which is that of a corner; a plane that all
/// corners are on one side of is nearest to one of them; what all corners are inside of, all of the body is.
DCEM_INLINE void Sight::look_from_within(std::span<const Vec3> corners_m) {
  look_from(corners_m);
  is_body_ = true;
}

/// Notes points and where they are from their middle.
DCEM_INLINE void Sight::take_points(std::span<const Vec3> points_m, const Vec3& middle_m) {
  middle_m_ = middle_m;
  offsets_m_.clear();
  radius_m_ = 0.0;
  for (const Vec3& point_m : points_m) {
    offsets_m_.push_back(point_m - middle_m);
    radius_m_ = std::max(radius_m_, 1e-6 + glm::length(offsets_m_.back()));
  }
  if (points_m.size() == 1) offsets_m_.clear();
  is_body_ = false;
  points_m_.assign(points_m.begin(), points_m.end());
  ignored_body_.reset();
  mounted_on_.clear();
}

DCEM_INLINE void Sight::look_through(const Scene& scene, const FacetOutlines& outlines, FacetId mirror,
                                     const Vec3& image_m, const std::optional<BodyId>& ignored_body) {
  const WorldFacet& facet = scene.facet(mirror);
  const std::span<const Vec3> window_m = scene.hull_m(facet);
  points_m_.assign(1, image_m);
  radius_m_ = 0.0;
  is_body_ = false;
  ignored_body_ = ignored_body;
  mounted_on_.clear();
  beam_.emplace(mirror, facet.plane, image_m, window_m, outlines.of(mirror).lift_m);
  map_.look_through(image_m, window_m, MirrorBeam::room_m, beam_->inwards());
}

DCEM_INLINE void Sight::look_through(const Scene& scene, const FacetOutlines& outlines, FacetId mirror,
                                     std::span<const Vec3> images_m, bool all_between) {
  const WorldFacet& facet = scene.facet(mirror);
  Vec3 middle_m(0.0);  // not that of a box around them, which may be on the other side of the mirror
  for (const Vec3& image_m : images_m) middle_m += image_m / static_cast<double>(images_m.size());
  take_points(images_m, middle_m);
  is_body_ = all_between;
  beam_.emplace(mirror, facet.plane, outlines.sides(mirror), images_m, outlines.of(mirror).lift_m);
  map_.look_through(middle_m_, scene.hull_m(facet), MirrorBeam::room_m, beam_->inwards(), offsets_m_);
}

DCEM_INLINE void Sight::look_at_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                        std::vector<FacetId>& seen) {
  seen_.assign(outlines.size(), 0);
  count_sheets(scene, settings, map_);
  reach_m_ = settings.reach_m + radius_m_ + in_reach_m;
  const auto look_at = [&](FacetId id) {
    if (seen_[id.value] != 0 || !may_see(scene, outlines, id)) return;
    seen_[id.value] = 1;
    seen.push_back(id);
    cover(scene, outlines, id, settings, map_);
  };
  const auto hidden = [&](const Aabb<double>& box) { return is_out_of_view(box) || map_.hides(box, longest_lift_m); };
  outlines.visit_from(position_m(), hidden, look_at);
  outlines.for_each_grazed(position_m(), radius_m_, lift_share(), longest_lift_m, [&](FacetId id) {
    if (is_lifted_far(scene, outlines, id) && !is_out_of_view(outlines.of(id).box)) look_at(id);
  });
  map_.forget_sheets();
}

DCEM_INLINE void Sight::look_at_bodies(const Scene& scene, const FacetOutlines& outlines, const BodyChoice& bodies,
                                       std::vector<FacetId>& seen) const {
  for (std::uint32_t number = 0; number < outlines.bodies().size(); ++number) {
    const FacetOutlines::BodyFacets& body = outlines.bodies()[number];
    if (body.box.empty() || !bodies.takes(number + 1)) continue;  // body 0 is the scenery
    if (is_out_of_view(body.box)) continue;
    const bool is_hidden = map_.hides(body.box, longest_lift_m);
    for (std::uint32_t index = body.first; index < body.first + body.count; ++index) {
      const FacetId id(index);
      if (is_hidden && !is_lifted_far(scene, outlines, id)) continue;
      if (may_see(scene, outlines, id)) seen.push_back(id);
    }
  }
}

DCEM_INLINE void Sight::find_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                     SeenLayer& layer, ThreadPool* pool) {
  for (int step = 0; step < scenery_steps; ++step) find_scenery_step(step, scene, outlines, settings, layer, pool);
}

DCEM_INLINE void Sight::find_scenery_step(int step, const Scene& scene, const FacetOutlines& outlines,
                                          const HalfSettings& settings, SeenLayer& layer, ThreadPool* pool) {
  if (step == 0) {
    layer.mirrors.clear();
    look_at_scenery(scene, outlines, settings, layer.mirrors);
  }
  if (step == 1) look_closer(scene, outlines, settings, layer.mirrors, pool);
  if (step == 2) finish(scene, outlines, settings, layer);
}

DCEM_INLINE void Sight::find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                    const BodyChoice& bodies, SeenLayer& layer) const {
  layer.mirrors.clear();
  look_at_bodies(scene, outlines, bodies, layer.mirrors);
  finish(scene, outlines, settings, layer);
}

DCEM_INLINE void Sight::find_facets(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                    bool bodies, std::vector<FacetId>& seen) {
  seen.clear();
  look_at_scenery(scene, outlines, settings, seen);
  look_closer(scene, outlines, settings, seen, nullptr);
  if (bodies) look_at_bodies(scene, outlines, {}, seen);
}

DCEM_INLINE bool Sight::may_see(const Scene& scene, const FacetOutlines& outlines, FacetId id) const {
  const WorldFacet& facet = scene.facet(id);
  if (!facet.present || facet.body == ignored_body_) return false;
  if (!beam_) return map_.shows(scene.hull_m(facet), facet.plane, nearer_on(scene, outlines, id));
  if (id == beam_->mirror() || beam_->is_beside(outlines.of(id).box)) return false;
  detail::InsetOutline inside;
  if (!inside.assign(scene.hull_m(facet))) return true;
  if (!beam_->cut(inside)) return inside.is_full();
  return map_.shows(inside.corners(), facet.plane, nearer_on(scene, outlines, id));
}

/// Notes the part of an outline that is beyond the mirror, where one is looked through.
DCEM_INLINE void Sight::cover_beyond(std::span<const Vec3> corners_m, const Plane& plane, const Plane* sheet,
                                     ViewMap& map) const {
  detail::InsetOutline beyond;
  if (beam_) {
    if (!beyond.assign(corners_m) || !beam_->cut_to_occluder(beyond)) return;
    corners_m = beyond.corners();
  }
  if (sheet == nullptr) return map.cover(corners_m, plane);
  map.cover_sheet(corners_m, plane, *sheet);
}

DCEM_INLINE void Sight::cover(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                              const HalfSettings& settings, ViewMap& map) const {
  const WorldFacet& facet = scene.facet(id);
  const FacetOutline& outline = outlines.of(id);
  const Plane* const sheet = facet.transmits && settings.sheets > 0 ? &facet.plane : nullptr;
  if (sheet != nullptr && settings.sheets > detail::SheetLayers::most_crossed) return;
  if (least_distance_m(facet.plane) <= 2.0 * outline.lift_m) return;  // an end that touches it looks past it
  if (outline.stray_m > flat_m) return cover_triangles(scene, facet, sheet, map);
  const double side = signed_distance_m(facet.plane, position_m());
  Plane plane = facet.plane;
  plane.point_m -= (side > 0.0 ? 1.0 : -1.0) * outline.stray_m * plane.normal;  // where it is farthest
  if (outline.fills_hull) return cover_beyond(scene.hull_m(facet), plane, sheet, map);
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    cover_beyond(scene.corners_m(facet.first_triangle + triangle), plane, sheet, map);
  }
}

/// A leg takes parallel sheets for one that lie within the weld tolerance of each other, or stray as far as facets may.
/// A thousand of them on top of each other, or fifty fanned out, would be needed to join what is told apart.
DCEM_INLINE void Sight::count_sheets(const Scene& scene, const HalfSettings& settings, ViewMap& map) {
  const double pile_m = 1e3 * scene.settings().weld_tolerance_m + 2.0 * facet_reach_m(scene);
  map.count_sheets(std::clamp(settings.sheets, 1, detail::SheetLayers::most_crossed), pile_m);
}

DCEM_INLINE void Sight::cover_triangles(const Scene& scene, const WorldFacet& facet, const Plane* sheet,
                                        ViewMap& map) const {
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    const std::array<Vec3, 3> corners_m = scene.corners_m(facet.first_triangle + triangle);
    const Vec3 normal = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double size = glm::length(normal);
    if (!(size > 1e-6)) continue;  // a sliver's normal says little, and it hides little
    const Plane plane{corners_m[0], normal / size};
    if (least_distance_m(plane) > 0.01) cover_beyond(corners_m, plane, sheet, map);
  }
}

/// Adds the edges. Where a point of an edge is seen from its exterior, so is one of its faces beside it: but for a
/// third facet that touches it there, and then nothing diffracts.
DCEM_INLINE void Sight::finish(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                               SeenLayer& layer) const {
  const auto out_of_reach = [&](WedgeId id) {
    const WorldWedge& wedge = scene.wedge(id);
    if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules) || is_inside(wedge.edge)) return true;
    const Vec3 &start_m = wedge.edge.start_m, &end_m = wedge.edge.end_m;
    if (is_beyond({glm::min(start_m, end_m), glm::max(start_m, end_m)})) return true;
    return !map_.shows(wedge.edge.start_m, wedge.edge.end_m, nearer_on(scene, outlines, id));
  };
  std::ranges::sort(layer.mirrors);
  collect_edges(scene, settings.edges ? std::span<const FacetId>(layer.mirrors) : std::span<const FacetId>(),
                layer.edges);
  std::erase_if(layer.edges, out_of_reach);
  std::erase_if(layer.mirrors, [&](FacetId id) {
    return std::ranges::binary_search(mounted_on_, id) || is_along(scene.facet(id).plane);
  });
}

}  // namespace dcem
