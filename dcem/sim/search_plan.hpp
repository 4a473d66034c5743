#pragma once
/// What a search can be: exact, or by rays, or both.
#include "dcem/sim/settings.hpp"

namespace dcem {

/// How a scene is searched.
struct SearchPlan {
  Discovery discovery;      ///< exact or sampled: whether every path within the declared orders is found
  bool exhaustive = false;  ///< all sequences are tried: small scenes
  int joined = 0;           ///< sequences of up to so many elements, one edge at most, are all found from halves
};

}  // namespace dcem
