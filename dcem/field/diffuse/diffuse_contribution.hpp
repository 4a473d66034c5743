#pragma once
/// What rough surfaces bring to a link, tile by tile.
#include <cstdint>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/field/power_sample.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

/// What one point of a rough surface brings, and the area that it stands for.
struct DiffuseContribution {
  PowerSample sample;
  Complex amplitude{};         ///< with seeded phases; otherwise 0
  std::uint32_t triangle = 0;  ///< of the scene; it keeps its number while the scene lives
  /// Which piece of the triangle the point is in: 1 is the whole, 2p and 2p + 1 are the halves of p. With seeded
  /// phases, or where paths are listed, so small a piece that hardly any other point is in it.
  std::uint64_t place = 1;
  Path path;  ///< one scattering at the point; empty unless `DiffuseSettings::list_paths`
  double area_m2 = 0.0;
};

struct DiffusePower {
  std::vector<DiffuseContribution> tiles;  ///< the points of all tiles that bring power
  double power_ratio = 0.0;                ///< their sum
  double residual_ratio = 0.0;             ///< estimate of what may be missing or too much
  std::uint64_t tiles_evaluated = 0;       ///< of seven points each
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
