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

/// What is searched for. A link over three mirrors and edges takes a quarter of a second in a city, which is too much
/// for tens of thousands of points: there the third one is looked for by rays, unless `exact` is asked for by name.
enum class SearchedFor { links, maps };

}  // namespace dcem
