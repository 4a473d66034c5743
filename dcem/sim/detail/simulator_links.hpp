#pragma once
/// How a `BasicSimulator` solves the links of a frame; included by basic_simulator.hpp.
#include <algorithm>
#include <array>
#include <utility>

#include "dcem/paths/discover/chain_count.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/link_work.hpp"

namespace dcem {

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<LinkResult> BasicSimulator<Surface, Index>::solve(std::span<const Device> receivers,
                                                              WorkCounters* work) const {
  Solved solved = solve_all(receivers, transmitter_ends(scene_.transmitters(), receivers.size()), {}, false);
  if (work != nullptr) *work += solved.work;
  return std::move(solved.links);
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<LinkResult> BasicSimulator<Surface, Index>::solve(std::span<const Device> transmitters,
                                                              std::span<const Device> receivers,
                                                              std::span<const LinkRequest> requests,
                                                              WorkCounters* work) const {
  std::vector<std::vector<std::uint32_t>> wanted(receivers.size());
  for (const auto& [transmitter, receiver] : requests) {
    if (transmitter >= transmitters.size() || receiver >= receivers.size()) {
      throw std::invalid_argument("solve: a link between devices that are not there");
    }
    wanted[receiver].push_back(static_cast<std::uint32_t>(transmitter));
  }
  const TransmitterEnds ends = transmitter_ends(transmitters, receivers.size());
  std::vector<Solved> by_receiver(receivers.size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(receivers.size(), [&](std::size_t index, unsigned worker) {
    std::vector<std::uint32_t>& of_one = wanted[index];
    std::sort(of_one.begin(), of_one.end());
    of_one.erase(std::unique(of_one.begin(), of_one.end()), of_one.end());
    by_receiver[index] = solve_receiver(receivers[index], index, ends.only(std::move(of_one)), nullptr,
                                        {rooms.empty() ? nullptr : &rooms[worker]});
  });
  Solved solved = sum_of(std::move(by_receiver), ends);
  if (work != nullptr) *work += solved.work;
  return std::move(solved.links);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::solve_all(
    std::span<const Device> receivers, const TransmitterEnds& transmitters, std::span<PathCache> caches,
    bool is_of_frame) const {
  const bool takes_all = !is_of_frame || choice_.takes_all();
  std::vector<Solved> by_receiver(receivers.size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(receivers.size(), [&](std::size_t index, unsigned worker) {
    PathCache* cache = caches.empty() ? nullptr : &caches[index];
    const Proposals proposals{rooms.empty() ? nullptr : &rooms[worker]};
    if (takes_all) {
      by_receiver[index] = solve_receiver(receivers[index], index, transmitters, cache, proposals);
      return;
    }
    const std::size_t gone = cache != nullptr ? cache->select(chosen_[index]) : 0;
    by_receiver[index] = solve_receiver(receivers[index], index, transmitters.only(chosen_[index]), cache, proposals);
    by_receiver[index].cache.died += gone;
  });
  return sum_of(std::move(by_receiver), transmitters);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::sum_of(
    std::vector<Solved>&& by_receiver, const TransmitterEnds& transmitters) {
  Solved sum;
  sum.work = transmitters.work;
  for (Solved& one : by_receiver) {
    for (LinkResult& link : one.links) sum.links.push_back(std::move(link));
    sum.work += one.work;
    sum.cache += one.cache;
  }
  std::stable_sort(sum.links.begin(), sum.links.end(),
                   [](const LinkResult& a, const LinkResult& b) { return a.transmitter < b.transmitter; });
  return sum;
}

/// The transmitters without the device that the receiver itself is: a device has no link to itself.
template <SurfaceModel Surface, SpatialIndex Index>
std::span<const std::optional<LinkEnd>> BasicSimulator<Surface, Index>::ends_beside(
    const Device& receiver, const TransmitterEnds& transmitters, std::vector<std::optional<LinkEnd>>& others) const {
  if (!transmitters.numbers.empty()) return transmitters.link;  // the choice has left it out
  const std::span<const Device> devices = scene_.transmitters();
  const auto is_receiver = [&](const Device& device) { return device.id == receiver.id; };
  const auto same = std::find_if(devices.begin(), devices.end(), is_receiver);
  if (same == devices.end() || transmitters.link.empty()) return transmitters.link;
  others = transmitters.link;
  others[static_cast<std::size_t>(same - devices.begin())].reset();
  return others;
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::solve_receiver(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, PathCache* cache,
    const Proposals& proposals) const {
  const Tracer tracer(scene_, index_);
  const DeviceState state = state_of(receiver);
  Solved solved;
  if (!state.present) {
    if (cache != nullptr) solved.cache.died = cache->clear();
    return solved;
  }
  if (transmitters.link.empty()) return solved;
  SearchCounters counters;
  const LinkEnd end = link_end(state, counters.solver.traversal);
  const PathSearchSettings search = search_settings(transmitters.embedded);
  std::vector<std::optional<LinkEnd>> others;
  const std::span<const std::optional<LinkEnd>> ends = ends_beside(receiver, transmitters, others);
  std::span<const SequenceList> joined = proposals.joined;
  std::vector<SequenceList> own;
  if (plan_.joined > 0 && joined.empty()) {
    ReceiverRoom& room = *proposals.room;
    const KeptHalf* const known = transmitters.half_of(receiver.id, end, joins_triples(search));
    if (known == nullptr) look_from(scene_, search, *outlines_, *lanes_, end, room);
    own = join_halves(scene_, search,
                      {*outlines_, *lanes_, transmitters.halves, known ? known->half() : room.half,
                       known && known->lists() ? *known->lists() : room.lists},
                      ends);
    joined = own;
  }
  std::vector<LinkPaths> found =
      find_paths(tracer, search, end, {receiver.id, frame_.index}, ends, counters, cache, transmitters.reached, joined);
  const Evaluator field = evaluator();
  const RadioEnd to = detail::radio_end(receiver, state);
  std::vector<DiffusePower> diffuse =
      diffuse_powers(receiver, {end, to}, transmitters, ends, proposals.room, solved.work);
  for (std::size_t transmitter = 0; transmitter < found.size(); ++transmitter) {
    if (!ends[transmitter]) continue;
    LinkResult& link = solved.links.emplace_back(
        make_link(std::move(found[transmitter]), std::move(diffuse[transmitter]), transmitters.number(transmitter),
                  {*ends[transmitter], transmitters.radio[transmitter]}, {end, to}, field));
    link.receiver = index;
    link.complete = !needs_rays(search) || search.max_interactions == 0;
    solved.work.paths += link.paths.size();
  }
  detail::add_search_work(counters, solved.work);
  solved.cache = counters.cache;
  return solved;
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<DiffusePower> BasicSimulator<Surface, Index>::diffuse_powers(const Device& receiver, const DeviceEnd& end,
                                                                         const TransmitterEnds& transmitters,
                                                                         std::span<const std::optional<LinkEnd>> ends,
                                                                         ReceiverRoom* room, WorkCounters& work) const {
  std::vector<DiffusePower> powers(ends.size());
  const PropagationSettings& propagation = settings_.propagation;
  if (!propagation.diffuse.enabled) return powers;
  const Tracer tracer(scene_, index_);
  const ScatteredPower<Surface, AnyPathLoss> scattered(scene_, surface_, propagation.path_loss, medium_,
                                                       settings_.frequency_hz);
  DiffuseIntegral<Index, Surface, AnyPathLoss> integral(tracer, scattered, propagation.diffuse,
                                                        propagation.max_transmissions);
  const std::vector<FacetId> own =
      facets_in_view(room->sight, scene_, *outlines_, end.link, propagation.max_transmissions);
  for (std::size_t index = 0; index < ends.size(); ++index) {
    if (!ends[index]) continue;
    const DiffuseKey key{propagation.seed, transmitters.device(index).id, receiver.id};
    powers[index] = integral.evaluate(*ends[index], transmitters.radio[index], end.link, end.radio,
                                      in_both(own, transmitters.in_view[index]), key);
    detail::add_diffuse_work(powers[index], work);
  }
  return powers;
}

template <SurfaceModel Surface, SpatialIndex Index>
LinkResult BasicSimulator<Surface, Index>::make_link(LinkPaths&& found, DiffusePower&& diffuse, std::size_t transmitter,
                                                     const DeviceEnd& from, const DeviceEnd& to,
                                                     const Evaluator& evaluator) const {
  std::vector<PathContribution> paths;
  for (Path& path : found.paths) paths.push_back(evaluator.evaluate(std::move(path), from.radio, to.radio));
  return finish_link(std::move(paths), std::move(diffuse), transmitter, from, to, evaluator);
}

template <SurfaceModel Surface, SpatialIndex Index>
LinkResult BasicSimulator<Surface, Index>::finish_link(std::vector<PathContribution>&& paths, DiffusePower&& diffuse,
                                                       std::size_t transmitter, const DeviceEnd& from,
                                                       const DeviceEnd& to, const Evaluator& evaluator) const {
  std::vector<PathContribution*> order;
  for (PathContribution& path : paths) order.push_back(&path);
  std::sort(order.begin(), order.end(), [](const PathContribution* one, const PathContribution* other) {
    return reported_before(one->path, other->path);
  });
  // The same sequence gives the same bits, so repeated paths stand side by side.
  const auto same = [](const PathContribution* one, const PathContribution* other) {
    return same_sequence(one->path, other->path);
  };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  const PropagationSettings& propagation = settings_.propagation;
  LinkResult link;
  link.transmitter = transmitter;
  link.diffuse = std::move(diffuse);
  bool line_of_sight = false;
  for (PathContribution* const path : order) {
    const bool is_direct = path->path.interactions.empty();
    if (is_direct) line_of_sight = path->path.foliage.empty();  // in foliage the segment is not free, though it is open
    if (is_direct && !propagation.line_of_sight) continue;
    const bool too_weak =
        propagation.min_path_gain_db && !(power_ratio_to_db(path->power_ratio) >= *propagation.min_path_gain_db);
    if (!too_weak) link.paths.push_back(std::move(*path));
  }
  trace_elements(link.paths, from, to, evaluator);
  link.statistics = link_statistics(link.paths, from.radio.power_dbm, line_of_sight, link.diffuse);
  return link;
}

template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::trace_elements(std::span<PathContribution> paths, const DeviceEnd& from,
                                                    const DeviceEnd& to, const Evaluator& evaluator) const {
  if (settings_.propagation.antenna_array != ArrayChannel::exact || !has_array(from.radio, to.radio)) return;
  const Tracer tracer(scene_, index_);
  const PathSearchSettings search = search_settings();
  PathSolver<Index> solver(tracer, search.max_transmissions, search.edges);
  TraversalCounters counters;
  const double length_m = wavelength_m(settings_.frequency_hz);
  const ElementEnds from_elements = element_ends(tracer, from.link, from.radio, length_m, counters);
  const ElementEnds to_elements = element_ends(tracer, to.link, to.radio, length_m, counters);
  ElementPaths<Index, Surface, AnyPathLoss> elements(solver, evaluator, from_elements, to_elements);
  for (PathContribution& path : paths) path.channel = elements.channel(path.path);
}

template <SurfaceModel Surface, SpatialIndex Index>
std::optional<PathContribution> BasicSimulator<Surface, Index>::solve_path(std::size_t transmitter,
                                                                           std::size_t receiver,
                                                                           const Sequence& sequence) const {
  const Device& from = scene_.transmitters()[transmitter];
  const Device& to = scene_.receivers()[receiver];
  const DeviceState from_state = state_of(from), to_state = state_of(to);
  if (!from_state.present || !to_state.present) return std::nullopt;
  const Tracer tracer(scene_, index_);
  const PathSearchSettings search = search_settings();
  PathSolver<Index> solver(tracer, search.max_transmissions, search.edges);
  TraversalCounters counters;
  const LinkEnd from_link = link_end(from_state, counters), to_link = link_end(to_state, counters);
  const RadioEnd from_radio = detail::radio_end(from, from_state), to_radio = detail::radio_end(to, to_state);
  std::optional<Path> path = solver.solve(from_link, to_link, sequence);
  if (!path) return std::nullopt;
  const Evaluator field = evaluator();
  PathContribution contribution = field.evaluate(std::move(*path), from_radio, to_radio);
  trace_elements({&contribution, 1}, {from_link, from_radio}, {to_link, to_radio}, field);
  return contribution;
}

/// Both ends are looked from as a link looks from them; what they reach is counted instead of joined.
template <SurfaceModel Surface, SpatialIndex Index>
std::vector<double> BasicSimulator<Surface, Index>::estimated_chains(const Device& receiver) const {
  const PathSearchSettings search = search_settings();
  if (search.max_diffractions == 0 || !needs_rays(search) || scene_.transmitters().empty()) return {};
  const Device& transmitter = scene_.transmitters().front();
  if (!state_of(transmitter).present || !state_of(receiver).present) return {};
  const Tracer tracer(scene_, index_);
  std::array<EdgeReach, 2> reach;
  std::array<ReachedEdges, 2> reached;
  SearchCounters counters;
  const std::array<const Device*, 2> ends{&receiver, &transmitter};
  for (std::size_t end = 0; end < ends.size(); ++end) {
    const LinkEnd link = link_end(state_of(*ends[end]), counters.solver.traversal);
    find_reach(tracer, search, link, {ends[end]->id, frame_.index}, search.rays, reach[end], counters);
    reached[end] = reach[end].edges();
  }
  return count_chains(reached[0], reached[1], chain_limits(search));
}

}  // namespace dcem
