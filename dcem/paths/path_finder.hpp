#pragma once
/// All paths of one receiver: a discovery proposes sequences, the solver decides.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/paths/exact_search.hpp"
#include "dcem/paths/path_solver.hpp"
#include "dcem/paths/ray_launcher.hpp"

namespace dcem {

struct PathSearchSettings {
  bool exhaustive = true;  ///< all sequences; otherwise those that rays propose
  int max_reflections = 2;
  int max_transmissions = 2;
  std::uint32_t rays = 2000;  ///< launched per receiver and frame where the search is not exhaustive
  std::uint64_t seed = 1;
};

/// The paths between one transmitter and one receiver, in the order of `reported_before`.
struct LinkPaths {
  std::vector<Path> paths;
  bool line_of_sight = false;  ///< the direct segment crosses nothing: the direct path is among the paths
};

struct SearchCounters {
  std::uint64_t rays = 0;
  std::uint64_t sequences_proposed = 0;
  SolverCounters solver;
};

/// Whose paths are wanted: the receiver's name and the frame turn the sphere of rays.
struct ReceiverKey {
  std::string_view id;
  std::size_t frame = 0;
};

/// The paths from every transmitter to one receiver. An absent transmitter has none.
template <typename Tree>
std::vector<LinkPaths> find_paths(const SceneTracer<Tree>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const ReceiverKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline void sort_and_drop_repeated(std::vector<Path>& paths) {
  std::sort(paths.begin(), paths.end(), reported_before);
  // The same sequence gives the same bits, so repeated paths stand side by side.
  paths.erase(std::unique(paths.begin(), paths.end(), same_sequence), paths.end());
}

}  // namespace detail

template <typename Tree>
std::vector<LinkPaths> find_paths(const SceneTracer<Tree>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const ReceiverKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters) {
  PathSolver<Tree> solver(tracer, settings.max_transmissions);
  std::vector<LinkPaths> links(transmitters.size());
  const auto try_all_transmitters = [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
    ++counters.sequences_proposed;
    for (std::size_t index = 0; index < transmitters.size(); ++index) {
      if (!transmitters[index]) continue;
      std::optional<Path> path = solver.solve(*transmitters[index], receiver, sequence, images_m);
      if (path) links[index].paths.push_back(std::move(*path));
    }
  };
  if (settings.exhaustive) {
    ExactSearch(tracer.scene(), settings.max_reflections).for_each_sequence(receiver, try_all_transmitters);
  } else {
    RayLauncher<Tree> launcher(tracer, {settings.rays, settings.max_reflections, settings.max_transmissions});
    launcher.for_each_sequence(receiver, launch_rotation(settings.seed, key.id, key.frame), try_all_transmitters);
    counters.rays += launcher.rays();
    counters.solver.traversal += launcher.traversal();
  }
  counters.solver += solver.counters();
  for (LinkPaths& link : links) {
    detail::sort_and_drop_repeated(link.paths);
    link.line_of_sight =
        std::any_of(link.paths.begin(), link.paths.end(), [](const Path& path) { return path.interactions.empty(); });
  }
  return links;
}

}  // namespace dcem
