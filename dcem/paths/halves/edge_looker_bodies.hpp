#pragma once
/// Bodies of edge_looker.hpp.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/edge_looker.hpp"
#include "dcem/paths/halves/hiding_outlines.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

DCEM_INLINE void EdgeLooker::look_over(std::span<const EdgePart> all, std::size_t first, std::size_t last,
                                       std::vector<std::array<std::uint32_t, 2>>& lit) {
  constexpr double nearer_boxes_share = 0.005;  // of the way, by which boxes count as nearer: as in `Sight`
  const std::span<const EdgePart> parts = all.subspan(first, last - first);
  const WorldWedge& wedge = scene_.wedge(WedgeId(parts.front().edge));
  view_.look_from(wedge.edge, parts);
  shown_.clear();
  const auto hidden = [&](const Aabb<double>& box) { return view_.hides(box); };
  const auto ask_one = [&](FacetId id) { ask(id, wedge); };
  outlines_.visit_from(scene_, 0.5 * (view_.first_m() + view_.last_m()), hidden, ask_one);
  outlines_.planes().for_each_between(view_.first_m(), view_.last_m(), 1.0 / nearer_boxes_share, [&](FacetId id) {
    if (is_asked_[id.value] != 0) return;
    outlines_.fetch(scene_, id);
    grazed_.push_back(id);
  });
  std::ranges::for_each(grazed_, ask_one);
  grazed_.clear();
  for (const FacetId id : asked_) is_asked_[id.value] = 0;
  asked_.clear();
  for (const auto& [facet, cells] : shown_) {
    const float from_m = view_.from_m(static_cast<std::uint32_t>(std::countr_zero(cells)));
    const float to_m = view_.to_m(static_cast<std::uint32_t>(std::bit_width(cells) - 1));
    for (std::size_t at = first; at < last; ++at) {
      if (all[at].from <= to_m && from_m <= all[at].to) lit.push_back({facet, static_cast<std::uint32_t>(at)});
    }
  }
}

/// A mirror that holds the edge in its plane gives no path over it, and its rays along that plane hide nothing.
DCEM_INLINE void EdgeLooker::ask(FacetId id, const WorldWedge& wedge) {
  if (is_asked_[id.value] != 0) return;
  is_asked_[id.value] = 1;
  asked_.push_back(id);
  const WorldFacet& facet = scene_.facet(id);
  if (!facet.present || holds_edge(facet.plane, wedge.edge, scene_.settings().weld_tolerance_m)) return;
  const std::uint32_t cells = view_.look_at(scene_.hull_m(facet), facet.plane, outlines_.of(id).lift_m);
  if (cells == 0) return;
  if (wedge.facets[0] == id || wedge.facets[1] == id) return;  // that is in the wedge's own terms
  shown_.push_back({id.value, cells});
  if ((hides_sheets_ || !facet.transmits) && !is_ignored_along(id, wedge)) cover(id);
}

/// Whether legs that leave the edge along one of its faces may ignore a facet: it lies along the face somewhere.
DCEM_INLINE bool EdgeLooker::is_ignored_along(FacetId id, const WorldWedge& wedge) const {
  const WorldFacet& facet = scene_.facet(id);
  const double tolerance_m = outlines_.of(id).lift_m;
  return std::ranges::any_of(wedge.facets, [&](FacetId face) {
    const Plane& plane = scene_.facet(face).plane;
    if (std::abs(glm::dot(plane.normal, facet.plane.normal)) <= lies_along_cosine) return false;
    double least_m = std::numeric_limits<double>::infinity(), most_m = -least_m;
    for (const Vec3& corner_m : scene_.hull_m(facet)) {
      const double distance_m = signed_distance_m(plane, corner_m);
      least_m = std::min(least_m, distance_m);
      most_m = std::max(most_m, distance_m);
    }
    return least_m <= tolerance_m && most_m >= -tolerance_m;
  });
}

DCEM_INLINE void EdgeLooker::cover(FacetId id) {
  const FacetOutline& outline = outlines_.of(id);
  detail::for_each_hiding_outline(scene_, outlines_, id, [&](std::span<const Vec3> corners_m, const Plane* own) {
    if (own == nullptr) return view_.cover(corners_m, scene_.facet(id).plane, outline.lift_m, outline.stray_m);
    view_.cover(corners_m, *own, std::max(outline.lift_m, 0.5 * detail::hiding_triangle_m), 0.0);
  });
}

}  // namespace dcem
