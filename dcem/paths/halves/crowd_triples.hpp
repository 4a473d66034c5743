#pragma once
/// Several receivers joined with one transmitter at once over three mirrors and edges: what `TripleJoiner` does for
/// one, with the receivers as lanes.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/crowd_beams.hpp"
#include "dcem/paths/halves/crowd_gates.hpp"
#include "dcem/paths/halves/crowd_images.hpp"
#include "dcem/paths/halves/double_images.hpp"
#include "dcem/paths/halves/half_joiner.hpp"

namespace dcem {

template <typename Index>
class CrowdTriples {
 public:
  CrowdTriples(CrowdGates<Index>& gates, const CrowdBeams& beams, const JoinOrders& orders)
      : gates_(gates),
        beams_(beams),
        scene_(gates.scene()),
        lanes_(gates.lanes()),
        orders_(orders),
        images_(gates, beams),
        double_images_(scene_, lanes_) {}

  /// Calls `visit(sequence, point)`, the sequence from the receiver outwards, for every sequence of three mirrors, or
  /// of two mirrors and an edge, that a path from the transmitter to a point of the crowd may take.
  template <typename Visit>
  void for_each_sequence(Visit&& visit) {
    if (orders_.interactions < 3 || orders_.reflections < 2) return;
    images_.lay_out();
    const bool edges = orders_.diffractions >= 1;
    if (edges) lay_out_edges();
    for (std::uint32_t number = 0; number < scene_.facets().size(); ++number) {
      over_two_mirrors(FacetId(number), edges, visit);
      if (edges) edge_to_two_mirrors(FacetId(number), visit);
    }
    if (!edges) return;
    for (std::uint32_t number = 0; number < scene_.wedges().size(); ++number) {
      edge_between_mirrors(WedgeId(number), visit);
    }
  }

 private:
  const BeamLists& mast() const { return gates_.mast(); }
  std::size_t pack_count() const { return gates_.packs().size(); }
  bool is_lit_over_mirrors(FacetId facet) const {
    return std::ranges::any_of(mast().tables(),
                               [&](const BeamTable& table) { return !table.mirrors_before(facet).empty(); });
  }
  /// The edges that the crowd sees, as its middle does.
  void lay_out_edges() {
    std::vector<EdgePart> parts;
    for (const SeenLayer& layer : gates_.crowd().layers()) {
      for (const WedgeId id : layer.edges) {
        parts.push_back(whole_edge(id.value, scene_.wedge(id).edge, gates_.crowd().sight().position_m()));
      }
    }
    edges_.build(parts, lanes_.origin_m(),
                 [&](const EdgePart& part) -> const Wedge& { return scene_.wedge(WedgeId(part.edge)).edge; });
    edge_numbers_.clear();
    for (const EdgePart& part : parts) edge_numbers_.push_back(part.edge);
  }

  /// The receivers' last two points are on mirrors, the second of which is `middle`.
  template <typename Visit>
  void over_two_mirrors(FacetId middle, bool edges, Visit& visit) {
    const std::span<const std::uint32_t> near = beams_.mirrors_before(middle);
    const bool mirrors = orders_.reflections >= 3 && is_lit_over_mirrors(middle);
    if (near.empty() || (!edges && !mirrors)) return;
    for (const std::uint32_t place : near) {
      for (const double side : {1.0, -1.0}) {
        if (!images_.look_over(place, middle, side)) continue;
        if (mirrors) join_mirrors(place, middle, visit);
        if (edges) join_edges(place, middle, visit);
      }
    }
  }

  template <typename Visit>
  void join_mirrors(std::uint32_t place, FacetId middle, Visit& visit) {
    mast().for_each_mirror_before(middle, images_.cone(), [&](std::uint32_t mirror) {
      const BeamMirror& first = mast().mirrors()[mirror];
      if (!may_hold(first.cone, images_.middle_m(), gates_.radius_m() + images_.error_m())) return;
      const double length_m = glm::length(first.image_m);
      const LanePoints apex(first.image_m);
      const Float8 error_m(images_.error_m() + LaneScene::error_m(length_m));
      for (std::size_t pack = 0; pack < pack_count(); ++pack) {
        const LaneGate at_first =
            lanes_.cross(first.facet, apex, images_.in_two().packs[pack], error_m, images_.in_two().lanes[pack]);
        if (at_first.lanes != 0) join_near(place, middle, pack, {first.facet, at_first}, error_m, visit);
      }
    });
  }

  template <typename Visit>
  void join_edges(std::uint32_t place, FacetId middle, Visit& visit) {
    const float radius_m = gates_.radius_m() + images_.error_m();
    mast().for_each_part_before(middle, images_.cone(), images_.middle_m(), radius_m, [&](const EdgePart& part) {
      const WedgeId edge(part.edge);
      const WorldWedge& wedge = scene_.wedge(edge);
      if (wedge.facets[0] == middle || wedge.facets[1] == middle) return;  // that is in the wedge's own terms
      for (std::size_t pack = 0; pack < pack_count(); ++pack) {
        const LaneGate at_first =
            lanes_.meet(part, images_.in_two().packs[pack], images_.error_m(), images_.in_two().lanes[pack]);
        if (at_first.lanes != 0) join_near(place, middle, pack, {edge, at_first}, Float8(images_.error_m()), visit);
      }
    });
  }

