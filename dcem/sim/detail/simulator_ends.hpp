#pragma once
/// What the transmitters of a `BasicSimulator` reach in a frame; included by basic_simulator.hpp.
#include <algorithm>
#include <memory>
#include <utility>

#include "dcem/paths/visible/surface_view.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/device_numbers.hpp"
#include "dcem/sim/detail/link_work.hpp"

namespace dcem {

template <SurfaceModel Surface, SpatialIndex Index>
typename BasicSimulator<Surface, Index>::TransmitterEnds BasicSimulator<Surface, Index>::transmitter_ends(
    std::span<const Device> devices, std::size_t receivers, std::span<EdgeReach> reach, std::span<KeptHalf> halves,
    SceneContacts contacts, bool fine) const {
  TransmitterEnds ends;
  ends.devices = devices;
  const bool are_of_scene = devices.data() == scene_.transmitters().data();
  ends.by_id = are_of_scene ? numbers_ : std::make_shared<const detail::DeviceNumbers>(detail::numbers_by_id(devices));
  ends.contacts = std::move(contacts);
  ends.link.resize(devices.size());
  ends.radio.resize(devices.size());
  pool_->for_each_quick(devices.size(), [&](std::size_t index) {
    const DeviceState state = state_of(devices[index]);
    TraversalCounters counters;
    if (state.present) ends.link[index] = link_end(state, counters);
    ends.radio[index].emplace(detail::radio_end(devices[index], state));
  });
  ends.reached.resize(ends.link.size());
  const PathSearchSettings search = search_settings(ends.contacts.known());
  if (search.max_diffractions > 0 && (search.exhaustive || needs_rays(search))) find_transmitter_reach(ends, reach);
  if (plan_.joined > 0 && search.max_interactions > 0) find_transmitter_halves(ends, receivers, halves, fine);
  if (settings_.propagation.diffuse.enabled) look_at_surfaces(ends);
  return ends;
}

/// The transmitters without the device that the receiver itself is: a device has no link to itself.
template <SurfaceModel Surface, SpatialIndex Index>
std::span<const std::optional<LinkEnd>> BasicSimulator<Surface, Index>::ends_beside(
    const Device& receiver, const TransmitterEnds& transmitters, std::vector<std::optional<LinkEnd>>& others) const {
  if (transmitters.by_id == nullptr) return transmitters.link;  // the choice has left it out
  const auto same = transmitters.by_id->find(receiver.id);
  if (same == transmitters.by_id->end()) return transmitters.link;
  others = transmitters.link;
  others[same->second].reset();
  return others;
}

/// As `surfaces_seen_from` does for receivers, so that a link has the same bits in a run and on a map.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::look_at_surfaces(TransmitterEnds& ends) const {
  ends.limits = std::make_shared<const ScatteringLimits>(scattering_limits(surface_, scene_.materials().size()));
  ends.surfaces.resize(ends.link.size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(ends.link.size(), [&](std::size_t index, unsigned worker) {
    if (!ends.link[index]) return;
    ends.surfaces[index] = std::make_shared<LitSurfaces>();
    ends.surfaces[index]->view = dcem::look_at_surfaces(rooms[worker].sight, scene_, *outlines_, *ends.link[index],
                                                        settings_.propagation.max_transmissions);
  });
}

template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::find_transmitter_halves(TransmitterEnds& ends, std::size_t receivers,
                                                             std::span<KeptHalf> halves, bool fine) const {
  const PathSearchSettings search = search_settings(ends.contacts.known());
  const bool triples = joins_triples(search);
  const auto serves = [&](const KeptHalf& half) { return !triples || half.lists() != nullptr; };
  const bool are_kept = ends.devices.data() == scene_.transmitters().data();
  if (halves.empty() && !fine && are_kept && halves_are_current_ &&
      std::all_of(halves_.begin(), halves_.end(), serves)) {
    ends.halves = HalfRefs(halves_);
    return;
  }
  if (halves.empty()) {
    const std::size_t count = ends.link.size();
    const int most = fine ? detail::fine_view_pixels_for(count) : detail::view_pixels_for(count);
    ends.own_halves = kept_halves(count, detail::pixels_for_facets(most, outlines_->size()));
    halves = ends.own_halves;
  }
  const bool over_mirrors = search.max_reflections >= 1 && search.max_interactions >= 2;
  HalfLists of_all{fine || over_mirrors ? lanes_.get() : nullptr, over_mirrors,
                   fine || (triples && (receivers > 0 || change_)), receivers, pool_.get()};
  of_all.for_triples = triples;
  const bool are_followed = halves.data() == halves_.data();
  if (are_followed) of_all.pace = pace_;  // others are asked for once
  const bool has_choice = !choice_.takes_all() && are_followed;
  const auto update = [&](std::size_t index, unsigned) {
    HalfLists lists = of_all;
    if (has_choice) lists.receivers = std::min(receivers, links_of_[index]);
    if (!ends.link[index]) return halves[index].forget();
    if (has_choice && links_of_[index] == 0) return halves[index].forget_bodies();
    halves[index].update(scene_, *outlines_, *ends.link[index], half_settings(search), lists,
                         change_ && are_followed ? change_->moved() : std::span<const char>{});
  };
  pool_->for_each(ends.link.size(), update);  // of a few, all threads share the lists
  ends.halves = HalfRefs(halves);
}

template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::find_transmitter_reach(TransmitterEnds& ends, std::span<EdgeReach> reach) const {
  const Tracer tracer(scene_, index_);
  const PathSearchSettings search = search_settings(ends.contacts.known());
  if (reach.empty()) {
    ends.own_reach.resize(ends.link.size());
    reach = ends.own_reach;
  }
  std::vector<SearchCounters> spent(ends.link.size());
  pool_->for_each(ends.link.size(), [&](std::size_t index, unsigned) {
    if (!ends.link[index]) return reach[index].clear();
    const bool known = reach[index].size() > 0;
    reach[index].next_frame(detail::proposal_lifetime_frames(search));
    find_reach(tracer, search, *ends.link[index], {ends.device(index).id, frame_.index},
               known ? search.rays_steady : search.rays, reach[index], spent[index]);
    ends.reached[index] = reach[index].edges();
  });
  for (const SearchCounters& one : spent) detail::add_search_work(one, ends.work);
}

}  // namespace dcem
