#pragma once
/// Bodies of candidate_pool.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/candidate_pool.hpp"

namespace dcem {

DCEM_INLINE CandidatePool::CandidatePool(std::shared_ptr<const Place> place, const BeamLists& reached,
                                         const JoinOrders& orders)
    : place_(std::move(place)),
      reached_(reached),
      orders_(orders),
      knows_edges_(reached.knows_edges()),
      edges_(place_->box().middle_m) {}

DCEM_INLINE void CandidatePool::go_on(const Scene& scene, const FacetOutlines& outlines) {
  const auto step = static_cast<std::size_t>(steps - steps_left_);
  --steps_left_;
  if (orders_.interactions < 1) return;
  if (steps_left_ == 0) {
    if (orders_.diffractions >= 1) find_over_edges(scene);
    fit();
    return;
  }
  if (orders_.reflections < 1) return;
  if (step == 0) find_single_mirrors();
  if (orders_.interactions < 2) return;
  const std::span<const PlaceMirror> all = place_->mirrors();
  constexpr std::size_t parts = steps - 1;
  const std::size_t first = all.size() * step / parts, last = all.size() * (step + 1) / parts;
  for (const PlaceMirror& mirror : all.subspan(first, last - first)) find_over_mirror(scene, outlines, mirror);
}

DCEM_INLINE void CandidatePool::find_single_mirrors() {
  const Vec3 middle = place_->box().middle_m - reached_.origin_m();
  for (const FacetId facet : place_->scenery().mirrors) {
    const std::uint32_t own = reached_.mirror_of(facet);
    if (own != BeamLists::nothing &&
        may_hold(reached_.mirrors()[own].cone, middle, static_cast<float>(place_->radius_m()))) {
      mirrors_.push_back({alone, own});
    }
  }
}

DCEM_INLINE void CandidatePool::find_over_mirror(const Scene& scene, const FacetOutlines& outlines,
                                                 const PlaceMirror& mirror) {
  const Vec3 image = mirror.image_m - reached_.origin_m();
  if (orders_.reflections >= 2) {
    listed().for_each_mirror_before(mirror.facet, mirror.cone, [&](std::uint32_t far) {
      const BeamMirror& first = reached_.mirrors()[far];
      if (may_hold(first.cone, image, static_cast<float>(place_->radius_m()))) mirrors_.push_back({mirror.number, far});
    });
  }
  if (orders_.diffractions >= 1) find_edges_over(scene, outlines, mirror);
}

DCEM_INLINE void CandidatePool::find_edges_over(const Scene& scene, const FacetOutlines& outlines,
                                                const PlaceMirror& mirror) {
  const Plane& plane = scene.facet(mirror.facet).plane;
  std::array<Vec3, 8> images_m;
  for (std::size_t corner = 0; corner < images_m.size(); ++corner) {
    images_m[corner] = mirrored(plane, place_->corners_m()[corner]);
  }
  const Vec3 image = mirror.image_m - reached_.origin_m();
  edges_.begin_mirror(plane, outlines.sides(mirror.facet));
  listed().for_each_part_before(
      mirror.facet, mirror.cone, image, static_cast<float>(place_->radius_m()), [&](const EdgePart& part) {
        const WorldWedge& wedge = scene.wedge(WedgeId(part.edge));
        if (holds_edge(plane, wedge.edge, scene.settings().weld_tolerance_m)) return;
        // The wedge's solid is convex: what all corners are inside of, the whole place is.
        const bool is_inside = std::ranges::none_of(
            images_m, [&](const Vec3& image_m) { return may_face(wedge.edge, image_m - wedge.edge.start_m); });
        if (is_inside) return;
        over_mirrors_.push_back({mirror.number, WedgeId(part.edge)});
        edges_.add_over(plane, wedge.edge, part);
      });
}

DCEM_INLINE void CandidatePool::find_over_edges(const Scene& scene) {
  const auto radius_m = static_cast<float>(place_->radius_m());
  const Vec3 middle = place_->box().middle_m - reached_.origin_m();
  for (const WedgeId edge : place_->scenery().edges) {
    const Wedge& wedge = scene.wedge(edge).edge;
    for (const EdgePart& part : listed().parts_of(edge)) {
      direct_.push_back({edge, alone});
      edges_.add(wedge, part);
    }
    if (orders_.interactions < 2 || orders_.reflections < 1) continue;
    listed().for_each_lit_part(edge, middle, radius_m, [&](const EdgePart& part, std::uint32_t far) {
      const Plane& plane = scene.facet(reached_.mirrors()[far].facet).plane;
      if (holds_edge(plane, wedge, scene.settings().weld_tolerance_m)) return;
      direct_.push_back({edge, far});
      edges_.add(wedge, part);
    });
  }
}

DCEM_INLINE bool CandidatePool::aim(const JoinGates& gates, const Vec3& receiver_m, std::size_t number,
                                    CandidateWay& way) const {
  const Scene& scene = gates.scene();
  const auto image_m = [&](FacetId facet) { return mirrored(scene.facet(facet).plane, receiver_m); };
  way.apex_m = reached_.half().position_m();
  way.elements.clear();
  const auto put = [&](SequenceElement element, const std::optional<Vec3>& point_m) {
    if (!point_m) return false;
    way.elements.push_back(element);
    way.points_m[way.elements.size() - 1] = *point_m;
    return true;
  };
  const auto take_far = [&](std::uint32_t place) {
    way.apex_m = reached_.mirrors()[place].image_m + reached_.origin_m();
    return reached_.mirrors()[place].facet;
  };
  if (number < mirrors_.size()) {
    const MirrorCandidate& one = mirrors_[number];
    const FacetId far = take_far(one.far);
    if (one.near == alone) return put(far, gates.crossing(far, way.apex_m, receiver_m));
    const FacetId near = place_->scenery().mirrors[one.near];
    const Vec3 near_image_m = image_m(near);
    const auto far_m = gates.crossing(far, way.apex_m, near_image_m);
    return far_m && put(near, gates.crossing(near, near_image_m, *far_m)) && put(far, far_m);
  }
  number -= mirrors_.size();
  if (number < direct_.size()) {
    const DirectCandidate& one = direct_[number];
    if (one.far == alone) return put(one.edge, gates.edge_point(one.edge, receiver_m, way.apex_m));
    const FacetId far = take_far(one.far);
    if (!put(one.edge, gates.edge_point(one.edge, receiver_m, way.apex_m))) return false;
    if (!put(far, gates.crossing(far, way.apex_m, way.points_m[0]))) return false;
    return may_face(scene.wedge(one.edge).edge, way.points_m[1] - way.points_m[0]);
  }
  const MirroredCandidate& one = over_mirrors_[number - direct_.size()];
  const FacetId near = place_->scenery().mirrors[one.near];
  const Vec3 near_image_m = image_m(near);
  const auto edge_m = gates.edge_point(one.edge, way.apex_m, near_image_m);
  if (!edge_m || !put(near, gates.crossing(near, near_image_m, *edge_m)) || !put(one.edge, edge_m)) return false;
  return may_face(scene.wedge(one.edge).edge, way.points_m[0] - way.points_m[1]);
}

DCEM_INLINE void CandidatePool::fit() {
  mirrors_.shrink_to_fit();
  direct_.shrink_to_fit();
  over_mirrors_.shrink_to_fit();
  edges_.fit();
}

DCEM_INLINE std::uint64_t CandidatePool::key(std::size_t number) const {
  const auto pair = [](std::uint64_t near, std::uint64_t far) { return (near << 32U) | far; };
  if (number < mirrors_.size()) {
    const MirrorCandidate& one = mirrors_[number];
    const std::uint32_t far = reached_.mirrors()[one.far].facet.value;
    return one.near == alone ? pair(alone, far) : pair(place_->scenery().mirrors[one.near].value, far);
  }
  number -= mirrors_.size();
  if (number < direct_.size()) {
    const DirectCandidate& one = direct_[number];
    const std::uint32_t edge = SequenceElement(one.edge).code();
    return one.far == alone ? pair(alone, edge) : pair(edge, reached_.mirrors()[one.far].facet.value);
  }
  const MirroredCandidate& one = over_mirrors_[number - direct_.size()];
  return pair(place_->scenery().mirrors[one.near].value, SequenceElement(one.edge).code());
}

}  // namespace dcem
