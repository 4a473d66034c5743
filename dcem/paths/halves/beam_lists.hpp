#pragma once
/// What an end reaches directly and over each of its mirrors, listed by what is reached.
///
/// Worked out once for many receivers; of an end that stands, what concerns the scenery alone is kept while bodies
/// move.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_finder.hpp"

namespace dcem {

class BeamLists {
 public:
  static constexpr std::uint32_t nothing = 0xffffffffU;
  /// Of an end that is looked at once.
  void find_all(const BeamSource& source);
  /// Of an end that stands, what does not change while bodies move …
  void find_scenery(const BeamSource& source);
  /// … or a part of it after the other: what is seen directly, and then, until it says that all is there, what is seen
  /// over so many mirrors more …
  void begin_scenery(const BeamSource& source);
  bool go_on(const BeamSource& source, std::size_t mirrors);
  /// … and the rest. The scenery's must be known.
  void find_bodies(const BeamSource& source);
  /// Whether what moves is listed, too.
  bool has_bodies() const { return has_bodies_; }

  const PathHalf& half() const { return *half_; }
  /// Of the numbers in single precision.
  const Vec3& origin_m() const { return lanes_->origin_m(); }
  /// Where the end is, from there.
  const Vec3& position_m() const { return position_m_; }
  /// The body that the end rides on.
  const std::optional<BodyId>& ignored_body() const { return half_->ignored_body(); }
  std::span<const BeamMirror> mirrors() const { return mirrors_; }
  /// The place of a facet among the mirrors, or `nothing`.
  std::uint32_t mirror_of(FacetId facet) const { return mirror_of_[facet.value]; }
  /// The parts of edges that the end may see, edge by edge; `EdgePart::edge` is the number of a wedge.
  std::span<const EdgePart> parts() const { return parts_; }
  std::span<const EdgePart> parts_of(WedgeId edge) const {
    return std::span(parts_).subspan(first_part_[edge.value], first_part_[edge.value + 1] - first_part_[edge.value]);
  }

  /// The places of the mirrors over which the end may light a facet.
  std::span<const std::uint32_t> mirrors_before(FacetId facet) const {
    return std::span(before_).subspan(first_before_[facet.value],
                                      first_before_[facet.value + 1] - first_before_[facet.value]);
  }
  /// Boxes that hold all parts.
  std::span<const ConeClusters::Box> boxes_of_parts() const { return part_clusters_.boxes(); }
  /// Calls `visit(part)` for parts on which the point that diffracts between the end and an apex may lie in a cone, for
  /// the apex at `apex` or within `radius_m` of it.
  template <typename Visit>
  void for_each_part_in(std::span<const HalfSpace> cone, const Vec3& apex, float radius_m, Visit&& visit) const {
    part_clusters_.for_each_in(cone, apex, radius_m, visit);
  }
  /// Calls `visit(part, mirror)` for the parts of an edge that mirrors may light, where the point that diffracts
  /// towards `point`, or what is within `radius_m` of it, may lie on the part.
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, const Vec3& point, float radius_m, Visit&& visit) const;
  /// The same of all parts of an edge that mirrors may light.
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, Visit&& visit) const;

 private:
  using Lanes = std::array<float, simd_lanes>;
  /// Eight parts of one edge, each lit by the image in a mirror.
  struct LitLanes {
    Lanes from{}, to{}, place{}, distance{};
    std::array<std::uint32_t, simd_lanes> mirror{};
  };
  void note_mirrors(const BeamSource& source, std::size_t layers);
  void lay_out(const BeamSource& source);
  void list_lit_parts(const Scene& scene);

  const PathHalf* half_ = nullptr;
  const LaneScene* lanes_ = nullptr;
  bool has_bodies_ = false;
  std::size_t looked_through_ = 0;  ///< so many mirrors, where the scenery's are worked out one after the other
  Vec3 position_m_{0.0};
  std::array<BeamFinds, 2> found_;  ///< of the scenery alone, or of all; of what moves
  std::vector<BeamMirror> mirrors_;
  std::vector<std::uint32_t> mirror_of_;
  std::vector<std::uint32_t> before_;
  std::vector<std::size_t> first_before_;
  std::vector<EdgePart> parts_;
  std::vector<std::size_t> first_part_, first_lit_;
  EdgeClusters part_clusters_;
  std::vector<LitLanes> lit_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline void BeamLists::find_all(const BeamSource& source) {
  note_mirrors(source, source.half.layers().size());
  has_bodies_ = true;
  found_ = {};
  const BeamFinder finder(source, mirrors_);
  for (const HalfLayer& layer : half_->layers()) finder.find_parts(layer, BeamFinder::many_pieces, found_[0]);
  if (source.over_mirrors) finder.look_through(0, mirrors_.size(), true, BeamFinder::few_pieces, found_[0]);
  lay_out(source);
}

