#pragma once
/// What rays have proposed in the last few frames.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Sequences that rays have proposed lately, whether or not they carried a path. Each is kept for a number of frames
/// after a ray followed it last. While as many come as go it asks for no memory.
class ProposalMemory {
 public:
  /// Notes that a ray followed a sequence; returns whether it is in the memory already.
  bool note(std::span<const SequenceElement> sequence);

  /// Adds a sequence that is known to be new and that no later frame will ask for: the memory is filled once and read.
  void append(std::span<const SequenceElement> sequence) {
    known_.append(sequence);
    last_frame_.push_back(frame_);
  }

  /// Goes on to the next frame and forgets what no ray has followed in the last `lifetime_frames` frames.
  void next_frame(std::uint32_t lifetime_frames);

  /// In the order in which they were first proposed.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t number = 0; number < known_.size(); ++number) visit(known_[number]);
  }

  std::size_t size() const { return known_.size(); }
  std::span<const SequenceElement> operator[](std::size_t number) const { return known_[number]; }
  void clear() {
    known_.clear();
    last_frame_.clear();
  }

 private:
  SequenceTable known_, kept_;             ///< the second is room for those that stay
  std::vector<std::uint64_t> last_frame_;  ///< by number
  std::uint64_t frame_ = 0;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/proposal_memory_bodies.hpp"
#endif
