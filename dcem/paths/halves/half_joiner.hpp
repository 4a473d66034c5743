#pragma once
/// Two halves joined: every sequence of at most two mirrors and edges that a path between two ends may take.
///
/// With R₁ the image of the receiver in its mirror and T₂ that of the transmitter in its own, both points of a path
/// over two mirrors lie on the straight line from R₁ to T₂: so T₂ is in the cone of R₁ through the receiver's mirror.
/// Over a mirror and an edge the point on the edge is in that cone, and follows from the image and the other end in
/// closed form. Over two edges: edge_pairs.hpp; over bodies: body_joiner.hpp. What is left is looked up in both maps,
/// each point at the end that must see it. The solver decides.
#include <cstddef>
#include <cstdint>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/body_joiner.hpp"
#include "dcem/paths/halves/edge_pair_joiner.hpp"
#include "dcem/paths/halves/in_both.hpp"
#include "dcem/paths/halves/layer_joiner.hpp"
#include "dcem/paths/halves/pair_gates.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/halves/waiting_pairs.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

class HalfJoiner {
 public:
  HalfJoiner(const Scene& scene, const FacetOutlines& outlines, const JoinOrders& orders)
      : gates_(scene, outlines, orders.longest_m),
        orders_(orders),
        layers_(scene, outlines, orders),
        bodies_(scene, outlines, orders),
        edge_pairs_(scene, outlines, orders) {}

  /// Calls `visit(sequence)`, from the receiver outwards, for each; seldom twice for one. With what the transmitter
  /// reaches, where that is known, ways over its mirrors need not be looked for.
  template <typename Visit>
  void for_each_sequence(const PathHalf& receiver, const PathHalf& transmitter, Visit&& visit,
                         const BeamLists* reached = nullptr) {
    gates_.direct(visit);
    for (const HalfLayer& own : receiver.layers()) {
      for (const HalfLayer& other : transmitter.layers()) singles(receiver, own, transmitter, other, visit);
    }
    if (orders_.interactions < 2) return;
    if (orders_.diffractions >= 2) edge_pairs_.for_each_pair(receiver, transmitter, reached, visit);
    const bool all_listed = reached != nullptr && reached->has_bodies();
    for (std::size_t own = 0; own < (all_listed ? receiver.layers().size() : 1); ++own) {
      const HalfLayer& near = receiver.layers()[own];
      if (reached != nullptr) {
        listed_pairs(receiver, near, *reached, visit);
      } else {
        layers_.for_each_pair(receiver, near, transmitter, transmitter.layers()[0], visit);
      }
    }
    if (!all_listed) bodies_.for_each_pair(receiver, transmitter, false, visit, reached);
  }

  /// The same for sequences over bodies, in at least one of their elements, where the transmitter has not listed them;
  /// without those over two edges.
  template <typename Visit>
  void for_each_body_sequence(const PathHalf& receiver, const PathHalf& transmitter, Visit&& visit,
                              const BeamLists* reached = nullptr) {
    for (const HalfLayer& own : receiver.layers().subspan(1)) {
      for (const HalfLayer& other : transmitter.layers().subspan(1)) {
        singles(receiver, own, transmitter, other, visit);
      }
    }
    if (orders_.interactions >= 2) bodies_.for_each_pair(receiver, transmitter, false, visit, reached);
  }

  /// The same for sequences over bodies that have moved, in at least one of their elements.
  template <typename Visit>
  void for_each_moved_sequence(const PathHalf& receiver, const PathHalf& transmitter, Visit&& visit,
                               const BeamLists* reached = nullptr) {
    constexpr std::size_t moved = 1;
    singles(receiver, receiver.layers()[moved], transmitter, transmitter.layers()[moved], visit);
    if (orders_.interactions < 2) return;
    if (orders_.diffractions >= 2) edge_pairs_.for_each_moved_pair(receiver, transmitter, visit);
    bodies_.for_each_pair(receiver, transmitter, true, visit, reached);
  }