inline void BeamLists::find_scenery(const BeamSource& source) {
  begin_scenery(source);
  go_on(source, mirrors_.size());
}

inline void BeamLists::begin_scenery(const BeamSource& source) {
  note_mirrors(source, 1);
  has_bodies_ = source.outlines.bodies().empty();
  found_ = {};
  looked_through_ = 0;
  BeamFinder(source, mirrors_).find_parts(half_->layers()[0], BeamFinder::many_pieces, found_[0]);
}

inline bool BeamLists::go_on(const BeamSource& source, std::size_t mirrors) {
  const std::size_t last = source.over_mirrors ? std::min(looked_through_ + mirrors, mirrors_.size()) : 0;
  BeamFinder(source, mirrors_).look_through(looked_through_, last, false, BeamFinder::many_pieces, found_[0]);
  looked_through_ = last;
  const bool is_done = !source.over_mirrors || last == mirrors_.size();
  if (is_done) lay_out(source);
  return is_done;
}

inline void BeamLists::find_bodies(const BeamSource& source) {
  note_mirrors(source, source.half.layers().size());
  has_bodies_ = true;
  found_[1] = {};
  const BeamFinder finder(source, mirrors_);
  for (const HalfLayer& layer : half_->layers().subspan(1)) finder.find_parts(layer, BeamFinder::few_pieces, found_[1]);
  if (source.over_mirrors) {
    const std::size_t standing = half_->layers()[0].mirrors.size();
    finder.reach_bodies(standing, found_[1]);
    finder.look_through(standing, mirrors_.size(), true, BeamFinder::few_pieces, found_[1]);
  }
  lay_out(source);
}

/// Of so many layers: that of the scenery comes first.
inline void BeamLists::note_mirrors(const BeamSource& source, std::size_t layers) {
  half_ = &source.half;
  lanes_ = &source.lanes;
  position_m_ = half_->position_m() - source.lanes.origin_m();
  mirror_of_.assign(source.scene.facets().size(), nothing);
  mirrors_.clear();
  for (const HalfLayer& layer : half_->layers().first(layers)) {
    for (std::size_t at = 0; at < layer.mirrors.size(); ++at) {
      mirror_of_[layer.mirrors[at].value] = static_cast<std::uint32_t>(mirrors_.size());
      mirrors_.push_back({layer.mirrors[at], layer.images_m[at] - source.lanes.origin_m(), layer.cones[at]});
    }
  }
}

/// Lists what has been found by what is reached.
inline void BeamLists::lay_out(const BeamSource& source) {
  const Scene& scene = source.scene;
  parts_ = found_[0].parts;
  parts_.insert(parts_.end(), found_[1].parts.begin(), found_[1].parts.end());
  std::ranges::stable_sort(parts_, {}, &EdgePart::edge);
  first_part_.assign(scene.wedges().size() + 1, 0);
  for (const EdgePart& part : parts_) ++first_part_[part.edge + 1];
  for (std::size_t edge = 1; edge < first_part_.size(); ++edge) first_part_[edge] += first_part_[edge - 1];
  part_clusters_.build(parts_, source.lanes.origin_m(),
                       [&](const EdgePart& part) -> const Wedge& { return scene.wedge(WedgeId(part.edge)).edge; });
  first_before_.assign(scene.facets().size() + 1, 0);
  for (const BeamFinds& found : found_) {
    for (const auto& pair : found.pairs) ++first_before_[pair[0] + 1];
  }
  for (std::size_t seen = 1; seen < first_before_.size(); ++seen) first_before_[seen] += first_before_[seen - 1];
  before_.resize(first_before_.back());
  std::vector<std::size_t> next(first_before_.begin(), first_before_.end() - 1);
  for (const BeamFinds& found : found_) {
    for (const auto& [seen, mirror] : found.pairs) before_[next[seen]++] = mirror;
  }
  list_lit_parts(scene);
}

