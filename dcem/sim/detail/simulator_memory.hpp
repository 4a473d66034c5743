#pragma once
/// How a `BasicSimulator` follows its links from frame to frame where the cache is exact; included by
/// basic_simulator.hpp. Whatever is remembered only spares work: a link is as it would be from scratch.
#include <algorithm>
#include <utility>

#include "dcem/paths/memory/standing_link.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/link_work.hpp"
#include "dcem/sim/verify/same_bits.hpp"

namespace dcem {

/// One receiver in one frame: what its links are solved with.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::Following {
  Following(const BasicSimulator& simulator, const TransmitterEnds& ends, const Tracer& of, const LinkEnd& receiver,
            const RadioEnd& at_receiver)
      : transmitters(ends),
        search(simulator.search_settings(ends.embedded)),
        tracer(of),
        solver(tracer, search.max_transmissions, search.edges),
        ways(tracer, search.max_transmissions),
        field(simulator.evaluator()),
        end(receiver),
        radio(at_receiver) {}

  /// What a sequence brings between a transmitter and the receiver.
  std::optional<PathContribution> solve(std::size_t transmitter, const Sequence& sequence) {
    std::optional<Path> path = solver.solve(*transmitters.link[transmitter], end, sequence);
    if (!path) return std::nullopt;
    return field.evaluate(std::move(*path), transmitters.radio[transmitter], radio);
  }

