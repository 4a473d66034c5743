#pragma once
/// How a `BasicSimulator` follows its links from frame to frame where the cache is exact; included by
/// basic_simulator.hpp. Whatever is remembered only spares work: a link is as it would be from scratch.
#include <algorithm>
#include <utility>

#include "dcem/paths/memory/standing_link.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/frame_links.hpp"
#include "dcem/sim/detail/link_work.hpp"
#include "dcem/sim/verify/same_bits.hpp"

namespace dcem {

/// One receiver in one frame: what all its links are solved with.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::Following {
  Following(const BasicSimulator& simulator, const TransmitterEnds& ends, const Device& at_end, const LinkEnd& at,
            const RadioEnd& at_receiver)
      : transmitters(ends),
        search(simulator.search_settings(ends.contacts.known())),
        tracer(simulator.scene_, simulator.index_),
        field(simulator.evaluator()),
        receiver(at_end),
        end(at),
        radio(at_receiver),
        as_transmitter(ends.half_of(at_end.id, at, joins_triples(search))) {}

  const TransmitterEnds& transmitters;
  PathSearchSettings search;
  Tracer tracer;
  Evaluator field;
  const Device& receiver;
  const LinkEnd& end;
  const RadioEnd& radio;
  const KeptHalf* as_transmitter;  ///< what the receiver sees, where it is a transmitter, too, and that is known
  // What it sees, and what it reaches where sequences of three elements are joined.
  const PathHalf* half = nullptr;
  const BeamLists* lists = nullptr;
  bool goes_through_places = false;               ///< its memory was told of this frame, and knows the place, if any
  std::shared_ptr<const SurfaceView> surfaces{};  ///< where diffuse power is asked for
};