/// Lays out lit parts in eights, edge by edge.
inline void BeamLists::list_lit_parts(const Scene& scene) {
  first_lit_.assign(scene.wedges().size() + 1, 0);
  for (const BeamFinds& found : found_) {
    for (const std::uint32_t edge : found.lit_edges) ++first_lit_[edge + 1];
  }
  for (std::size_t edge = 1; edge < first_lit_.size(); ++edge) {
    first_lit_[edge] = first_lit_[edge - 1] + (first_lit_[edge] + simd_lanes - 1) / simd_lanes;
  }
  LitLanes none;
  none.to.fill(-1e30F);
  none.mirror.fill(nothing);
  lit_.assign(first_lit_.back(), none);
  std::vector<std::size_t> count(scene.wedges().size(), 0);
  for (const BeamFinds& found : found_) {
    for (std::size_t at = 0; at < found.lit.size(); ++at) {
      const std::uint32_t edge = found.lit_edges[at];
      const std::size_t number = count[edge]++, lane = number % simd_lanes;
      LitLanes& eight = lit_[first_lit_[edge] + number / simd_lanes];
      eight.from[lane] = found.lit[at].from;
      eight.to[lane] = found.lit[at].to;
      eight.place[lane] = found.lit[at].place;
      eight.distance[lane] = found.lit[at].distance;
      eight.mirror[lane] = found.lit[at].edge;
    }
  }
}

template <typename Visit>
void BeamLists::for_each_lit_part(WedgeId edge, Visit&& visit) const {
  for (std::size_t at = first_lit_[edge.value]; at < first_lit_[edge.value + 1]; ++at) {
    const LitLanes& eight = lit_[at];
    for (std::size_t lane = 0; lane < simd_lanes && eight.mirror[lane] != nothing; ++lane) {
      visit(EdgePart{edge.value, eight.from[lane], eight.to[lane], eight.place[lane], eight.distance[lane]},
            eight.mirror[lane]);
    }
  }
}

template <typename Visit>
void BeamLists::for_each_lit_part(WedgeId edge, const Vec3& point, float radius_m, Visit&& visit) const {
  const LaneEdge& line = lanes_->edge(edge);
  const Vec3 away = point - Vec3(line.start[0], line.start[1], line.start[2]);
  const Vec3 direction(line.direction[0], line.direction[1], line.direction[2]);
  const double place_m = glm::dot(away, direction);
  const Float8 place(static_cast<float>(place_m)),
      distance(static_cast<float>(glm::length(away - place_m * direction)));
  const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(point) + glm::length(away));
  for (std::size_t at = first_lit_[edge.value]; at < first_lit_[edge.value + 1]; ++at) {
    const LitLanes& eight = lit_[at];
    const Float8 own_place(eight.place), own_distance(eight.distance);
    const Float8 sum = own_distance + distance, between = place - own_place;
    const Float8 met = own_place + between * (own_distance / sum);
    const Float8 reach = edge_point_reach_m(own_distance, sum, between, radius_m) +
                         edge_point_error_m(own_place, own_distance) + slack_m;
    std::uint32_t left = ~((met + reach < Float8(eight.from)) | (Float8(eight.to) + reach < met)).bits() & 0xffU;
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      if (eight.mirror[lane] == nothing) continue;
      visit(EdgePart{edge.value, eight.from[lane], eight.to[lane], eight.place[lane], eight.distance[lane]},
            eight.mirror[lane]);
    }
  }
}

}  // namespace dcem
