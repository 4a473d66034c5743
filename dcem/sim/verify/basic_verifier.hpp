#pragma once
/// The verifier of verifier.hpp, for any model of surfaces.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dcem/paths/path_id.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/verify/brute_force_simulator.hpp"
#include "dcem/sim/verify/same_bits.hpp"
#include "dcem/sim/verify/verification_report.hpp"

namespace dcem {

/// Follows a simulation frame by frame.
template <SurfaceModel Surface = MaterialTable>
class BasicVerifier {
 public:
  /// With the scene, the settings and the surface model of the simulation.
  BasicVerifier(const Scene& scene, const SimulationSettings& settings, const Surface& surface);

  /// Checks a frame that the simulation has solved.
  void check(const Frame& frame, const FrameResult& result);

  const VerificationReport& report() const { return report_; }

 private:
  static SimulationSettings alone(SimulationSettings settings);
  static SimulationSettings rival(SimulationSettings settings, Discovery discovery);
  bool has_the_links(const FrameResult& result);
  bool is_allowed(const LinkResult& link, std::size_t path) const;
  void check_paths(const FrameResult& result);
  void check_from_scratch(const FrameResult& result, const FrameResult& expected);
  void compare(const FrameResult& result, const FrameResult& other);
  void note(const FrameResult& frame, const LinkResult& link, const Path& path, const std::string& what);

