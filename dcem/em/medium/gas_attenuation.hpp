#pragma once
/// Attenuation by the gases of the air, line by line: Recommendation ITU-R P.676-13, Annex 1, eqs. (1) to (9).
///   γ = γ_o + γ_w = 0.1820·f·(N″_o + N″_w)   dB/km, f in GHz                                                      (1)
///   N″_o = Σ S·F + N″_D,  N″_w = Σ S·F                                                                            (2)
///   S = a1·1e-7·p·θ³·exp(a2·(1 − θ))   or   b1·1e-1·e·θ^3.5·exp(b2·(1 − θ)),  θ = 300/T                           (3)
///   e = ρ·T/216.7                                                                                                 (4)
/// p is the pressure of the DRY air and e that of the vapour, both in hPa (a barometer shows p + e); T in K, ρ in g/m³.
/// Polarization and direction do not matter. Dispersion by the lines is not modelled. Good from 1 to 1000 GHz.
#include <cmath>

#include "dcem/em/medium/gas_lines.hpp"
#include "dcem/em/surface/range_check.hpp"

namespace dcem {

/// The state of the air; the defaults are the standard ground values of the Recommendation.
struct Air {
  double temperature_k = 288.15;
  double dry_pressure_hpa = 1013.25;
  double water_vapour_g_per_m3 = 7.5;

