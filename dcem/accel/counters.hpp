#pragma once
/// Work counters of tree queries.
#include <cstdint>

namespace dcem {

/// What one or several queries cost. A query adds to what is there, so one object can sum over many rays.
struct TraversalCounters {
  std::uint64_t nodes_visited = 0;      ///< nodes whose box was compared with the query
  std::uint64_t primitives_tested = 0;  ///< calls of the leaf callback

  TraversalCounters& operator+=(const TraversalCounters& other) {
    nodes_visited += other.nodes_visited;
    primitives_tested += other.primitives_tested;
    return *this;
  }
  friend bool operator==(const TraversalCounters&, const TraversalCounters&) = default;
};

}  // namespace dcem
