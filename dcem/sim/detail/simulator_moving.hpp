#pragma once
/// How a `BasicSimulator` finds the paths of a link that moves, from what its ends see and from what is known of
/// places; included by basic_simulator.hpp.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"
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
  const bool pools = std::any_of(following.transmitters.halves.begin(), following.transmitters.halves.end(), is_listed);
  if (!pools && following.as_transmitter != nullptr) {
    memory.half.forget_bodies();  // nobody tells it how they move
    following.half = &following.as_transmitter->half();
    return;
  }
  const double longest_step_m =
      pools ? detail::longest_pooled_step_m(change_->bodies_there()) : detail::longest_step_in_place_m;
  PlaceUse use{longest_step_m, false, false, some_rest(following.transmitters), known_places_.get()};
  use.early = early_of(static_cast<std::size_t>(&memory - receivers_.data()));
  memory.half.keep_places(use);
  following.goes_through_places = true;
  const HalfSettings settings = half_settings(search);
  if (stands || !memory.half.is_followed()) {
    memory.half.update(scene_, *outlines_, following.end, settings, {}, change_->moved());
  } else if (!memory.half.update_in_place(scene_, *outlines_, following.end, settings, change_->moved())) {
    return look_from(scene_, search, *outlines_, *lanes_, following.end, room);
  }
  following.half = &memory.half.half();
}

/// The same of a receiver of which nothing is kept.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_anew(Following& following, ReceiverRoom& room) const {
  const KeptHalf* const known = following.as_transmitter;
  following.half = known != nullptr ? &known->half() : &room.half;
  following.lists = known != nullptr ? known->lists() : &room.lists;
  if (known == nullptr) look_from(scene_, following.search, *outlines_, *lanes_, following.end, room);
}

/// The same where sequences of three elements are joined: what a receiver that stands reaches over its mirrors is kept,
/// and what one that moves may reach from its place.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_for_triples(Following& following, detail::ReceiverMemory& memory,
                                                      ReceiverRoom& room, bool stands) const {
  const PathSearchSettings& search = following.search;
  if (const KeptHalf* const known = following.as_transmitter) {
    memory.half.forget_bodies();  // nobody tells it how they move
    memory.forget_pools();
    following.half = &known->half();
    following.lists = known->lists();
    return;
  }
  const HalfSettings settings = half_settings(search);
  // Where most transmitters have listed what they reach: other links are joined from what the place sees, which is
  // more.
  const auto listed = std::count_if(following.transmitters.halves.begin(), following.transmitters.halves.end(),
                                    [](const KeptHalf& transmitter) { return transmitter.lists() != nullptr; });
  const bool mostly_pools = 2 * static_cast<std::size_t>(listed) > following.transmitters.link.size();
  const auto device = static_cast<std::size_t>(&memory - receivers_.data());
  PlaceUse use{detail::longest_step_of_triples_m, false, true, some_rest(following.transmitters), known_places_.get()};
  use.early = early_of(device);
  use.longest_shared_step_m = mostly_pools ? detail::longest_pooled_step_m(change_->bodies_there()) : 0.0;
  use.follows = driven_ways_.follows(device);
  use.leads = !use.follows && driven_ways_.has_followers(device);  // one for all: each would take a frame and a half
  memory.half.keep_places(use);
  following.goes_through_places = true;
  if (stands) {
    memory.forget_pools();
    const HalfLists lists{lanes_.get(), true, true, 0, nullptr, BeamFinder::few_pieces};
    memory.half.update(scene_, *outlines_, following.end, settings, lists, change_->moved());
    following.half = &memory.half.half();
    following.lists = memory.half.lists();
    return;
  }
  const bool is_in_place = memory.half.update_in_place(scene_, *outlines_, following.end, settings, change_->moved());
  if (!memory.half.is_in_places()) memory.forget_pools();  // it moves too fast
  if (!is_in_place) return look_from(scene_, search, *outlines_, *lanes_, following.end, room);
  following.half = &memory.half.half();
  if (outlines_->bodies().empty() && all_rest(following.transmitters)) return;
  memory.half.lay_out_images(scene_, *outlines_);
  const BeamSource source{scene_, *outlines_, *lanes_, memory.half.half(), settings, true};
  room.lists.find_from(source, *memory.half.place(), change_->moved());
}

/// Whether all transmitters are where they were in the frame before.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::all_rest(const TransmitterEnds& transmitters) const {
  for (std::size_t transmitter = 0; transmitter < transmitters.link.size(); ++transmitter) {
    if (transmitters.link[transmitter] && transmitter_rests_[transmitters.number(transmitter)] == 0) return false;
  }
  return true;
}

/// Whether any of them is: a link with it has candidates in the receiver's places, or will have.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::some_rest(const TransmitterEnds& transmitters) const {
  for (std::size_t transmitter = 0; transmitter < transmitters.link.size(); ++transmitter) {
    if (transmitters.link[transmitter] && transmitter_rests_[transmitters.number(transmitter)] != 0) return true;
  }
  return false;
}

