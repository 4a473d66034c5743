#pragma once
/// One receiver's half joined with those of all transmitters.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/discover/path_search.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/kept_half.hpp"

namespace dcem {

inline HalfSettings half_settings(const PathSearchSettings& settings) {
  return {settings.max_diffractions > 0, settings.max_transmissions == 0, settings.edges};
}
inline HalfJoiner::Orders joined_orders(const PathSearchSettings& settings) {
  return {settings.max_reflections, settings.max_diffractions, settings.max_interactions};
}

/// The halves that a search from one receiver joins.
struct LinkHalves {
  const FacetOutlines& outlines;
  std::span<const KeptHalf> transmitters;  ///< by their numbers; those of absent ones are not looked at
  PathHalf& receiver;                      ///< room for the receiver's own
};

/// By transmitter, every sequence that `halves_cover` names and that may carry a path to the receiver.
inline std::vector<SequenceList> join_halves(const Scene& scene, const PathSearchSettings& settings,
                                             const LinkHalves& halves, const LinkEnd& receiver,
                                             std::span<const std::optional<LinkEnd>> transmitters) {
  std::vector<SequenceList> proposed(transmitters.size());
  const bool direct_alone = settings.max_interactions == 0;
  if (!direct_alone) {
    halves.receiver.find_scenery(scene, halves.outlines, receiver, half_settings(settings));
    halves.receiver.find_bodies(scene, halves.outlines, half_settings(settings));
  }
  HalfJoiner joiner(scene, halves.outlines, joined_orders(settings));
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (!transmitters[index]) continue;
    if (direct_alone) {
      proposed[index].add({});
    } else {
      joiner.for_each_sequence(halves.receiver, halves.transmitters[index].half(),
                               [&](const Sequence& sequence) { proposed[index].add(sequence); });
    }
  }
  return proposed;
}

}  // namespace dcem
