#pragma once
/// What rays have proposed in the last few frames.
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Sequences that rays have proposed lately, whether or not they carried a path. Each is kept for a number of frames
/// after a ray followed it last.
class ProposalMemory {
 public:
  /// Notes that a ray followed a sequence; returns whether it is in the memory already.
  bool note(const Sequence& sequence);

  /// Adds a sequence that is known to be new and that no later frame will ask for: the memory is filled once and read.
  void append(const Sequence& sequence) { proposals_.push_back({sequence, frame_}); }

  /// Goes on to the next frame and forgets what no ray has followed in the last `lifetime_frames` frames.
  void next_frame(std::uint32_t lifetime_frames);

  /// In the order in which they were first proposed.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (const Proposal& proposal : proposals_) visit(proposal.sequence);
  }

  std::size_t size() const { return proposals_.size(); }
  void clear() { *this = {}; }

 private:
  struct Proposal {
    Sequence sequence;
    std::uint64_t last_frame = 0;
  };

  std::vector<Proposal> proposals_;
  std::unordered_map<Sequence, std::size_t, SequenceHash> index_;
  std::uint64_t frame_ = 0;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/proposal_memory_bodies.hpp"
#endif
