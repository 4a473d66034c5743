#pragma once
/// One receiver's search in one frame: what was remembered, what a discovery or the caller proposes, what
/// edges join.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/exact_search.hpp"
#include "dcem/paths/discover/half_pairs.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/discover/ray_launcher.hpp"
#include "dcem/paths/discover/search_counters.hpp"
#include "dcem/paths/discover/search_settings.hpp"
#include "dcem/paths/halves/covered.hpp"
#include "dcem/paths/solve/fetch_elements.hpp"
#include "dcem/paths/solve/path_solver.hpp"

namespace dcem {

inline ChainLimits chain_limits(const PathSearchSettings& settings) {
  return {static_cast<std::size_t>(settings.max_reflections), static_cast<std::size_t>(settings.max_diffractions),
          static_cast<std::size_t>(settings.max_interactions), settings.exhaustive};
}

/// The paths between one transmitter and one receiver, in the order of `reported_before`.
struct LinkPaths {
  std::vector<Path> paths;
  bool line_of_sight = false;  ///< the direct segment crosses nothing: the direct path is among the paths
};

/// What turns a sphere of rays: the name of the device that shoots it, and the frame.
struct SphereKey {
  std::string_view id;
  std::size_t frame = 0;
};

namespace detail {

/// How long proposals are tried again: three times the frames in which the few rays of a steady frame add up to a full
/// search. Longer brings nothing (office, six seeds), and each proposal costs a solution per link and frame.
inline std::uint32_t proposal_lifetime_frames(const PathSearchSettings& settings) {
  const std::uint32_t steady = std::max<std::uint32_t>(1, settings.rays_steady);
  return 3 * ((settings.rays + steady - 1) / steady);
}

/// Beside its mirrors a chain has one edge at least.
inline std::size_t most_mirrors_of_a_half(const PathSearchSettings& settings) {
  return static_cast<std::size_t>(std::max(0, std::min(settings.max_reflections, settings.max_interactions - 1)));
}

template <typename Index>
class PathSearch {
 public:
  PathSearch(const SceneTracer<Index>& tracer, const PathSearchSettings& settings, const LinkEnd& receiver,
             std::span<const std::optional<LinkEnd>> transmitters, SearchCounters& counters)
      : tracer_(tracer),
        settings_(settings),
        receiver_(receiver),
        transmitters_(transmitters),
        counters_(counters),
        solver_(tracer, settings.max_transmissions, settings.edges),
        links_(transmitters.size()) {}

  /// Solves what was remembered of each link.
  void revalidate(const PathCache& cache) {
    cache_ = &cache;
    Sequence sequence;
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      const SequenceTable* const remembered = cache.sequences(index);
      if (!transmitters_[index] || remembered == nullptr) continue;
      for (std::size_t number = 0; number < remembered->size(); ++number) {
        sequence.assign((*remembered)[number].begin(), (*remembered)[number].end());
        const bool valid = keep(index, solver_.solve(*transmitters_[index], receiver_, sequence));
        ++counters_.cache.revalidated;
        ++(valid ? counters_.cache.reused : counters_.cache.expired);
      }
    }
  }

  /// Solves every sequence of mirrors there is. Edges within reach take the place of what `reach` holds, where given.
  void search_all(EdgeReach* reach) {
    ExactSearch search(tracer_.scene(), settings_.max_reflections);
    if (reach != nullptr) {
      reach->clear();
      search.note_edges(*reach, settings_.edges, most_mirrors_of_a_half(settings_));
    }
    search.for_each_sequence(
        receiver_, [&](const Sequence& sequence, const std::vector<Vec3>& images_m) { try_all(sequence, images_m); });
  }

  /// Solves the sequences that somebody else proposes, by transmitter.
  void solve_proposed(std::span<const SequenceList> proposed) {
    Sequence sequence;
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      if (!transmitters_[index]) continue;
      const SequenceList& all = proposed[index];
      constexpr std::size_t ahead = 4, soon = 2;
      for (std::size_t number = 0; number < all.size(); ++number) {
        if (number + ahead < all.size()) fetch_elements(tracer_.scene(), all[number + ahead]);
        if (number + soon < all.size()) fetch_faces(tracer_.scene(), all[number + soon]);
        const std::span<const SequenceElement> elements = all[number];
        sequence.assign(elements.begin(), elements.end());
        ++counters_.sequences_proposed;
        if (!is_remembered(index, sequence)) keep(index, solver_.solve(*transmitters_[index], receiver_, sequence));
      }
    }
  }

