#pragma once
/// What a radio engineer reads off one link in one frame.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/field/diffuse/diffuse_contribution.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/field/power_sample.hpp"

namespace dcem {

/// Powers are dBm; a value that is not defined (no path, no line of sight, …) is absent.
struct LinkStatistics {
  bool line_of_sight = false;                   ///< the direct segment crosses nothing
  std::size_t path_count = 0;                   ///< of specular paths
  std::optional<double> power_dbm;              ///< |Σh|² of the specular paths, and the diffuse power
  std::optional<double> power_incoherent_dbm;   ///< Σ|h|², and the diffuse power
  std::optional<double> power_los_dbm;          ///< incoherent, the direct path
  std::optional<double> power_reflected_dbm;    ///< incoherent, paths with a reflection
  std::optional<double> power_transmitted_dbm;  ///< incoherent, paths that only cross sheets
  std::optional<double> power_diffracted_dbm;   ///< incoherent, paths with a diffraction
  std::optional<double> power_diffuse_dbm;      ///< of rough surfaces
  std::optional<double> path_gain_db;           ///< coherent power over transmitted power
  std::optional<double> first_delay_s;
  std::optional<double> mean_delay_s;        ///< Σ P τ / Σ P
  std::optional<double> rms_delay_spread_s;  ///< √(Σ P τ²/Σ P − mean²), τ counted from the first delay
  std::optional<double> k_factor_db;         ///< line of sight over everything else; absent without either
  std::optional<double> azimuth_spread_arrival_rad;
  std::optional<double> azimuth_spread_departure_rad;
  std::optional<double> zenith_spread_arrival_rad;
  std::optional<double> zenith_spread_departure_rad;
  std::optional<double> mean_doppler_hz;        ///< Σ P f / Σ P
  std::optional<double> rms_doppler_spread_hz;  ///< √(Σ P (f − mean)² / Σ P)
};

/// Statistics of one link. `power_dbm` is that of the transmitter; `line_of_sight` says whether the direct segment is
/// free (it may be, while the direct path is not among the paths). Delays, angles and Doppler count diffuse power, too.
LinkStatistics link_statistics(std::span<const PathContribution> paths, double power_dbm, bool line_of_sight,
                               const DiffusePower& diffuse = {});

/// All that brings power: paths, then tiles.
std::vector<PowerSample> power_samples(std::span<const PathContribution> paths, const DiffusePower& diffuse);

namespace detail {

inline std::optional<double> ratio_to_dbm(double power_ratio, double power_dbm) {
  return power_ratio > 0.0 ? std::optional(power_dbm + power_ratio_to_db(power_ratio)) : std::nullopt;
}

}  // namespace detail

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/channel/link_statistics_bodies.hpp"
#endif
