#pragma once
/// One receiver's half joined with those of all transmitters.
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/discover/path_search.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"

namespace dcem {

inline JoinOrders joined_orders(const PathSearchSettings& settings) {
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

/// Halves of some transmitters, by number, without copies of them.
class HalfRefs {
 public:
  HalfRefs() = default;
  explicit HalfRefs(std::span<const KeptHalf> halves) : refs_(halves.begin(), halves.end()) {}
  void add(const KeptHalf& half) { refs_.emplace_back(half); }

  const KeptHalf& operator[](std::size_t number) const { return refs_[number]; }
  bool empty() const { return refs_.empty(); }
  auto begin() const { return refs_.begin(); }
  auto end() const { return refs_.end(); }

 private:
  std::vector<std::reference_wrapper<const KeptHalf>> refs_;
};

/// The halves that a search from one receiver joins.
struct LinkHalves {
  const FacetOutlines& outlines;
  const LaneScene& lanes;
  const HalfRefs& transmitters;  ///< those of absent ones are not looked at
  const PathHalf& receiver;
  const BeamLists& reached;  ///< by the receiver, where sequences of three elements are joined
};

/// What a receiver sees, worked out from scratch.
inline void look_from(const Scene& scene, const PathSearchSettings& settings, const FacetOutlines& outlines,
                      const LaneScene& lanes, const LinkEnd& receiver, ReceiverRoom& room) {
  if (settings.max_interactions == 0) return;
  const HalfSettings seen = half_settings(settings);
  room.half.find_scenery(scene, outlines, receiver, seen);
  room.half.find_bodies(scene, outlines, seen);
  if (joins_triples(settings)) room.lists.find_all({scene, outlines, lanes, room.half, seen, true});
}

/// Every sequence that `halves_cover` names and that may carry a path from a transmitter to the receiver.
inline SequenceList join_link(const Scene& scene, const PathSearchSettings& settings, const LinkHalves& halves,
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

/// The same by transmitter.
inline std::vector<SequenceList> join_halves(const Scene& scene, const PathSearchSettings& settings,
                                             const LinkHalves& halves,
                                             std::span<const std::optional<LinkEnd>> transmitters) {
  std::vector<SequenceList> proposed(transmitters.size());
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (transmitters[index]) proposed[index] = join_link(scene, settings, halves, index);
  }
  return proposed;
}

}  // namespace dcem