/// One link of a receiver in one frame: what is its own, so that another thread may solve the next one.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::FollowedLink {
  FollowedLink(const Following& of_receiver, detail::LinkMemory& before, std::size_t number, bool both_rest)
      : of(of_receiver),
        memory(before),
        transmitter(number),
        rests(both_rest),
        solver(of.tracer, of.search.max_transmissions, of.search.edges),
        ways(of.tracer, of.search.max_transmissions) {}

  const LinkEnd& from() const { return *of.transmitters.link[transmitter]; }
  PooledLink& pooled() {
    if (memory.pooled == nullptr) memory.pooled = std::make_unique<PooledLink>();
    return *memory.pooled;
  }
  /// What a sequence brings between the transmitter and the receiver.
  std::optional<PathContribution> solve(const Sequence& sequence) {
    std::optional<Path> path = solver.solve(from(), of.end, sequence);
    if (!path) return std::nullopt;
    return of.field.evaluate(std::move(*path), of.transmitters.radio_of(transmitter), of.radio);
  }

  const Following& of;
  detail::LinkMemory& memory;
  std::size_t transmitter;  ///< among those of `of`
  bool rests;               ///< both ends are where they were
  PathSolver<Index> solver;
  WayFinder<Index> ways;
  SearchCounters counters{};
  CacheCounters cache{};
  WorkCounters work{};
};

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::follow_all(
    const TransmitterEnds& transmitters) {
  const std::span<const Device> receivers = scene_.receivers();
  const bool takes_all = choice_.takes_all();
  const LinkListsOfAll all = takes_all ? all_links(receivers, transmitters) : LinkListsOfAll{};
  const LinkListsOfAll& lists = takes_all ? all : chosen_;
  detail::FrameLinks links(lists, std::move(room_), *pool_);
  std::vector<Spent> spent(pool_->size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  const std::vector<std::size_t> order = detail::busiest_first(lists);
  pool_->for_each(receivers.size(), [&](std::size_t place, unsigned worker) {
    const std::size_t index = order[place];
    ReceiverRoom* const room = rooms.empty() ? nullptr : &rooms[worker];
    const Device& receiver = receivers[index];
    spent[worker] += takes_all
                         ? follow_receiver(receiver, index, transmitters, room, links.of(index))
                         : follow_receiver(receiver, index, transmitters.only(chosen_[index]), room, links.of(index));
  });
  return detail::sum_up(std::move(links), spent, transmitters.work);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Spent BasicSimulator<Surface, Index>::follow_receiver(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room,
    const LinkSlots& links) {
  detail::ReceiverMemory& memory = receivers_[index];
  const DeviceState state = state_of(receiver);
  Spent spent;
  if (!state.present) {
    spent.cache.died += detail::path_count(memory.links);
    memory.forget();
    return spent;
  }
  TraversalCounters traversal;
  const LinkEnd end = link_end(state, traversal);
  if (memory.end && memory.end->ignored_body != end.ignored_body) {
    spent.cache.died += detail::path_count(memory.links);
    memory.links.clear();
  }
  const bool is_kept = is_remembered_[index] != 0;
  if (!is_kept) memory.forget_views();
  const bool stands = detail::same_bits(memory.end, end), is_same = detail::same_bits(memory.state, state);
  memory.end = end;
  memory.state = state;
  spent.cache.died += memory.select(transmitters.numbers, transmitters.link.size());
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
  if (plan_.joined == 0 && !all_stay) {
    spent += solve_again(receiver, index, transmitters, room, links);
    return spent;
  }
  std::vector<LinkToFollow> to_follow;
  std::size_t count = 0;
  for (std::size_t transmitter = 0; transmitter < ends.size(); ++transmitter) {
    detail::LinkMemory& link = memory.links[transmitter];
    if (!ends[transmitter]) {
      spent.cache.died += link.path_count();
      link.forget();
      continue;
    }
    const std::size_t number = transmitters.number(transmitter);
    const bool rests = is_kept && stands && link.result && transmitter_rests_[number] != 0;
    if (transmitter_rests_[number] == 0) link.pooled.reset();
    if (stays(transmitter)) {
      spent.cache.taken_over += link.result->paths.size();
      DCEM_ASSERT(count < links.size());
      links[count++] = *link.result;
    } else {
      to_follow.push_back({transmitter, count, rests, rests && is_same && transmitter_is_same_[number] != 0});
      DCEM_ASSERT(count < links.size());
      links[count++].receiver = index;
    }
  }
  DCEM_ASSERT(count == links.size());
  if (!to_follow.empty()) {
    Following following(*this, transmitters, receiver, end, radio);
    if (is_kept) {
      look_from_receiver(following, memory, *room, stands);
    } else {
      look_anew(following, *room);
    }
    following.surfaces = surfaces_seen_from(receiver, end, transmitters, room);
    SearchCounters counters;
    counters.solver.traversal += traversal;
    detail::add_search_work(counters, spent.work);
    spent += follow_links(following, memory, to_follow, links);
  } else if (change_->any_moved()) {
    memory.half.forget_bodies();
  }
  for (std::size_t link = 0; link < count; ++link) spent.work.paths += links[link].paths.size();
#if !defined(NDEBUG)
  check_some(receiver, index, transmitters, room, links);
#endif
  return spent;
}

/// Solves links of a receiver, from what is known of each; threads that have nothing else to do help.
template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Spent BasicSimulator<Surface, Index>::follow_links(
    const Following& following, detail::ReceiverMemory& memory, std::span<const LinkToFollow> wanted,
    const LinkSlots& links) const {
  // What the links share is only read from here on.
  if (following.half == &memory.half.half() && std::any_of(wanted.begin(), wanted.end(), [&](const LinkToFollow& link) {
        return joins_anew(following, memory, link);
      })) {
    memory.half.lay_out_images(scene_, *outlines_);
  }
  std::vector<Spent> by_link(wanted.size());
  pool_->for_each(wanted.size(), [&](std::size_t number, unsigned) {
    const LinkToFollow& one = wanted[number];
    FollowedLink link(following, memory.links[one.transmitter], one.transmitter, one.rests);
    LinkResult& result = links[one.place];
    const std::size_t receiver = result.receiver;
    result = follow_link(link, memory.half, one.fields_stay);
    result.receiver = receiver;
    link.memory.count_births(result, link.cache);
    link.memory.keep(result);
    link.counters.solver += link.solver.counters();
    detail::add_search_work(link.counters, link.work);
    by_link[number] = {link.work, link.cache};
  });
  Spent spent;
  for (const Spent& one : by_link) spent += one;
  return spent;
}

/// One link, from what is known of it.
template <SurfaceModel Surface, SpatialIndex Index>
LinkResult BasicSimulator<Surface, Index>::follow_link(FollowedLink& link, const KeptHalf& half,
                                                       bool fields_stay) const {
  const TransmitterEnds& transmitters = link.of.transmitters;
  std::vector<PathContribution> paths = link.rests && link.memory.standing.is_known()
                                            ? paths_of_standing(link, fields_stay)
                                            : paths_of_moving(link, half);
  const DeviceEnd to{link.of.end, link.of.radio};
  DiffusePower diffuse =
      diffuse_power(link.of.receiver, to, link.of.surfaces.get(), transmitters, link.transmitter, link.work);
  LinkResult result = finish_link(std::move(paths), std::move(diffuse), transmitters.number(link.transmitter),
                                  {link.from(), transmitters.radio_of(link.transmitter)}, to, link.of.field);
  result.complete = true;
  return result;
}

/// One in a hundred pairs of link and frame, chosen at random, is solved from scratch: in builds that are not for use.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::check_some(const Device& receiver, std::size_t index,
                                                const TransmitterEnds& transmitters, ReceiverRoom* room,
                                                const LinkSlots& links) const {
  const auto is_chosen = [&](const LinkResult& link) {
    return hash_values(frame_.index, index, link.transmitter) % 100 == 0;
  };
  bool any = false;
  for (std::size_t link = 0; link < links.size(); ++link) any = any || is_chosen(links[link]);
  if (!any) return;
  const Solved expected = solve_alone(receiver, index, transmitters, {room});
  for (std::size_t link = 0; link < links.size(); ++link) {
    DCEM_ASSERT(!is_chosen(links[link]) || detail::same_bits(links[link], expected.links[link]));
  }
}

/// Whether links are direct paths and nothing else, and so many that to remember them costs more than to solve them.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::has_plain_links() const {
  const PropagationSettings& propagation = settings_.propagation;
  return interaction_order(propagation) == 0 && !propagation.diffuse.enabled &&
         propagation.antenna_array != ArrayChannel::exact &&
         scene_.transmitters().size() >= detail::very_many_transmitters;
}

/// All links of a receiver from scratch, where sequences are not joined from halves. Of direct paths alone, where links
/// are very many, no more is remembered than which there are as long as bodies change: memory costs more than they do.
template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Spent BasicSimulator<Surface, Index>::solve_again(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room,
    const LinkSlots& links) {
  Spent spent = solve_receiver(receiver, index, transmitters, nullptr, {room}, links);
  std::vector<detail::LinkMemory>& known = receivers_[index].links;
  const bool keeps_paths_alone = change_->any() && has_plain_links();
  std::size_t found = 0;
  for (std::size_t transmitter = 0; transmitter < known.size(); ++transmitter) {
    detail::LinkMemory& memory = known[transmitter];
    if (found == links.size() || links[found].transmitter != transmitters.number(transmitter)) {
      spent.cache.died += memory.path_count();
      memory.forget();
      continue;
    }
    const LinkResult& link = links[found++];
    memory.count_births(link, spent.cache);
    keeps_paths_alone ? memory.keep_paths(link) : memory.keep(link);
  }
  DCEM_ASSERT(found == links.size());
  return spent;
}

}  // namespace dcem
