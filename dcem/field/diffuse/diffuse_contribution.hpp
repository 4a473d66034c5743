#pragma once
/// What rough surfaces bring to a link, tile by tile.
#include <cstdint>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/field/power_sample.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

/// What one tile brings.
struct DiffuseContribution {
  PowerSample sample;
  Complex amplitude{};         ///< with seeded phases; otherwise 0
  std::uint32_t triangle = 0;  ///< of the scene; it keeps its number while the scene lives
  std::uint64_t place = 1;     ///< which part of the triangle: 1 is the whole, 2p and 2p + 1 are the halves of p
  Path path;                   ///< one scattering at the tile's centroid; empty unless `DiffuseSettings::list_paths`
};

struct DiffusePower {
  std::vector<DiffuseContribution> tiles;  ///< those that bring power, facet by facet
  double power_ratio = 0.0;                ///< their sum
  double residual_ratio = 0.0;             ///< estimate of what may be missing or too much
  std::uint64_t tiles_evaluated = 0;
  std::uint64_t legs = 0;
  TraversalCounters traversal;
  bool converged = true;  ///< within the tolerance; false where the budget was spent before
};

/// The samples of all tiles.
inline std::vector<PowerSample> power_samples(const DiffusePower& diffuse) {
  std::vector<PowerSample> samples;
  samples.reserve(diffuse.tiles.size());
  for (const DiffuseContribution& tile : diffuse.tiles) samples.push_back(tile.sample);
  return samples;
}

}  // namespace dcem
