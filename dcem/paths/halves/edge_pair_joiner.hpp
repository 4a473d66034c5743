#pragma once
/// Two halves joined over an edge of each: see edge_pairs.hpp.
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/edge_pairs.hpp"
#include "dcem/paths/halves/pair_gates.hpp"

namespace dcem {

class EdgePairJoiner {
 public:
  EdgePairJoiner(const Scene& scene, const FacetOutlines& outlines, const JoinOrders& orders)
      : gates_(scene, outlines, orders.longest_m), pairs_(scene, outlines) {}

  /// Calls `visit(sequence)` for each; `reached`: what the transmitter reaches, where that is known.
  template <typename Visit>
  void for_each_pair(const PathHalf& receiver, const PathHalf& transmitter, const BeamLists* reached, Visit& visit) {
    parts_.clear();
    if (reached != nullptr) parts_ = reached->parts();
    for (std::size_t layer = 0; layer < transmitter.layers().size(); ++layer) {
      if (reached == nullptr || (layer > 0 && !reached->has_bodies())) add_edges(transmitter, layer);
    }
    join(receiver, receiver.layers(), transmitter, visit);
  }

  /// The same for pairs with at least one edge of a body that has moved.
  template <typename Visit>
  void for_each_moved_pair(const PathHalf& receiver, const PathHalf& transmitter, Visit& visit) {
    constexpr std::size_t moved = 1;
    parts_.clear();
    add_edges(transmitter, moved);
    join(receiver, receiver.layers(), transmitter, visit);
    parts_.clear();
    for (std::size_t layer = 0; layer < transmitter.layers().size(); ++layer) {
      if (layer != moved) add_edges(transmitter, layer);
    }
    join(receiver, receiver.layers().subspan(moved, 1), transmitter, visit);
  }

 private:
  void add_edges(const PathHalf& transmitter, std::size_t layer) {
    for (const WedgeId edge : transmitter.layers()[layer].edges) {
      parts_.push_back(whole_edge(edge.value, gates_.scene().wedge(edge).edge, transmitter.position_m()));
    }
  }

  /// With the transmitter's edges in `parts_`.
  template <typename Visit>
  void join(const PathHalf& receiver, std::span<const HalfLayer> layers, const PathHalf& transmitter, Visit& visit) {
    if (parts_.empty()) return;
    pairs_.aim(transmitter.position_m(), parts_);
    for (const HalfLayer& layer : layers) {
      pairs_.for_each(receiver.position_m(), layer.edges, [&](const EdgePair& pair) {
        gates_.pair(receiver, pair.near, pair.near_m, transmitter, pair.far, pair.far_m, visit);
      });
    }
  }

  PairGates gates_;
  EdgePairs pairs_;
  std::vector<EdgePart> parts_;
};

}  // namespace dcem
