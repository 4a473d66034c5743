#pragma once
/// What is remembered of a receiver and its links from frame to frame, where the cache is exact.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/discover/cache_counters.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/memory/pooled_link.hpp"
#include "dcem/paths/memory/standing_link.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/verify/same_bits.hpp"

namespace dcem::detail {

/// By how much a device may move from frame to frame so that it pays to know what it may see from anywhere in a place,
/// by measurement in Munich and Bad Hersfeld: where that is joined with what standing transmitters list, once for the
/// place. Sequences over bodies are found anew in each frame, over all that may be seen from the place: among many
/// bodies it pays only for who stays in it for long …
inline double longest_pooled_step_m(std::size_t bodies) {
  return std::min(2.0, 60.0 / static_cast<double>(std::max<std::size_t>(1, bodies)));
}
/// … the same where sequences of three elements are joined …
inline constexpr double longest_step_of_triples_m = 0.75;
/// … and where it is joined anew in each frame.
inline constexpr double longest_step_in_place_m = 0.25;

/// What a receiver and a link whose transmitter stands take, by measurement: three views; 7,000 candidates of a place,
/// and those of the next one. Candidates of three elements, 180,000 of a place in Munich, take ten times as much.
inline constexpr double remembered_receiver_bytes = 5e6, remembered_link_bytes = 1e6, remembered_triples_bytes = 1e7;

/// One link in the frame before.
struct LinkMemory {
  std::optional<LinkResult> result;         ///< none: the link was not there
  StandingLink<PathContribution> standing;  ///< while both ends stand
  std::unique_ptr<PooledLink> pooled;       ///< while the transmitter stands and the receiver goes through places

  void forget() {
    result.reset();
    standing.forget();
    pooled.reset();
  }
};

/// How many paths they had.
inline std::size_t path_count(std::span<const LinkMemory> links) {
  std::size_t count = 0;
  for (const LinkMemory& link : links) count += link.result ? link.result->paths.size() : 0;
  return count;
}

struct ReceiverMemory {
  std::optional<DeviceState> state;  ///< none: it was not there
  std::optional<LinkEnd> end;
  KeptHalf half;
  std::vector<LinkMemory> links;  ///< by transmitter
  /// The transmitters of `links`, ascending; empty: all of them, as they stand in the scene.
  std::vector<std::uint32_t> numbers;

  /// The links of a frame are those with `transmitters`, or with `count` as they stand in the scene. Returns how many
  /// paths those links had that are no more.
  std::size_t select(std::span<const std::uint32_t> transmitters, std::size_t count);
  /// By the number of the transmitter in the scene; the link must be there.
  LinkMemory& link(std::size_t transmitter) {
    if (numbers.empty()) return links[transmitter];
    const auto place = std::lower_bound(numbers.begin(), numbers.end(), transmitter);
    return links[static_cast<std::size_t>(place - numbers.begin())];
  }

  /// What the receiver sees, and what is known of its links beyond what they brought in the frame before.
  void forget_views() {
    half.forget();
    forget_pools();
    for (LinkMemory& link : links) link.standing.forget();
  }

  /// The candidates of the places that it was in.
  void forget_pools() {
    for (LinkMemory& link : links) link.pooled.reset();
  }

  /// The frame before, of which the next one is not the successor.
  void forget_frame() {
    state.reset();
    end.reset();
    links.clear();
    numbers.clear();
    half.forget_bodies();
  }

  /// All of it: the receiver has left.
  void forget() {
    forget_frame();
    half.forget();
  }
};

inline std::size_t ReceiverMemory::select(std::span<const std::uint32_t> transmitters, std::size_t count) {
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
    kept[now] = std::move(links[static_cast<std::size_t>(before - numbers.begin())]);
  }
  const std::size_t gone = path_count(links);  // of those that are kept nothing has stayed behind
  links = std::move(kept);
  numbers.assign(transmitters.begin(), transmitters.end());
  return gone;
}

/// Whether a device is as it was, to the last bit: from a coordinate of −0 follow other signs than from 0.
inline bool same_bits(const std::optional<LinkEnd>& before, const LinkEnd& now) {
  return before == now && same_bits(before->position_m, now.position_m);
}
inline bool same_bits(const std::optional<DeviceState>& before, const DeviceState& now) {
  return before == now && same_bits(before->position_m, now.position_m) &&
         same_bits(before->velocity_mps, now.velocity_mps) && same_bits(before->rotation[0], now.rotation[0]) &&
         same_bits(before->rotation[1], now.rotation[1]) && same_bits(before->rotation[2], now.rotation[2]);
}

/// Counts the paths that a link has now and had not, and those that it had.
inline void count_births(const std::optional<LinkResult>& before, const LinkResult& now, CacheCounters& counters) {
  const auto same = [](const PathContribution& one, const PathContribution& other) {
    return same_sequence(one.path, other.path);
  };
  if (before && std::ranges::equal(before->paths, now.paths, same)) return;
  const auto keys_of = [](const std::vector<PathContribution>& paths) {
    std::vector<std::uint64_t> keys;
    for (const PathContribution& path : paths) keys.push_back(SequenceHash()(sequence_of(path.path)));
    std::ranges::sort(keys);
    return keys;
  };
  const std::vector<std::uint64_t> old = before ? keys_of(before->paths) : std::vector<std::uint64_t>{};
  const std::vector<std::uint64_t> present = keys_of(now.paths);
  std::vector<std::uint64_t> both;
  std::ranges::set_intersection(old, present, std::back_inserter(both));
  counters.born += present.size() - both.size();
  counters.died += old.size() - both.size();
}

}  // namespace dcem::detail
