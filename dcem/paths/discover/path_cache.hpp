#pragma once
/// What one receiver remembers from frame to frame: which sequences of mirrors carried a path, and which ones rays have
/// proposed lately. Never a point, a length or a gain: those are solved anew in every frame, so nothing that is
/// reported can be stale.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/discover/cache_counters.hpp"
#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/proposal_memory.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// The mirrors and edges of a path, counted from the receiver.
Sequence sequence_of(const Path& path);

/// The memory of one receiver, one list per transmitter. A list is written anew in each frame from the paths of that
/// frame, so what is not found again is forgotten without further ado.
class PathCache {
 public:
  /// The sequences of one link; nothing where there was no link.
  using Link = std::optional<std::vector<Sequence>>;

  /// The sequences that carried a path between the receiver and a transmitter in the frame before; nothing where there
  /// was no such link.
  const Link& sequences(std::size_t transmitter) const {
    static const Link none;
    return transmitter < links_.size() ? links_[transmitter] : none;
  }

  /// Forgets everything, as when the receiver was away; returns how many sequences that were.
  std::size_t clear();

  /// Says which transmitters, ascending, the receiver has links with in the new frame, where that is not all of them:
  /// from here on link n is that of `transmitters[n]`. Forgets the others; returns how many sequences that were.
  std::size_t select(std::span<const std::uint32_t> transmitters);

  ProposalMemory& proposals() { return proposals_; }
  EdgeReach& reach() { return reach_; }

  /// Forgets the sequences for which `gone(element)` holds at any element; returns how many.
  template <typename Gone>
  std::size_t forget(Gone&& gone) {
    std::size_t forgotten = 0;
    for (Link& link : links_) {
      if (!link) continue;
      forgotten += std::erase_if(
          *link, [&](const Sequence& sequence) { return std::any_of(sequence.begin(), sequence.end(), gone); });
    }
    return forgotten;
  }

  /// Starts the lists of a new frame with this many transmitters, none of which has a link yet; returns the old ones.
  std::vector<Link> begin_frame(std::size_t transmitters) {
    return std::exchange(links_, std::vector<Link>(transmitters));
  }

  /// The paths of a link in the new frame.
  void remember(std::size_t transmitter, std::span<const Path> paths);

 private:
  std::vector<Link> links_;
  std::vector<std::uint32_t> transmitters_;  ///< those of `links_`, where they have been selected
  ProposalMemory proposals_;
  EdgeReach reach_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/path_cache_bodies.hpp"
#endif
