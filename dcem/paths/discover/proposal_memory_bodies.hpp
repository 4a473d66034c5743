#pragma once
/// Bodies of proposal_memory.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/proposal_memory.hpp"

namespace dcem {

DCEM_INLINE bool ProposalMemory::note(std::span<const SequenceElement> sequence) {
  if (const auto number = known_.find(sequence)) {
    last_frame_[*number] = frame_;
    return true;
  }
  known_.insert(sequence);
  last_frame_.push_back(frame_);
  return false;
}

DCEM_INLINE void ProposalMemory::next_frame(std::uint32_t lifetime_frames) {
  ++frame_;
  const auto is_old = [&](std::uint64_t last) { return last + lifetime_frames < frame_; };
  if (std::ranges::none_of(last_frame_, is_old)) return;
  kept_.clear();
  for (std::size_t number = 0; number < last_frame_.size(); ++number) {
    if (is_old(last_frame_[number])) continue;
    // One that was appended may be there twice: the later counts.
    const bool is_new = kept_.insert(known_[number]);
    last_frame_[is_new ? kept_.size() - 1 : *kept_.find(known_[number])] = last_frame_[number];
  }
  std::swap(known_, kept_);
  last_frame_.resize(known_.size());
}

}  // namespace dcem
