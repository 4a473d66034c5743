#pragma once
/// How a `Simulator` moves to a frame and solves its links; included by simulator.hpp.
#include <algorithm>
#include <chrono>

#include "dcem/sim/simulator.hpp"

namespace dcem {

namespace detail {

inline void add_search_work(const SearchCounters& counters, WorkCounters& work) {
  work.rays += counters.rays;
  work.legs += counters.solver.legs;
  work.sequences_proposed += counters.sequences_proposed;
  work.sequences_solved += counters.solver.sequences_solved;
  work.nodes_visited += counters.solver.traversal.nodes_visited;
  work.primitives_tested += counters.solver.traversal.primitives_tested;
}

inline void add_diffuse_work(const DiffusePower& diffuse, WorkCounters& work) {
  work.legs += diffuse.legs;
  work.nodes_visited += diffuse.traversal.nodes_visited;
  work.primitives_tested += diffuse.traversal.primitives_tested;
  work.diffuse_tiles += diffuse.tiles_evaluated;
  work.diffuse_links_unfinished += diffuse.converged ? 0 : 1;
}

/// A device in a frame as fields see it.
inline RadioEnd radio_end(const Device& device, const DeviceState& state) {
  return {state.position_m, state.velocity_mps, device.antenna, state.rotation};
}

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace detail

template <SurfaceModel Surface, typename Tree>
FrameResult Simulator<Surface, Tree>::advance(const Frame& frame) {
  FrameResult result{frame.index, frame.time_s, {}, {}, {}, {}, 0.0, 0.0};
  const detail::Stopwatch update_watch;
  const ChangeSet changes = scene_.apply(frame);
  result.tree = update_tree(changes);
  forget_replaced(changes, result.cache);
  frame_ = frame;
  result.update_time_s = update_watch.seconds();
  const detail::Stopwatch solve_watch;
  Solved solved = solve_all(scene_.receivers(), transmitter_ends(reach_), caches_);
  result.links = std::move(solved.links);
  result.work = solved.work;
  result.cache += solved.cache;
  result.solve_time_s = solve_watch.seconds();
  return result;
}

template <SurfaceModel Surface, typename Tree>
UpkeepReport Simulator<Surface, Tree>::move_to(const Frame& frame) {
  const ChangeSet changes = scene_.apply(frame);
  CacheCounters not_reported;
  forget_replaced(changes, not_reported);
  frame_ = frame;
  return update_tree(changes);
}

template <SurfaceModel Surface, typename Tree>
std::optional<PathContribution> Simulator<Surface, Tree>::solve_path(std::size_t transmitter, std::size_t receiver,
                                                                     const Sequence& sequence) const {
  const Device& from = scene_.transmitters()[transmitter];
  const Device& to = scene_.receivers()[receiver];
  const DeviceState from_state = scene_.device_state(from, frame_), to_state = scene_.device_state(to, frame_);
  if (!from_state.present || !to_state.present) return std::nullopt;
  const Tracer tracer(scene_, tree_);
  const PathSearchSettings search = search_settings();
  PathSolver<Tree> solver(tracer, search.max_transmissions, search.edges);
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

template <SurfaceModel Surface, typename Tree>
void Simulator<Surface, Tree>::trace_elements(std::span<PathContribution> paths, const DeviceEnd& from,
                                              const DeviceEnd& to, const Evaluator& evaluator) const {
  if (settings_.propagation.antenna_array != ArrayChannel::exact || !has_array(from.radio, to.radio)) return;
  const Tracer tracer(scene_, tree_);
  const PathSearchSettings search = search_settings();
  PathSolver<Tree> solver(tracer, search.max_transmissions, search.edges);
  TraversalCounters counters;
  const double length_m = wavelength_m(settings_.frequency_hz);
  const ElementEnds from_elements = element_ends(tracer, from.link, from.radio, length_m, counters);
  const ElementEnds to_elements = element_ends(tracer, to.link, to.radio, length_m, counters);
  ElementPaths<Tree, Surface, AnyPathLoss> elements(solver, evaluator, from_elements, to_elements);
  for (PathContribution& path : paths) path.channel = elements.channel(path.path);
}

template <SurfaceModel Surface, typename Tree>
UpkeepReport Simulator<Surface, Tree>::update_tree(const ChangeSet& changes) {
  for (const BodyId body : changes.moved) {
    const auto [first, last] = scene_.triangle_range(body);
    for (std::uint32_t triangle = first; triangle < last; ++triangle) moved_.push_back(triangle);
  }
  // Kept where this throws (a box too far away): the tree must hear of them in a later frame.
  const UpkeepReport report = maintainer_.update(tree_, moved_, scene_.triangle_boxes());
  moved_.clear();
  return report;
}

/// A path over an object that has left its place is not the same path as one over the object that came.
template <SurfaceModel Surface, typename Tree>
void Simulator<Surface, Tree>::forget_replaced(const ChangeSet& changes, CacheCounters& counters) {
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

template <SurfaceModel Surface, typename Tree>
typename Simulator<Surface, Tree>::TransmitterEnds Simulator<Surface, Tree>::transmitter_ends(
    std::span<EdgeReach> reach) const {
  TransmitterEnds ends;
  for (const Device& device : scene_.transmitters()) {
    const DeviceState state = scene_.device_state(device, frame_);
    TraversalCounters counters;
    ends.link.push_back(state.present ? std::optional(link_end(state, counters)) : std::nullopt);
    ends.radio.push_back(detail::radio_end(device, state));
  }
  ends.reached.resize(ends.link.size());
  if (diffraction_order(settings_.propagation) > 0) find_transmitter_reach(ends, reach);
  return ends;
}

template <SurfaceModel Surface, typename Tree>
void Simulator<Surface, Tree>::find_transmitter_reach(TransmitterEnds& ends, std::span<EdgeReach> reach) const {
  const Tracer tracer(scene_, tree_);
  const PathSearchSettings search = search_settings();
  if (reach.empty()) {
    ends.own_reach.resize(ends.link.size());
    reach = ends.own_reach;
  }
  std::vector<SearchCounters> spent(ends.link.size());
  parallel_for(ends.link.size(), settings_.threads, [&](std::size_t index, unsigned) {
    if (!ends.link[index]) return reach[index].clear();
    const bool known = reach[index].size() > 0;
    reach[index].next_frame(detail::proposal_lifetime_frames(search));
    find_reach(tracer, search, *ends.link[index], {scene_.transmitters()[index].id, frame_.index},
               known ? search.rays_steady : search.rays, reach[index], spent[index]);
    ends.reached[index] = reach[index].edges();
  });
  for (const SearchCounters& one : spent) detail::add_search_work(one, ends.work);
}

template <SurfaceModel Surface, typename Tree>
PathSearchSettings Simulator<Surface, Tree>::search_settings() const {
  const PropagationSettings& propagation = settings_.propagation;
  return {discovery_ == Discovery::exact,
          reflection_order(propagation),
          propagation.max_transmissions,
          propagation.rays,
          steady_rays(propagation),
          propagation.seed,
          diffraction_order(propagation),
          interaction_order(propagation),
          {degrees_to_radians(propagation.diffraction.min_exterior_angle_deg), propagation.diffraction.free_edges,
           propagation.diffraction.region == DiffractionRegion::shadow}};
}

template <SurfaceModel Surface, typename Tree>
std::vector<LinkResult> Simulator<Surface, Tree>::solve(std::span<const Device> receivers, WorkCounters* work) const {
  Solved solved = solve_all(receivers, transmitter_ends({}), {});
  if (work != nullptr) *work += solved.work;
  return std::move(solved.links);
}

template <SurfaceModel Surface, typename Tree>
typename Simulator<Surface, Tree>::Solved Simulator<Surface, Tree>::solve_all(std::span<const Device> receivers,
                                                                              const TransmitterEnds& transmitters,
                                                                              std::span<PathCache> caches) const {
  std::vector<Solved> by_receiver(receivers.size());
  parallel_for(receivers.size(), settings_.threads, [&](std::size_t index, unsigned) {
    PathCache* cache = caches.empty() ? nullptr : &caches[index];
    by_receiver[index] = solve_receiver(receivers[index], index, transmitters, cache);
  });
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
template <SurfaceModel Surface, typename Tree>
std::span<const std::optional<LinkEnd>> Simulator<Surface, Tree>::ends_beside(
    const Device& receiver, const TransmitterEnds& transmitters, std::vector<std::optional<LinkEnd>>& others) const {
  const std::span<const Device> devices = scene_.transmitters();
  const auto is_receiver = [&](const Device& device) { return device.id == receiver.id; };
  const auto same = std::find_if(devices.begin(), devices.end(), is_receiver);
  if (same == devices.end()) return transmitters.link;
  others = transmitters.link;
  others[static_cast<std::size_t>(same - devices.begin())].reset();
  return others;
}

template <SurfaceModel Surface, typename Tree>
typename Simulator<Surface, Tree>::Solved Simulator<Surface, Tree>::solve_receiver(const Device& receiver,
                                                                                   std::size_t index,
                                                                                   const TransmitterEnds& transmitters,
                                                                                   PathCache* cache) const {
  const Tracer tracer(scene_, tree_);
  const DeviceState state = scene_.device_state(receiver, frame_);
  Solved solved;
  if (!state.present) {
    if (cache != nullptr) solved.cache.died = cache->clear();
    return solved;
  }
  SearchCounters counters;
  const LinkEnd end = link_end(state, counters.solver.traversal);
  const PathSearchSettings search = search_settings();
  std::vector<std::optional<LinkEnd>> others;
  const std::span<const std::optional<LinkEnd>> ends = ends_beside(receiver, transmitters, others);
  std::vector<LinkPaths> found =
      find_paths(tracer, search, end, {receiver.id, frame_.index}, ends, counters, cache, transmitters.reached);
  const Evaluator field = evaluator();
  const RadioEnd to = detail::radio_end(receiver, state);
  std::vector<DiffusePower> diffuse = diffuse_powers(receiver.id, end, to, transmitters, ends, solved.work);
  for (std::size_t transmitter = 0; transmitter < found.size(); ++transmitter) {
    if (!ends[transmitter]) continue;
    LinkResult& link =
        solved.links.emplace_back(make_link(std::move(found[transmitter]), std::move(diffuse[transmitter]), transmitter,
                                            {*ends[transmitter], transmitters.radio[transmitter]}, {end, to}, field));
    link.receiver = index;
    link.complete = search.exhaustive || (search.max_reflections == 0 && search.max_diffractions == 0);
    solved.work.paths += link.paths.size();
  }
  detail::add_search_work(counters, solved.work);
  solved.cache = counters.cache;
  return solved;
}

template <SurfaceModel Surface, typename Tree>
std::vector<DiffusePower> Simulator<Surface, Tree>::diffuse_powers(const std::string& receiver, const LinkEnd& end,
                                                                   const RadioEnd& to,
                                                                   const TransmitterEnds& transmitters,
                                                                   std::span<const std::optional<LinkEnd>> ends,
                                                                   WorkCounters& work) const {
  std::vector<DiffusePower> powers(ends.size());
  const PropagationSettings& propagation = settings_.propagation;
  if (!propagation.diffuse.enabled) return powers;
  const Tracer tracer(scene_, tree_);
  const ScatteredPower<Surface, AnyPathLoss> scattered(scene_, surface_, propagation.path_loss, medium_,
                                                       settings_.frequency_hz);
  DiffuseIntegral<Tree, Surface, AnyPathLoss> integral(tracer, scattered, propagation.diffuse,
                                                       propagation.max_transmissions);
  for (std::size_t index = 0; index < ends.size(); ++index) {
    if (!ends[index]) continue;
    const DiffuseKey key{propagation.seed, scene_.transmitters()[index].id, receiver};
    powers[index] = integral.evaluate(*ends[index], transmitters.radio[index], end, to, key);
    detail::add_diffuse_work(powers[index], work);
  }
  return powers;
}

template <SurfaceModel Surface, typename Tree>
LinkResult Simulator<Surface, Tree>::make_link(LinkPaths&& found, DiffusePower&& diffuse, std::size_t transmitter,
                                               const DeviceEnd& from, const DeviceEnd& to,
                                               const Evaluator& evaluator) const {
  const PropagationSettings& propagation = settings_.propagation;
  LinkResult link;
  link.transmitter = transmitter;
  link.diffuse = std::move(diffuse);
  bool line_of_sight = found.line_of_sight;
  for (Path& path : found.paths) {
    const bool is_direct = path.interactions.empty();
    if (is_direct && !path.foliage.empty()) line_of_sight = false;  // the segment is not free, though nothing stops it
    if (is_direct && !propagation.line_of_sight) continue;
    PathContribution contribution = evaluator.evaluate(std::move(path), from.radio, to.radio);
    const bool too_weak =
        propagation.min_path_gain_db && !(power_ratio_to_db(contribution.power_ratio) >= *propagation.min_path_gain_db);
    if (!too_weak) link.paths.push_back(std::move(contribution));
  }
  trace_elements(link.paths, from, to, evaluator);
  const double power_dbm = scene_.transmitters()[transmitter].power_dbm;
  link.statistics = link_statistics(link.paths, power_dbm, line_of_sight, link.diffuse);
  return link;
}

}  // namespace dcem
