#pragma once
/// Bodies of known_pools.hpp.
#include <algorithm>
#include <functional>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/known_pools.hpp"

namespace dcem {

DCEM_INLINE const PlacePools* KnownPools::find(const Place& place, std::size_t transmitter) const {
  const std::size_t at = place_of(place, transmitter);
  return is_of(at, place, transmitter) ? &pools_[at].pools : nullptr;
}

DCEM_INLINE void KnownPools::note(std::size_t transmitter, PlacePools pools) {
  const Place& place = pools.pool->place();
  const std::size_t at = place_of(place, transmitter);
  if (is_of(at, place, transmitter)) {
    pools_[at].pools = std::move(pools);
  } else {
    pools_.insert(pools_.begin() + static_cast<std::ptrdiff_t>(at), {transmitter, std::move(pools)});
  }
}

DCEM_INLINE void KnownPools::keep(const std::function<bool(const Place&, std::size_t)>& keeps) {
  std::erase_if(pools_, [&](const Known& known) { return !keeps(known.pools.pool->place(), known.transmitter); });
}

DCEM_INLINE std::size_t KnownPools::place_of(const Place& place, std::size_t transmitter) const {
  const auto comes_before = [&](const Known& known) {
    const Place* const own = &known.pools.pool->place();
    return own != &place ? std::less<const Place*>()(own, &place) : known.transmitter < transmitter;
  };
  return static_cast<std::size_t>(std::ranges::partition_point(pools_, comes_before) - pools_.begin());
}

}  // namespace dcem
