#pragma once
/// One receiver's half joined with those of all transmitters.
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/discover/search_settings.hpp"
#include "dcem/paths/halves/join_orders.hpp"
#include "dcem/paths/halves/kept_half.hpp"

namespace dcem {

inline JoinOrders joined_orders(const PathSearchSettings& settings) {
  return {settings.max_reflections, settings.max_diffractions, settings.max_interactions, settings.max_path_length_m};
}
/// Whether sequences of three elements are joined: both ends then look through their mirrors.
inline bool joins_triples(const PathSearchSettings& settings) {
  return settings.joined >= 3 && settings.max_interactions >= 3 && settings.max_reflections >= 2;
}
/// Whether the candidates of a place are all that such a search may find there.
inline bool pools_cover(const PathSearchSettings& settings) {
  return settings.max_interactions >= 1 && (settings.max_diffractions <= 1 || settings.max_interactions <= 1);
}
/// Of an end of links. Where three elements are joined, each of its mirrors costs so much that it pays to look twice;
/// where one is, no view is so wide that it does.
inline HalfSettings half_settings(const PathSearchSettings& settings) {
  constexpr std::size_t many = 5'000;  // small facets, by measurement, where two are joined
  const bool pairs = settings.max_interactions >= 2;
  const std::size_t closer_from = joins_triples(settings) ? 0 : pairs ? many : std::numeric_limits<std::size_t>::max();
  return {settings.max_diffractions > 0,
          settings.max_transmissions,
          settings.edges,
          closer_from,
          settings.max_path_length_m,
          pairs};
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
void look_from(const Scene& scene, const PathSearchSettings& settings, const FacetOutlines& outlines,
               const LaneScene& lanes, const LinkEnd& receiver, ReceiverRoom& room);

/// Every sequence that `halves_cover` names and that may carry a path from a transmitter to the receiver.
SequenceList join_link(const Scene& scene, const PathSearchSettings& settings, const LinkHalves& halves,
                       std::size_t transmitter);

/// The same by transmitter.
std::vector<SequenceList> join_halves(const Scene& scene, const PathSearchSettings& settings, const LinkHalves& halves,
                                      std::span<const std::optional<LinkEnd>> transmitters);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/link_halves_bodies.hpp"
#endif
