#pragma once
/// The whole line: scene and settings in, links out, frame by frame.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/bvh.hpp"
#include "dcem/channel/field_evaluator.hpp"
#include "dcem/channel/link_statistics.hpp"
#include "dcem/channel/radio_map.hpp"
#include "dcem/core/parallel_for.hpp"
#include "dcem/paths/obstruction.hpp"
#include "dcem/paths/path_finder.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// Owns the scene and the tree over it. `Surface` says how surfaces reflect and transmit: the scene's materials, or a
/// model of the caller's own. `Tree` is `Bvh<double>`, or `BruteForce<double>` to check it.
template <SurfaceModel Surface = MaterialTable, typename Tree = Bvh<double>>
class Simulator {
 public:
  /// Throws std::invalid_argument where a setting is out of range or a material is not tabled at the frequency.
  Simulator(Scene scene, SimulationSettings settings) requires std::same_as<Surface, MaterialTable>
      : Simulator(std::move(scene), settings, nullptr) {}

  /// With a reflection model of the caller's own.
  Simulator(Scene scene, SimulationSettings settings, Surface surface);

  const Scene& scene() const { return scene_; }
  const SimulationSettings& settings() const { return settings_; }
  const Tree& tree() const { return tree_; }
  Discovery discovery() const { return discovery_; }  ///< exact or sampled: what is really done

  /// Moves the scene to a frame and solves all links.
  FrameResult advance(const Frame& frame);
  /// The same for the instant `time_s`, by the motions of the scene.
  FrameResult advance_to(double time_s, std::size_t index = 0) { return advance(scene_.frame_at(time_s, index)); }

  /// Links from all transmitters to receivers of the caller's, in the current frame, by transmitter, then receiver.
  /// `LinkResult::receiver` is the index in `receivers`.
  std::vector<LinkResult> solve(std::span<const Device> receivers, WorkCounters* work = nullptr) const;

  /// One map per transmitter over the grid, in the current frame. `progress(n)` is called from the working threads
  /// whenever n more points are done.
  std::vector<RadioMap> radio_maps(const ReceiverGrid& grid, const std::function<void(std::size_t)>& progress = {},
                                   WorkCounters* work = nullptr) const;

 private:
  using Tracer = SceneTracer<Tree>;
  using Evaluator = FieldEvaluator<Surface, AnyPathLoss>;

  /// A transmitter as paths and as fields see it; absent while its object is away.
  struct TransmitterEnds {
    std::vector<std::optional<LinkEnd>> link;
    std::vector<RadioEnd> radio;
  };

  Simulator(Scene scene, SimulationSettings settings, std::nullptr_t) requires std::same_as<Surface, MaterialTable>
      : Simulator(scene, settings,
                  MaterialTable({scene.materials().begin(), scene.materials().end()}, settings.frequency_hz,
                                settings.itu)) {}

  TreeReport update_tree(const ChangeSet& changes);
  TransmitterEnds transmitter_ends() const;
  PathSearchSettings search_settings() const;
  /// The links of one receiver, one per transmitter that is present; empty where the receiver is absent.
  std::vector<LinkResult> solve_receiver(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters,
                                         WorkCounters& work) const;
  LinkResult make_link(LinkPaths&& found, std::size_t transmitter, const RadioEnd& from, const RadioEnd& to,
                       const Evaluator& evaluator) const;
  static RadioMapPoint map_point(const LinkResult& link, const Vec3& position_m);

