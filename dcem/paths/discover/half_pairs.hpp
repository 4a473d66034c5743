#pragma once
/// Chains over two edges, one that the receiver reaches and one that the transmitter reaches, in sampled search.
///
/// Of all pairs of halves few can carry a path: each edge must lie outside the other's wedge, and the shortest way from
/// one end's image to the other's must meet both within their ends. That is asked of whole groups of edges by the boxes
/// around them, then of eight at once in single precision with how far each number may be off
/// (paths/discover/half_packs.hpp). What is refused cannot be a path, so nothing is lost; what is left the solver
/// decides.
#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/search_counters.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Appends the chains over two edges within some limits, from the receiver outwards, each once, without those that
/// surely carry no path. Between the edges lies nothing, or one of the mirrors that one of them sees.
void join_edge_pairs(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver,
                     const ReachingEnd& transmitter, SequenceList& chains, PairCounters& counters);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/half_pairs_bodies.hpp"
#endif
