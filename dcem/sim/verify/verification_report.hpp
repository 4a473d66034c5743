#pragma once
/// What verifying a simulation showed.
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/field/path_contribution.hpp"

namespace dcem {

/// Shares of the paths that there are; each is 1 where there are none.
struct Recall {
  std::uint64_t paths_there = 0;  ///< paths that exhaustive search finds
  std::uint64_t paths_found = 0;  ///< of these, paths that were reported
  std::uint64_t links = 0;        ///< links that have a path
  double power_share_sum = 0.0;   ///< over these links: the power of the paths found over that of all, both incoherent

  double by_count() const {
    return paths_there > 0 ? static_cast<double>(paths_found) / static_cast<double>(paths_there) : 1.0;
  }
  /// Mean over the links of the share of the power.
  double by_power() const { return links > 0 ? power_share_sum / static_cast<double>(links) : 1.0; }

  Recall& operator+=(const Recall& other) {
    paths_there += other.paths_there;
    paths_found += other.paths_found;
    links += other.links;
    power_share_sum += other.power_share_sum;
    return *this;
  }
};

namespace detail {

bool contains(const std::vector<PathContribution>& paths, const Path& path);

}  // namespace detail

/// The recall of the paths `found` of one link against `all` there are.
Recall recall_of(const std::vector<PathContribution>& found, const std::vector<PathContribution>& all);

/// What the frames checked so far showed.
struct VerificationReport {
  std::uint64_t frames = 0;
  std::uint64_t links = 0;
  std::uint64_t frames_with_other_links = 0;  ///< a link is missing, or there should be none
  std::uint64_t paths = 0;                    ///< reported paths, each solved again
  std::uint64_t paths_different = 0;  ///< of these, paths that came out otherwise or not at all, or are listed twice
  std::uint64_t paths_extra = 0;      ///< found by one discovery, and denied by the exhaustive one
  bool from_scratch = false;          ///< the cache is exact: each link is solved from scratch, too
  std::uint64_t links_different = 0;  ///< of these, links that came out otherwise
  bool compared = false;              ///< the second discovery was possible
  Recall recall;                      ///< of sampled paths; not meaningful otherwise
  std::vector<Recall> recall_by_frame;
  std::vector<std::string> differences;  ///< a line for each of the first ten

  bool passed() const {
    return frames_with_other_links == 0 && paths_different == 0 && paths_extra == 0 && links_different == 0;
  }
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/verify/verification_report_bodies.hpp"
#endif
