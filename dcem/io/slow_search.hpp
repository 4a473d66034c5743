#pragma once
/// A word before a sampled search that takes hours, or does not end.
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace dcem::io {

/// What a sampled search is to do.
struct SampledTask {
  /// Of one link, by the most interactions: `Simulator::estimated_chains`.
  std::span<const double> chains;
  std::size_t links = 1;  ///< of a frame
  std::size_t frames = 1;
};

/// What it would take, and with which max_interactions a link takes no more than a minute. Nothing where one link takes
/// less than a minute of one thread, and all of them less than an hour of one thread.
std::optional<std::string> slow_search_hint(const SampledTask& task);

}  // namespace dcem::io
