#pragma once
/// Bodies of sight.hpp: how a `Sight` finds what may be seen.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/fetch.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/facet_edges.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

DCEM_INLINE void Sight::look_from(const LinkEnd& end, ThreadPool* pool) {
  if (pool == nullptr) {
    map_.look_from(end.position_m);
  } else {
    map_.look_from(end.position_m, *pool);
  }
  points_m_.assign(1, end.position_m);
  radius_m_ = 0.0;
  is_body_ = faces_are_old_ = false;
  ignored_body_ = end.ignored_body;
  mounted_on_ = end.mounted_on;
  beam_.reset();
}

DCEM_INLINE void Sight::look_from(std::span<const Vec3> points_m) {
  Aabb<double> box;
  for (const Vec3& point_m : points_m) box.extend(point_m);
  take_points(points_m, points_m.size() == 1 ? points_m[0] : box.center());
  map_.look_from_by_face(middle_m_, offsets_m_);
  beam_.reset();
  faces_are_old_ = true;
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
  is_body_ = faces_are_old_ = false;
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
  is_body_ = faces_are_old_ = false;
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

/// From one point face by face: each is looked at in one order of its own, however many threads there are.
DCEM_INLINE void Sight::look_at_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                        std::vector<FacetId>& seen, ThreadPool* pool) {
  begin_looking(scene, outlines, settings);
  if (std::exchange(faces_are_old_, false)) {
    for (int face = 0; face < map_.faces(); ++face) map_.empty(face);
  }
  if (map_.faces() == 1 || !map_.is_of_one_point()) {
    look_at_faces(scene, outlines, settings, {}, seen);
    if (pool != nullptr) map_.settle();
  } else {
    look_at_each_face(scene, outlines, settings, pool);
    gather_faces(seen);
  }
  map_.forget_sheets();
}

DCEM_INLINE void Sight::begin_looking(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings) {
  seen_.assign(outlines.size(), 0);
  count_sheets(scene, settings, map_);
  hides_under_feet_ = is_above_feet(outlines);
  hide_nothing_below_feet(outlines, map_);
  reach_m_ = settings.reach_m + radius_m_ + in_reach_m;
  grazed_.clear();
  outlines.planes().for_each_near(position_m(), radius_m_, lift_share() / longest_lift_share, [&](FacetId id) {
    outlines.fetch(scene, id);
    grazed_.push_back(id);
  });
  std::erase_if(grazed_,
                [&](FacetId id) { return !is_lifted_far(scene, outlines, id) || is_out_of_view(outlines.of(id).box); });
}

DCEM_INLINE void Sight::look_at_each_face(const Scene& scene, const FacetOutlines& outlines,
                                          const HalfSettings& settings, ThreadPool* pool) {
  if (pool == nullptr) {
    for (int face = 0; face < map_.faces(); ++face) look_at_face(scene, outlines, settings, face);
    return;
  }
  pool->for_each(static_cast<std::size_t>(map_.faces()), [&](std::size_t number, unsigned) {
    const auto face = static_cast<int>(number);
    look_at_face(scene, outlines, settings, face);
    map_.settle({face, face + 1});
  });
}

DCEM_INLINE void Sight::look_at_face(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                     int face) {
  std::vector<FacetId>& found = found_[static_cast<std::size_t>(face)];
  found.clear();
  look_at_faces(scene, outlines, settings, {face, face + 1}, found);
}

/// What the faces show, each facet once.
DCEM_INLINE void Sight::gather_faces(std::vector<FacetId>& seen) {
  for (std::size_t face = 0; face < static_cast<std::size_t>(map_.faces()); ++face) {
    const unsigned before = (1U << face) - 1U;
    for (const FacetId id : found_[face]) {
      if ((seen_[id.value] & before) == 0) seen.push_back(id);
    }
  }
}

DCEM_INLINE void Sight::look_at_faces(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                      const FaceSpan& faces, std::vector<FacetId>& seen) {
  const auto bit = static_cast<unsigned char>(1U << static_cast<unsigned>(faces.first));
  const bool is_one = faces.last - faces.first == 1;
  const auto look_at = [&](FacetId id) {
    if (is_one && map_.is_beside(outlines.of(id).box, faces.first)) return;
    std::atomic_ref<unsigned char> marks(seen_[id.value]);  // others mark it for their faces
    if ((marks.load(std::memory_order_relaxed) & bit) != 0 || !may_see(scene, outlines, id, faces)) return;
    marks.fetch_or(bit, std::memory_order_relaxed);
    seen.push_back(id);
    cover(scene, outlines, id, settings, map_, faces);
  };
  const auto hidden = [&](const Aabb<double>& box) {
    return is_out_of_view(box) || map_.hides(box, nearer_boxes, faces);
  };
  outlines.visit_from(scene, position_m(), hidden, look_at);
  for (const FacetId id : grazed_) look_at(id);
}

DCEM_INLINE void Sight::look_at_bodies(const Scene& scene, const FacetOutlines& outlines, const BodyChoice& bodies,
                                       std::vector<FacetId>& seen) const {
  for (std::uint32_t number = 0; number < outlines.bodies().size(); ++number) {
    const FacetOutlines::BodyFacets& body = outlines.bodies()[number];
    if (body.box.empty() || !bodies.takes(number + 1)) continue;  // body 0 is the scenery
    if (is_out_of_view(body.box)) continue;
    const bool is_hidden = map_.hides(body.box, nearer_boxes);
    for (std::uint32_t index = body.first; index < body.first + body.count; ++index) {
      const FacetId id(index);
      if (is_hidden && !is_lifted_far(scene, outlines, id, bodies.end_m)) continue;
      if (may_see(scene, outlines, id, {}, bodies.end_m)) seen.push_back(id);
    }
  }
}

