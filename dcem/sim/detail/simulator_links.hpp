#pragma once
/// How a `BasicSimulator` solves the links of a frame; included by basic_simulator.hpp.
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "dcem/channel/link_statistics.hpp"
#include "dcem/field/diffuse/diffuse_power.hpp"
#include "dcem/field/element_paths.hpp"
#include "dcem/paths/discover/chain_count.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/frame_links.hpp"
#include "dcem/sim/detail/link_work.hpp"

namespace dcem {

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<LinkResult> BasicSimulator<Surface, Index>::solve(std::span<const Device> receivers,
                                                              WorkCounters* work) const {
  Solved solved = solve_all(receivers, transmitter_ends(scene_.transmitters(), receivers.size()), {}, false);
  if (work != nullptr) *work += solved.spent.work;
  return std::move(solved.links);
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<LinkResult> BasicSimulator<Surface, Index>::solve(std::span<const Device> transmitters,
                                                              std::span<const Device> receivers,
                                                              std::span<const LinkRequest> requests,
                                                              WorkCounters* work) const {
  std::vector<std::vector<std::uint32_t>> wanted =
      detail::requested_links(requests, transmitters.size(), receivers.size());
  const TransmitterEnds ends = transmitter_ends(transmitters, receivers.size());
  pool_->for_each_quick(receivers.size(), [&](std::size_t index) {
    std::vector<std::uint32_t>& of_one = wanted[index];
    const bool is_there = state_of(receivers[index]).present;
    std::erase_if(of_one, [&](std::uint32_t transmitter) { return !is_there || !ends.link[transmitter]; });
    detail::sort_and_drop_repeated(of_one);
  });
  detail::FrameLinks links(wanted, {}, *pool_);
  std::vector<Spent> spent(pool_->size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(receivers.size(), [&](std::size_t index, unsigned worker) {
    spent[worker] += solve_receiver(receivers[index], index, ends.only(wanted[index]), nullptr,
                                    {rooms.empty() ? nullptr : &rooms[worker]}, links.of(index));
  });
  Solved solved = detail::sum_up(std::move(links), spent, ends.work);
  if (work != nullptr) *work += solved.spent.work;
  return std::move(solved.links);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::LinkListsOfAll BasicSimulator<Surface, Index>::all_links(
    std::span<const Device> receivers, const TransmitterEnds& transmitters) const {
  LinkListsOfAll lists(receivers.size());
  pool_->for_each_quick(receivers.size(), [&](std::size_t index) {
    if (!state_of(receivers[index]).present) return;
    std::vector<std::optional<LinkEnd>> others;
    const std::span<const std::optional<LinkEnd>> ends = ends_beside(receivers[index], transmitters, others);
    for (std::size_t transmitter = 0; transmitter < ends.size(); ++transmitter) {
      if (ends[transmitter]) lists[index].push_back(static_cast<std::uint32_t>(transmitter));
    }
  });
  return lists;
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::solve_all(
    std::span<const Device> receivers, const TransmitterEnds& transmitters, std::span<PathCache> caches,
    bool is_of_frame) const {
  const bool takes_all = !is_of_frame || choice_.takes_all();
  const LinkListsOfAll all = takes_all ? all_links(receivers, transmitters) : LinkListsOfAll{};
  detail::FrameLinks links(takes_all ? all : chosen_, {}, *pool_);
  std::vector<Spent> spent(pool_->size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(receivers.size(), [&](std::size_t index, unsigned worker) {
    PathCache* cache = caches.empty() ? nullptr : &caches[index];
    const Proposals proposals{rooms.empty() ? nullptr : &rooms[worker]};
    const LinkSlots slots = links.of(index);
    if (takes_all) {
      spent[worker] += solve_receiver(receivers[index], index, transmitters, cache, proposals, slots);
      return;
    }
    if (cache != nullptr) spent[worker].cache.died += cache->select(chosen_[index]);
    spent[worker] +=
        solve_receiver(receivers[index], index, transmitters.only(chosen_[index]), cache, proposals, slots);
  });
  return detail::sum_up(std::move(links), spent, transmitters.work);
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Solved BasicSimulator<Surface, Index>::solve_alone(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, const Proposals& proposals) const {
  std::vector<std::optional<LinkEnd>> others;
  const std::span<const std::optional<LinkEnd>> ends = ends_beside(receiver, transmitters, others);
  const auto is_there = [](const std::optional<LinkEnd>& end) { return end.has_value(); };
  Solved solved;
  if (state_of(receiver).present) {
    solved.links.resize(static_cast<std::size_t>(std::count_if(ends.begin(), ends.end(), is_there)));
  }
  solved.spent = solve_receiver(receiver, index, transmitters, nullptr, proposals, LinkSlots(solved.links));
  return solved;
}

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::Spent BasicSimulator<Surface, Index>::solve_receiver(
    const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, PathCache* cache,
    const Proposals& proposals, const LinkSlots& links) const {
  const DeviceState state = state_of(receiver);
  Spent spent;
  if (!state.present) {
    if (cache != nullptr) spent.cache.died = cache->clear();
    return spent;
  }
  if (transmitters.link.empty()) return spent;
  SearchCounters counters;
  const LinkEnd end = link_end(state, counters.solver.traversal);
  const ReceiverSearch search(*this, receiver, end, transmitters, proposals);
  // Rays, and all sequences there are, are tried on all links in one go; sequences of halves link by link.
  const bool samples = needs_rays(search.search), goes_apart = plan_.joined > 0 && !samples && cache == nullptr;
  std::vector<LinkPaths> found;
  if (!goes_apart) found = search.find_together(cache, counters);
  const Evaluator field = evaluator();
  const RadioEnd to = detail::radio_end(receiver, state);
  const std::shared_ptr<const SurfaceView> view = surfaces_seen_from(receiver, end, transmitters, proposals.room);
  std::vector<std::size_t> present;
  for (std::size_t transmitter = 0; transmitter < search.transmitter_ends.size(); ++transmitter) {
    if (search.transmitter_ends[transmitter]) present.push_back(transmitter);
  }
  DCEM_ASSERT(links.size() == present.size());
  std::vector<WorkCounters> of_link(present.size());
  const auto solve_link = [&](std::size_t place, unsigned) {
    const std::size_t transmitter = present[place];
    WorkCounters& work = of_link[place];
    LinkPaths paths = goes_apart ? search.find_apart(transmitter, work) : std::move(found[transmitter]);
    DiffusePower diffuse = diffuse_power(receiver, {end, to}, view.get(), transmitters, transmitter, work);
    LinkResult& link = links[place];
    link = make_link(std::move(paths), std::move(diffuse), transmitters.number(transmitter),
                     {*search.transmitter_ends[transmitter], transmitters.radio_of(transmitter)}, {end, to}, field,
                     std::move(link.paths));
    link.receiver = index;
    link.complete = !samples || search.search.max_interactions == 0;
    work.paths += link.paths.size();
  };
  if (goes_apart || settings_.propagation.diffuse.enabled) {
    pool_->for_each(present.size(), solve_link);  // threads that have nothing else to do help
  } else {
    for (std::size_t place = 0; place < present.size(); ++place) {
      links.fetch_after(place);
      solve_link(place, 0);  // 2 µs each
    }
  }
  for (const WorkCounters& one : of_link) spent.work += one;
  detail::add_search_work(counters, spent.work);
  spent.cache = counters.cache;
  return spent;
}

template <SurfaceModel Surface, SpatialIndex Index>
std::shared_ptr<const SurfaceView> BasicSimulator<Surface, Index>::surfaces_seen_from(
    const Device& receiver, const LinkEnd& end, const TransmitterEnds& transmitters, ReceiverRoom* room) const {
  if (!settings_.propagation.diffuse.enabled) return nullptr;
  if (std::shared_ptr<const SurfaceView> known = transmitters.view_of(receiver.id, end)) return known;
  return std::make_shared<const SurfaceView>(
      dcem::look_at_surfaces(room->sight, scene_, *outlines_, end, settings_.propagation.max_transmissions));
}

template <SurfaceModel Surface, SpatialIndex Index>
DiffusePower BasicSimulator<Surface, Index>::diffuse_power(const Device& receiver, const DeviceEnd& end,
                                                           const SurfaceView* view, const TransmitterEnds& transmitters,
                                                           std::size_t transmitter, WorkCounters& work) const {
  const PropagationSettings& propagation = settings_.propagation;
  if (view == nullptr) return {};
  const Tracer tracer(scene_, index_);
  const ScatteredPower<Surface, AnyPathLoss> scattered(scene_, surface_, propagation.path_loss, medium_,
                                                       settings_.frequency_hz, transmitters.limits);
  DiffuseIntegral<Index, Surface, AnyPathLoss> integral(tracer, scattered, propagation.diffuse,
                                                        propagation.max_transmissions);
  const DiffuseKey key{propagation.seed, transmitters.device(transmitter).id, receiver.id};
  DiffusePower power = integral.evaluate(
      {*transmitters.link[transmitter], transmitters.radio_of(transmitter), *transmitters.surfaces[transmitter]},
      {end.link, end.radio, *view}, key);
  detail::add_diffuse_work(power, work);
  return power;
}

template <SurfaceModel Surface, SpatialIndex Index>
LinkResult BasicSimulator<Surface, Index>::make_link(LinkPaths&& found, DiffusePower&& diffuse, std::size_t transmitter,
                                                     const DeviceEnd& from, const DeviceEnd& to,
                                                     const Evaluator& evaluator,
                                                     std::vector<PathContribution>&& room) const {
  std::vector<PathContribution> paths = std::move(room);
  paths.clear();
  for (Path& path : found.paths) paths.push_back(evaluator.evaluate(std::move(path), from.radio, to.radio));
  return finish_link(std::move(paths), std::move(diffuse), transmitter, from, to, evaluator);
}

template <SurfaceModel Surface, SpatialIndex Index>
LinkResult BasicSimulator<Surface, Index>::finish_link(std::vector<PathContribution>&& paths, DiffusePower&& diffuse,
                                                       std::size_t transmitter, const DeviceEnd& from,
                                                       const DeviceEnd& to, const Evaluator& evaluator) const {
  const PropagationSettings& propagation = settings_.propagation;
  const double longest_m = propagation.max_path_length_m.value_or(std::numeric_limits<double>::infinity());
  bool line_of_sight = false;
  const auto is_told = [&](const PathContribution& path) {
    const bool is_direct = path.path.interactions.empty();
    if (is_direct) line_of_sight = path.path.foliage.empty();  // in foliage the segment is not free, though it is open
    if (is_direct && !propagation.line_of_sight) return false;
    if (path.path.length_m > longest_m) return false;
    return !propagation.min_path_gain_db || power_ratio_to_db(path.power_ratio) >= *propagation.min_path_gain_db;
  };
  LinkResult link;
  link.transmitter = transmitter;
  link.diffuse = std::move(diffuse);
  if (paths.size() <= 1) {  // the direct path alone, of most links of a fleet
    if (!paths.empty() && !is_told(paths.front())) paths.clear();
    link.paths = std::move(paths);
  } else {
    for (PathContribution* const path : detail::in_order(paths)) {
      if (is_told(*path)) link.paths.push_back(std::move(*path));
    }
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