  friend bool operator==(const Air&, const Air&) = default;
};

inline constexpr double min_gas_frequency_hz = 1e9;
inline constexpr double max_gas_frequency_hz = 1000e9;

/// Throws std::invalid_argument that names the field unless the temperature is 150 to 350 K, the dry pressure 0 to
/// 1200 hPa and the vapour 0 to 100 g/m³. That is all air from the ground to space with a margin: the hottest measured
/// is 330 K, the highest pressure at sea level 1085 hPa, saturated air at 50 °C holds 83 g/m³. In hotter air with much
/// vapour and hardly any oxygen the interference terms would make N″_o negative. Nobody asks whether the vapour would
/// condense.
inline void validate(const Air& air) {
  detail::require_within("temperature_k", air.temperature_k, 150.0, 350.0, "K");
  detail::require_within("dry_pressure_hpa", air.dry_pressure_hpa, 0.0, 1200.0, "hPa");
  detail::require_within("water_vapour_g_per_m3", air.water_vapour_g_per_m3, 0.0, 100.0, "g/m3");
}

/// Partial pressure of the water vapour in hPa, eq. (4): the law of ideal gases.
inline double vapour_pressure_hpa(const Air& air) {
  return air.water_vapour_g_per_m3 * air.temperature_k / 216.7;
}

namespace detail {

/// What the lines depend on: θ = 300 K/T and the two pressures in hPa.
struct GasState {
  double theta, dry_hpa, vapour_hpa;
};

inline GasState gas_state(const Air& air) {
  return {300.0 / air.temperature_k, air.dry_pressure_hpa, vapour_pressure_hpa(air)};
}

/// Shape F of a line at `line` of width Δf and interference correction δ, eq. (5); all frequencies in GHz, Δf > 0.
inline double line_shape(double frequency_ghz, double line_ghz, double width_ghz, double interference) {
  const auto wing = [&](double distance_ghz) {
    return (width_ghz - interference * distance_ghz) / (distance_ghz * distance_ghz + width_ghz * width_ghz);
  };
  return frequency_ghz / line_ghz * (wing(line_ghz - frequency_ghz) + wing(line_ghz + frequency_ghz));
}

/// Δf of an oxygen line in GHz: pressure broadening, eq. (6a), and Zeeman splitting, which rules above the
/// stratosphere, eq. (6b).
inline double line_width_ghz(const OxygenLine& line, const GasState& air) {
  const double pressure_width_ghz =
      line.a3 * 1e-4 * (air.dry_hpa * std::pow(air.theta, 0.8 - line.a4) + 1.1 * air.vapour_hpa * air.theta);
  return std::sqrt(pressure_width_ghz * pressure_width_ghz + 2.25e-6);
}

/// Δf of a line of water vapour in GHz: pressure broadening, eq. (6a), and Doppler broadening, eq. (6b).
inline double line_width_ghz(const WaterVapourLine& line, const GasState& air) {
  const double width_ghz =
      line.b3 * 1e-4 *
      (air.dry_hpa * std::pow(air.theta, line.b4) + line.b5 * air.vapour_hpa * std::pow(air.theta, line.b6));
  const double doppler_squared = 2.1316e-12 * line.frequency_ghz * line.frequency_ghz / air.theta;
  return 0.535 * width_ghz + std::sqrt(0.217 * width_ghz * width_ghz + doppler_squared);
}

/// N″_D: the Debye spectrum of oxygen below 10 GHz and the nitrogen that collisions make absorb above 100 GHz, eq. (8)
/// with the width d of eq. (9). The Debye term is multiplied by d/d, so that it is 0 and not 0/0 without any air.
inline double dry_continuum(double frequency_ghz, const GasState& air) {
  const double d_ghz = 5.6e-4 * (air.dry_hpa + air.vapour_hpa) * std::pow(air.theta, 0.8);
  const double debye = 6.14e-5 * d_ghz / (d_ghz * d_ghz + frequency_ghz * frequency_ghz);
  const double nitrogen =
      1.4e-12 * air.dry_hpa * std::pow(air.theta, 1.5) / (1.0 + 1.9e-5 * std::pow(frequency_ghz, 1.5));
  return frequency_ghz * air.dry_hpa * air.theta * air.theta * (debye + nitrogen);
}

/// N″_o, eq. (2) with the strengths of eq. (3) and the interference correction δ of eq. (7).
inline double oxygen_refractivity(double frequency_ghz, const GasState& air) {
  double sum = 0.0;
  for (const OxygenLine& line : oxygen_lines) {
    const double strength =
        line.a1 * 1e-7 * air.dry_hpa * (air.theta * air.theta * air.theta) * std::exp(line.a2 * (1.0 - air.theta));
    const double interference =
        (line.a5 + line.a6 * air.theta) * 1e-4 * (air.dry_hpa + air.vapour_hpa) * std::pow(air.theta, 0.8);
    sum += strength * line_shape(frequency_ghz, line.frequency_ghz, line_width_ghz(line, air), interference);
  }
  return sum + dry_continuum(frequency_ghz, air);
}

/// N″_w, eq. (2) with the strengths of eq. (3); lines of water vapour do not interfere, δ = 0.
inline double water_vapour_refractivity(double frequency_ghz, const GasState& air) {
  double sum = 0.0;
  for (const WaterVapourLine& line : water_vapour_lines) {
    const double strength =
        line.b1 * 1e-1 * air.vapour_hpa * std::pow(air.theta, 3.5) * std::exp(line.b2 * (1.0 - air.theta));
    sum += strength * line_shape(frequency_ghz, line.frequency_ghz, line_width_ghz(line, air), 0.0);
  }
  return sum;
}

/// Frequency in GHz of arguments that eq. (1) is good for, else std::invalid_argument.
inline double checked_gas_frequency_ghz(double frequency_hz, const Air& air) {
  require_within("frequency of the attenuation by gases (ITU-R P.676)", frequency_hz / 1e9, min_gas_frequency_hz / 1e9,
                 max_gas_frequency_hz / 1e9, "GHz");
  validate(air);
  return frequency_hz / 1e9;
}

}  // namespace detail

/// γ_o in dB/km: oxygen's lines and the continuum of dry air, ≥ 0. `frequency_hz` in 1…1000 GHz (closed) and `air` as
/// validate() wants it, else std::invalid_argument.
inline double oxygen_attenuation_db_per_km(double frequency_hz, const Air& air = {}) {
  const double frequency_ghz = detail::checked_gas_frequency_ghz(frequency_hz, air);
  return 0.1820 * frequency_ghz * detail::oxygen_refractivity(frequency_ghz, detail::gas_state(air));
}

/// γ_w in dB/km: water vapour, ≥ 0, and 0 where there is none. Arguments as for oxygen_attenuation_db_per_km.
inline double water_vapour_attenuation_db_per_km(double frequency_hz, const Air& air = {}) {
  const double frequency_ghz = detail::checked_gas_frequency_ghz(frequency_hz, air);
  return 0.1820 * frequency_ghz * detail::water_vapour_refractivity(frequency_ghz, detail::gas_state(air));
}

/// γ = γ_o + γ_w in dB/km, eq. (1). Arguments as for oxygen_attenuation_db_per_km.
inline double gas_attenuation_db_per_km(double frequency_hz, const Air& air = {}) {
  return oxygen_attenuation_db_per_km(frequency_hz, air) + water_vapour_attenuation_db_per_km(frequency_hz, air);
}

}  // namespace dcem
