#pragma once
/// What a radio engineer reads off one link in one frame.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/channel/path_contribution.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

/// Powers are dBm; a value that is not defined (no path, no line of sight, …) is absent.
struct LinkStatistics {
  bool line_of_sight = false;  ///< the direct segment crosses nothing
  std::size_t path_count = 0;
  std::optional<double> power_dbm;              ///< coherent: |Σh|²
  std::optional<double> power_incoherent_dbm;   ///< Σ|h|²
  std::optional<double> power_los_dbm;          ///< incoherent, the direct path
  std::optional<double> power_reflected_dbm;    ///< incoherent, paths with a reflection
  std::optional<double> power_transmitted_dbm;  ///< incoherent, paths that only cross sheets
  std::optional<double> power_diffracted_dbm;   ///< incoherent, paths with a diffraction
  std::optional<double> path_gain_db;           ///< coherent power over transmitted power
  std::optional<double> first_delay_s;
  std::optional<double> mean_delay_s;        ///< Σ P τ / Σ P
  std::optional<double> rms_delay_spread_s;  ///< √(Σ P τ²/Σ P − mean²), τ counted from the first delay
  std::optional<double> k_factor_db;         ///< line of sight over everything else; absent without either
  std::optional<double> azimuth_spread_arrival_rad;
  std::optional<double> azimuth_spread_departure_rad;
  std::optional<double> mean_doppler_hz;        ///< Σ P f / Σ P
  std::optional<double> rms_doppler_spread_hz;  ///< √(Σ P (f − mean)² / Σ P)
};

/// Statistics of the paths of one link. `power_dbm` is that of the transmitter; `line_of_sight` says whether the direct
/// segment is free (it may be, while the direct path is not among the paths).
LinkStatistics link_statistics(std::span<const PathContribution> paths, double power_dbm, bool line_of_sight);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline std::optional<double> ratio_to_dbm(double power_ratio, double power_dbm) {
  return power_ratio > 0.0 ? std::optional(power_dbm + power_ratio_to_db(power_ratio)) : std::nullopt;
}

/// |Σh|², over all ports.
inline double coherent_power_ratio(std::span<const PathContribution> paths) {
  ComplexMatrix2 sum;
  for (const PathContribution& path : paths) sum = sum + path.ports;
  return paths.empty() ? 0.0 : norm_squared(sum) / paths.front().transmit_ports;
}

/// Power-weighted moments of a quantity of the paths.
template <typename Quantity>
double weighted_mean(std::span<const PathContribution> paths, double total, Quantity&& quantity) {
  double sum = 0.0;
  for (const PathContribution& path : paths) sum += path.power_ratio * quantity(path);
  return sum / total;
}

template <typename Quantity>
double weighted_deviation(std::span<const PathContribution> paths, double total, double mean, Quantity&& quantity) {
  const auto squared = [&](const PathContribution& path) {
    const double difference = quantity(path) - mean;
    return difference * difference;
  };
  return std::sqrt(weighted_mean(paths, total, squared));
}

/// Circular spread √(−2 ln|Σ P e^{ja}/Σ P|). Source: 3GPP TR 38.901, Annex A.
template <typename Angle>
double circular_spread_rad(std::span<const PathContribution> paths, double total, Angle&& angle) {
  const double c = weighted_mean(paths, total, [&](const PathContribution& path) { return std::cos(angle(path)); });
  const double s = weighted_mean(paths, total, [&](const PathContribution& path) { return std::sin(angle(path)); });
  const double length = std::clamp(std::hypot(c, s), 1e-300, 1.0);
  return std::sqrt(std::max(0.0, -2.0 * std::log(length)));
}

inline void add_powers(LinkStatistics& statistics, std::span<const PathContribution> paths, double power_dbm) {
  double los = 0.0, reflected = 0.0, transmitted = 0.0, diffracted = 0.0;
  for (const PathContribution& path : paths) {
    const auto has = [&](InteractionKind kind) {
      return std::any_of(path.path.interactions.begin(), path.path.interactions.end(),
                         [&](const Interaction& interaction) { return interaction.kind == kind; });
    };
    (path.path.interactions.empty()      ? los
     : has(InteractionKind::diffraction) ? diffracted
     : has(InteractionKind::reflection)  ? reflected
                                         : transmitted) += path.power_ratio;
  }
  const double rest = reflected + transmitted + diffracted;
  const double total = los + rest;
  statistics.power_incoherent_dbm = ratio_to_dbm(total, power_dbm);
  statistics.power_los_dbm = ratio_to_dbm(los, power_dbm);
  statistics.power_reflected_dbm = ratio_to_dbm(reflected, power_dbm);
  statistics.power_transmitted_dbm = ratio_to_dbm(transmitted, power_dbm);
  if (los > 0.0 && rest > 0.0) statistics.k_factor_db = power_ratio_to_db(los / rest);
  statistics.power_diffracted_dbm = ratio_to_dbm(diffracted, power_dbm);
  const double coherent = coherent_power_ratio(paths);
  statistics.power_dbm = ratio_to_dbm(coherent, power_dbm);
  if (coherent > 0.0) statistics.path_gain_db = power_ratio_to_db(coherent);
}

inline void add_moments(LinkStatistics& statistics, std::span<const PathContribution> paths) {
  double total = 0.0, first_s = paths.front().delay_s;
  for (const PathContribution& path : paths) {
    total += path.power_ratio;
    first_s = std::min(first_s, path.delay_s);
  }
  statistics.first_delay_s = first_s;
  if (!(total > 0.0)) return;
  const auto excess_s = [&](const PathContribution& path) { return path.delay_s - first_s; };
  const auto doppler = [](const PathContribution& path) { return path.doppler_hz; };
  const double mean_excess_s = weighted_mean(paths, total, excess_s);
  const double mean_doppler_hz = weighted_mean(paths, total, doppler);
  statistics.mean_delay_s = first_s + mean_excess_s;
  statistics.rms_delay_spread_s = weighted_deviation(paths, total, mean_excess_s, excess_s);
  statistics.mean_doppler_hz = mean_doppler_hz;
  statistics.rms_doppler_spread_hz = weighted_deviation(paths, total, mean_doppler_hz, doppler);
  statistics.azimuth_spread_arrival_rad =
      circular_spread_rad(paths, total, [](const PathContribution& path) { return path.arrival.azimuth_rad; });
  statistics.azimuth_spread_departure_rad =
      circular_spread_rad(paths, total, [](const PathContribution& path) { return path.departure.azimuth_rad; });
}

}  // namespace detail

inline LinkStatistics link_statistics(std::span<const PathContribution> paths, double power_dbm, bool line_of_sight) {
  LinkStatistics statistics;
  statistics.line_of_sight = line_of_sight;
  statistics.path_count = paths.size();
  if (paths.empty()) return statistics;
  detail::add_powers(statistics, paths, power_dbm);
  detail::add_moments(statistics, paths);
  return statistics;
}

}  // namespace dcem
