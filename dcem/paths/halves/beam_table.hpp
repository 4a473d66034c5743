#pragma once
/// What an end reaches directly and over some of its mirrors, laid out by what is reached.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_finder.hpp"
#include "dcem/paths/halves/row_index.hpp"

namespace dcem {

class BeamTable {
 public:
  static constexpr std::uint32_t nothing = 0xffffffffU;

  /// The lanes must stay. `mirrors`: those whose places have been found.
  void lay_out(const Scene& scene, const LaneScene& lanes, const BeamFinds& finds, std::span<const BeamMirror> mirrors);

  /// Facets that are lit over mirrors, ascending; the places of the mirrors over which one may be; and, to be visited,
  /// of those of them whose images may lie in a cone.
  std::span<const std::uint32_t> lit_facets() const { return before_rows_.used(); }
  std::span<const std::uint32_t> mirrors_before(FacetId facet) const {
    const RowIndex::Row row = before_rows_.row(facet.value);
    return std::span(before_).subspan(row.first, row.last - row.first);
  }
  template <typename Visit>
  void for_each_mirror_before(FacetId facet, std::span<const HalfSpace> cone, Visit&& visit) const;
  /// Of those whose images, mirrored in the facet, may see some of the boxes through it.
  template <typename Visit>
  void for_each_mirror_before(FacetId facet, const WindowOutline& window, std::span<const CentredBox> boxes,
                              Visit&& visit) const;
  /// Edges that are lit over mirrors, ascending.
  std::span<const std::uint32_t> lit_edges() const { return lit_rows_.used(); }
  /// Calls `visit(part, mirror)` for the parts of an edge that mirrors may light, where the point that diffracts
  /// towards `point`, or what is within `radius_m` of it, may lie on the part.
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, const Vec3& point, float radius_m, Visit&& visit) const;
  /// The same of all parts of an edge that mirrors may light.
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, Visit&& visit) const;

  /// The parts of edges that the end may see, edge by edge; `EdgePart::edge` is the number of a wedge.
  std::span<const EdgePart> parts() const { return parts_; }
  std::span<const EdgePart> parts_of(WedgeId edge) const {
    const RowIndex::Row row = part_rows_.row(edge.value);
    return std::span(parts_).subspan(row.first, row.last - row.first);
  }
  /// From now on it is known over which parts the end may light the facets of the scenery; `lit`: as `BeamFinder` has
  /// it.
  void list_parts_before(const Scene& scene, std::span<const std::array<std::uint32_t, 2>> lit);
  bool knows_parts_before() const { return listed_facets_ > 0; }
  /// Boxes that hold all parts: of bodies one for each of them.
  std::span<const CentredBox> boxes_of_parts() const {
    return body_boxes_.empty() ? part_clusters_.boxes() : std::span<const CentredBox>(body_boxes_);
  }
  /// Whether the end may light a facet over a mirror or an edge.
  bool lights(FacetId facet) const {
    if (!mirrors_before(facet).empty()) return true;
    if (facet.value >= listed_facets_) return !parts_.empty();
    const RowIndex::Row row = before_part_rows_.row(facet.value);
    return row.first != row.last;
  }
  /// Whether the end may light an edge, directly or over a mirror.
  bool lights(WedgeId edge) const {
    const RowIndex::Row lit = lit_rows_.row(edge.value);
    return !parts_of(edge).empty() || lit.first != lit.last;
  }
  /// Asks for what is listed of a facet that is soon asked about.
  [[gnu::always_inline]] void fetch(FacetId facet) const {
    before_rows_.fetch(facet.value);
    if (facet.value < listed_facets_) before_part_rows_.fetch(facet.value);
  }
  /// Calls `visit(part)` for parts on which the point that diffracts between the end and an apex may lie in a cone, for
  /// the apex at `apex` or within `radius_m` of it.
  template <typename Visit>
  void for_each_part_in(std::span<const HalfSpace> cone, const Vec3& apex, float radius_m, Visit&& visit) const {
    part_clusters_.for_each_in(cone, apex, radius_m, [&](std::uint32_t number) { visit(parts_[number]); });
  }
  /// The same for parts over which the end may light a facet, through which the cone looks: where that is not known,
  /// for all.
  template <typename Visit>
  void for_each_part_before(FacetId facet, std::span<const HalfSpace> cone, const Vec3& apex, float radius_m,
                            Visit&& visit) const;

 private:
  using Lanes = std::array<float, simd_lanes>;
  /// Eight parts of one edge, each lit by the image in a mirror.
  struct LitLanes {
    Lanes from{}, to{}, place{}, distance{};
    std::array<std::uint32_t, simd_lanes> mirror{};
  };
  PointRow images_in(const RowIndex::Row& row) const {
    return {{&images_[0][row.first], &images_[1][row.first], &images_[2][row.first]}, row.last - row.first};
  }
  /// Calls `visit(mirror)` for those of a row that a walk tells of.
  template <typename Visit>
  auto told_of_mirrors(const RowIndex::Row& row, Visit& visit) const {
    return [&visit, before = before_.data() + row.first](std::size_t first, std::uint32_t lanes) {
      for (; lanes != 0; lanes &= lanes - 1) visit(before[first + static_cast<std::size_t>(std::countr_zero(lanes))]);
    };
  }
  void lay_out_parts(const Scene& scene, const BeamFinds& finds);
  void find_body_boxes(const Scene& scene);
  void lay_out_lit_parts(const Scene& scene, const BeamFinds& finds);
  static EdgePart part_in(const LitLanes& eight, WedgeId edge, std::size_t lane) {
    return {edge.value, eight.from[lane], eight.to[lane], eight.place[lane], eight.distance[lane]};
  }

  const LaneScene* lanes_ = nullptr;
  RowIndex before_rows_, part_rows_, lit_rows_;
  std::vector<std::uint32_t> before_;
  std::array<std::vector<float>, 3> images_;  ///< of the mirrors in `before_`, and seven numbers more
  std::vector<EdgePart> parts_;
  EdgeClusters part_clusters_;
  std::uint32_t listed_facets_ = 0;  ///< of so many it is known over which parts they may be lit
  RowIndex before_part_rows_;        ///< in eights, by facet
  std::vector<std::uint32_t> before_parts_;
  std::vector<PartRecord> part_records_;  ///< all parts, and one that is nowhere
  std::vector<CentredBox> body_boxes_;    ///< none where there are parts of the scenery
  std::vector<LitLanes> lit_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Visit>
