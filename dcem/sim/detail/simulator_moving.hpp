#pragma once
/// How a `BasicSimulator` finds the paths of a link that moves, from what its ends see and from what is known of
/// places; included by basic_simulator.hpp.
#include <utility>

#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/simulator_memory.hpp"

namespace dcem {

/// What the receiver may see, as its place or itself shows it, and what of the bodies.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_from_receiver(Following& following, detail::ReceiverMemory& memory,
                                                        ReceiverRoom& room, bool stands) const {
  const PathSearchSettings& search = following.search;
  following.half = &room.half;
  following.lists = &room.lists;
  if (search.max_interactions == 0) return;
  if (joins_triples(search)) return look_for_triples(following, memory, room, stands);
  const auto is_listed = [](const KeptHalf& transmitter) { return transmitter.lists() != nullptr; };
  const bool pools = std::ranges::any_of(following.transmitters.halves, is_listed);
  if (!pools && following.as_transmitter != nullptr) {
    memory.half.forget_bodies();  // nobody tells it how they move
    following.half = &following.as_transmitter->half();
    return;
  }
  memory.half.keep_places(pools ? detail::longest_pooled_step_m : detail::longest_step_in_place_m, false);
  memory.half.update(scene_, *outlines_, following.end, half_settings(search), {}, change_->moved());
  following.half = &memory.half.half();
}

/// The same where sequences of three elements are joined: what a receiver that stands reaches over its mirrors is kept.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_for_triples(Following& following, detail::ReceiverMemory& memory,
                                                      ReceiverRoom& room, bool stands) const {
  const PathSearchSettings& search = following.search;
  const KeptHalf* known = following.as_transmitter;
  if (known == nullptr && stands) {
    const HalfLists lists{lanes_.get(), true, true, 0, nullptr, BeamFinder::few_pieces};
    memory.half.update(scene_, *outlines_, following.end, half_settings(search), lists, change_->moved());
    known = &memory.half;
  } else {
    memory.half.forget_bodies();
  }
  if (known == nullptr) return look_from(scene_, search, *outlines_, *lanes_, following.end, room);
  following.half = &known->half();
  following.lists = known->lists();
}

/// All paths of a link, from sequences found from both ends. Where the ends stand, all that may carry a path later is
/// noted.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_of_moving(Following& following,
                                                                              detail::ReceiverMemory& memory,
                                                                              std::size_t transmitter,
                                                                              bool rests) const {
  memory.links[transmitter].standing.forget();
  if (may_pool(following, memory, transmitter, rests)) {
    if (memory.half.place()) return paths_in_place(following, memory, transmitter);
    prepare_pool(following, memory, transmitter);
  }
  if (following.half == &memory.half.half()) memory.half.lay_out_images(scene_, *outlines_);
  const LinkHalves halves{*outlines_, *lanes_, following.transmitters.halves, *following.half, *following.lists};
  const SequenceList proposed = join_link(scene_, following.search, halves, transmitter);
  StandingLink<PathContribution>& standing = memory.links[transmitter].standing;
  const bool notes = rests && scene_.bodies().size() > 1;
  std::vector<PathContribution> paths;
  Sequence sequence;
  for (std::size_t number = 0; number < proposed.size(); ++number) {
    const std::span<const SequenceElement> elements = proposed[number];
    sequence.assign(elements.begin(), elements.end());
    ++following.counters.sequences_proposed;
    std::optional<PathContribution> found =
        notes ? note_standing(following, standing, transmitter, sequence) : following.solve(transmitter, sequence);
    if (found) paths.push_back(std::move(*found));
  }
  if (notes) standing.complete();
  return paths;
}

/// Whether it pays to know all candidates of the places that the receiver comes through.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::may_pool(const Following& following, const detail::ReceiverMemory& memory,
                                              std::size_t transmitter, bool rests) const {
  const PathSearchSettings& search = following.search;
  const bool is_covered = search.max_interactions >= 1 && !joins_triples(search) &&
                          (search.max_diffractions <= 1 || search.max_interactions <= 1);
  return is_covered && !rests && memory.half.is_in_places() &&
         following.transmitters.halves[transmitter].lists() != nullptr;
}

/// Finds some of the candidates of the place that the receiver will be in next.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::prepare_pool(const Following& following, detail::ReceiverMemory& memory,
                                                  std::size_t transmitter) const {
  auto next = memory.half.next_place();
  if (!next) return;
  const BeamLists& reached = *following.transmitters.halves[transmitter].lists();
  memory.links[transmitter].pooled.prepare({scene_, *outlines_, reached, joined_orders(following.search)},
                                           std::move(next), memory.half.frames_to_next());
}

/// All paths of a link whose transmitter stands, from the candidates of the receiver's place.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_in_place(Following& following,
                                                                             detail::ReceiverMemory& memory,
                                                                             std::size_t transmitter) const {
  PooledLink& pooled = memory.links[transmitter].pooled;
  const KeptHalf& mast = following.transmitters.halves[transmitter];
  if (!pooled.is_of(*memory.half.place())) {
    pooled.enter({scene_, *outlines_, *mast.lists(), joined_orders(following.search)}, memory.half.place());
  }
  std::vector<PathContribution> paths;
  const auto solve = [&](const Sequence& sequence) {
    ++following.counters.sequences_proposed;
    std::optional<PathContribution> found = following.solve(transmitter, sequence);
    if (found) paths.push_back(std::move(*found));
    return found.has_value();
  };
  solve({});
  const JoinGates gates(scene_, *outlines_);
  pooled.for_each_open(PoolJudge<Index>{gates, *outlines_, *following.transmitters.link[transmitter], following.end,
                                        mast.half(), following.ways, following.counters.solver},
                       solve);
  HalfJoiner(scene_, *outlines_, joined_orders(following.search))
      .for_each_body_sequence(*following.half, mast.half(), solve);
  prepare_pool(following, memory, transmitter);
  return paths;
}

}  // namespace dcem