  Discovery discovery_;
  BasicSimulator<Surface, BruteForceIndex> alone_;  ///< solves single paths
  LinkChoice choice_;
  std::optional<BasicSimulator<Surface>> rival_;      ///< the other discovery
  std::optional<BasicSimulator<Surface>> forgetful_;  ///< where the cache is exact: the same without it
  VerificationReport report_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <SurfaceModel Surface>
BasicVerifier<Surface>::BasicVerifier(const Scene& scene, const SimulationSettings& settings, const Surface& surface)
    : discovery_(resolve_discovery(settings.propagation, scene)),
      alone_(scene, alone(settings), surface),
      choice_(scene, settings.links) {
  PropagationSettings automatic = settings.propagation;
  automatic.discovery = Discovery::automatic;
  const bool small = resolve_discovery(automatic, scene) == Discovery::exact;
  if (discovery_ == Discovery::exact) {
    rival_.emplace(scene, rival(settings, Discovery::sampled), surface);
  } else if (small) {
    rival_.emplace(scene, rival(settings, Discovery::exact), surface);
  }
  report_.compared = rival_.has_value();
  if (resolve_cache(settings.propagation, discovery_) == CacheMode::exact) {
    forgetful_.emplace(scene, rival(settings, settings.propagation.discovery), surface);
  }
  report_.from_scratch = forgetful_.has_value();
}

template <SurfaceModel Surface>
SimulationSettings BasicVerifier<Surface>::alone(SimulationSettings settings) {
  settings.propagation.discovery = Discovery::sampled;  // of no effect: no search is made
  settings.propagation.cache = CacheMode::off;
  return settings;
}

template <SurfaceModel Surface>
SimulationSettings BasicVerifier<Surface>::rival(SimulationSettings settings, Discovery discovery) {
  settings.propagation.discovery = discovery;
  settings.propagation.cache = CacheMode::off;
  settings.tree.policy = TreePolicy::rebuild_always;
  return settings;
}

template <SurfaceModel Surface>
void BasicVerifier<Surface>::check(const Frame& frame, const FrameResult& result) {
  ++report_.frames;
  report_.links += result.links.size();
  alone_.move_to(frame);
  const bool complete = has_the_links(result);
  if (!complete) {
    ++report_.frames_with_other_links;
    if (report_.differences.size() < 10) {
      report_.differences.push_back("frame " + std::to_string(result.index) +
                                    ": the links are not those of its devices");
    }
  }
  check_paths(result);
  if (forgetful_) {
    const FrameResult expected = forgetful_->advance(frame);
    if (complete) check_from_scratch(result, expected);
  }
  if (!rival_) return;
  const FrameResult other = rival_->advance(frame);
  if (complete) compare(result, other);
}

/// By transmitter, then receiver: every pair of devices that are there, that the settings leave and that are not the
/// same device.
template <SurfaceModel Surface>
bool BasicVerifier<Surface>::has_the_links(const FrameResult& result) {
  const auto transmitters = alone_.scene().transmitters(), receivers = alone_.scene().receivers();
  const auto place_of = [&](const Device& device) {
    const DeviceState state = alone_.scene().device_state_now(device, result.time_s);
    return state.present ? std::optional(state.position_m) : std::nullopt;
  };
  std::vector<std::optional<Vec3>> places_m;
  for (const Device& device : transmitters) places_m.push_back(place_of(device));
  choice_.place(places_m);
  std::vector<std::pair<std::size_t, std::size_t>> expected, found;
  for (std::size_t to = 0; to < receivers.size(); ++to) {
    const std::optional<Vec3> place_m = place_of(receivers[to]);
    if (!place_m) continue;
    for (const std::uint32_t from : choice_.transmitters_of(to, *place_m)) expected.emplace_back(from, to);
  }
  std::sort(expected.begin(), expected.end());
  for (const LinkResult& link : result.links) found.emplace_back(link.transmitter, link.receiver);
  return found == expected;
}

/// Whether a path is within the declared orders and is not listed before.
template <SurfaceModel Surface>
bool BasicVerifier<Surface>::is_allowed(const LinkResult& link, std::size_t path) const {
  const Path& own = link.paths[path].path;
  const PropagationSettings& propagation = alone_.settings().propagation;
  const Sequence sequence = sequence_of(own);
  const std::size_t edges = edge_count(sequence);
  if (sequence.size() - edges > static_cast<std::size_t>(reflection_order(propagation)) ||
      edges > static_cast<std::size_t>(diffraction_order(propagation)) ||
      sequence.size() > static_cast<std::size_t>(interaction_order(propagation))) {
    return false;
  }
  return std::none_of(link.paths.begin(), link.paths.begin() + static_cast<std::ptrdiff_t>(path),
                      [&](const PathContribution& other) { return same_sequence(other.path, own); });
}

template <SurfaceModel Surface>
void BasicVerifier<Surface>::check_paths(const FrameResult& result) {
  std::vector<std::vector<bool>> same(result.links.size());
  parallel_for(result.links.size(), alone_.settings().threads, [&](std::size_t index, unsigned) {
    const LinkResult& link = result.links[index];
    for (std::size_t path = 0; path < link.paths.size(); ++path) {
      const PathContribution& reported = link.paths[path];
      const auto again = alone_.solve_path(link.transmitter, link.receiver, sequence_of(reported.path));
      same[index].push_back(again && is_allowed(link, path) && detail::same_bits(*again, reported));
    }
  });
  for (std::size_t index = 0; index < result.links.size(); ++index) {
    const LinkResult& link = result.links[index];
    for (std::size_t path = 0; path < link.paths.size(); ++path) {
      ++report_.paths;
      if (same[index][path]) continue;
      ++report_.paths_different;
      note(result, link, link.paths[path].path, "is another path, or none, when solved on its own, or is there twice");
    }
  }
}

template <SurfaceModel Surface>
void BasicVerifier<Surface>::check_from_scratch(const FrameResult& result, const FrameResult& expected) {
  for (std::size_t index = 0; index < result.links.size(); ++index) {
    const LinkResult &own = result.links[index], &other = expected.links[index];
    if (detail::same_bits(own, other)) continue;
    ++report_.links_different;
    if (report_.differences.size() >= 10) continue;
    const Scene& scene = alone_.scene();
    report_.differences.push_back("frame " + std::to_string(result.index) + ", " +
                                  scene.transmitters()[own.transmitter].id + " to " +
                                  scene.receivers()[own.receiver].id + ": " + std::to_string(own.paths.size()) +
                                  " paths that are not the " + std::to_string(other.paths.size()) + " from scratch");
  }
}

template <SurfaceModel Surface>
void BasicVerifier<Surface>::compare(const FrameResult& result, const FrameResult& other) {
  Recall recall;
  for (std::size_t index = 0; index < result.links.size(); ++index) {
    const bool sampled = discovery_ == Discovery::sampled;
    const LinkResult& link = result.links[index];
    const std::vector<PathContribution>& by_rays = sampled ? link.paths : other.links[index].paths;
    const std::vector<PathContribution>& all = sampled ? other.links[index].paths : link.paths;
    recall += recall_of(by_rays, all);
    for (const PathContribution& path : by_rays) {
      if (detail::contains(all, path.path)) continue;
      ++report_.paths_extra;
      note(result, link, path.path, "is found by rays and not by exhaustive search");
    }
  }
  report_.recall += recall;
  report_.recall_by_frame.push_back(recall);
}

template <SurfaceModel Surface>
void BasicVerifier<Surface>::note(const FrameResult& frame, const LinkResult& link, const Path& path,
                                  const std::string& what) {
  if (report_.differences.size() >= 10) return;
  const Scene& scene = alone_.scene();
  report_.differences.push_back("frame " + std::to_string(frame.index) + ", " +
                                scene.transmitters()[link.transmitter].id + " to " +
                                scene.receivers()[link.receiver].id + ": path " + path_id(scene, path) + " " + what);
}

}  // namespace dcem
