#pragma once
/// Body of kept_half.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/kept_half.hpp"

namespace dcem {

DCEM_INLINE std::vector<KeptHalf> kept_halves(std::size_t count, int map_pixels) {
  return std::vector<KeptHalf>(count, KeptHalf(map_pixels));
}

}  // namespace dcem
