#pragma once
/// What solving costs, counted.
#include <cstdint>

#include "dcem/accel/counters.hpp"

namespace dcem {

struct SolverCounters {
  std::uint64_t sequences_solved = 0;
  std::uint64_t legs = 0;
  TraversalCounters traversal;

  SolverCounters& operator+=(const SolverCounters& other) {
    sequences_solved += other.sequences_solved;
    legs += other.legs;
    traversal += other.traversal;
    return *this;
  }
};

}  // namespace dcem