/// All paths of a link, from sequences found from both ends. Where the ends stand, all that may carry a path later is
/// noted.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_of_moving(FollowedLink& link,
                                                                              const KeptHalf& half) const {
  link.memory.standing.forget();
  const Following& following = link.of;
  if (may_pool(following, half, link.transmitter, link.rests)) {
    if (half.place()) return paths_in_place(link, half);
    prepare_pool(link, half);
  }
  const LinkHalves halves{*outlines_, *lanes_, following.transmitters.halves, *following.half, *following.lists};
  const SequenceList proposed = join_link(scene_, following.search, halves, link.transmitter);
  const bool notes = link.rests && scene_.bodies().size() > 1;
  std::vector<PathContribution> paths;
  Sequence sequence;
  for (std::size_t number = 0; number < proposed.size(); ++number) {
    const std::span<const SequenceElement> elements = proposed[number];
    sequence.assign(elements.begin(), elements.end());
    ++link.counters.sequences_proposed;
    std::optional<PathContribution> found = notes ? note_standing(link, sequence) : link.solve(sequence);
    if (found) paths.push_back(std::move(*found));
  }
  if (notes) link.memory.standing.complete();
  return paths;
}

/// Whether what both ends see is joined as it is: not where a link is known, nor in a place of which all candidates
/// are.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::joins_anew(const Following& following, const detail::ReceiverMemory& memory,
                                                const LinkToFollow& link) const {
  if (link.rests && memory.links[link.transmitter].standing.is_known()) return false;
  return !may_pool(following, memory.half, link.transmitter, link.rests) || !memory.half.place();
}

/// Whether it pays to know all candidates of the places that the receiver comes through.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::may_pool(const Following& following, const KeptHalf& half, std::size_t transmitter,
                                              bool rests) const {
  const bool stands = transmitter_rests_[following.transmitters.number(transmitter)] != 0;
  return pools_cover(following.search) && !rests && stands && following.goes_through_places && half.is_in_places() &&
         following.transmitters.halves[transmitter].lists() != nullptr;
}

/// Finds some of the candidates of the place that the receiver will be in next.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::prepare_pool(FollowedLink& link, const KeptHalf& half) const {
  auto next = half.next_place();
  if (!next) return;
  link.pooled().prepare(pool_source(link), std::move(next), half.work_ahead());
}

/// What the candidates of a link are found with.
template <SurfaceModel Surface, SpatialIndex Index>
PoolSource BasicSimulator<Surface, Index>::pool_source(const FollowedLink& link) const {
  const TransmitterEnds& transmitters = link.of.transmitters;
  return {scene_,
          *outlines_,
          *lanes_,
          *transmitters.halves[link.transmitter].lists(),
          joined_orders(link.of.search),
          known_pools_,
          transmitters.number(link.transmitter)};
}

/// All paths of a link whose transmitter stands, from the candidates of the receiver's place.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_in_place(FollowedLink& link,
                                                                             const KeptHalf& half) const {
  PooledLink& pooled = link.pooled();
  const Following& following = link.of;
  const KeptHalf& mast = following.transmitters.halves[link.transmitter];
  const PoolSource source = pool_source(link);
  if (!pooled.is_of(*half.place())) {
    pooled.enter(source, half.place());
  } else if (!half.next_place()) {
    pooled.renew(source, half.place());
  }
  std::vector<PathContribution> paths;
  const auto solve = [&](const Sequence& sequence) {
    ++link.counters.sequences_proposed;
    std::optional<PathContribution> found = link.solve(sequence);
    if (found) paths.push_back(std::move(*found));
    return found.has_value();
  };
  solve({});
  const JoinGates gates(scene_, *outlines_);
  const PoolJudge<Index> judge{gates,       *outlines_, link.from(),         following.end,
                               mast.half(), link.ways,  link.counters.solver};
  pooled.for_each_open(judge, solve);
  pooled.for_each_open_triple(judge, *mast.lists(), solve);
  const JoinOrders orders = joined_orders(following.search);
  HalfJoiner(scene_, *outlines_, orders).for_each_body_sequence(*following.half, mast.half(), solve, mast.lists());
  if (joins_triples(following.search) && !outlines_->bodies().empty()) {
    TripleJoiner(scene_, *outlines_, *lanes_, orders).for_each_body_sequence(*following.lists, *mast.lists(), solve);
  }
  prepare_pool(link, half);
  return paths;
}

/// What the frame has brought to light of places: from the next one on everybody may take it over.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::note_places() {
  if (plan_.joined == 0) return;
  const auto is_listed = [](const KeptHalf& transmitter) { return transmitter.lists() != nullptr; };
  if (joins_triples(search_settings({})) && std::any_of(halves_.begin(), halves_.end(), is_listed)) note_ways();
  for (detail::ReceiverMemory& memory : receivers_) {
    if (!memory.half.place()) continue;
    if (const auto entered = memory.half.take_entered()) known_places_->note(entered);
    for (std::size_t place = 0; place < memory.links.size(); ++place) {
      const std::unique_ptr<PooledLink>& pooled = memory.links[place].pooled;
      if (pooled == nullptr) continue;
      auto news = pooled->news();
      if (!news || !known_places_->holds(news->pool->place())) continue;
      known_pools_.note(memory.numbers.empty() ? place : memory.numbers[place], *std::move(news));
    }
  }
  for (KeptHalf& half : halves_) {
    if (const auto entered = half.take_entered()) known_places_->note(entered);
  }
  if (!known_places_->next_frame(most_known_places_)) return;
  known_pools_.keep([&](const Place& place, std::size_t) { return known_places_->holds(place); });
}

/// Where receivers have driven that may take over places.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::note_ways() {
  for (std::size_t device = 0; device < receivers_.size(); ++device) {
    const detail::ReceiverMemory& memory = receivers_[device];
    const bool takes_over = memory.end && is_remembered_[device] != 0 && memory.half.is_followed();
    driven_ways_.note(device, takes_over ? std::optional(memory.end->position_m) : std::nullopt);
  }
  driven_ways_.next_frame();
}

}  // namespace dcem
