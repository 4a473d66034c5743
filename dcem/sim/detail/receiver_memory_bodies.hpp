#pragma once
/// Bodies of receiver_memory.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/receiver_memory.hpp"

namespace dcem::detail {

DCEM_INLINE void LinkMemory::keep(const LinkResult& now) {
  if (result == nullptr) {
    result = std::make_unique<LinkResult>(now);
    paths.clear();
  } else {
    *result = now;
  }
}

DCEM_INLINE void LinkMemory::keep_paths(const LinkResult& now) {
  result.reset();
  paths.assign(now.paths);
}

DCEM_INLINE void LinkMemory::count_births(const LinkResult& now, CacheCounters& counters) const {
  if (result == nullptr) return paths.count_births(now.paths, counters);
  const auto same = [](const PathContribution& one, const PathContribution& other) {
    return same_sequence(one.path, other.path);
  };
  if (!std::ranges::equal(result->paths, now.paths, same)) PathKeys(result->paths).count_births(now.paths, counters);
}

DCEM_INLINE void LinkMemory::forget() {
  result.reset();
  paths.clear();
  standing.forget();
  pooled.reset();
}

DCEM_INLINE std::size_t path_count(std::span<const LinkMemory> links) {
  std::size_t count = 0;
  for (const LinkMemory& link : links) count += link.path_count();
  return count;
}

DCEM_INLINE std::size_t ReceiverMemory::select(std::span<const std::uint32_t> transmitters, std::size_t count) {
  if (transmitters.empty() && numbers.empty() && count > 0) {
    links.resize(count);
    return 0;
  }
  if (links.size() == transmitters.size() && std::ranges::equal(numbers, transmitters)) return 0;
  std::vector<LinkMemory> kept(transmitters.size());
  auto before = numbers.begin();
  for (std::size_t now = 0; now < kept.size(); ++now) {
    before = std::lower_bound(before, numbers.end(), transmitters[now]);
    if (before == numbers.end() || *before != transmitters[now] || links.empty()) continue;
    kept[now] = std::exchange(links[static_cast<std::size_t>(before - numbers.begin())], {});
  }
  const std::size_t gone = path_count(links);  // of those that are kept nothing has stayed behind
  links = std::move(kept);
  numbers.assign(transmitters.begin(), transmitters.end());
  return gone;
}

DCEM_INLINE LinkMemory& ReceiverMemory::link(std::size_t transmitter) {
  if (numbers.empty()) return links[transmitter];
  const auto place = std::lower_bound(numbers.begin(), numbers.end(), transmitter);
  return links[static_cast<std::size_t>(place - numbers.begin())];
}

DCEM_INLINE void ReceiverMemory::forget_views() {
  half.forget();
  forget_pools();
  for (LinkMemory& link : links) link.standing.forget();
}

DCEM_INLINE void ReceiverMemory::forget_pools() {
  for (LinkMemory& link : links) link.pooled.reset();
}

DCEM_INLINE void ReceiverMemory::forget_frame() {
  state.reset();
  end.reset();
  links.clear();
  numbers.clear();
  half.forget_bodies();
}

DCEM_INLINE void ReceiverMemory::forget() {
  forget_frame();
  half.forget();
}

DCEM_INLINE bool same_bits(const std::optional<LinkEnd>& before, const LinkEnd& now) {
  return before == now && same_bits(before->position_m, now.position_m);
}

DCEM_INLINE bool same_bits(const std::optional<DeviceState>& before, const DeviceState& now) {
  return before == now && same_bits(before->position_m, now.position_m) &&
         same_bits(before->velocity_mps, now.velocity_mps) && same_bits(before->rotation[0], now.rotation[0]) &&
         same_bits(before->rotation[1], now.rotation[1]) && same_bits(before->rotation[2], now.rotation[2]);
}

}  // namespace dcem::detail
