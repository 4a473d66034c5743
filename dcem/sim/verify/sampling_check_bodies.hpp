#pragma once
/// Bodies of sampling_check.hpp.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/core/units.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/search_size.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/sampling_check.hpp"
#include "dcem/sim/verify/verification_report.hpp"

namespace dcem {

namespace detail {

/// An exact search takes up to a second a link in a city with three interactions.
inline constexpr std::size_t most_exact_links = 64;
/// Of the second search. A thread tries about a million in a second.
inline constexpr std::uint64_t most_reference_sequences = 4'000'000;
inline constexpr std::uint64_t most_reference_factor = 10, least_reference_factor = 2;
inline constexpr std::uint64_t most_reference_rays = 100'000'000;

/// How the second search is made.
struct ReferencePlan {
  PropagationSettings propagation;
  std::size_t receivers = 0;
};

/// Whether an exact search is offered and bounded: that from halves is, trying all sequences need not be.
inline bool is_soon_exact(const PropagationSettings& propagation, const Scene& scene, std::size_t links) {
  const SearchPlan plan = plan_search(propagation, scene);
  if (plan.discovery != Discovery::exact) return false;
  return !plan.exhaustive || estimated_sequences(propagation, scene) * static_cast<double>(links) <=
                                 static_cast<double>(most_reference_sequences);
}

/// Many receivers with ten times as many rays, or fewer with fewer; none where even that is too long.
inline ReferencePlan plan_reference(const Simulator& simulator, std::size_t most_receivers,
                                    std::uint64_t sequences_of_one, SamplingReport& report) {
  ReferencePlan plan{simulator.settings().propagation, most_receivers};
  plan.propagation.cache = CacheMode::off;
  plan.propagation.diffuse.enabled = false;
  PropagationSettings by_halves = plan.propagation;
  by_halves.discovery = Discovery::automatic;
  const std::size_t links = most_receivers * simulator.scene().transmitters().size();
  report.exact = links <= most_exact_links && is_soon_exact(by_halves, simulator.scene(), links);
  if (report.exact) {
    plan.propagation = by_halves;
    return plan;
  }
  const std::uint64_t affordable = most_reference_sequences / std::max<std::uint64_t>(1, sequences_of_one);
  const std::uint64_t factor = std::min(affordable, most_reference_factor);
  plan.receivers = factor < least_reference_factor
                       ? 0
                       : static_cast<std::size_t>(std::min<std::uint64_t>(most_receivers, affordable / factor));
  plan.propagation.rays = static_cast<std::uint32_t>(std::min(most_reference_rays, factor * plan.propagation.rays));
  report.reference_rays = plan.propagation.rays;
  return plan;
}

/// Every so many, from the middle of the first part of the list.
inline std::vector<std::size_t> evenly_spread(const std::vector<std::size_t>& list, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(list.size(), most);
  for (std::size_t number = 0; number < count; ++number) {
    chosen.push_back(list[(2 * number + 1) * list.size() / (2 * count)]);
  }
  return chosen;
}

/// By transmitter and receiver.
using LinksByEnds = std::map<std::pair<std::size_t, std::size_t>, const LinkResult*>;

/// The links of some receivers, whose numbers ascend.
inline LinksByEnds links_of(std::span<const LinkResult> links, const std::vector<std::size_t>& receivers) {
  LinksByEnds found;
  for (const LinkResult& link : links) {
    if (!std::binary_search(receivers.begin(), receivers.end(), link.receiver)) continue;
    found.emplace(std::pair(link.transmitter, link.receiver), &link);
  }
  return found;
}

/// Solves some links again, ascending by receiver: `devices` are the receivers whose numbers are `receivers`. What no
/// such link has as its transmitter is not looked from.
inline std::vector<std::pair<const LinkResult*, LinkResult>> solved_again(const Simulator& reference,
                                                                          const LinksByEnds& found,
                                                                          const std::vector<std::size_t>& receivers,
                                                                          const std::vector<Device>& devices) {
  std::vector<std::size_t> numbers;  // of the transmitters, ascending as the links are
  std::vector<Device> transmitters;
  std::vector<LinkRequest> requests;
  for (const auto& [ends, link] : found) {
    if (numbers.empty() || numbers.back() != ends.first) {
      numbers.push_back(ends.first);
      transmitters.push_back(reference.scene().transmitters()[ends.first]);
    }
    const auto receiver = std::lower_bound(receivers.begin(), receivers.end(), ends.second) - receivers.begin();
    requests.push_back({numbers.size() - 1, static_cast<std::size_t>(receiver)});
  }
  std::vector<std::pair<const LinkResult*, LinkResult>> pairs;
  for (LinkResult& again : reference.solve(transmitters, devices, requests)) {
    pairs.emplace_back(found.at({numbers[again.transmitter], receivers[again.receiver]}), std::move(again));
  }
  return pairs;
}

inline CheckedLink checked(const LinkResult& found, const LinkResult& again) {
  CheckedLink link{found.paths.size(), found.paths.size(), 0.0};
  double power_ratio = 0.0, lacking = 0.0;
  for (const PathContribution& path : found.paths) power_ratio += path.power_ratio;
  for (const PathContribution& path : again.paths) {
    if (contains(found.paths, path.path)) continue;
    ++link.paths_there;
    lacking += path.power_ratio;
  }
  if (power_ratio > 0.0) link.missing_db = power_ratio_to_db(1.0 + lacking / power_ratio);
  return link;
}

}  // namespace detail

DCEM_INLINE std::optional<double> SamplingReport::recall() const {
  std::size_t found = 0, there = 0;
  for (const CheckedLink& link : links) found += link.paths_found, there += link.paths_there;
  return there > 0 ? std::optional(static_cast<double>(found) / static_cast<double>(there)) : std::nullopt;
}

DCEM_INLINE std::optional<double> SamplingReport::missing_db(double share) const {
  std::vector<double> missing_db;
  for (const CheckedLink& link : links) {
    if (link.paths_found > 0) missing_db.push_back(link.missing_db);
  }
  return missing_db.empty() ? std::nullopt : std::optional(quantile(std::move(missing_db), share));
}

DCEM_INLINE std::size_t SamplingReport::links_not_reached() const {
  return static_cast<std::size_t>(std::count_if(links.begin(), links.end(), [](const CheckedLink& link) {
    return link.paths_found == 0 && link.paths_there > 0;
  }));
}

DCEM_INLINE void SamplingReport::add(const SamplingReport& other) {
  if (links.empty()) {
    *this = other;
  } else if (other.exact == exact && !other.links.empty()) {
    links.insert(links.end(), other.links.begin(), other.links.end());
    reference_rays = std::min(reference_rays, other.reference_rays);
  }
}

DCEM_INLINE SamplingReport check_sampling(const Simulator& simulator, const Frame& frame, const SolvedLinks& solved,
                                          std::size_t most_receivers) {
  SamplingReport report;
  if (simulator.discovery() == Discovery::exact) return report;
  report.is_sampled = true;
  report.rays = simulator.settings().propagation.rays;
  std::vector<std::size_t> present;
  for (std::size_t index = 0; index < solved.receivers.size(); ++index) {
    if (simulator.is_present(solved.receivers[index])) present.push_back(index);
  }
  if (present.empty() || solved.links.empty()) return report;
  const detail::ReferencePlan plan = detail::plan_reference(simulator, std::min(most_receivers, present.size()),
                                                            solved.sequences / present.size(), report);
  if (plan.receivers == 0) return report;
  const std::vector<std::size_t> chosen = detail::evenly_spread(present, plan.receivers);
  std::vector<Device> devices;
  for (const std::size_t index : chosen) devices.push_back(solved.receivers[index]);
  SimulationSettings settings = simulator.settings();
  settings.propagation = plan.propagation;
  Simulator reference(simulator.scene(), settings);
  reference.move_to(frame);
  const detail::LinksByEnds found = detail::links_of(solved.links, chosen);
  for (const auto& [link, again] : detail::solved_again(reference, found, chosen, devices)) {
    report.links.push_back(detail::checked(*link, again));
  }
  return report;
}

}  // namespace dcem
