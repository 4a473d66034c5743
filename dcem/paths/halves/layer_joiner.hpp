#pragma once
/// Two elements, one of a layer of each end: two mirrors, or a mirror and an edge.
#include <cstddef>
#include <cstdint>

#include "dcem/paths/halves/pair_gates.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/halves/waiting_pairs.hpp"

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
    const auto ask = [&](std::uint32_t at, std::uint32_t far_at) {
      gates_.mirrors(receiver, near.mirrors[at], near.images_m[at], transmitter, far.mirrors[far_at],
                     far.images_m[far_at], visit);
    };
    const auto facet_of = [&](std::uint32_t far_at) { return far.mirrors[far_at]; };
    for (std::uint32_t at = 0; at < near.mirrors.size() && orders_.reflections >= 2; ++at) {
      far.for_each_image_in(near.cones[at], near.images_m[at], beside_m,
                            [&](std::uint32_t far_at) { waiting_.add(at, far_at); });
      waiting_.ask_if_many(gates_.gates(), facet_of, ask);
    }
    waiting_.ask_all(gates_.gates(), facet_of, ask);
    if (orders_.reflections < 1 || orders_.diffractions < 1) return;
    mirrors_to_edges(receiver, near, transmitter, far, false, visit);
    mirrors_to_edges(transmitter, far, receiver, near, true, visit);
  }

 private:
  /// `turned`: the mirrors are the transmitter's.
  template <typename Visit>
  void mirrors_to_edges(const PathHalf& over, const HalfLayer& mirrors, const PathHalf& beside, const HalfLayer& edges,
                        bool turned, Visit& visit) {
    const auto ask = [&](std::uint32_t at, std::uint32_t edge) {
      gates_.mirror_to_edge(over, mirrors.mirrors[at], mirrors.images_m[at], beside, edges.edges[edge], turned, visit);
    };
    const auto edge_of = [&](std::uint32_t edge) { return edges.edges[edge]; };
    for (std::uint32_t at = 0; at < mirrors.mirrors.size(); ++at) {
      edges.for_each_edge_in(mirrors.cones[at], mirrors.images_m[at],
                             [&](std::uint32_t edge) { waiting_.add(at, edge); });
      waiting_.ask_if_many(gates_.gates(), edge_of, ask);
    }
    waiting_.ask_all(gates_.gates(), edge_of, ask);
  }

  PairGates gates_;
  JoinOrders orders_;
  WaitingPairs waiting_;
};

}  // namespace dcem
