#pragma once
/// What is remembered of a receiver and its links from frame to frame, where the cache is exact.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/discover/cache_counters.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/memory/pooled_link.hpp"
#include "dcem/paths/memory/standing_link.hpp"
#include "dcem/sim/detail/path_keys.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/verify/same_bits.hpp"

namespace dcem::detail {

/// By how much a device may move from frame to frame so that it pays to know what it may see from anywhere in a place,
/// by measurement in Munich and Bad Hersfeld: where that is joined with what standing transmitters list, once for the
/// place. Sequences over bodies are found anew in each frame, over all that may be seen from the place: among many
/// bodies it pays only for who stays in it for long …
inline double longest_pooled_step_m(std::size_t bodies) {
  return std::min(2.0, 400.0 / static_cast<double>(std::max<std::size_t>(1, bodies)));
}
/// … the same where sequences of three elements are joined, and nobody follows who could take places over …
inline constexpr double longest_step_of_triples_m = 0.75;
/// … and where it is joined anew in each frame.
inline constexpr double longest_step_in_place_m = 0.25;

/// What of its time from scratch a link is spared by the candidates of a place, by measurement in Munich: the less, the
/// farther the receiver moves from frame to frame.
inline double spared_in_place(double step_m) {
  return std::max(0.0, 0.5 - step_m / 3.0);
}

/// What a receiver and a link whose transmitter stands take, by measurement: three views; 7,000 candidates of a place,
/// and those of the next one. Candidates of three elements, 180,000 of a place in Munich, take ten times as much.
inline constexpr double remembered_receiver_bytes = 5e6, remembered_link_bytes = 1e6, remembered_triples_bytes = 1e7;

/// So many places that somebody has come into are known for each receiver: behind ten cars that follow each other at
/// two seconds lie five for each of them.
inline constexpr std::size_t known_places_per_receiver = 6;

/// Of so many transmitters direct paths, 2 µs each, are not kept from one frame in which bodies change to the next: the
/// first frame in which none does solves them once more, and keeps them.
inline constexpr std::size_t very_many_transmitters = 512;

/// One link in the frame before.
struct LinkMemory {
  std::unique_ptr<LinkResult> result;       ///< none: the link was not there, or only `paths` are remembered of it
  PathKeys paths;                           ///< those that it had, where there is no result
  StandingLink<PathContribution> standing;  ///< while both ends stand
  std::unique_ptr<PooledLink> pooled;       ///< while the transmitter stands and the receiver goes through places

  /// All that it brings, which the next frame may take over.
  void keep(const LinkResult& now);
  /// Which paths it has, and no more: the result takes a kilobyte that nobody may read.
  void keep_paths(const LinkResult& now);
  void forget();
  std::size_t path_count() const { return result ? result->paths.size() : paths.size(); }
  /// Counts the paths that it has now and had not, and those that it had.
  void count_births(const LinkResult& now, CacheCounters& counters) const;
};

/// How many paths they had.
std::size_t path_count(std::span<const LinkMemory> links);

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
  LinkMemory& link(std::size_t transmitter);

  /// What the receiver sees, and what is known of its links beyond what they brought in the frame before.
  void forget_views();

  /// The candidates of the places that it was in.
  void forget_pools();

  /// The frame before, of which the next one is not the successor.
  void forget_frame();

  /// All of it: the receiver has left.
  void forget();
};

/// Whether a device is as it was, to the last bit: from a coordinate of −0 follow other signs than from 0.
bool same_bits(const std::optional<LinkEnd>& before, const LinkEnd& now);
bool same_bits(const std::optional<DeviceState>& before, const DeviceState& now);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/receiver_memory_bodies.hpp"
#endif
