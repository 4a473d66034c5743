#pragma once
/// Bodies of beam_table.hpp.
#include <algorithm>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/beam_table.hpp"

namespace dcem {

DCEM_INLINE void BeamTable::lay_out(const Scene& scene, const LaneScene& lanes, const BeamFinds& finds,
                                    std::span<const BeamMirror> mirrors) {
  lanes_ = &lanes;
  before_.resize(finds.pairs.size());
  before_rows_.build(
      scene.facets().size(), finds.pairs.size(), 1, [&](std::size_t item) { return finds.pairs[item][0]; },
      [&](std::size_t item, std::uint32_t place) { before_[place] = finds.pairs[item][1]; });
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float>& places = images_[static_cast<std::size_t>(axis)];
    places.assign(before_.size() + simd_lanes - 1, 0.0F);
    std::ranges::transform(before_, places.begin(),
                           [&](std::uint32_t mirror) { return static_cast<float>(mirrors[mirror].image_m[axis]); });
  }
  lay_out_parts(scene, finds);
  listed_facets_ = 0;
  lay_out_lit_parts(scene, finds);
}

DCEM_INLINE void BeamTable::lay_out_parts(const Scene& scene, const BeamFinds& finds) {
  parts_.resize(finds.parts.size());
  part_rows_.build(
      scene.wedges().size(), parts_.size(), 1, [&](std::size_t item) { return finds.parts[item].edge; },
      [&](std::size_t item, std::uint32_t place) { parts_[place] = finds.parts[item]; });
  part_clusters_.build(parts_, lanes_->origin_m(),
                       [&](const EdgePart& part) -> const Wedge& { return scene.wedge(WedgeId(part.edge)).edge; });
  find_body_boxes(scene);
}

DCEM_INLINE void BeamTable::list_parts_before(const Scene& scene, std::span<const std::array<std::uint32_t, 2>> lit) {
  const auto nowhere = static_cast<std::uint32_t>(parts_.size());
  part_records_.assign(parts_.size() + 1, {});
  part_records_.back().direction_to[3] = -1e30F;
  part_records_.back().place_distance[1] = 1.0F;  // where an apex on its line would be met, too, were it 0
  for (std::size_t at = 0; at < parts_.size(); ++at) {
    const EdgePart& part = parts_[at];
    const LaneEdge& edge = lanes_->edge(WedgeId(part.edge));
    part_records_[at] = {{edge.start[0], edge.start[1], edge.start[2], part.from},
                         {edge.direction[0], edge.direction[1], edge.direction[2], part.to},
                         {part.place, part.distance, 0.0F, 0.0F}};
  }
  before_part_rows_.build(
      scene.facets().size(), lit.size(), simd_lanes, [&](std::size_t item) { return lit[item][0]; },
      [&](std::size_t item, std::uint32_t place) {
        if (item == 0) before_parts_.assign(before_part_rows_.size(), nowhere);
        before_parts_[place] = lit[item][1];
      });
  listed_facets_ = scene.bodies().size() > 1 ? scene.world().first(BodyId(1)).facet
                                             : static_cast<std::uint32_t>(scene.facets().size());
}

/// Bodies are small and apart: a box around parts of several of them says little.
DCEM_INLINE void BeamTable::find_body_boxes(const Scene& scene) {
  body_boxes_.clear();
  for (std::size_t first = 0, last = 0; first < parts_.size(); first = last) {
    const BodyId body = scene.wedge(WedgeId(parts_[first].edge)).body;
    if (body == BodyId(0)) return body_boxes_.clear();
    Aabb<double> box;
    for (; last < parts_.size() && scene.wedge(WedgeId(parts_[last].edge)).body == body; ++last) {
      const Wedge& edge = scene.wedge(WedgeId(parts_[last].edge)).edge;
      box.extend(edge.start_m - lanes_->origin_m());
      box.extend(edge.end_m - lanes_->origin_m());
    }
    body_boxes_.push_back(ConeClusters::box_of(box));
  }
}

/// In eights, edge by edge.
DCEM_INLINE void BeamTable::lay_out_lit_parts(const Scene& scene, const BeamFinds& finds) {
  LitLanes none;
  none.to.fill(-1e30F);
  none.mirror.fill(nothing);
  lit_.clear();
  lit_rows_.build(
      scene.wedges().size(), finds.lit.size(), simd_lanes, [&](std::size_t item) { return finds.lit_edges[item]; },
      [&](std::size_t item, std::uint32_t place) {
        if (lit_.empty()) lit_.assign(lit_rows_.size() / simd_lanes, none);
        LitLanes& eight = lit_[place / simd_lanes];
        const std::size_t lane = place % simd_lanes;
        const EdgePart& part = finds.lit[item];
        eight.from[lane] = part.from;
        eight.to[lane] = part.to;
        eight.place[lane] = part.place;
        eight.distance[lane] = part.distance;
        eight.mirror[lane] = part.edge;
      });
}

}  // namespace dcem
