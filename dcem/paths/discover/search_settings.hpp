#pragma once
/// What one receiver's search looks for, and how.
#include <cstdint>
#include <limits>

#include "dcem/paths/halves/covered.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

struct PathSearchSettings {
  bool exhaustive = true;  ///< all sequences; otherwise those that rays propose
  int max_reflections = 2;
  int max_transmissions = 2;
  std::uint32_t rays = 2000;        ///< launched per receiver and frame where the search is not exhaustive
  std::uint32_t rays_steady = 200;  ///< the same in a frame in which every link is remembered from the frame before
  std::uint64_t seed = 1;
  int max_diffractions = 0;
  int max_interactions = 10;  ///< reflections and diffractions together
  EdgeRules edges{};          ///< which edges diffract
  /// Where the search is not exhaustive: the sequences of up to so many elements that `halves_cover` names are all
  /// proposed by the caller, and rays look for the others alone.
  int joined = 0;
  double max_path_length_m = std::numeric_limits<double>::infinity();  ///< what is longer need not be proposed
};

/// Whether rays have anything to look for.
inline bool needs_rays(const PathSearchSettings& settings) {
  return !settings.exhaustive && !halves_cover(settings.joined, settings.max_diffractions, settings.max_interactions);
}

}  // namespace dcem
