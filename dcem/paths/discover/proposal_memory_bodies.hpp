#pragma once
/// Bodies of proposal_memory.hpp.
#include <cstddef>
#include <cstdint>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/proposal_memory.hpp"

namespace dcem {

DCEM_INLINE bool ProposalMemory::note(const Sequence& sequence) {
  const auto [entry, is_new] = index_.try_emplace(sequence, proposals_.size());
  if (is_new) {
    proposals_.push_back({sequence, frame_});
  } else {
    proposals_[entry->second].last_frame = frame_;
  }
  return !is_new;
}

DCEM_INLINE void ProposalMemory::next_frame(std::uint32_t lifetime_frames) {
  ++frame_;
  const std::size_t forgotten = std::erase_if(
      proposals_, [&](const Proposal& proposal) { return proposal.last_frame + lifetime_frames < frame_; });
  if (forgotten == 0) return;
  index_.clear();
  for (std::size_t index = 0; index < proposals_.size(); ++index) index_.emplace(proposals_[index].sequence, index);
}

}  // namespace dcem
