#pragma once
/// The noise that a receiver adds to what it receives.
#include <cmath>
#include <stdexcept>

#include "dcem/core/constants.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

struct NoiseSettings {
  double bandwidth_hz = 1e6;     ///< noise bandwidth of the receiver, above 0, at most 1e12
  double noise_figure_db = 0.0;  ///< 0…100
  double temperature_k = 290.0;  ///< of the antenna and its surroundings, above 0, at most 1e6
};

/// Throws std::invalid_argument, naming the field, where a value is out of range.
inline void validate(const NoiseSettings& noise) {
  const auto check = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  check(noise.bandwidth_hz > 0.0 && noise.bandwidth_hz <= 1e12,
        "bandwidth_hz: expected a number above 0, at most 1e12");
  check(noise.noise_figure_db >= 0.0 && noise.noise_figure_db <= 100.0, "noise_figure_db: expected 0 to 100");
  check(noise.temperature_k > 0.0 && noise.temperature_k <= 1e6,
        "temperature_k: expected a number above 0, at most 1e6");
}

/// Noise power at the receiver's input, N = k·T·B·F, in dBm: k Boltzmann's constant, T `temperature_k`, B
/// `bandwidth_hz`, F the noise figure as a ratio. Source: H. T. Friis, Noise figures of radio receivers, Proc. IRE 32,
/// 1944, with T in the place of his 290 K.
inline double noise_power_dbm(const NoiseSettings& noise) {
  const double power_w = boltzmann_constant_j_per_k * noise.temperature_k * noise.bandwidth_hz;
  return watt_to_dbm(power_w) + noise.noise_figure_db;
}

}  // namespace dcem