  /// Solves what rays propose in this frame and, with a memory, what they proposed in the frames before.
  void shoot(const SphereKey& key, std::uint32_t rays, ProposalMemory* memory, EdgeReach* reach) {
    if (memory != nullptr) try_again(*memory);
    RayLauncher<Index> launcher(tracer_, {rays, settings_.max_reflections, settings_.max_transmissions});
    if (reach != nullptr) launcher.note_edges(*reach, settings_.edges, most_mirrors_of_a_half(settings_));
    launcher.for_each_sequence(receiver_, launch_rotation(settings_.seed, key.id, key.frame),
                               [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
                                 if (memory == nullptr || !memory->note(sequence)) try_all(sequence, images_m);
                               });
    if (memory != nullptr) memory->next_frame(proposal_lifetime_frames(settings_));
    counters_.rays += launcher.rays();
    counters_.solver.traversal += launcher.traversal();
  }

  /// Solves every chain that joins what the receiver reaches with what each transmitter reaches.
  void join(ReachedEdges own, std::span<const ReachedEdges> transmitters, JoinRoom& room) {
    ChainLimits limits = chain_limits(settings_);
    limits.few_apart = !settings_.exhaustive;
    ChainJoiner joiner(tracer_.scene(), limits);
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      if (!transmitters_[index]) continue;
      if (limits.few_apart) join_few(index, own, transmitters[index], room);
      if (limits.few_apart && limits.max_diffractions <= 2) continue;
      joiner.for_each_chain(own, transmitters[index], [&](const Sequence& sequence) { try_chain(index, sequence); });
    }
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
  void try_again(const ProposalMemory& memory) {
    std::vector<Vec3> images_m;
    Sequence sequence;
    memory.for_each([&](std::span<const SequenceElement> elements) {
      sequence.assign(elements.begin(), elements.end());
      images_m.assign(1, receiver_.position_m);
      for (const SequenceElement element : sequence) {
        append_image(images_m, tracer_.scene().facet(element.mirror()).plane);
      }
      try_all(sequence, images_m);
    });
  }

  /// Solves mirrors for every transmitter for which they were not remembered.
  void try_all(const Sequence& mirrors, const std::vector<Vec3>& images_m) {
    if (is_joined(mirrors)) return;
    ++counters_.sequences_proposed;
    for (std::size_t index = 0; index < transmitters_.size(); ++index) {
      if (!transmitters_[index] || is_remembered(index, mirrors)) continue;
      keep(index, solver_.solve(*transmitters_[index], receiver_, mirrors, images_m));
    }
  }

  /// Solves the chains over one edge or two of a link.
  void join_few(std::size_t transmitter, ReachedEdges own, ReachedEdges reached, JoinRoom& room) {
    const ChainLimits limits = chain_limits(settings_);
    const ReachingEnd near{receiver_.position_m, own}, far{transmitters_[transmitter]->position_m, reached};
    room.chains.clear();
    room.meetings.join(tracer_.scene(), limits, near, far, room.chains);
    join_edge_pairs(tracer_.scene(), limits, near, far, room.chains, counters_.pairs);
    Sequence chain;
    for (std::size_t number = 0; number < room.chains.size(); ++number) {
      chain.assign(room.chains[number].begin(), room.chains[number].end());
      try_chain(transmitter, chain);
    }
  }

  void try_chain(std::size_t transmitter, const Sequence& chain) {
    if (is_joined(chain)) return;
    ++counters_.sequences_proposed;
    if (!is_remembered(transmitter, chain))
      keep(transmitter, solver_.solve(*transmitters_[transmitter], receiver_, chain));
  }

  /// Whether halves have proposed a sequence, if it may carry a path at all.
  bool is_joined(const Sequence& sequence) const { return halves_cover(settings_.joined, sequence); }

  bool is_remembered(std::size_t transmitter, const Sequence& sequence) const {
    const SequenceTable* const remembered = cache_ != nullptr ? cache_->sequences(transmitter) : nullptr;
    return remembered != nullptr && remembered->contains(sequence);
  }

  bool keep(std::size_t transmitter, std::optional<Path>&& path) {
    if (path) links_[transmitter].paths.push_back(std::move(*path));
    return path.has_value();
  }

  const SceneTracer<Index>& tracer_;
  const PathSearchSettings& settings_;
  const LinkEnd& receiver_;
  std::span<const std::optional<LinkEnd>> transmitters_;
  SearchCounters& counters_;
  PathSolver<Index> solver_;
  std::vector<LinkPaths> links_;
  const PathCache* cache_ = nullptr;  ///< its sequences have been tried; none where nothing was remembered
};

}  // namespace detail

}  // namespace dcem
