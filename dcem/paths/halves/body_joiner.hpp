#pragma once
/// Two mirrors, or a mirror and an edge, at least one of them of a body: few elements on a body, many in the scenery.
///
/// So the scenery's are not asked about everything that moves: which of an end's mirrors may light a body at all is
/// known (`PathHalf::mirrors_lighting`), and the body's mirrors and edges are met with these alone.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/layer_joiner.hpp"
#include "dcem/paths/halves/path_half.hpp"

namespace dcem {

class BodyJoiner {
 public:
  BodyJoiner(const Scene& scene, const FacetOutlines& outlines, const JoinOrders& orders)
      : gates_(scene, outlines, orders.longest_m),
        layers_(scene, outlines, orders),
        outlines_(outlines),
        orders_(orders),
        origin_m_(outlines.middle_m()) {}

  /// Calls `visit(sequence)` for each. `moved_alone`: at least one element is of a body that has moved. With what the
  /// transmitter reaches of the scenery, where that is known, only the parts of edges that it sees are looked at.
  template <typename Visit>
  void for_each_pair(const PathHalf& receiver, const PathHalf& transmitter, bool moved_alone, Visit& visit,
                     const BeamLists* reached = nullptr) {
    for (std::size_t own = 1; own < receiver.layers().size(); ++own) {
      const bool own_moved = own == moved;
      if (own_moved || !moved_alone) {
        with_scenery(transmitter, receiver, own, true, visit, reached);
        with_scenery(receiver, transmitter, own, false, visit, nullptr);
      }
      for (std::size_t other = 1; other < transmitter.layers().size(); ++other) {
        if (own_moved || other == moved || !moved_alone)
          layers_.for_each_pair(receiver, receiver.layers()[own], transmitter, transmitter.layers()[other], visit);
      }
    }
  }

 private:
  static constexpr std::size_t moved = 1;  ///< the layer of bodies that have moved

  /// An element of the scenery next to `beside`, one of a body next to `other`. `turned`: `beside` is the transmitter.
  /// `reached`: by `beside`, where that is known.
  template <typename Visit>
  void with_scenery(const PathHalf& beside, const PathHalf& other, std::size_t layer, bool turned, Visit& visit,
                    const BeamLists* reached) {
    const HalfLayer &scenery = beside.layers()[0], &bodies = other.layers()[layer];
    const BodyElements& elements = other.bodies_of(layer);
    const bool edges = orders_.reflections >= 1 && orders_.diffractions >= 1;
    for (const BodyElements::Part& body : elements.parts()) {
      for (const std::uint32_t at : beside.mirrors_lighting(body.body)) {
        const std::span<const HalfSpace> cone = beside.cone(gates_.scene(), outlines_, at, scratch_);
        const Vec3 image_m = beside.image_m(gates_.scene(), at);
        if (orders_.reflections >= 2) {
          mirrors_in_cone(beside, scenery.mirrors[at], image_m, cone, other, bodies, body, turned, visit);
        }
        if (!edges) continue;
        elements.for_each_edge_in(body, cone, image_m - origin_m_, [&](WedgeId edge) {
          gates_.mirror_to_edge(beside, scenery.mirrors[at], image_m, other, edge, turned, visit);
        });
      }
    }
    if (!edges) return;
    for (std::size_t at = 0; at < bodies.mirrors.size(); ++at) {
      const auto ask = [&](WedgeId edge) {
        gates_.mirror_to_edge(other, bodies.mirrors[at], bodies.images_m[at], beside, edge, !turned, visit);
      };
      if (reached == nullptr) {
        scenery.for_each_edge_in(bodies.cones[at], bodies.images_m[at],
                                 [&](std::uint32_t edge) { ask(scenery.edges[edge]); });
        continue;
      }
      reached->tables()[BeamLists::of_scenery].for_each_part_in(bodies.cones[at], bodies.images_m[at] - origin_m_, 0.0F,
                                                                [&](const EdgePart& part) {
                                                                  const WedgeId edge(part.edge);
                                                                  if (gates_.scene().wedge(edge).body == BodyId(0))
                                                                    ask(edge);
                                                                });
    }
  }

  /// The mirrors of a body whose image of `other` may be seen through a mirror of the scenery.
  template <typename Visit>
  void mirrors_in_cone(const PathHalf& beside, FacetId mirror, const Vec3& image_m, std::span<const HalfSpace> cone,
                       const PathHalf& other, const HalfLayer& bodies, const BodyElements::Part& body, bool turned,
                       Visit& visit) {
    for (std::uint32_t at = body.first_mirror; at < body.first_mirror + body.mirror_count; ++at) {
      const Vec3 other_image = bodies.images_m[at] - origin_m_;
      if (!may_hold(cone, other_image, 1e-6F * static_cast<float>(glm::length(other_image)))) continue;
      if (turned) {
        gates_.mirrors(other, bodies.mirrors[at], bodies.images_m[at], beside, mirror, image_m, visit);
      } else {
        gates_.mirrors(beside, mirror, image_m, other, bodies.mirrors[at], bodies.images_m[at], visit);
      }
    }
  }

  PairGates gates_;
  LayerJoiner layers_;
  const FacetOutlines& outlines_;
  JoinOrders orders_;
  std::vector<HalfSpace> scratch_;
  Vec3 origin_m_;  ///< of the numbers in single precision
};

}  // namespace dcem