  const TransmitterEnds& transmitters;
  PathSearchSettings search;
  const Tracer& tracer;
  PathSolver<Index> solver;
  WayFinder<Index> ways;
  Evaluator field;
  const LinkEnd& end;
  const RadioEnd& radio;
  SearchCounters counters;
  CacheCounters cache;
};

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::follow_all(
    const TransmitterEnds& transmitters) {
  const std::span<const Device> receivers = scene_.receivers();
  std::vector<Solved> by_receiver(receivers.size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(receivers.size(), [&](std::size_t index, unsigned worker) {
    ReceiverRoom* const room = rooms.empty() ? nullptr : &rooms[worker];
    by_receiver[index] = choice_.takes_all()
                             ? follow_receiver(receivers[index], index, transmitters, room)
                             : follow_receiver(receivers[index], index, transmitters.only(chosen_[index]), room);
  });
  return sum_of(std::move(by_receiver), transmitters);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::follow_receiver(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room) {
  detail::ReceiverMemory& memory = receivers_[index];
  const Tracer tracer(scene_, index_);
  const DeviceState state = state_of(receiver);
  Solved solved;
  if (!state.present) {
    for (const detail::LinkMemory& link : memory.links)
      solved.cache.died += link.result ? link.result->paths.size() : 0;
    memory.forget();
    return solved;
  }
  TraversalCounters traversal;
  const LinkEnd end = link_end(state, traversal);
  if (memory.end && memory.end->ignored_body != end.ignored_body) memory.links.clear();
  const bool stands = detail::same_bits(memory.end, end), is_same = detail::same_bits(memory.state, state);
  memory.end = end;
  memory.state = state;
  solved.cache.died += memory.select(transmitters.numbers, transmitters.link.size());
  std::vector<std::optional<LinkEnd>> others;
  const std::span<const std::optional<LinkEnd>> ends = ends_beside(receiver, transmitters, others);
  const RadioEnd radio = detail::radio_end(receiver, state);
  const auto stays = [&](std::size_t transmitter) {
    return !ends[transmitter] || (stands && is_same && memory.links[transmitter].result &&
                                  transmitter_is_same_[transmitters.number(transmitter)] != 0 && !change_->any());
  };
  bool all_stay = true;
  for (std::size_t transmitter = 0; transmitter < ends.size(); ++transmitter) {
    all_stay = all_stay && stays(transmitter);
  }
  if (plan_.joined == 0 && !all_stay) return solve_again(receiver, index, transmitters, room);
  std::optional<Following> following;  // made where something is to be solved
  for (std::size_t transmitter = 0; transmitter < ends.size(); ++transmitter) {
    const std::size_t number = transmitters.number(transmitter);
    detail::LinkMemory& link = memory.links[transmitter];
    if (!ends[transmitter]) {
      solved.cache.died += link.result ? link.result->paths.size() : 0;
      link.forget();
      continue;
    }
    const bool rests = stands && link.result && transmitter_rests_[number] != 0;
    if (transmitter_rests_[number] == 0) link.pooled.forget();
    if (stays(transmitter)) {
      solved.cache.taken_over += link.result->paths.size();
      solved.links.push_back(*link.result);
      continue;
    }
    if (!following) {
      following.emplace(*this, transmitters, tracer, end, radio);
      look_from_receiver(*following, memory, *room);
    }
    const bool fields_stay = rests && is_same && transmitter_is_same_[number] != 0;
    std::vector<PathContribution> paths = rests && link.standing.is_known() && !joins_triples(following->search)
                                              ? paths_of_standing(*following, memory, transmitter, fields_stay)
                                              : paths_of_moving(*following, memory, *room, transmitter, rests);
    std::vector<DiffusePower> diffuse(ends.size());
    if (settings_.propagation.diffuse.enabled) {
      std::vector<std::optional<LinkEnd>> alone(ends.size());
      alone[transmitter] = ends[transmitter];
      diffuse = diffuse_powers(receiver, {end, radio}, transmitters, alone, room, solved.work);
    }
    LinkResult result =
        finish_link(std::move(paths), std::move(diffuse[transmitter]), number,
                    {*ends[transmitter], transmitters.radio[transmitter]}, {end, radio}, following->field);
    result.receiver = index;
    result.complete = true;
    detail::count_births(link.result, result, solved.cache);
    link.result = result;
    solved.links.push_back(std::move(result));
  }
  if (!following && change_->any_moved()) memory.half.forget_bodies();
  for (const LinkResult& link : solved.links) solved.work.paths += link.paths.size();
#if !defined(NDEBUG)
  check_some(receiver, index, transmitters, solved.links, room);
#endif
  if (following) {
    following->counters.solver += following->solver.counters();
    following->counters.solver.traversal += traversal;
    detail::add_search_work(following->counters, solved.work);
    solved.cache += following->cache;
  }
  return solved;
}

/// One in a hundred pairs of link and frame, chosen at random, is solved from scratch: in builds that are not for use.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::check_some(const Device& receiver, std::size_t index,
                                                const TransmitterEnds& transmitters, std::span<const LinkResult> links,
                                                ReceiverRoom* room) const {
  const auto is_chosen = [&](const LinkResult& link) {
    return hash_values(frame_.index, index, link.transmitter) % 100 == 0;
  };
  if (std::none_of(links.begin(), links.end(), is_chosen)) return;
  const Solved expected = solve_receiver(receiver, index, transmitters, nullptr, {room});
  for (std::size_t link = 0; link < links.size(); ++link) {
    DCEM_ASSERT(!is_chosen(links[link]) || detail::same_bits(links[link], expected.links[link]));
  }
}

/// All links of a receiver from scratch, where sequences are not joined from halves.
template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::solve_again(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room) {
  Solved solved = solve_receiver(receiver, index, transmitters, nullptr, {room});
  detail::ReceiverMemory& memory = receivers_[index];
  const std::vector<detail::LinkMemory> before = std::exchange(memory.links, {});
  memory.links.resize(transmitters.link.size());
  for (const LinkResult& link : solved.links) {
    detail::LinkMemory& now = memory.link(link.transmitter);
    detail::count_births(before[static_cast<std::size_t>(&now - memory.links.data())].result, link, solved.cache);
    now.result = link;
  }
  return solved;
}

/// What the receiver may see, as its place or itself shows it, and what of the bodies.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_from_receiver(Following& following, detail::ReceiverMemory& memory,
                                                        ReceiverRoom& room) const {
  const PathSearchSettings& search = following.search;
  if (search.max_interactions == 0) return;
  if (joins_triples(search)) return look_from(scene_, search, *outlines_, *lanes_, following.end, room);
  const auto is_listed = [](const KeptHalf& transmitter) { return transmitter.lists() != nullptr; };
  const bool pools = std::ranges::any_of(following.transmitters.halves, is_listed);
  memory.half.keep_places(pools ? detail::longest_pooled_step_m : detail::longest_step_in_place_m, false);
  memory.half.update(scene_, *outlines_, following.end, half_settings(search), {}, change_->moved());
}

