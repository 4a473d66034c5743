#pragma once
/// Bodies of link_halves.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/link_halves.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"

namespace dcem {

DCEM_INLINE void look_from(const Scene& scene, const PathSearchSettings& settings, const FacetOutlines& outlines,
                           const LaneScene& lanes, const LinkEnd& receiver, ReceiverRoom& room) {
  if (settings.max_interactions == 0) return;
  const HalfSettings seen = half_settings(settings);
  room.half.find_scenery(scene, outlines, receiver, seen);
  room.half.find_bodies(scene, outlines, seen);
  if (joins_triples(settings)) room.lists.find_all({scene, outlines, lanes, room.half, seen, true});
}

DCEM_INLINE SequenceList join_link(const Scene& scene, const PathSearchSettings& settings, const LinkHalves& halves,
                                   std::size_t transmitter) {
  SequenceList proposed;
  const auto add = [&](const Sequence& sequence) { proposed.add(sequence); };
  if (settings.max_interactions == 0) {
    add({});
    return proposed;
  }
  const KeptHalf& far = halves.transmitters[transmitter];
  const JoinOrders orders = joined_orders(settings);
  HalfJoiner(scene, halves.outlines, orders).for_each_sequence(halves.receiver, far.half(), add, far.lists());
  if (joins_triples(settings)) {
    TripleJoiner(scene, halves.outlines, halves.lanes, orders).for_each_sequence(halves.reached, *far.lists(), add);
  }
  return proposed;
}

DCEM_INLINE std::vector<SequenceList> join_halves(const Scene& scene, const PathSearchSettings& settings,
                                                  const LinkHalves& halves,
                                                  std::span<const std::optional<LinkEnd>> transmitters) {
  std::vector<SequenceList> proposed(transmitters.size());
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (transmitters[index]) proposed[index] = join_link(scene, settings, halves, index);
  }
  return proposed;
}

}  // namespace dcem
