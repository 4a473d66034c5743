#pragma once
/// Checks the frames of a simulation against solutions that share nothing with it but the scene and the formulas.
///
/// 0. The links are those of the devices that are there, and no path is listed twice or above the declared orders.
/// 1. Every reported path is solved again on its own, from its surfaces, with every triangle asked in turn: no tree, no
///    memory of frames before. It must be the same path to the last bit.
/// 2. Where the scene allows exhaustive search, sampled paths are compared with all paths there are: one that is not
///    among them is invalid, and the share of those found is the recall. Paths found by exhaustive search are compared
///    with those that rays find: rays must find nothing else.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/brute_force.hpp"
#include "dcem/paths/path_id.hpp"
#include "dcem/sim/simulator.hpp"

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
  bool compared = false;              ///< the second discovery was possible
  Recall recall;                      ///< of sampled paths; not meaningful otherwise
  std::vector<Recall> recall_by_frame;
  std::vector<std::string> differences;  ///< a line for each of the first ten

  bool passed() const { return frames_with_other_links == 0 && paths_different == 0 && paths_extra == 0; }
};

/// Follows a simulation frame by frame.
template <SurfaceModel Surface = MaterialTable>
class Verifier {
 public:
  /// With the scene, the settings and the surface model of the simulation.
  Verifier(const Scene& scene, const SimulationSettings& settings, const Surface& surface);

  /// Checks a frame that the simulation has solved.
  void check(const Frame& frame, const FrameResult& result);

  const VerificationReport& report() const { return report_; }

 private:
  static SimulationSettings alone(SimulationSettings settings);
  static SimulationSettings rival(SimulationSettings settings, Discovery discovery);
  bool has_the_links(const FrameResult& result) const;
  bool is_allowed(const LinkResult& link, std::size_t path) const;
  void check_paths(const FrameResult& result);
  void compare(const FrameResult& result, const FrameResult& other);
  void note(const FrameResult& frame, const LinkResult& link, const Path& path, const std::string& what);

  Discovery discovery_;
  Simulator<Surface, BruteForce<double>> alone_;  ///< solves single paths
  std::optional<Simulator<Surface>> rival_;       ///< the other discovery
  VerificationReport report_;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

inline bool same_bits(const Path& a, const Path& b) {
  return same_sequence(a, b) && same_bits(a.length_m, b.length_m) &&
         std::equal(a.foliage.begin(), a.foliage.end(), b.foliage.begin(), b.foliage.end(),
                    [](const FoliageLength& x, const FoliageLength& y) {
                      return x.material == y.material && same_bits(x.length_m, y.length_m);
                    }) &&
         std::equal(a.interactions.begin(), a.interactions.end(), b.interactions.begin(),
                    [](const Interaction& x, const Interaction& y) { return same_bits(x.point_m, y.point_m); });
}

inline bool same_bits(const Complex& a, const Complex& b) {
  return same_bits(a.real(), b.real()) && same_bits(a.imag(), b.imag());
}

inline bool same_bits(const ComplexMatrix2& a, const ComplexMatrix2& b) {
  return same_bits(a(0, 0), b(0, 0)) && same_bits(a(0, 1), b(0, 1)) && same_bits(a(1, 0), b(1, 0)) &&
         same_bits(a(1, 1), b(1, 1));
}

inline bool same_bits(const Direction& a, const Direction& b) {
  return same_bits(a.azimuth_rad, b.azimuth_rad) && same_bits(a.zenith_rad, b.zenith_rad);
}

inline bool same_bits(const ChannelMatrix& a, const ChannelMatrix& b) {
  if (a.rows() != b.rows() || a.columns() != b.columns()) return false;
  for (std::size_t row = 0; row < a.rows(); ++row) {
    for (std::size_t column = 0; column < a.columns(); ++column) {
      if (!same_bits(a(row, column), b(row, column))) return false;
    }
  }
  return true;
}

inline bool same_bits(const PathContribution& a, const PathContribution& b) {
  return same_bits(a.path, b.path) && same_bits(a.transfer, b.transfer) && same_bits(a.ports, b.ports) &&
         same_bits(a.channel, b.channel) && same_bits(a.amplitude, b.amplitude) && a.has_amplitude == b.has_amplitude &&
         a.transmit_ports == b.transmit_ports && same_bits(a.power_ratio, b.power_ratio) &&
         same_bits(a.delay_s, b.delay_s) && same_bits(a.doppler_hz, b.doppler_hz) &&
         same_bits(a.departure, b.departure) && same_bits(a.arrival, b.arrival);
}

inline bool contains(const std::vector<PathContribution>& paths, const Path& path) {
  return std::any_of(paths.begin(), paths.end(),
                     [&](const PathContribution& other) { return same_sequence(other.path, path); });
}

}  // namespace detail