void BeamTable::for_each_mirror_before(FacetId facet, std::span<const HalfSpace> cone, Visit&& visit) const {
  const RowIndex::Row row = before_rows_.row(facet.value);
  if (row.first == row.last) return;
  const auto visit_eight = told_of_mirrors(row, visit);
  detail::cone_kernels().points(images_in(row), cone, told_to(visit_eight));
}

template <typename Visit>
void BeamTable::for_each_mirror_before(FacetId facet, const WindowOutline& window, std::span<const CentredBox> boxes,
                                       Visit&& visit) const {
  const RowIndex::Row row = before_rows_.row(facet.value);
  if (row.first == row.last) return;
  const auto visit_eight = told_of_mirrors(row, visit);
  detail::cone_kernels().mirrored(images_in(row), window, boxes, told_to(visit_eight));
}

template <typename Visit>
void BeamTable::for_each_part_before(FacetId facet, std::span<const HalfSpace> cone, const Vec3& apex, float radius_m,
                                     Visit&& visit) const {
  if (facet.value >= listed_facets_) return for_each_part_in(cone, apex, radius_m, visit);
  const RowIndex::Row row = before_part_rows_.row(facet.value);
  if (row.first == row.last) return;
  const std::span<const std::uint32_t> numbers = std::span(before_parts_).subspan(row.first, row.last - row.first);
  const auto visit_eight = [&](std::size_t first, std::uint32_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      visit(parts_[numbers[first + static_cast<std::size_t>(std::countr_zero(lanes))]]);
    }
  };
  detail::cone_kernels().listed_parts(part_records_, numbers, cone, edge_target(apex, radius_m), told_to(visit_eight));
}

template <typename Visit>
void BeamTable::for_each_lit_part(WedgeId edge, Visit&& visit) const {
  const RowIndex::Row row = lit_rows_.row(edge.value);
  for (std::size_t at = row.first / simd_lanes; at < row.last / simd_lanes; ++at) {
    const LitLanes& eight = lit_[at];
    for (std::size_t lane = 0; lane < simd_lanes && eight.mirror[lane] != nothing; ++lane) {
      visit(part_in(eight, edge, lane), eight.mirror[lane]);
    }
  }
}

template <typename Visit>
void BeamTable::for_each_lit_part(WedgeId edge, const Vec3& point, float radius_m, Visit&& visit) const {
  const RowIndex::Row row = lit_rows_.row(edge.value);
  if (row.first == row.last) return;
  const LaneEdge& line = lanes_->edge(edge);
  const Vec3 away = point - Vec3(line.start[0], line.start[1], line.start[2]);
  const Vec3 direction(line.direction[0], line.direction[1], line.direction[2]);
  const double place_m = glm::dot(away, direction);
  const Float8 place(static_cast<float>(place_m)),
      distance(static_cast<float>(glm::length(away - place_m * direction)));
  const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(point) + glm::length(away));
  for (std::size_t at = row.first / simd_lanes; at < row.last / simd_lanes; ++at) {
    const LitLanes& eight = lit_[at];
    const Float8 own_place(eight.place), own_distance(eight.distance);
    const Float8 sum = own_distance + distance, between = place - own_place;
    const Float8 met = own_place + between * (own_distance / sum);
    const Float8 reach = edge_point_reach_m(own_distance, sum, between, radius_m) +
                         edge_point_error_m(own_place, own_distance) + slack_m;
    std::uint32_t left = ~((met + reach < Float8(eight.from)) | (Float8(eight.to) + reach < met)).bits() & 0xffU;
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      if (eight.mirror[lane] != nothing) visit(part_in(eight, edge, lane), eight.mirror[lane]);
    }
  }
}

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/beam_table_bodies.hpp"
#endif
