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
    if (orders_.interactions < 3) return;
    const Ends ends{receiver, transmitter};
    const bool edges = orders_.diffractions >= 1 && orders_.reflections >= 2;
    for (std::uint32_t number = 0; number < scene().facets().size(); ++number) {
      const FacetId middle(number);
      if (orders_.reflections >= 3) three_mirrors(ends, middle, visit);
      if (edges) two_mirrors_to_edge(ends, receiver, transmitter, middle, false, visit);
      if (edges) two_mirrors_to_edge(ends, transmitter, receiver, middle, true, visit);
    }
    if (!edges) return;
    for (std::uint32_t number = 0; number < scene().wedges().size(); ++number) {
      edge_between_mirrors(ends, WedgeId(number), visit);
    }
  }

 private:
  struct Ends {
    const BeamLists &receiver, &transmitter;
  };

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

  template <typename Visit>
  void three_mirrors(const Ends& ends, FacetId middle, Visit& visit) {
    const std::span<const std::uint32_t> near = ends.receiver.mirrors_before(middle);
    const std::span<const std::uint32_t> far = ends.transmitter.mirrors_before(middle);
    if (near.empty() || far.empty()) return;
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
  void two_mirrors_to_edge(const Ends& ends, const BeamLists& over, const BeamLists& beside, FacetId middle,
                           bool turned, Visit& visit) {
    if (over.mirrors_before(middle).empty() || beside.parts().empty()) return;
    images_.for_each(over, middle, beside.boxes_of_parts(), [&](const BeamMirror& mirror, const Vec3& twice_m) {
      edges_over(mirror, middle, twice_m, beside, [&](WedgeId edge, const Vec3& edge_m, const Vec3& mirror_m) {
        if (turned) {
          offer(ends, {edge, middle, mirror.facet}, edge_m, mirror_m, visit);
        } else {
          offer(ends, {mirror.facet, middle, edge}, mirror_m, edge_m, visit);
        }
      });
    });
  }

  /// Calls `visit(edge, point on it, point on the mirror)` for edges that `beside` sees, over two mirrors.
  template <typename Visit>
  void edges_over(const BeamMirror& mirror, FacetId middle, const Vec3& twice_m, const BeamLists& beside,
                  Visit&& visit) {
    const std::span<const HalfSpace> cone = images_.cone(mirror, middle, twice_m);
    beside.for_each_part_in(cone, twice_m - lanes_.origin_m(), 0.0F, [&](std::uint32_t number) {
      const WedgeId edge(beside.parts()[number].edge);
      const WorldWedge& wedge = scene().wedge(edge);
      if (wedge.facets[0] == middle || wedge.facets[1] == middle) return;  // that is in the wedge's own terms
      const auto edge_m = gates_.edge_point(edge, beside.half().position_m(), twice_m);
      if (!edge_m) return;
      const auto middle_m = gates_.crossing(middle, twice_m, *edge_m);
      if (!middle_m || !may_face(wedge.edge, *middle_m - *edge_m)) return;
      const auto mirror_m = gates_.crossing(mirror.facet, image_m(mirror), *middle_m);
      if (mirror_m) visit(edge, *edge_m, *mirror_m);
    });
  }

  template <typename Visit>
  void edge_between_mirrors(const Ends& ends, WedgeId edge, Visit& visit) {
    const WorldWedge& wedge = scene().wedge(edge);
    ends.receiver.for_each_lit_part(edge, [&](const EdgePart&, std::uint32_t place) {
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
      ends.transmitter.for_each_lit_part(edge, one.image_m, 0.0F, join);
    });
  }

  JoinGates gates_;
  const LaneScene& lanes_;
  JoinOrders orders_;
  DoubleImages images_;
  Sequence sequence_;
};

}  // namespace dcem
