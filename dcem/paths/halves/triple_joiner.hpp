#pragma once
/// Three interactions: every sequence of three mirrors, or of two mirrors and an edge, that a path may take.
///
/// Both ends have listed what they light over each of their mirrors; a sequence is met at its middle element, or at the
/// edge. With R₁₂ the image of the receiver in its two mirrors and T₃ that of the transmitter in its own, both last
/// points of a path over three mirrors lie on the straight line from R₁₂ to T₃. Over an edge the point that diffracts
/// follows in closed form from the images on both sides of it, and lies in the cone of each. What is left is looked up
/// in the views of both ends. The solver decides.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/double_images.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/in_both.hpp"
#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

class TripleJoiner {
 public:
  TripleJoiner(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const JoinOrders& orders)
      : gates_(scene, outlines), lanes_(lanes), orders_(orders), images_(scene, lanes) {}

  /// Calls `visit(sequence)`, from the receiver outwards, for each sequence of three elements; seldom twice for one.
  template <typename Visit>
  void for_each_sequence(const BeamLists& receiver, const BeamLists& transmitter, Visit&& visit) {
    join_where(
        receiver, transmitter, [](std::size_t, std::size_t) { return true; }, visit);
  }

  /// The same of sequences over a body, in at least one of their elements.
  template <typename Visit>
  void for_each_body_sequence(const BeamLists& receiver, const BeamLists& transmitter, Visit&& visit) {
    constexpr std::size_t scenery = BeamLists::of_scenery;
    const auto takes = [](std::size_t near, std::size_t far) { return near != scenery || far != scenery; };
    join_where(receiver, transmitter, takes, visit);
  }

  /// The same of sequences over a body that has moved, in at least one of their elements: then it is in what one of the
  /// ends reaches over moved bodies.
  template <typename Visit>
  void for_each_moved_sequence(const BeamLists& receiver, const BeamLists& transmitter, Visit&& visit) {
    constexpr std::size_t moved = BeamLists::of_moved;
    const auto takes = [](std::size_t near, std::size_t far) { return near == moved || far == moved; };
    join_where(receiver, transmitter, takes, visit);
  }

 private:
  struct Ends {
    const BeamLists &receiver, &transmitter;
  };
  /// A table of an end.
  struct Listed {
    const BeamLists& lists;
    const BeamTable& table;
  };

  template <typename Takes, typename Visit>
  void join_where(const BeamLists& receiver, const BeamLists& transmitter, Takes&& takes, Visit& visit) {
    const Ends ends{receiver, transmitter};
    for (std::size_t near = 0; near < receiver.tables().size(); ++near) {
      for (std::size_t far = 0; far < transmitter.tables().size(); ++far) {
        if (takes(near, far)) join(ends, receiver.tables()[near], transmitter.tables()[far], visit);
      }
    }
  }

  const Scene& scene() const { return gates_.scene(); }
  /// The image of an end in one of its mirrors.
  Vec3 image_m(const BeamMirror& mirror) const { return mirror.image_m + lanes_.origin_m(); }

  template <typename Visit>
  void offer(const Ends& ends, std::array<SequenceElement, 3> sequence, const Vec3& first_m, const Vec3& last_m,
             Visit& visit) {
    if (gates_.hides(ends.receiver.half(), sequence.front(), first_m)) return;
    if (gates_.hides(ends.transmitter.half(), sequence.back(), last_m)) return;
    sequence_.assign(sequence.begin(), sequence.end());
    visit(std::as_const(sequence_));
  }

  /// What the receiver and what the transmitter reach, as far as it stands in a table of each.
  template <typename Visit>
  void join(const Ends& ends, const BeamTable& near, const BeamTable& far, Visit& visit) {
    if (orders_.interactions < 3) return;
    if (orders_.reflections >= 3) {
      for_each_in_both<std::uint32_t>(near.lit_facets(), far.lit_facets(), [&](std::size_t at) {
        const std::uint32_t middle = near.lit_facets()[at];
        three_mirrors(ends, FacetId(middle), near.mirrors_before(FacetId(middle)), far.mirrors_before(FacetId(middle)),
                      visit);
      });
    }
    if (orders_.diffractions < 1 || orders_.reflections < 2) return;
    two_mirrors_to_edge(ends, {ends.receiver, near}, {ends.transmitter, far}, false, visit);
    two_mirrors_to_edge(ends, {ends.transmitter, far}, {ends.receiver, near}, true, visit);
    for_each_in_both<std::uint32_t>(near.lit_edges(), far.lit_edges(), [&](std::size_t at) {
      edge_between_mirrors(ends, near, far, WedgeId(near.lit_edges()[at]), visit);
    });
  }

