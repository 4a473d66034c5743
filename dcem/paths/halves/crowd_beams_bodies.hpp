#pragma once
/// Bodies of crowd_beams.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/crowd_beams.hpp"

namespace dcem {

DCEM_INLINE void CrowdBeams::Lists::lay_out(std::size_t count) {
  first_.assign(count + 1, 0);
  for (const auto& [lit, mirror] : found_) ++first_[lit + 1];
  for (std::size_t lit = 1; lit < first_.size(); ++lit) first_[lit] += first_[lit - 1];
  mirrors_.resize(found_.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& [lit, mirror] : found_) mirrors_[next[lit]++] = mirror;
}

DCEM_INLINE void CrowdBeams::look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                       const Crowd& crowd, const HalfSettings& settings) {
  take_mirrors(scene, outlines, lanes, crowd);
  pairs_.clear();
  lit_.clear();
  for (std::uint32_t place = 0; place < mirrors_.size(); ++place) {
    sight_.look_through(scene, outlines, mirrors_[place].facet, mirrors_[place].images_m);
    sight_.find_facets(scene, outlines, settings, true, seen_);
    for (const FacetId seen : seen_) pairs_.add(seen.value, place);
    if (settings.edges) find_lit_edges(scene, outlines, lanes, settings, place);
  }
  pairs_.lay_out(scene.facets().size());
  lit_.lay_out(scene.wedges().size());
}

DCEM_INLINE void CrowdBeams::take_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                          const Crowd& crowd) {
  struct Extent {
    std::size_t first_plane, first_image;
  };
  std::vector<Extent> extents;
  std::vector<HalfSpace> cone;
  std::vector<Vec3> points_m;
  mirrors_.clear();
  planes_.clear();
  images_m_.clear();
  for (const SeenLayer& layer : crowd.layers()) {
    for (const FacetId facet : layer.mirrors) {
      const Plane& plane = scene.facet(facet).plane;
      for (const double side : {1.0, -1.0}) {
        if (!crowd.cone(outlines, facet, plane, side, cone)) continue;
        crowd.points_beside(plane, side, points_m);
        extents.push_back({planes_.size(), images_m_.size()});
        planes_.insert(planes_.end(), cone.begin(), cone.end());
        for (const Vec3& point_m : points_m) images_m_.push_back(mirrored(plane, point_m));
        const Vec3 middle_m = mirrored(plane, crowd.sight().position_m()) - lanes.origin_m();
        mirrors_.push_back({facet, side, middle_m, {}, {}});
      }
    }
  }
  extents.push_back({planes_.size(), images_m_.size()});
  for (std::size_t place = 0; place < mirrors_.size(); ++place) {
    const auto [plane, image] = extents[place];
    mirrors_[place].cone = std::span(planes_).subspan(plane, extents[place + 1].first_plane - plane);
    mirrors_[place].images_m = std::span(images_m_).subspan(image, extents[place + 1].first_image - image);
  }
}

/// Of the edges of what has been seen through a mirror, those of which a part may be.
DCEM_INLINE void CrowdBeams::find_lit_edges(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                            const HalfSettings& settings, std::uint32_t mirror) {
  collect_edges(scene, seen_, edges_);
  for (const WedgeId id : edges_) {
    if (!may_light(scene, settings, mirrors_[mirror], id)) continue;
    const Wedge& edge = scene.wedge(id).edge;
    EdgePart part = whole_edge(id.value, edge, sight_.position_m());
    cut_to_cone(part, edge, lanes.origin_m(), mirrors_[mirror].cone);
    if (part.from > part.to) continue;
    const Vec3 direction = edge_direction(edge);
    const Vec3 from_m = edge.start_m + static_cast<double>(part.from) * direction;
    const Vec3 to_m = edge.start_m + static_cast<double>(part.to) * direction;
    if (sight_.shows(scene, outlines, id, from_m, to_m)) lit_.add(id.value, mirror);
  }
}

DCEM_INLINE bool CrowdBeams::may_light(const Scene& scene, const HalfSettings& settings, const CrowdMirror& mirror,
                                       WedgeId id) const {
  const WorldWedge& wedge = scene.wedge(id);
  if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) return false;
  if (wedge.facets[0] == mirror.facet || wedge.facets[1] == mirror.facet) return false;  // in the wedge's own terms
  return std::ranges::any_of(mirror.images_m,
                             [&](const Vec3& image_m) { return may_face(wedge.edge, image_m - wedge.edge.start_m); });
}

}  // namespace dcem
