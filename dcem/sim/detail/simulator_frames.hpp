#pragma once
/// How a `BasicSimulator` moves to a frame; included by basic_simulator.hpp.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "dcem/paths/query/obstruction.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/link_work.hpp"
#include "dcem/sim/receiver_part.hpp"

namespace dcem {

namespace detail {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace detail

template <SurfaceModel Surface, SpatialIndex Index>
FrameResult BasicSimulator<Surface, Index>::advance(const Frame& frame) {
  FrameResult result{frame.index, frame.time_s, {}, {}, {}, {}, 0.0, 0.0};
  const detail::Stopwatch update_watch;
  const ChangeSet changes = scene_.apply(frame, pool_.get());
  if (change_) change_->note(frame_, frame);
  result.tree = update_index(changes);
  forget_replaced(changes, result.cache);
  frame_ = frame;
  result.update_time_s = update_watch.seconds();
  const detail::Stopwatch solve_watch;
  choose_links();
  const std::size_t walking = change_ && plan_.joined > 0 ? receivers_on_the_move() : scene_.receivers().size();
  pace_ = pace_of_lists(walking);
  const TransmitterEnds transmitters = transmitter_ends(scene_.transmitters(), walking, reach_, halves_);
  halves_are_current_ = !transmitters.halves.empty() && choice_.takes_all();
  if (change_) {
    note_transmitters(transmitters);
    choose_remembered(walking);
  }
  Solved solved = change_ ? follow_all(transmitters) : solve_all(scene_.receivers(), transmitters, caches_, true);
  result.links = std::move(solved.links);
  if (change_) note_places();
  if (finds_lifetimes()) find_lifetimes(result.links, transmitters);
  result.work = solved.spent.work;
  result.cache += solved.spent.cache;
  note_rays(result.work);
  ++frames_done_;
  result.solve_time_s = solve_watch.seconds();
  return result;
}

template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::choose_links() {
  if (choice_.takes_all()) return;
  const std::span<const Device> receivers = scene_.receivers();
  std::vector<std::optional<Vec3>> places_m(scene_.transmitters().size());
  pool_->for_each_quick(places_m.size(), [&](std::size_t index) {
    const DeviceState state = state_of(scene_.transmitters()[index]);
    if (state.present) places_m[index] = state.position_m;
  });
  choice_.place(places_m);
  chosen_.resize(receivers.size());
  std::vector<std::optional<Vec3>> receivers_m(receivers.size());
  pool_->for_each_quick(receivers.size(), [&](std::size_t index) {
    const DeviceState state = state_of(receivers[index]);
    chosen_[index].clear();
    if (!state.present) return;
    receivers_m[index] = state.position_m;
    chosen_[index] = choice_.transmitters_of(index, state.position_m);
  });
  if (settings_.links.receivers) keep_part(*settings_.links.receivers, settings_.links.range_m, receivers_m, chosen_);
  if (halves_.empty()) return;
  links_of_.assign(places_m.size(), 0);
  for (const std::vector<std::uint32_t>& of_one : chosen_) {
    for (const std::uint32_t transmitter : of_one) ++links_of_[transmitter];
  }
}

/// How many receivers are not where they were in the frame before.
template <SurfaceModel Surface, SpatialIndex Index>
std::size_t BasicSimulator<Surface, Index>::receivers_on_the_move() const {
  std::size_t count = 0;
  for (std::size_t index = 0; index < receivers_.size(); ++index) count += is_on_the_move(index) ? 1 : 0;
  return count;
}

template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::is_on_the_move(std::size_t receiver) const {
  const DeviceState state = state_of(scene_.receivers()[receiver]);
  const std::optional<LinkEnd>& before = receivers_[receiver].end;
  return state.present && (!before || before->position_m != state.position_m);
}

/// How much transmitters may list in this frame, of which so many receivers are not where they were: by what those in
/// places were spared in the frame before.
template <SurfaceModel Surface, SpatialIndex Index>
ListPace BasicSimulator<Surface, Index>::pace_of_lists(std::size_t walking) const {
  ListPace pace;
  if (settings_.expected_frames && frames_done_ < *settings_.expected_frames) {
    pace.frames_left = *settings_.expected_frames - frames_done_;
  }
  const auto is_listed = [](const KeptHalf& transmitter) { return transmitter.lists() != nullptr; };
  if (!change_ || walking == 0 || std::ranges::none_of(halves_, is_listed)) return pace;
  for (std::size_t index = 0; index < receivers_.size(); ++index) {
    const KeptHalf& half = receivers_[index].half;
    if (half.place() && is_on_the_move(index)) pace.spared += detail::spared_in_place(half.step_m());
  }
  pace.spared = std::min(1.0, pace.spared / static_cast<double>(walking));
  return pace;
}

/// Chooses the receivers of which it is remembered what they see: the first ones of those that are there; `walking` of
/// them are not where they were.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::choose_remembered(std::size_t walking) {
  const std::span<const Device> receivers = scene_.receivers();
  is_remembered_.assign(receivers.size(), 1);
  most_known_places_ = detail::known_places_per_receiver * walking;
  if (plan_.joined == 0 || std::isinf(settings_.most_remembered_bytes)) return;  // nobody looks, or all may
  const auto rests = [&](std::size_t transmitter) { return transmitter_rests_[transmitter] != 0; };
  const auto all_at_rest = std::count_if(transmitter_rests_.begin(), transmitter_rests_.end(), std::identity());
  const bool triples = joins_triples(search_settings({}));
  std::vector<double> bytes(receivers.size());
  pool_->for_each_quick(receivers.size(), [&](std::size_t index) {
    const DeviceState state = state_of(receivers[index]);
    if (!state.present) return;
    const std::optional<LinkEnd>& before = receivers_[index].end;
    const bool walks = before && before->position_m != state.position_m;
    const auto at_rest = choice_.takes_all() ? all_at_rest : std::ranges::count_if(chosen_[index], rests);
    bytes[index] = detail::remembered_receiver_bytes +
                   static_cast<double>(at_rest) *
                       (detail::remembered_link_bytes + (triples && walks ? detail::remembered_triples_bytes : 0.0));
  });
  double needed_bytes = 0.0;
  for (std::size_t index = 0; index < bytes.size(); ++index) {
    needed_bytes += bytes[index];
    is_remembered_[index] = needed_bytes <= settings_.most_remembered_bytes ? 1 : 0;
  }
  // Places that nobody is in take what is left: each of them less than a receiver that walks.
  const double left_bytes = std::max(0.0, settings_.most_remembered_bytes - needed_bytes);
  double of_one_bytes = detail::remembered_receiver_bytes;
  for (const double of_receiver_bytes : bytes) of_one_bytes = std::max(of_one_bytes, of_receiver_bytes);
  const double most_places = std::min(left_bytes / of_one_bytes, static_cast<double>(most_known_places_));
  most_known_places_ = static_cast<std::size_t>(most_places);
}

/// Notes which transmitters are as in the frame before.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::note_transmitters(const TransmitterEnds& ends) {
  const std::size_t count = ends.link.size();
  transmitters_before_.resize(count);
  transmitter_states_before_.resize(count);
  transmitter_rests_.assign(count, 0);
  transmitter_is_same_.assign(count, 0);
  pool_->for_each_quick(count, [&](std::size_t index) {
    const DeviceState state = state_of(scene_.transmitters()[index]);
    transmitter_rests_[index] = ends.link[index] && detail::same_bits(transmitters_before_[index], *ends.link[index]);
    transmitter_is_same_[index] =
        transmitter_rests_[index] != 0 && detail::same_bits(transmitter_states_before_[index], state);
    transmitters_before_[index] = ends.link[index];
    transmitter_states_before_[index] = state;
  });
  if (known_pools_.size() == 0) return;
  known_pools_.keep([&](const Place&, std::size_t transmitter) { return transmitter_rests_[transmitter] != 0; });
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<ShellAtPoint> BasicSimulator<Surface, Index>::shells_at(const Vec3& point_m) const {
  const Tracer tracer(scene_, index_);
  std::vector<ShellAtPoint> shells;
  for (const auto& [body, number] : shells_around(tracer, index_, point_m)) shells.push_back({body, number, false});
  TraversalCounters counters;
  for (const FacetId facet : tracer.facets_near(point_m, scene_.settings().weld_tolerance_m, {}, counters)) {
    const BodyId body = scene_.facet(facet).body;
    const std::uint32_t number = scene_.shell_of_triangle(scene_.facet(facet).first_triangle);
    if (number == 0) continue;
    std::erase(shells, ShellAtPoint{body, number, false});
    shells.push_back({body, number, true});
  }
  std::sort(shells.begin(), shells.end());
  shells.erase(std::unique(shells.begin(), shells.end()), shells.end());
  return shells;
}

template <SurfaceModel Surface, SpatialIndex Index>
TreeUpdateReport BasicSimulator<Surface, Index>::move_to(const Frame& frame) {
  const ChangeSet changes = scene_.apply(frame, pool_.get());
  CacheCounters not_reported;
  forget_replaced(changes, not_reported);
  frame_ = frame;
  for (detail::ReceiverMemory& receiver : receivers_) receiver.forget_frame();
  for (KeptHalf& half : halves_) half.forget_bodies();
  known_pools_.clear();
  *known_places_ = {};
  driven_ways_ = {};
  return update_index(changes);
}

template <SurfaceModel Surface, SpatialIndex Index>
TreeUpdateReport BasicSimulator<Surface, Index>::pass(const Frame& frame, const WorkCounters& spent) {
  if (cache_ == CacheMode::seed) throw std::logic_error("pass: the cache remembers what only advance() finds");
  const TreeUpdateReport report = move_to(frame);
  TraversalCounters not_reported;
  for (std::size_t index = 0; index < halves_.size(); ++index) {
    const DeviceState state = state_of(scene_.transmitters()[index]);
    if (!state.present) {
      halves_[index].forget();
      continue;
    }
    halves_[index].pass(link_end(state, not_reported), scene_.receivers().size());
  }
  note_rays(spent);
  ++frames_done_;
  return report;
}

template <SurfaceModel Surface, SpatialIndex Index>
TreeUpdateReport BasicSimulator<Surface, Index>::update_index(const ChangeSet& changes) {
  halves_are_current_ = false;
  for (const BodyId body : changes.moved) {
    const auto [first, last] = scene_.triangle_range(body);
    const auto had = static_cast<std::ptrdiff_t>(moved_.size());
    moved_.resize(moved_.size() + (last - first));
    std::iota(moved_.begin() + had, moved_.end(), first);
  }
  if (outlines_) {
    outlines_->update(scene_, changes.moved);
    if (lanes_) lanes_->update(scene_, *outlines_, changes.moved);
  }
  // Kept where this throws (a box too far away): the index must hear of them in a later frame.
  const TreeUpdateReport report = [&] {
    const TriangleView mesh = scene_.triangle_view();
    if constexpr (requires { index_.update(mesh, scene_.triangle_boxes(), moved_, pool_.get()); }) {
      return index_.update(mesh, scene_.triangle_boxes(), moved_, pool_.get());
    }
    return index_.update(mesh, scene_.triangle_boxes(), moved_);
  }();
  moved_.clear();
  return report;
}

/// A path over an object that has left its place is not the same path as one over the object that came.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::forget_replaced(const ChangeSet& changes, CacheCounters& counters) {
  if (changes.replaced.empty()) return;
  const auto gone = [&](SequenceElement element) {
    const BodyId body = element.is_edge() ? scene_.wedge(element.edge()).body : scene_.facet(element.mirror()).body;
    return std::binary_search(changes.replaced.begin(), changes.replaced.end(), body);
  };
  for (PathCache& cache : caches_) {
    const std::size_t forgotten = cache.forget(gone);
    counters.expired += forgotten;
    counters.died += forgotten;
  }
}

template <SurfaceModel Surface, SpatialIndex Index>
PathSearchSettings BasicSimulator<Surface, Index>::search_settings(const KnownContacts& known) const {
  const PropagationSettings& propagation = settings_.propagation;
  return {plan_.exhaustive,
          reflection_order(propagation),
          propagation.max_transmissions,
          propagation.rays,
          steady_rays(propagation),
          propagation.seed,
          diffraction_order(propagation),
          interaction_order(propagation),
          {degrees_to_radians(propagation.diffraction.min_exterior_angle_deg), propagation.diffraction.free_edges,
           propagation.diffraction.region == DiffractionRegion::shadow, known},
          plan_.joined,
          propagation.max_path_length_m.value_or(std::numeric_limits<double>::infinity())};
}

}  // namespace dcem
