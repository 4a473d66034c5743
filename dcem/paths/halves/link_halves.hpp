#pragma once
/// One receiver's half joined with those of all transmitters.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/discover/path_search.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"

namespace dcem {

inline HalfJoiner::Orders joined_orders(const PathSearchSettings& settings) {
  return {settings.max_reflections, settings.max_diffractions, settings.max_interactions};
}
/// Whether sequences of three elements are joined: both ends then look through their mirrors.
inline bool joins_triples(const PathSearchSettings& settings) {
  return settings.joined >= 3 && settings.max_interactions >= 3 && settings.max_reflections >= 2;
}
/// Of an end of links. Where three elements are joined, each of its mirrors costs so much that it pays to look twice.
inline HalfSettings half_settings(const PathSearchSettings& settings) {
  constexpr std::size_t many = 2'500;  // by measurement, where two are joined
  return {settings.max_diffractions > 0, settings.max_transmissions == 0, settings.edges,
          joins_triples(settings) ? 0 : many};
}

/// Room for what a receiver sees: one per thread.
struct ReceiverRoom {
  PathHalf half;
  BeamLists lists;
  Sight sight{PathHalf::default_pixels};  ///< at what scatters
};

/// The halves that a search from one receiver joins.
struct LinkHalves {
  const FacetOutlines& outlines;
  std::span<const KeptHalf> transmitters;  ///< by their numbers; those of absent ones are not looked at
  ReceiverRoom& receiver;
  const LaneScene& lanes;
};

/// By transmitter, every sequence that `halves_cover` names and that may carry a path to the receiver.
inline std::vector<SequenceList> join_halves(const Scene& scene, const PathSearchSettings& settings,
                                             const LinkHalves& halves, const LinkEnd& receiver,
                                             std::span<const std::optional<LinkEnd>> transmitters) {
  std::vector<SequenceList> proposed(transmitters.size());
  const HalfSettings seen = half_settings(settings);
  const bool triples = joins_triples(settings), direct_alone = settings.max_interactions == 0;
  ReceiverRoom& room = halves.receiver;
  if (!direct_alone) {
    room.half.find_scenery(scene, halves.outlines, receiver, seen);
    room.half.find_bodies(scene, halves.outlines, seen);
  }
  if (triples) room.lists.find_all({scene, halves.outlines, halves.lanes, room.half, seen, true});
  HalfJoiner joiner(scene, halves.outlines, joined_orders(settings));
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (!transmitters[index]) continue;
    const auto add = [&](const Sequence& sequence) { proposed[index].add(sequence); };
    if (direct_alone) {
      add({});
      continue;
    }
    const KeptHalf& transmitter = halves.transmitters[index];
    joiner.for_each_sequence(room.half, transmitter.half(), add, transmitter.lists());
    if (!triples) continue;
    TripleJoiner(scene, halves.outlines, halves.lanes, joined_orders(settings))
        .for_each_sequence(room.lists, *transmitter.lists(), add);
  }
  return proposed;
}

}  // namespace dcem
