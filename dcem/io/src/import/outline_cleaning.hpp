#pragma once
/// What is mended in a ring before anybody asks what it encloses. Private to dcem::io.
#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

struct RingCleaning {
  bool had_repeats = false;  ///< corners that stand twice in a row
  bool had_spikes = false;   ///< there and back on one line
};

/// Takes out corners within a millimetre of the one before, and spikes: corners where the ring turns back by all but a
/// degree. Fewer than three corners are left where the ring has no inside.
inline RingCleaning clean_ring(Ring& ring) {
  constexpr double same_m = 1e-3;
  constexpr double spike_cosine = 0.99985;  // of 1°
  RingCleaning found;
  // Ring ends with its first corner in most files: that is no fault.
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  for (std::size_t index = 0; ring.size() >= 3 && index < ring.size();) {
    const std::size_t count = ring.size();
    const Vec2 &before = ring[(index + count - 1) % count], &here = ring[index], &after = ring[(index + 1) % count];
    const double in_m = glm::length(here - before), out_m = glm::length(after - here);
    const bool repeats = in_m < same_m;
    const bool is_spike =
        !repeats && out_m >= same_m && glm::dot(before - here, after - here) > spike_cosine * in_m * out_m;
    if (!repeats && !is_spike) {
      ++index;
      continue;
    }
    // A corner that stands twice once a spike is gone was not found twice.
    found.had_repeats = found.had_repeats || (repeats && !found.had_spikes);
    found.had_spikes = found.had_spikes || is_spike;
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(index));
    index -= std::min<std::size_t>(index, 2);  // a spike may hide another one
  }
  return found;
}

}  // namespace dcem::io
