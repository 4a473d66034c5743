#pragma once
/// Bodies of shared_beams.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/facet_edges.hpp"
#include "dcem/paths/halves/shared_beams.hpp"

namespace dcem {

DCEM_INLINE void SharedBeams::Lists::lay_out(std::size_t count) {
  first_.assign(count + 1, 0);
  for (const auto& [lit, mirror] : found_) ++first_[lit + 1];
  for (std::size_t lit = 1; lit < first_.size(); ++lit) first_[lit] += first_[lit - 1];
  mirrors_.resize(found_.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& [lit, mirror] : found_) mirrors_[next[lit]++] = mirror;
}

DCEM_INLINE void SharedBeams::begin(bool all_between) {
  all_between_ = all_between;
  pairs_.clear();
  lit_.clear();
}

DCEM_INLINE void SharedBeams::find_lit_facets(const Scene& scene, const FacetOutlines& outlines,
                                              const HalfSettings& settings, const SharedMirror& mirror,
                                              std::uint32_t place, bool bodies) {
  sight_.look_through(scene, outlines, mirror.facet, mirror.images_m, all_between_);
  sight_.find_facets(scene, outlines, settings, bodies, seen_);
  for (const FacetId seen : seen_) pairs_.add(seen.value, place);
}

DCEM_INLINE void SharedBeams::lay_out(const Scene& scene) {
  pairs_.lay_out(scene.facets().size());
  lit_.lay_out(scene.wedges().size());
}

DCEM_INLINE void SharedBeams::fit() {
  sight_ = Sight(view_pixels);
  pairs_.fit();
  lit_.fit();
  seen_ = {};
  edges_ = {};
}

/// Of the edges of what has been seen through a mirror, those of which a part may be.
DCEM_INLINE void SharedBeams::find_lit_edges(const Scene& scene, const FacetOutlines& outlines, const Vec3& origin_m,
                                             const HalfSettings& settings, const SharedMirror& mirror,
                                             std::uint32_t place) {
  if (!settings.edges) return;
  collect_edges(scene, seen_, edges_);
  for (const WedgeId id : edges_) {
    if (!may_light(scene, settings, mirror, id)) continue;
    const Wedge& edge = scene.wedge(id).edge;
    EdgePart part = whole_edge(id.value, edge, sight_.position_m());
    cut_to_contact(part, contact_at(id, settings.rules));
    cut_to_cone(part, edge, origin_m, mirror.cone);
    if (part.from > part.to) continue;
    const Vec3 direction = edge_direction(edge);
    const Vec3 from_m = edge.start_m + static_cast<double>(part.from) * direction;
    const Vec3 to_m = edge.start_m + static_cast<double>(part.to) * direction;
    if (sight_.shows(scene, outlines, id, from_m, to_m)) lit_.add(id.value, place);
  }
}

DCEM_INLINE bool SharedBeams::may_light(const Scene& scene, const HalfSettings& settings, const SharedMirror& mirror,
                                        WedgeId id) {
  const WorldWedge& wedge = scene.wedge(id);
  if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) return false;
  if (wedge.facets[0] == mirror.facet || wedge.facets[1] == mirror.facet) return false;  // in the wedge's own terms
  // The wedge's solid is convex: what all points are inside of, all between them is.
  return std::ranges::any_of(mirror.images_m,
                             [&](const Vec3& image_m) { return may_face(wedge.edge, image_m - wedge.edge.start_m); });
}

}  // namespace dcem
