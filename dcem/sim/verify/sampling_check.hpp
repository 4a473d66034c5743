#pragma once
/// What a search by rays lacks, told from some of its links that are searched again, better: exactly where that is
/// offered, otherwise with up to ten times as many rays, which finds most of what is easy to find and so tells the
/// least that is missing. The second search is bounded: it tries some millions of sequences at most, a few seconds.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/sim/frame_result.hpp"
#include "dcem/world/frame.hpp"

namespace dcem {

class Simulator;
struct Device;

/// One link, found by rays and searched again.
struct CheckedLink {
  std::size_t paths_found = 0;  ///< by the rays
  std::size_t paths_there = 0;  ///< by either search
  double missing_db = 0.0;      ///< how much the incoherent power grows with what rays lack; 0 where they found nothing
};

struct SamplingReport {
  bool is_sampled = false;           ///< some kinds of paths are left to rays
  bool exact = false;                ///< the second search misses nothing
  std::uint32_t rays = 0;            ///< of the search that is checked, per receiver
  std::uint32_t rays_steady = 0;     ///< the same in frames that remember those before; 0 where nothing is remembered
  std::uint32_t reference_rays = 0;  ///< of the second search, where it is not exact
  std::vector<CheckedLink> links{};  ///< empty where no second search was made: it may be too long

  /// The share of the paths that rays found; nothing where there are none.
  std::optional<double> recall() const;
  /// The `share` quantile of what links lack, dB, of those on which rays found something; nothing where there are none.
  std::optional<double> missing_db(double share) const;
  /// Links on which rays found nothing although there is a path.
  std::size_t links_not_reached() const;
  /// Adds the links of another check of the same run.
  void add(const SamplingReport& other);
};

/// Links of a simulator's current frame, and how many sequences were proposed for them.
struct SolvedLinks {
  std::span<const Device> receivers;
  std::span<const LinkResult> links;  ///< of these receivers
  std::uint64_t sequences = 0;
};

/// Checks the links of at most `most_receivers` receivers, evenly spread. Makes a second simulator, which needs as much
/// memory as the first one did. Nothing is done where no kind of path is left to rays.
SamplingReport check_sampling(const Simulator& simulator, const Frame& frame, const SolvedLinks& solved,
                              std::size_t most_receivers = 8);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/verify/sampling_check_bodies.hpp"
#endif
