#pragma once
/// Bodies of path_keys.hpp.
#include <algorithm>
#include <iterator>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/sim/detail/path_keys.hpp"

namespace dcem::detail {

DCEM_INLINE void PathKeys::assign(std::span<const PathContribution> paths) {
  clear();
  for (const PathContribution& path : paths) {
    const Sequence sequence = sequence_of(path.path);  // transmissions are no part of it
    if (sequence.empty()) {
      has_direct_ = true;
    } else {
      others_.push_back(SequenceHash()(sequence));
    }
  }
  std::ranges::sort(others_);
}

DCEM_INLINE void PathKeys::clear() {
  has_direct_ = false;
  others_.clear();
}

DCEM_INLINE void PathKeys::count_births(std::span<const PathContribution> now, CacheCounters& counters) const {
  const PathKeys present(now);
  std::vector<std::uint64_t> both;
  std::ranges::set_intersection(others_, present.others_, std::back_inserter(both));
  const std::size_t kept = both.size() + (has_direct_ && present.has_direct_ ? 1 : 0);
  counters.born += present.size() - kept;
  counters.died += size() - kept;
}

}  // namespace dcem::detail
