#include "dcem/io/slow_search.hpp"

#include <algorithm>

#include "dcem/sim/search_size.hpp"

namespace dcem::io {
namespace {

constexpr double long_link_s = 60.0, long_run_s = 3600.0;

double link_time_s(double chains) {
  return chains / sequences_tried_per_s;
}

/// The largest max_interactions with which a link takes no longer than `most_s`.
std::size_t most_interactions_within(std::span<const double> chains, double most_s) {
  const auto is_longer = [&](double count) { return link_time_s(count) > most_s; };
  const auto first = std::find_if(chains.begin(), chains.end(), is_longer);
  return first == chains.begin() ? 0 : static_cast<std::size_t>(first - chains.begin()) - 1;
}

std::string count_text(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

std::optional<std::string> slow_search_hint(const SampledTask& task) {
  if (task.chains.empty()) return std::nullopt;
  const double link_s = link_time_s(task.chains.back());
  const double links = std::max(1.0, static_cast<double>(task.links) * static_cast<double>(task.frames));
  if (link_s < long_link_s && link_s * links < long_run_s) return std::nullopt;
  const std::size_t most = most_interactions_within(task.chains, std::min(long_link_s, long_run_s / links));
  return "rays propose about " + rough_number(task.chains.back()) + " chains of edges and mirrors for a link: about " +
         rough_duration(link_s) + " of one thread, and " + rough_duration(link_s * links) + " for the " +
         count_text(task.links, "link") + " of " + count_text(task.frames, "frame") +
         "; lower propagation.max_interactions (" + std::to_string(most) + ": about " +
         rough_duration(std::max(1.0, link_time_s(task.chains[most]) * links)) +
         "), max_diffractions or max_reflections";
}

}  // namespace dcem::io