 private:
  /// One mirror, or one edge.
  template <typename Visit>
  void singles(const PathHalf& receiver, const HalfLayer& near, const PathHalf& transmitter, const HalfLayer& far,
               Visit& visit) {
    if (orders_.interactions < 1) return;
    if (orders_.reflections >= 1) {
      for_each_in_both<FacetId>(near.mirrors, far.mirrors, [&](std::size_t at) {
        gates_.mirror(receiver, transmitter, near.mirrors[at], near.images_m[at], visit);
      });
    }
    if (orders_.diffractions < 1) return;
    for_each_in_both<WedgeId>(near.edges, far.edges,
                              [&](std::size_t at) { gates_.edge(receiver, transmitter, near.edges[at], visit); });
  }

  /// Two elements, with what the transmitter reaches.
  template <typename Visit>
  void listed_pairs(const PathHalf& receiver, const HalfLayer& near, const BeamLists& reached, Visit& visit) {
    if (orders_.reflections >= 2) listed_mirrors(receiver, near, reached, visit);
    if (orders_.reflections < 1 || orders_.diffractions < 1) return;
    listed_edges(receiver, near, reached, visit);
    mirrors_to_parts(receiver, near, reached, visit);
  }

  template <typename Visit>
  void listed_mirrors(const PathHalf& receiver, const HalfLayer& near, const BeamLists& reached, Visit& visit) {
    const auto ask = [&](std::uint32_t at, std::uint32_t place) {
      const BeamMirror& far = reached.mirrors()[place];
      gates_.mirrors(receiver, near.mirrors[at], near.images_m[at], reached.half(), far.facet,
                     far.image_m + reached.origin_m(), visit);
    };
    const auto facet_of = [&](std::uint32_t place) { return reached.mirrors()[place].facet; };
    for (std::uint32_t at = 0; at < near.mirrors.size(); ++at) {
      reached.for_each_mirror_before(near.mirrors[at], near.cones[at], [&](std::uint32_t place) {
        __builtin_prefetch(&reached.mirrors()[place]);
        waiting_.add(at, place);
      });
      waiting_.ask_if_many(gates_.gates(), facet_of, ask);
    }
    waiting_.ask_all(gates_.gates(), facet_of, ask);
  }

  /// Edges of which the transmitter sees a part, over the receiver's mirrors.
  template <typename Visit>
  void mirrors_to_parts(const PathHalf& receiver, const HalfLayer& near, const BeamLists& reached, Visit& visit) {
    const auto ask = [&](std::uint32_t at, std::uint32_t edge) {
      gates_.mirror_to_edge(receiver, near.mirrors[at], near.images_m[at], reached.half(), WedgeId(edge), false, visit);
    };
    const auto edge_of = [](std::uint32_t edge) { return WedgeId(edge); };
    for (std::uint32_t at = 0; at < near.mirrors.size(); ++at) {
      reached.for_each_part_before(near.mirrors[at], near.cones[at], near.images_m[at] - reached.origin_m(), 0.0F,
                                   [&](const EdgePart& part) { waiting_.add(at, part.edge); });
      waiting_.ask_if_many(gates_.gates(), edge_of, ask);
    }
    waiting_.ask_all(gates_.gates(), edge_of, ask);
  }

  /// Edges that the receiver sees, lit over the transmitter's mirrors.
  template <typename Visit>
  void listed_edges(const PathHalf& receiver, const HalfLayer& near, const BeamLists& reached, Visit& visit) {
    const Vec3 end = receiver.position_m() - reached.origin_m();
    const auto ask = [&](std::uint32_t at, std::uint32_t place) {
      const BeamMirror& far = reached.mirrors()[place];
      gates_.mirror_to_edge(reached.half(), far.facet, far.image_m + reached.origin_m(), receiver, near.edges[at], true,
                            visit);
    };
    const auto facet_of = [&](std::uint32_t place) { return reached.mirrors()[place].facet; };
    for (std::uint32_t at = 0; at < near.edges.size(); ++at) {
      reached.for_each_lit_part(near.edges[at], end, 0.0F, [&](const EdgePart&, std::uint32_t place) {
        __builtin_prefetch(&reached.mirrors()[place]);
        waiting_.add(at, place);
      });
      waiting_.ask_if_many(gates_.gates(), facet_of, ask);
    }
    waiting_.ask_all(gates_.gates(), facet_of, ask);
  }

  PairGates gates_;
  JoinOrders orders_;
  LayerJoiner layers_;
  BodyJoiner bodies_;
  EdgePairJoiner edge_pairs_;
  WaitingPairs waiting_;
};

}  // namespace dcem
