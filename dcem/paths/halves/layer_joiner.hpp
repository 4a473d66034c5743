#pragma once
/// Two elements, one of a layer of each end: two mirrors, or a mirror and an edge.
#include <cstddef>
#include <cstdint>

#include "dcem/paths/halves/pair_gates.hpp"
#include "dcem/paths/halves/path_half.hpp"

namespace dcem {

class LayerJoiner {
 public:
  LayerJoiner(const Scene& scene, const FacetOutlines& outlines, const JoinOrders& orders)
      : gates_(scene, outlines, orders.longest_m), orders_(orders) {}

  /// Calls `visit(sequence)`, from the receiver outwards, for each pair of an element of `near`, of the receiver, and
  /// one of `far`, of the transmitter.
  template <typename Visit>
  void for_each_pair(const PathHalf& receiver, const HalfLayer& near, const PathHalf& transmitter, const HalfLayer& far,
                     Visit& visit) {
    constexpr auto beside_m = static_cast<float>(JoinGates::beside_m);
    for (std::size_t at = 0; at < near.mirrors.size() && orders_.reflections >= 2; ++at) {
      far.for_each_image_in(near.cones[at], near.images_m[at], beside_m, [&](std::uint32_t far_at) {
        gates_.mirrors(receiver, near.mirrors[at], near.images_m[at], transmitter, far.mirrors[far_at],
                       far.images_m[far_at], visit);
      });
    }
    if (orders_.reflections < 1 || orders_.diffractions < 1) return;
    mirrors_to_edges(receiver, near, transmitter, far, false, visit);
    mirrors_to_edges(transmitter, far, receiver, near, true, visit);
  }

 private:
  /// `turned`: the mirrors are the transmitter's.
  template <typename Visit>
  void mirrors_to_edges(const PathHalf& over, const HalfLayer& mirrors, const PathHalf& beside, const HalfLayer& edges,
                        bool turned, Visit& visit) {
    for (std::size_t at = 0; at < mirrors.mirrors.size(); ++at) {
      edges.for_each_edge_in(mirrors.cones[at], mirrors.images_m[at], [&](std::uint32_t edge) {
        gates_.mirror_to_edge(over, mirrors.mirrors[at], mirrors.images_m[at], beside, edges.edges[edge], turned,
                              visit);
      });
    }
  }

  PairGates gates_;
  JoinOrders orders_;
};

}  // namespace dcem