  template <typename Visit>
  void three_mirrors(const Ends& ends, FacetId middle, std::span<const std::uint32_t> near,
                     std::span<const std::uint32_t> far, Visit& visit) {
    const Plane& plane = scene().facet(middle).plane;
    for (std::size_t first = 0; first < far.size(); first += simd_lanes) {
      const std::span<const std::uint32_t> eight =
          far.subspan(first, std::min<std::size_t>(simd_lanes, far.size() - first));
      std::array<Vec3, simd_lanes> images;
      double reach_m = 0.0;
      for (std::size_t lane = 0; lane < eight.size(); ++lane) {
        images[lane] = ends.transmitter.mirrors()[eight[lane]].image_m;
        reach_m = std::max(reach_m, glm::length(images[lane]));
      }
      const LanePoints from(std::span<const Vec3>(images).first(eight.size()), Vec3(0.0));
      for (const std::uint32_t place : near) {
        const BeamMirror& one = ends.receiver.mirrors()[place];
        const Vec3 twice_m = mirrored(plane, image_m(one));  // the receiver in its two mirrors
        const Vec3 twice = twice_m - lanes_.origin_m();
        const float error_m = LaneScene::error_m(reach_m + glm::length(twice));
        LaneGate gate = lanes_.cross(middle, from, LanePoints(twice), Float8(error_m), (1U << eight.size()) - 1U);
        for (; gate.lanes != 0; gate.lanes &= gate.lanes - 1) {
          const BeamMirror& other =
              ends.transmitter.mirrors()[eight[static_cast<std::size_t>(std::countr_zero(gate.lanes))]];
          const auto far_m = gates_.crossing(other.facet, image_m(other), twice_m);
          if (!far_m) continue;
          const auto middle_m = gates_.crossing(middle, twice_m, *far_m);
          if (!middle_m) continue;
          const auto near_m = gates_.crossing(one.facet, image_m(one), *middle_m);
          if (near_m) offer(ends, {one.facet, middle, other.facet}, *near_m, *far_m, visit);
        }
      }
    }
  }

  /// Over two mirrors of `over` to an edge that `beside` sees; `turned`: `over` is the transmitter.
  template <typename Visit>
  void two_mirrors_to_edge(const Ends& ends, const Listed& over, const Listed& beside, bool turned, Visit& visit) {
    if (beside.table.parts().empty()) return;
    for (const std::uint32_t number : over.table.lit_facets()) {
      const FacetId middle(number);
      const auto meet = [&](const BeamMirror& mirror, const Vec3& twice_m) {
        edges_over(mirror, middle, twice_m, beside, [&](WedgeId edge, const Vec3& edge_m, const Vec3& mirror_m) {
          if (turned) {
            offer(ends, {edge, middle, mirror.facet}, edge_m, mirror_m, visit);
          } else {
            offer(ends, {mirror.facet, middle, edge}, mirror_m, edge_m, visit);
          }
        });
      };
      images_.for_each(over.lists, over.table, middle, beside.table.boxes_of_parts(), meet);
    }
  }

  /// Calls `visit(edge, point on it, point on the mirror)` for edges that `beside` sees, over two mirrors.
  template <typename Visit>
  void edges_over(const BeamMirror& mirror, FacetId middle, const Vec3& twice_m, const Listed& beside, Visit&& visit) {
    const std::span<const HalfSpace> cone = images_.cone(mirror, middle, twice_m);
    beside.table.for_each_part_before(middle, cone, twice_m - lanes_.origin_m(), 0.0F, [&](const EdgePart& part) {
      const WedgeId edge(part.edge);
      const WorldWedge& wedge = scene().wedge(edge);
      if (wedge.facets[0] == middle || wedge.facets[1] == middle) return;  // that is in the wedge's own terms
      const auto edge_m = gates_.edge_point(edge, beside.lists.half().position_m(), twice_m);
      if (!edge_m) return;
      const auto middle_m = gates_.crossing(middle, twice_m, *edge_m);
      if (!middle_m || !may_face(wedge.edge, *middle_m - *edge_m)) return;
      const auto mirror_m = gates_.crossing(mirror.facet, image_m(mirror), *middle_m);
      if (mirror_m) visit(edge, *edge_m, *mirror_m);
    });
  }

  template <typename Visit>
  void edge_between_mirrors(const Ends& ends, const BeamTable& near, const BeamTable& far, WedgeId edge, Visit& visit) {
    const WorldWedge& wedge = scene().wedge(edge);
    near.for_each_lit_part(edge, [&](const EdgePart&, std::uint32_t place) {
      const BeamMirror& one = ends.receiver.mirrors()[place];
      const auto join = [&](const EdgePart&, std::uint32_t other_place) {
        const BeamMirror& other = ends.transmitter.mirrors()[other_place];
        const auto edge_m = gates_.edge_point(edge, image_m(one), image_m(other));
        if (!edge_m) return;
        const auto near_m = gates_.crossing(one.facet, image_m(one), *edge_m);
        if (!near_m || !may_face(wedge.edge, *near_m - *edge_m)) return;
        const auto far_m = gates_.crossing(other.facet, image_m(other), *edge_m);
        if (!far_m || !may_face(wedge.edge, *far_m - *edge_m)) return;
        offer(ends, {one.facet, edge, other.facet}, *near_m, *far_m, visit);
      };
      far.for_each_lit_part(edge, one.image_m, 0.0F, join);
    });
  }

  JoinGates gates_;
  const LaneScene& lanes_;
  JoinOrders orders_;
  DoubleImages images_;
  Sequence sequence_;
};

}  // namespace dcem
