#pragma once
/// What one receiver remembers from frame to frame: which sequences of mirrors carried a path, and which ones rays have
/// proposed lately. Never a point, a length or a gain: those are solved anew in every frame, so nothing that is
/// reported can be stale.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/discover/cache_counters.hpp"
#include "dcem/paths/discover/edge_meetings.hpp"
#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/discover/proposal_memory.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// The mirrors and edges of a path, counted from the receiver.
void sequence_of(const Path& path, Sequence& sequence);
inline Sequence sequence_of(const Path& path) {
  Sequence sequence;
  sequence_of(path, sequence);
  return sequence;
}

/// Room in which the chains of a link are joined.
struct JoinRoom {
  EdgeMeetings meetings;
  SequenceList chains;
};

/// The memory of one receiver, one list per transmitter. A list is written anew in each frame from the paths of that
/// frame, so what is not found again is forgotten without further ado; its room is that of the list before the last.
class PathCache {
 public:
  /// The sequences that carried a path between the receiver and a transmitter in the last frame; none where there was
  /// no such link.
  const SequenceTable* sequences(std::size_t transmitter) const { return sequences_of(links_, transmitter); }
  /// The same of the frame before, as soon as a new one has begun.
  const SequenceTable* sequences_before(std::size_t transmitter) const { return sequences_of(before_, transmitter); }

  /// Forgets everything, as when the receiver was away; returns how many sequences that were.
  std::size_t clear();

  /// Says which transmitters, ascending, the receiver has links with in the new frame, where that is not all of them:
  /// from here on link n is that of `transmitters[n]`. Forgets the others; returns how many sequences that were.
  std::size_t select(std::span<const std::uint32_t> transmitters);

  ProposalMemory& proposals() { return proposals_; }
  EdgeReach& reach() { return reach_; }
  /// Holds nothing from frame to frame but memory that need not be asked for again.
  JoinRoom& room() { return room_; }

  /// Forgets the sequences for which `gone(element)` holds at any element; returns how many.
  template <typename Gone>
  std::size_t forget(Gone&& gone) {
    std::size_t forgotten = 0;
    for (Link& link : links_) forgotten += forget_in(link, gone);
    return forgotten;
  }

  /// Starts the lists of a new frame with this many transmitters, none of which has a link yet.
  void begin_frame(std::size_t transmitters);

  /// The paths of a link in the new frame.
  void remember(std::size_t transmitter, std::span<const Path> paths);

 private:
  struct Link {
    bool is_there = false;
    SequenceTable sequences;
  };

  static const SequenceTable* sequences_of(std::span<const Link> links, std::size_t transmitter) {
    return transmitter < links.size() && links[transmitter].is_there ? &links[transmitter].sequences : nullptr;
  }
  static std::size_t count_in(std::span<const Link> links);

  template <typename Gone>
  std::size_t forget_in(Link& link, Gone&& gone) {
    if (!link.is_there) return 0;
    const std::size_t before = link.sequences.size();
    link.sequences.erase_if(
        [&](std::span<const SequenceElement> sequence) { return std::any_of(sequence.begin(), sequence.end(), gone); });
    return before - link.sequences.size();
  }

  std::vector<Link> links_, before_;
  std::vector<std::uint32_t> transmitters_;  ///< those of `links_`, where they have been selected
  Sequence sequence_;                        ///< room for one
  ProposalMemory proposals_;
  EdgeReach reach_;
  JoinRoom room_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/path_cache_bodies.hpp"
#endif
