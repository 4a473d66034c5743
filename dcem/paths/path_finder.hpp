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

#include "dcem/paths/discover/edge_view.hpp"
#include "dcem/paths/discover/path_search.hpp"

namespace dcem {

/// The paths from every transmitter to one receiver. An absent transmitter has none. With a `cache`, the sequences that
/// it remembers are tried first, and afterwards it holds those of the paths found. `reached` says which edges each
/// transmitter reaches, and is needed where diffractions are wanted; `proposed`, by transmitter, holds the sequences of
/// the halves where the settings say so.
template <typename Index>
std::vector<LinkPaths> find_paths(const SceneTracer<Index>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const SphereKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters,
                                  PathCache* cache = nullptr, std::span<const ReachedEdges> reached = {},
                                  std::span<const SequenceList> proposed = {});

/// The edges that one end reaches: by exhaustive search every one, in place of what `reach` holds; otherwise those that
/// `rays` rays come by, in addition to it.
template <typename Index>
void find_reach(const SceneTracer<Index>& tracer, const PathSearchSettings& settings, const LinkEnd& end,
                const SphereKey& key, std::uint32_t rays, EdgeReach& reach, SearchCounters& counters);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Notes what the edges of a reach see, in sampled search.
template <typename Index>
void look_from_edges(const SceneTracer<Index>& tracer, const PathSearchSettings& settings, const LinkEnd& end,
                     std::size_t frame, std::uint32_t rays, EdgeReach& reach, SearchCounters& counters) {
  EdgeView<Index> view(tracer, end);
  view.look(reach, chain_limits(settings), {settings.seed, frame}, rays_of_an_edge(rays));
  counters.rays += view.rays();
  counters.solver.traversal += view.traversal();
}

inline bool remembers_all(const PathCache& cache, std::span<const std::optional<LinkEnd>> transmitters) {
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    if (transmitters[index] && cache.sequences(index) == nullptr) return false;
  }
  return true;
}

/// Writes the cache for the next frame and counts what came and went.
inline void remember(PathCache& cache, std::span<const std::optional<LinkEnd>> transmitters,
                     std::span<const LinkPaths> links, CacheCounters& counters) {
  cache.begin_frame(transmitters.size());
  for (std::size_t index = 0; index < transmitters.size(); ++index) {
    const SequenceTable* const before = cache.sequences_before(index);
    const std::size_t there_were = before != nullptr ? before->size() : 0;
    if (!transmitters[index]) {
      counters.died += there_were;
      continue;
    }
    cache.remember(index, links[index].paths);
    const SequenceTable& now = *cache.sequences(index);
    std::uint64_t stayed = 0;
    for (std::size_t number = 0; before != nullptr && number < now.size(); ++number) {
      stayed += before->contains(now[number]) ? 1U : 0U;
    }
    counters.born += now.size() - stayed;
    counters.died += there_were - stayed;
  }
}

}  // namespace detail

template <typename Index>
std::vector<LinkPaths> find_paths(const SceneTracer<Index>& tracer, const PathSearchSettings& settings,
                                  const LinkEnd& receiver, const SphereKey& key,
                                  std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters,
                                  PathCache* cache, std::span<const ReachedEdges> reached,
                                  std::span<const SequenceList> proposed) {
  DCEM_ASSERT(settings.max_diffractions == 0 || reached.size() == transmitters.size());
  DCEM_ASSERT(settings.joined == 0 || proposed.size() == transmitters.size());
  detail::PathSearch<Index> search(tracer, settings, receiver, transmitters, counters);
  const bool steady = cache != nullptr && detail::remembers_all(*cache, transmitters);
  PathCache forgotten;
  PathCache& kept = cache != nullptr ? *cache : forgotten;
  EdgeReach& seen = kept.reach();
  const bool joins_edges = settings.max_diffractions > 0 && (settings.exhaustive || needs_rays(settings));
  EdgeReach* const noted = joins_edges ? &seen : nullptr;
  if (cache != nullptr) search.revalidate(*cache);
  if (settings.joined > 0) search.solve_proposed(proposed);
  if (settings.exhaustive) {
    search.search_all(noted);
  } else if (needs_rays(settings)) {
    const std::uint32_t rays = steady ? settings.rays_steady : settings.rays;
    search.shoot(key, rays, cache != nullptr ? &cache->proposals() : nullptr, noted);
    if (noted != nullptr) detail::look_from_edges(tracer, settings, receiver, key.frame, rays, seen, counters);
  }
  if (noted != nullptr) search.join(seen.edges(), reached, kept.room());
  if (noted != nullptr) seen.next_frame(detail::proposal_lifetime_frames(settings));
  std::vector<LinkPaths> links = search.take();
  if (cache != nullptr) detail::remember(*cache, transmitters, links, counters.cache);
  return links;
}

template <typename Index>
void find_reach(const SceneTracer<Index>& tracer, const PathSearchSettings& settings, const LinkEnd& end,
                const SphereKey& key, std::uint32_t rays, EdgeReach& reach, SearchCounters& counters) {
  const auto ignore_mirrors = [](const Sequence&, const std::vector<Vec3>&) {};
  if (settings.exhaustive) {
    ExactSearch search(tracer.scene(), settings.max_reflections);
    reach.clear();
    search.note_edges(reach, settings.edges, detail::most_mirrors_of_a_half(settings));
    search.for_each_sequence(end, ignore_mirrors);
    return;
  }
  RayLauncher<Index> launcher(tracer, {rays, settings.max_reflections, settings.max_transmissions});
  launcher.note_edges(reach, settings.edges, detail::most_mirrors_of_a_half(settings));
  launcher.for_each_sequence(end, launch_rotation(settings.seed, key.id, key.frame), ignore_mirrors);
  counters.rays += launcher.rays();
  counters.solver.traversal += launcher.traversal();
  detail::look_from_edges(tracer, settings, end, key.frame, rays, reach, counters);
}

}  // namespace dcem
