#pragma once
/// Bodies of verification_report.hpp.
#include <algorithm>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/sim/verify/verification_report.hpp"

namespace dcem {

namespace detail {

DCEM_INLINE bool contains(const std::vector<PathContribution>& paths, const Path& path) {
  return std::any_of(paths.begin(), paths.end(),
                     [&](const PathContribution& other) { return same_sequence(other.path, path); });
}

}  // namespace detail

DCEM_INLINE Recall recall_of(const std::vector<PathContribution>& found, const std::vector<PathContribution>& all) {
  Recall recall;
  if (all.empty()) return recall;
  double power_there = 0.0, power_found = 0.0;
  for (const PathContribution& path : all) {
    const bool is_found = detail::contains(found, path.path);
    ++recall.paths_there;
    recall.paths_found += is_found ? 1U : 0U;
    power_there += path.power_ratio;
    power_found += is_found ? path.power_ratio : 0.0;
  }
  recall.links = 1;
  recall.power_share_sum = power_there > 0.0 ? power_found / power_there : 1.0;
  return recall;
}

}  // namespace dcem
