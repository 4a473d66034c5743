#pragma once
/// Books of a search: what was launched, proposed, joined and solved.
#include <cstdint>

#include "dcem/paths/discover/cache_counters.hpp"
#include "dcem/paths/solve/solver_counters.hpp"

namespace dcem {

/// What joining the pairs of two edges took.
struct PairCounters {
  std::uint64_t boxes_asked = 0;  ///< of groups of edges
  std::uint64_t packs_asked = 0;  ///< eight pairs at once
};

struct SearchCounters {
  std::uint64_t rays = 0;
  std::uint64_t sequences_proposed = 0;
  PairCounters pairs;
  SolverCounters solver;
  CacheCounters cache;
};

}  // namespace dcem
