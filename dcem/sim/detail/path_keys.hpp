#pragma once
/// Which paths a link had, in less room than the paths take.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/discover/cache_counters.hpp"

namespace dcem::detail {

/// Sequences by their hashes; the direct path, through sheets or not, which most links of a fleet have and no other,
/// needs none.
class PathKeys {
 public:
  PathKeys() = default;
  explicit PathKeys(std::span<const PathContribution> paths) { assign(paths); }

  void assign(std::span<const PathContribution> paths);
  void clear();
  std::size_t size() const { return others_.size() + (has_direct_ ? 1 : 0); }
  /// Counts the paths that are there `now` and were not, and those that were.
  void count_births(std::span<const PathContribution> now, CacheCounters& counters) const;

 private:
  bool has_direct_ = false;
  std::vector<std::uint64_t> others_;  ///< ascending
};

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/path_keys_bodies.hpp"
#endif
