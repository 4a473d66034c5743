#pragma once
/// All paths of one receiver: the memory of the last frame and a discovery propose sequences, the solver decides.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/paths/exact_search.hpp"
#include "dcem/paths/path_cache.hpp"
#include "dcem/paths/path_solver.hpp"
#include "dcem/paths/ray_launcher.hpp"

namespace dcem {

struct PathSearchSettings {
  bool exhaustive = true;  ///< all sequences; otherwise those that rays propose
  int max_reflections = 2;
  int max_transmissions = 2;
  std::uint32_t rays = 2000;        ///< launched per receiver and frame where the search is not exhaustive
  std::uint32_t rays_steady = 200;  ///< the same in a frame in which every link is remembered from the frame before
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
  CacheCounters cache;
};

/// Whose paths are wanted: the receiver's name and the frame turn the sphere of rays.
struct ReceiverKey {
  std::string_view id;
  std::size_t frame = 0;
};

/// The paths from every transmitter to one receiver. An absent transmitter has none. With a `cache`, the sequences that
/// it remembers are tried first, and afterwards it holds those of the paths found.
template <typename Tree>
std::vector<LinkPaths> find_paths(const SceneTracer<Tree>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const ReceiverKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters,
                                  PathCache* cache = nullptr);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline void sort_and_drop_repeated(std::vector<Path>& paths) {
  std::sort(paths.begin(), paths.end(), reported_before);
  // The same sequence gives the same bits, so repeated paths stand side by side.
  paths.erase(std::unique(paths.begin(), paths.end(), same_sequence), paths.end());
}

/// Frames after which so few rays have added up to a full search.
inline std::uint32_t proposal_lifetime_frames(const PathSearchSettings& settings) {
  const std::uint32_t steady = std::max<std::uint32_t>(1, settings.rays_steady);
  return (settings.rays + steady - 1) / steady;
}

/// One receiver's search in one frame.
template <typename Tree>
class PathFinder {
 public:
  PathFinder(const SceneTracer<Tree>& tracer, const PathSearchSettings& settings, const LinkEnd& receiver,
             std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters)
      : tracer_(tracer),
        settings_(settings),
        receiver_(receiver),
        transmitters_(transmitters),
        counters_(counters),
        solver_(tracer, settings.max_transmissions),
        links_(transmitters.size()),
        tried_(transmitters.size()) {}

  /// Solves what was remembered of each link.
  void revalidate(const PathCache& cache) {
    std::vector<Vec3> images_m;
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      if (!transmitters_[index] || !cache.sequences(index)) continue;
      for (const Sequence& sequence : *cache.sequences(index)) {
        make_images(sequence, images_m);
        tried_[index].insert(sequence);
        ++counters_.cache.revalidated;
        ++(try_one(index, sequence, images_m) ? counters_.cache.reused : counters_.cache.expired);
      }
    }
  }

  /// Solves every sequence there is.
  void search_all() {
    ExactSearch(tracer_.scene(), settings_.max_reflections)
        .for_each_sequence(receiver_, [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
          try_all(sequence, images_m);
        });
  }

  /// Solves what rays propose in this frame and, with a memory, what they proposed in the frames before.
  void shoot(const ReceiverKey& key, std::uint32_t rays, ProposalMemory* memory) {
    if (memory != nullptr) {
      std::vector<Vec3> images_m;
      memory->for_each([&](const Sequence& sequence) {
        make_images(sequence, images_m);
        try_all(sequence, images_m);
      });
    }
    RayLauncher<Tree> launcher(tracer_, {rays, settings_.max_reflections, settings_.max_transmissions});
    launcher.for_each_sequence(receiver_, launch_rotation(settings_.seed, key.id, key.frame),
                               [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
                                 if (memory == nullptr || !memory->note(sequence)) try_all(sequence, images_m);
                               });
    if (memory != nullptr) memory->next_frame(proposal_lifetime_frames(settings_));
    counters_.rays += launcher.rays();
    counters_.solver.traversal += launcher.traversal();
  }

  std::vector<LinkPaths> take() {
    counters_.solver += solver_.counters();
    for (LinkPaths& link : links_) {
      sort_and_drop_repeated(link.paths);
      link.line_of_sight =
          std::any_of(link.paths.begin(), link.paths.end(), [](const Path& path) { return path.interactions.empty(); });
    }
    return std::move(links_);
  }

 private:
  void make_images(const Sequence& sequence, std::vector<Vec3>& images_m) const {
    images_m.assign(1, receiver_.position_m);
    for (const FacetId mirror : sequence) append_image(images_m, tracer_.scene().facet(mirror).plane);
  }

  /// Solves a sequence for every transmitter for which it was not remembered.
  void try_all(const Sequence& sequence, const std::vector<Vec3>& images_m) {
    ++counters_.sequences_proposed;
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      if (transmitters_[index] && !tried_[index].contains(sequence)) try_one(index, sequence, images_m);
    }
  }

  bool try_one(std::size_t transmitter, const Sequence& sequence, const std::vector<Vec3>& images_m) {
    std::optional<Path> path = solver_.solve(*transmitters_[transmitter], receiver_, sequence, images_m);
    if (!path) return false;
    links_[transmitter].paths.push_back(std::move(*path));
    return true;
  }

  const SceneTracer<Tree>& tracer_;
  const PathSearchSettings& settings_;
  const LinkEnd& receiver_;
  std::span<const std::optional<LinkEnd>> transmitters_;
  SearchCounters& counters_;
  PathSolver<Tree> solver_;
  std::vector<LinkPaths> links_;
  std::vector<SequenceTable> tried_;  ///< per transmitter: the sequences that were remembered
};

inline bool remembers_all(const PathCache& cache, std::span<const std::optional<LinkEnd>> transmitters) {
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (transmitters[index] && !cache.sequences(index)) return false;
  }
  return true;
}

/// Writes the cache for the next frame and counts what came and went.
inline void remember(PathCache& cache, std::span<const std::optional<LinkEnd>> transmitters,
                     std::span<const LinkPaths> links, CacheCounters& counters) {
  const std::vector<PathCache::Link> before = cache.begin_frame(transmitters.size());
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    SequenceTable old;
    if (index < before.size() && before[index]) {
      for (const Sequence& sequence : *before[index]) old.insert(sequence);
    }
    if (!transmitters[index]) {
      counters.died += old.size();
      continue;
    }
    cache.remember(index, links[index].paths);
    std::uint64_t stayed = 0;
    for (const Sequence& sequence : *cache.sequences(index)) stayed += old.contains(sequence) ? 1U : 0U;
    counters.born += cache.sequences(index)->size() - stayed;
    counters.died += old.size() - stayed;
  }
}

}  // namespace detail

template <typename Tree>
std::vector<LinkPaths> find_paths(const SceneTracer<Tree>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const ReceiverKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters,
                                  PathCache* cache) {
  detail::PathFinder<Tree> finder(tracer, settings, receiver, transmitters, counters);
  const bool steady = cache != nullptr && detail::remembers_all(*cache, transmitters);
  if (cache != nullptr) finder.revalidate(*cache);
  if (settings.exhaustive) {
    finder.search_all();
  } else {
    finder.shoot(key, steady ? settings.rays_steady : settings.rays, cache != nullptr ? &cache->proposals() : nullptr);
  }
  std::vector<LinkPaths> links = finder.take();
  if (cache != nullptr) detail::remember(*cache, transmitters, links, counters.cache);
  return links;
}

}  // namespace dcem
