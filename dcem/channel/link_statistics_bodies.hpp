#pragma once
/// Bodies of link_statistics.hpp.
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "dcem/channel/link_statistics.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem {

DCEM_INLINE std::vector<PowerSample> power_samples(std::span<const PathContribution> paths,
                                                   const DiffusePower& diffuse) {
  std::vector<PowerSample> samples;
  samples.reserve(paths.size() + diffuse.tiles.size());
  for (const PathContribution& path : paths) samples.push_back(power_sample(path));
  for (const DiffuseContribution& tile : diffuse.tiles) samples.push_back(tile.sample);
  return samples;
}

namespace detail {

/// |Σh|² over all ports. Tiles with a phase of their own take part; other diffuse power is added.
inline double coherent_power_ratio(std::span<const PathContribution> paths, const DiffusePower& diffuse) {
  ComplexMatrix2 sum;
  for (const PathContribution& path : paths) sum = sum + path.ports;
  double power = 0.0;
  for (const DiffuseContribution& tile : diffuse.tiles) {
    tile.amplitude != Complex{} ? void(sum(0, 0) += tile.amplitude) : void(power += tile.sample.power_ratio);
  }
  const int transmit_ports = paths.empty() ? 1 : paths.front().transmit_ports;
  return norm_squared(sum) / transmit_ports + power;
}

/// The kind of a path decides which share it belongs to.
struct PowerShares {
  double los = 0.0, reflected = 0.0, transmitted = 0.0, diffracted = 0.0;

  void add(const PathContribution& path) {
    const std::vector<Interaction>& interactions = path.path.interactions;
    const auto has = [&](InteractionKind kind) {
      return std::any_of(interactions.begin(), interactions.end(),
                         [&](const Interaction& at) { return at.kind == kind; });
    };
    (interactions.empty()                ? los
     : has(InteractionKind::diffraction) ? diffracted
     : has(InteractionKind::reflection)  ? reflected
                                         : transmitted) += path.power_ratio;
  }
};

inline void add_powers(LinkStatistics& statistics, std::span<const PathContribution> paths, const DiffusePower& diffuse,
                       double power_dbm) {
  PowerShares shares;
  for (const PathContribution& path : paths) shares.add(path);
  const double rest = shares.reflected + shares.transmitted + shares.diffracted + diffuse.power_ratio;
  statistics.power_incoherent_dbm = ratio_to_dbm(shares.los + rest, power_dbm);
  statistics.power_los_dbm = ratio_to_dbm(shares.los, power_dbm);
  statistics.power_reflected_dbm = ratio_to_dbm(shares.reflected, power_dbm);
  statistics.power_transmitted_dbm = ratio_to_dbm(shares.transmitted, power_dbm);
  statistics.power_diffracted_dbm = ratio_to_dbm(shares.diffracted, power_dbm);
  statistics.power_diffuse_dbm = ratio_to_dbm(diffuse.power_ratio, power_dbm);
  if (shares.los > 0.0 && rest > 0.0) statistics.k_factor_db = power_ratio_to_db(shares.los / rest);
  const double coherent = coherent_power_ratio(paths, diffuse);
  statistics.power_dbm = ratio_to_dbm(coherent, power_dbm);
  if (coherent > 0.0) statistics.path_gain_db = power_ratio_to_db(coherent);
}

inline void add_moments(LinkStatistics& statistics, std::span<const PowerSample> samples) {
  statistics.first_delay_s = first_delay_s(samples);
  const std::optional<PowerMoments> moments = power_moments(samples);
  if (!moments) return;
  statistics.mean_delay_s = moments->mean_delay_s;
  statistics.rms_delay_spread_s = moments->rms_delay_spread_s;
  statistics.mean_doppler_hz = moments->mean_doppler_hz;
  statistics.rms_doppler_spread_hz = moments->rms_doppler_spread_hz;
  statistics.azimuth_spread_arrival_rad = moments->azimuth_spread_arrival_rad;
  statistics.azimuth_spread_departure_rad = moments->azimuth_spread_departure_rad;
  statistics.zenith_spread_arrival_rad = moments->zenith_spread_arrival_rad;
  statistics.zenith_spread_departure_rad = moments->zenith_spread_departure_rad;
}

}  // namespace detail

DCEM_INLINE LinkStatistics link_statistics(std::span<const PathContribution> paths, double power_dbm,
                                           bool line_of_sight, const DiffusePower& diffuse) {
  LinkStatistics statistics;
  statistics.line_of_sight = line_of_sight;
  statistics.path_count = paths.size();
  if (paths.empty() && diffuse.tiles.empty()) return statistics;
  detail::add_powers(statistics, paths, diffuse, power_dbm);
  if (!line_of_sight) statistics.k_factor_db.reset();  // a direct path through foliage is none
  detail::add_moments(statistics, power_samples(paths, diffuse));
  return statistics;
}

}  // namespace dcem
