#pragma once
/// How many elements joined sequences have, and how long their paths may be.
#include <limits>

namespace dcem {

/// The most mirrors and edges of a sequence, and the most of both together.
struct JoinOrders {
  int reflections = 2, diffractions = 1, interactions = 2;
  double longest_m = std::numeric_limits<double>::infinity();  ///< sequences of longer paths need not be proposed
};

}  // namespace dcem