inline Recall recall_of(const std::vector<PathContribution>& found, const std::vector<PathContribution>& all) {
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

template <SurfaceModel Surface>
Verifier<Surface>::Verifier(const Scene& scene, const SimulationSettings& settings, const Surface& surface)
    : discovery_(resolve_discovery(settings.propagation, scene)), alone_(scene, alone(settings), surface) {
  PropagationSettings automatic = settings.propagation;
  automatic.discovery = Discovery::automatic;
  const bool small = resolve_discovery(automatic, scene) == Discovery::exact;
  if (discovery_ == Discovery::exact) {
    rival_.emplace(scene, rival(settings, Discovery::sampled), surface);
  } else if (small) {
    rival_.emplace(scene, rival(settings, Discovery::exact), surface);
  }
  report_.compared = rival_.has_value();
}

template <SurfaceModel Surface>
SimulationSettings Verifier<Surface>::alone(SimulationSettings settings) {
  settings.propagation.discovery = Discovery::sampled;  // of no effect: no search is made
  settings.propagation.cache = CacheMode::off;
  return settings;
}

template <SurfaceModel Surface>
SimulationSettings Verifier<Surface>::rival(SimulationSettings settings, Discovery discovery) {
  settings.propagation.discovery = discovery;
  settings.propagation.cache = CacheMode::off;
  settings.tree_update.policy = TreePolicy::rebuild_always;
  return settings;
}

template <SurfaceModel Surface>
void Verifier<Surface>::check(const Frame& frame, const FrameResult& result) {
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
  if (!rival_) return;
  const FrameResult other = rival_->advance(frame);
  if (complete) compare(result, other);
}

/// By transmitter, then receiver: every pair of devices that are there and are not the same device.
template <SurfaceModel Surface>
bool Verifier<Surface>::has_the_links(const FrameResult& result) const {
  const auto transmitters = alone_.scene().transmitters(), receivers = alone_.scene().receivers();
  auto link = result.links.begin();
  for (std::size_t from = 0; from < transmitters.size(); ++from) {
    for (std::size_t to = 0; to < receivers.size(); ++to) {
      const bool linked = transmitters[from].id != receivers[to].id && alone_.is_present(transmitters[from]) &&
                          alone_.is_present(receivers[to]);
      if (!linked) continue;
      if (link == result.links.end() || link->transmitter != from || link->receiver != to) return false;
      ++link;
    }
  }
  return link == result.links.end();
}

/// Whether a path is within the declared orders and is not listed before.
template <SurfaceModel Surface>
bool Verifier<Surface>::is_allowed(const LinkResult& link, std::size_t path) const {
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
void Verifier<Surface>::check_paths(const FrameResult& result) {
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
void Verifier<Surface>::compare(const FrameResult& result, const FrameResult& other) {
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
void Verifier<Surface>::note(const FrameResult& frame, const LinkResult& link, const Path& path,
                             const std::string& what) {
  if (report_.differences.size() >= 10) return;
  const Scene& scene = alone_.scene();
  report_.differences.push_back("frame " + std::to_string(frame.index) + ", " +
                                scene.transmitters()[link.transmitter].id + " to " +
                                scene.receivers()[link.receiver].id + ": path " + path_id(scene, path) + " " + what);
}

}  // namespace dcem