  Scene scene_;
  SimulationSettings settings_;
  Surface surface_;
  Tree tree_;
  Discovery discovery_;
  Frame frame_;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace detail

template <SurfaceModel Surface, typename Tree>
Simulator<Surface, Tree>::Simulator(Scene scene, SimulationSettings settings, Surface surface)
    : scene_(std::move(scene)), settings_(std::move(settings)), surface_(std::move(surface)) {
  validate(settings_);
  discovery_ = resolve_discovery(settings_.propagation, scene_);
  frame_ = scene_.frame_at(0.0);
  scene_.apply(frame_);
  tree_.build_grouped(scene_.triangle_boxes(), scene_.first_triangles());
}

template <SurfaceModel Surface, typename Tree>
FrameResult Simulator<Surface, Tree>::advance(const Frame& frame) {
  FrameResult result{frame.index, frame.time_s, {}, {}, {}, 0.0, 0.0};
  const detail::Stopwatch update_watch;
  result.tree = update_tree(scene_.apply(frame));
  frame_ = frame;
  result.update_time_s = update_watch.seconds();
  const detail::Stopwatch solve_watch;
  result.links = solve(scene_.receivers(), &result.work);
  result.solve_time_s = solve_watch.seconds();
  return result;
}

template <SurfaceModel Surface, typename Tree>
TreeReport Simulator<Surface, Tree>::update_tree(const ChangeSet& changes) {
  std::vector<std::uint32_t> moved;
  for (const BodyId body : changes.moved) {
    const auto [first, last] = scene_.triangle_range(body);
    for (std::uint32_t triangle = first; triangle < last; ++triangle) moved.push_back(triangle);
  }
  const RefitReport refit = tree_.refit(moved, scene_.triangle_boxes());
  return {tree_.nodes().size() - refit.touched_nodes, refit.touched_nodes, 0, tree_.sah_cost()};
}

template <SurfaceModel Surface, typename Tree>
typename Simulator<Surface, Tree>::TransmitterEnds Simulator<Surface, Tree>::transmitter_ends() const {
  const Tracer tracer(scene_, tree_);
  TransmitterEnds ends;
  for (const Device& device : scene_.transmitters()) {
    const DeviceState state = scene_.device_state(device, frame_);
    TraversalCounters counters;
    ends.link.push_back(state.present
                            ? std::optional(make_link_end(tracer, state.position_m, state.ignored_body, counters))
                            : std::nullopt);
    ends.radio.push_back({state.position_m, state.velocity_mps, device.antenna});
  }
  return ends;
}

template <SurfaceModel Surface, typename Tree>
PathSearchSettings Simulator<Surface, Tree>::search_settings() const {
  const PropagationSettings& propagation = settings_.propagation;
  return {discovery_ == Discovery::exact, reflection_order(propagation), propagation.max_transmissions,
          propagation.rays, propagation.seed};
}

template <SurfaceModel Surface, typename Tree>
std::vector<LinkResult> Simulator<Surface, Tree>::solve(std::span<const Device> receivers, WorkCounters* work) const {
  const TransmitterEnds transmitters = transmitter_ends();
  std::vector<std::vector<LinkResult>> by_receiver(receivers.size());
  std::vector<WorkCounters> spent(receivers.size());
  parallel_for(receivers.size(), settings_.threads, [&](std::size_t index, unsigned) {
    by_receiver[index] = solve_receiver(receivers[index], index, transmitters, spent[index]);
  });
  std::vector<LinkResult> links;
  for (std::vector<LinkResult>& of_receiver : by_receiver) {
    for (LinkResult& link : of_receiver) links.push_back(std::move(link));
  }
  std::stable_sort(links.begin(), links.end(),
                   [](const LinkResult& a, const LinkResult& b) { return a.transmitter < b.transmitter; });
  for (const WorkCounters& one : spent) {
    if (work != nullptr) *work += one;
  }
  return links;
}

template <SurfaceModel Surface, typename Tree>
std::vector<LinkResult> Simulator<Surface, Tree>::solve_receiver(const Device& receiver, std::size_t index,
                                                                 const TransmitterEnds& transmitters,
                                                                 WorkCounters& work) const {
  const Tracer tracer(scene_, tree_);
  const DeviceState state = scene_.device_state(receiver, frame_);
  if (!state.present) return {};
  SearchCounters counters;
  const LinkEnd end = make_link_end(tracer, state.position_m, state.ignored_body, counters.solver.traversal);
  const PathSearchSettings search = search_settings();
  std::vector<LinkPaths> found =
      find_paths(tracer, search, end, {receiver.id, frame_.index}, transmitters.link, counters);
  const Evaluator evaluator(scene_, surface_, settings_.propagation.path_loss, settings_.frequency_hz);
  const RadioEnd to{state.position_m, state.velocity_mps, receiver.antenna};
  std::vector<LinkResult> links;
  for (std::size_t transmitter = 0; transmitter < found.size(); ++transmitter) {
    const bool itself = scene_.transmitters()[transmitter].id == receiver.id;
    if (!transmitters.link[transmitter] || itself) continue;
    links.push_back(
        make_link(std::move(found[transmitter]), transmitter, transmitters.radio[transmitter], to, evaluator));
    links.back().receiver = index;
    links.back().complete = search.exhaustive || search.max_reflections == 0;
    work.paths += links.back().paths.size();
  }
  work.rays += counters.rays;
  work.legs += counters.solver.legs;
  work.sequences_proposed += counters.sequences_proposed;
  work.sequences_solved += counters.solver.sequences_solved;
  work.nodes_visited += counters.solver.traversal.nodes_visited;
  work.primitives_tested += counters.solver.traversal.primitives_tested;
  return links;
}

template <SurfaceModel Surface, typename Tree>
LinkResult Simulator<Surface, Tree>::make_link(LinkPaths&& found, std::size_t transmitter, const RadioEnd& from,
                                               const RadioEnd& to, const Evaluator& evaluator) const {
  const PropagationSettings& propagation = settings_.propagation;
  LinkResult link;
  link.transmitter = transmitter;
  for (Path& path : found.paths) {
    if (path.interactions.empty() && !propagation.line_of_sight) continue;
    PathContribution contribution = evaluator.evaluate(std::move(path), from, to);
    const bool too_weak =
        propagation.min_path_gain_db && !(power_ratio_to_db(contribution.power_ratio) >= *propagation.min_path_gain_db);
    if (!too_weak) link.paths.push_back(std::move(contribution));
  }
  link.statistics = link_statistics(link.paths, scene_.transmitters()[transmitter].power_dbm, found.line_of_sight);
  return link;
}

template <SurfaceModel Surface, typename Tree>
RadioMapPoint Simulator<Surface, Tree>::map_point(const LinkResult& link, const Vec3& position_m) {
  RadioMapPoint point{position_m, false, link.statistics, {}};
  const auto strongest = std::max_element(
      link.paths.begin(), link.paths.end(),
      [](const PathContribution& a, const PathContribution& b) { return a.power_ratio < b.power_ratio; });
  if (strongest != link.paths.end()) point.strongest_kinds = kinds(strongest->path);
  return point;
}

template <SurfaceModel Surface, typename Tree>
std::vector<RadioMap> Simulator<Surface, Tree>::radio_maps(const ReceiverGrid& grid,
                                                           const std::function<void(std::size_t)>& progress,
                                                           WorkCounters* work) const {
  const TransmitterEnds transmitters = transmitter_ends();
  const Tracer tracer(scene_, tree_);
  std::vector<Vec3> transmitters_m;
  std::vector<RadioMap> maps;
  for (std::size_t index = 0; index < transmitters.radio.size(); ++index) {
    if (transmitters.link[index]) transmitters_m.push_back(transmitters.radio[index].position_m);
    maps.push_back({grid, scene_.transmitters()[index].id, std::vector<RadioMapPoint>(grid.size())});
  }
  const ObstructionTest<Tree> obstruction(tracer, tree_, transmitters_m);
  std::vector<WorkCounters> spent(grid.rows());
  parallel_for(grid.rows(), settings_.threads, [&](std::size_t row, unsigned) {
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = row * grid.columns() + column;
      const Vec3 position_m = grid_point_m(grid, row, column);
      const bool obstructed = obstruction.obstructed(position_m);
      for (RadioMap& map : maps) map.points[cell] = {position_m, obstructed, {}, {}};
      if (obstructed) continue;
      for (const LinkResult& link : solve_receiver(grid_receiver(grid, row, column), cell, transmitters, spent[row])) {
        maps[link.transmitter].points[cell] = map_point(link, position_m);
      }
    }
    if (progress) progress(grid.columns());
  });
  for (const WorkCounters& one : spent) {
    if (work != nullptr) *work += one;
  }
  return maps;
}

}  // namespace dcem