  /// From a transmitter's first point over the middle mirror and that of the receivers.
  template <typename Visit>
  void join_near(std::uint32_t place, FacetId middle, std::size_t pack, const CrowdStop& first, const Float8& error_m,
                 Visit& visit) {
    const LaneGate at_middle = lanes_.cross(middle, first.at.points, images_.in_two().packs[pack],
                                            error_m + first.at.beside_m, first.at.lanes);
    if (at_middle.lanes == 0) return;
    const FacetId last = beams_.mirrors()[place].facet;
    const LaneGate at_last = lanes_.cross(last, at_middle.points, images_.in(place).packs[pack],
                                          error_m + at_middle.beside_m, at_middle.lanes);
    if (at_last.lanes == 0) return;
    gates_.offer(pack, std::array{CrowdStop{last, at_last}, CrowdStop{middle, at_middle}, first}, at_last.lanes, visit);
  }

  /// The receivers' last point is on an edge, the two before it on mirrors of the transmitter.
  template <typename Visit>
  void edge_to_two_mirrors(FacetId middle, Visit& visit) {
    if (edge_numbers_.empty()) return;
    for (const BeamTable& table : mast().tables()) {
      if (table.mirrors_before(middle).empty()) continue;
      double_images_.for_each(
          mast(), table, middle, edges_.boxes(),
          [&](const BeamMirror& mirror, const Vec3& twice_m) { edges_over(mirror, middle, twice_m, visit); });
    }
  }

  template <typename Visit>
  void edges_over(const BeamMirror& mirror, FacetId middle, const Vec3& twice_m, Visit& visit) {
    const Vec3 twice = twice_m - lanes_.origin_m();
    const std::span<const HalfSpace> cone = double_images_.cone(mirror, middle, twice_m);
    const float error_m = gates_.error_with(2.0 * glm::length(twice) + lanes_.reach_m());
    edges_.template for_each_in<true>(cone, twice, gates_.radius_m(), [&](std::uint32_t number) {
      const WedgeId edge(edge_numbers_[number]);
      const WorldWedge& wedge = scene_.wedge(edge);
      if (wedge.facets[0] == middle || wedge.facets[1] == middle) return;  // that is in the wedge's own terms
      if (!may_face(wedge.edge, twice_m - wedge.edge.start_m)) return;
      const EdgePart part = whole_edge(edge.value, wedge.edge, twice_m);
      for (std::size_t pack = 0; pack < pack_count(); ++pack) {
        const LaneGate at_edge = lanes_.meet(part, gates_.packs()[pack], error_m, gates_.crowd().lanes_of(pack));
        if (at_edge.lanes != 0) join_far(mirror, middle, twice, pack, {edge, at_edge}, Float8(error_m), visit);
      }
    });
  }

  /// From an edge over the middle mirror and that of the transmitter.
  template <typename Visit>
  void join_far(const BeamMirror& mirror, FacetId middle, const Vec3& twice, std::size_t pack, const CrowdStop& last,
                const Float8& error_m, Visit& visit) {
    const LaneGate at_middle =
        lanes_.cross(middle, LanePoints(twice), last.at.points, error_m + last.at.beside_m, last.at.lanes);
    if (at_middle.lanes == 0) return;
    const LaneGate at_first = lanes_.cross(mirror.facet, LanePoints(mirror.image_m), at_middle.points,
                                           error_m + at_middle.beside_m, at_middle.lanes);
    if (at_first.lanes == 0) return;
    gates_.offer(pack, std::array{last, CrowdStop{middle, at_middle}, CrowdStop{mirror.facet, at_first}},
                 at_first.lanes, visit);
  }

  /// An edge that both ends light over a mirror each.
  template <typename Visit>
  void edge_between_mirrors(WedgeId edge, Visit& visit) {
    for (const std::uint32_t place : beams_.mirrors_before(edge)) {
      const CrowdMirror& near = beams_.mirrors()[place];
      const PackImages& images = images_.in(place);
      const float radius_m = gates_.radius_m();
      mast().for_each_lit_part(edge, near.middle_m, radius_m, [&](const EdgePart& part, std::uint32_t mirror) {
        const BeamMirror& far = mast().mirrors()[mirror];
        const float error_m =
            gates_.error_with(glm::length(far.image_m) + glm::length(near.middle_m) + lanes_.reach_m());
        for (std::size_t pack = 0; pack < pack_count(); ++pack) {
          const LaneGate at_edge = lanes_.meet(part, images.packs[pack], error_m, images.lanes[pack]);
          if (at_edge.lanes == 0) continue;
          const Float8 off_m = Float8(error_m) + at_edge.beside_m;
          const LaneGate at_first =
              lanes_.cross(far.facet, LanePoints(far.image_m), at_edge.points, off_m, at_edge.lanes);
          if (at_first.lanes == 0) continue;
          const LaneGate at_last = lanes_.cross(near.facet, at_edge.points, images.packs[pack], off_m, at_first.lanes);
          if (at_last.lanes == 0) continue;
          gates_.offer(
              pack,
              std::array{CrowdStop{near.facet, at_last}, CrowdStop{edge, at_edge}, CrowdStop{far.facet, at_first}},
              at_last.lanes, visit);
        }
      });
    }
  }

  CrowdGates<Index>& gates_;
  const CrowdBeams& beams_;
  const Scene& scene_;
  const LaneScene& lanes_;
  JoinOrders orders_;
  CrowdImages<Index> images_;
  DoubleImages double_images_;
  EdgeClusters edges_;
  std::vector<std::uint32_t> edge_numbers_;
};

}  // namespace dcem