DCEM_INLINE void Sight::find_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                     SeenLayer& layer, ThreadPool* pool) {
  layer.mirrors.clear();
  look_at_scenery(scene, outlines, settings, layer.mirrors, pool);
  look_closer(scene, outlines, settings, layer.mirrors, pool);
  finish(scene, outlines, settings, layer, pool);
}

/// A face to each side, then those above and below.
DCEM_INLINE void Sight::find_scenery_step(int step, const Scene& scene, const FacetOutlines& outlines,
                                          const HalfSettings& settings, SeenLayer& layer) {
  constexpr int last_look = scenery_steps - 2;
  DCEM_ASSERT(map_.faces() == last_look + 2);
  const auto look_at = [&](int face) {
    map_.empty(face);
    look_at_face(scene, outlines, settings, face);
  };
  faces_are_old_ = false;
  if (step == 0) begin_looking(scene, outlines, settings);
  if (step < last_look) look_at(step);
  if (step == last_look) {
    look_at(step);
    look_at(step + 1);
    layer.mirrors.clear();
    gather_faces(layer.mirrors);
    map_.forget_sheets();
  }
  if (step <= last_look) return;
  look_closer(scene, outlines, settings, layer.mirrors, nullptr);
  finish(scene, outlines, settings, layer);
}

DCEM_INLINE void Sight::find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                    const BodyChoice& bodies, SeenLayer& layer) const {
  layer.mirrors.clear();
  look_at_bodies(scene, outlines, bodies, layer.mirrors);
  finish(scene, outlines, settings, layer, nullptr, bodies.end_m);
}

DCEM_INLINE void Sight::find_facets(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                    bool bodies, std::vector<FacetId>& seen) {
  seen.clear();
  look_at_scenery(scene, outlines, settings, seen, nullptr);
  look_closer(scene, outlines, settings, seen, nullptr);
  if (bodies) look_at_bodies(scene, outlines, {}, seen);
}

DCEM_INLINE bool Sight::may_see(const Scene& scene, const FacetOutlines& outlines, FacetId id, const FaceSpan& faces,
                                const Vec3* end_m) const {
  const WorldFacet& facet = scene.facet(id);
  if (!facet.present || facet.body == ignored_body_) return false;
  if (reaches_under_feet(outlines, id)) {
    return !beam_ || (id != beam_->mirror() && !beam_->is_beside(outlines.of(id).box));
  }
  if (!beam_) return map_.shows(scene.hull_m(facet), facet.plane, nearer_on(scene, outlines, id, 0.0, end_m), faces);
  if (id == beam_->mirror() || beam_->is_beside(outlines.of(id).box)) return false;
  detail::InsetOutline inside;
  if (!inside.assign(scene.hull_m(facet))) return true;
  if (!beam_->cut(inside)) return inside.is_full();
  return map_.shows(inside.corners(), facet.plane, nearer_on(scene, outlines, id, 0.0, end_m), faces);
}

/// Drops edges. Those after the one that is asked about are fetched, and then their faces.
template <typename Drop>
void keep_edges(const Scene& scene, const FacetOutlines& outlines, std::vector<WedgeId>& edges, Drop&& drop) {
  constexpr std::size_t ahead = 8, soon = 4;
  std::size_t kept = 0;
  for (std::size_t at = 0; at < edges.size(); ++at) {
    if (at + ahead < edges.size()) fetch(scene.wedge(edges[at + ahead]));
    if (at + soon < edges.size()) {
      for (const FacetId face : scene.wedge(edges[at + soon]).facets) {
        fetch(scene.facet(face).plane);
        fetch(outlines.of(face).stray_m);
      }
    }
    if (!drop(edges[at])) edges[kept++] = edges[at];
  }
  edges.resize(kept);
}

/// Adds the edges. Where a point of an edge is seen from its exterior, so is one of its faces beside it: but for a
/// third facet that touches it there, and then nothing diffracts.
DCEM_INLINE void Sight::finish(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                               SeenLayer& layer, ThreadPool* pool, const Vec3* end_m) const {
  const std::span<const Vec3> points_m = points_or(end_m);
  const auto out_of_reach = [&](WedgeId id) {
    const WorldWedge& wedge = scene.wedge(id);
    if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules) || are_inside(points_m, wedge.edge))
      return true;
    const Vec3 &first_m = wedge.edge.start_m, &last_m = wedge.edge.end_m;
    if (is_beyond({glm::min(first_m, last_m), glm::max(first_m, last_m)})) return true;
    return !map_.shows(wedge.edge.start_m, wedge.edge.end_m, nearer_on(scene, outlines, id, end_m));
  };
  std::ranges::sort(layer.mirrors);
  collect_edges(scene, settings.edges ? std::span<const FacetId>(layer.mirrors) : std::span<const FacetId>(),
                layer.edges);
  if (!settings.asked_edges.empty()) {
    std::erase_if(layer.edges, [&](WedgeId id) { return settings.asked_edges[id.value] == 0; });
  }
  if (pool == nullptr) {
    keep_edges(scene, outlines, layer.edges, out_of_reach);
  } else {
    std::vector<char> is_out(layer.edges.size());
    pool->for_each_quick(is_out.size(), [&](std::size_t at) { is_out[at] = out_of_reach(layer.edges[at]) ? 1 : 0; });
    std::size_t kept = 0;
    for (std::size_t at = 0; at < is_out.size(); ++at) {
      if (is_out[at] == 0) layer.edges[kept++] = layer.edges[at];
    }
    layer.edges.resize(kept);
  }
  std::erase_if(layer.mirrors, [&](FacetId id) {
    return std::ranges::binary_search(mounted_on_, id) || are_along(points_m, scene.facet(id).plane);
  });
}

}  // namespace dcem