/// All paths of a link, from sequences found from both ends. Where the ends stand, all that may carry a path later is
/// noted.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_of_moving(Following& following,
                                                                              detail::ReceiverMemory& memory,
                                                                              ReceiverRoom& room,
                                                                              std::size_t transmitter,
                                                                              bool rests) const {
  const bool triples = joins_triples(following.search);
  memory.links[transmitter].standing.forget();
  if (may_pool(following, memory, transmitter, rests)) {
    if (memory.half.place()) return paths_in_place(following, memory, transmitter);
    prepare_pool(following, memory, transmitter);
  }
  std::vector<std::optional<LinkEnd>> alone(following.transmitters.link.size());
  alone[transmitter] = following.transmitters.link[transmitter];
  memory.half.lay_out_images(scene_, *outlines_);
  const LinkHalves halves{*outlines_, *lanes_, following.transmitters.halves, triples ? room.half : memory.half.half(),
                          room.lists};
  const SequenceList proposed = join_halves(scene_, following.search, halves, alone)[transmitter];
  StandingLink<PathContribution>& standing = memory.links[transmitter].standing;
  const bool notes = rests && !triples && scene_.bodies().size() > 1;
  std::vector<PathContribution> paths;
  Sequence sequence;
  for (std::size_t number = 0; number < proposed.size(); ++number) {
    const std::span<const SequenceElement> elements = proposed[number];
    sequence.assign(elements.begin(), elements.end());
    ++following.counters.sequences_proposed;
    std::optional<PathContribution> found = following.solve(transmitter, sequence);
    if (notes) note_standing(following, standing, transmitter, sequence, found);
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
      .for_each_body_sequence(memory.half.half(), mast.half(), solve);
  prepare_pool(following, memory, transmitter);
  return paths;
}

/// Notes what may carry a path as long as the ends stand.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::note_standing(Following& following, StandingLink<PathContribution>& standing,
                                                   std::size_t transmitter, const Sequence& sequence,
                                                   const std::optional<PathContribution>& found) const {
  const LinkEnd& from = *following.transmitters.link[transmitter];
  if (found) {
    standing.add({following.ways.find_open(from, following.end, sequence), found, following.solver.had_choice()});
  } else if (auto way = following.ways.find(from, following.end, sequence, following.counters.solver)) {
    standing.add({std::move(*way), std::nullopt});
  }
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_of_standing(Following& following,
                                                                                detail::ReceiverMemory& memory,
                                                                                std::size_t transmitter,
                                                                                bool fields_stay) const {
  StandingLink<PathContribution>& standing = memory.links[transmitter].standing;
  const auto has_moved = [&](SequenceElement element) {
    const BodyId body = element.is_edge() ? scene_.wedge(element.edge()).body : scene_.facet(element.mirror()).body;
    return change_->moved()[body.value] != 0;
  };
  if (change_->any_moved()) standing.drop(has_moved);
  for (auto& entry : standing.entries()) {
    if ((entry.has_choice && change_->any()) || change_->boxes().meet(entry.way.points_m, entry.way.around)) {
      ++following.cache.revalidated;
      const bool was = entry.outcome.has_value();
      entry.outcome = following.solve(transmitter, entry.way.sequence);
      entry.has_choice = following.solver.had_choice();
      ++(entry.outcome ? following.cache.reused : following.cache.expired);
      if (!was && !entry.outcome) --following.cache.expired;
    } else if (entry.outcome) {
      ++following.cache.taken_over;
      if (!fields_stay) {
        entry.outcome = following.field.evaluate(std::move(entry.outcome->path),
                                                 following.transmitters.radio[transmitter], following.radio);
      }
    }
  }
  if (change_->any_moved() && following.search.max_interactions > 0) {
    const auto add = [&](const Sequence& sequence) {
      ++following.counters.sequences_proposed;
      note_standing(following, standing, transmitter, sequence, following.solve(transmitter, sequence));
    };
    HalfJoiner(scene_, *outlines_, joined_orders(following.search))
        .for_each_moved_sequence(memory.half.half(), following.transmitters.halves[transmitter].half(), add);
  }
  std::vector<PathContribution> paths;
  for (const auto& entry : standing.entries()) {
    if (entry.outcome) paths.push_back(*entry.outcome);
  }
  return paths;
}

}  // namespace dcem
