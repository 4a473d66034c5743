#pragma once
/// A coverage map: what a receiver would measure at each point of a grid.
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "dcem/channel/link_statistics.hpp"
#include "dcem/core/constants.hpp"
#include "dcem/core/units.hpp"
#include "dcem/scene/device.hpp"

namespace dcem {

struct RadioMapPoint {
  Vec3 position_m{0.0};
  /// Inside a closed object or on a surface: nothing can be measured here, and nothing is reported.
  bool obstructed = false;
  LinkStatistics statistics;
  std::string strongest_kinds;  ///< kinds of the strongest path; empty also for the line of sight
};

/// The map of one transmitter over one grid, row by row (row 0 has the smallest y).
struct RadioMap {
  ReceiverGrid grid;
  std::string transmitter;
  std::vector<RadioMapPoint> points;
};

/// Field strength (rms) that gives an isotropic receiver of gain 1 this power: E = √(4π·Z0·P)/λ, in dB over 1 µV/m.
/// Source: ITU-R P.525-4, section 2 (P = E²/Z0 · λ²/4π).
inline double field_strength_dbuv_per_m(double power_dbm, double frequency_hz) {
  const double wavelength_m = speed_of_light_mps / frequency_hz;
  const double field_v_per_m = std::sqrt(4.0 * pi * free_space_impedance_ohm * dbm_to_watt(power_dbm)) / wavelength_m;
  return amplitude_ratio_to_db(field_v_per_m * 1e6);
}

}  // namespace dcem
