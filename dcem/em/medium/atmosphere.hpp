#pragma once
/// The air between two devices: gases (ITU-R P.676-13) and rain (ITU-R P.838-3) as a loss on a whole path, the same all
/// along it. A path of length L with the specific attenuation γ in dB/km keeps 10^(−γL/20000) of its field; it is not
/// delayed.
#include <array>
#include <cmath>
#include <cstddef>

#include "dcem/core/constants.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/medium/gas_attenuation.hpp"
#include "dcem/em/medium/rain_attenuation.hpp"

namespace dcem {

/// What the air is made of. No atmosphere at all is a default-constructed AirLoss.
struct Atmosphere {
  bool gas = true;                     ///< oxygen and water vapour attenuate; off: rain alone
  double temperature_k = 288.15;       ///< 150 to 350
  double dry_pressure_hpa = 1013.25;   ///< of the dry air, without the vapour; 0 to 1200
  double water_vapour_g_per_m3 = 7.5;  ///< 0 to 100
  double rain_mm_per_h = 0.0;          ///< 0 to 1000

  friend bool operator==(const Atmosphere&, const Atmosphere&) = default;
};

/// Throws std::invalid_argument that names the field and what is expected, for values outside the ranges written above;
/// those of the air count even where `gas` is off.
inline void validate(const Atmosphere& atmosphere) {
  validate(Air{atmosphere.temperature_k, atmosphere.dry_pressure_hpa, atmosphere.water_vapour_g_per_m3});
  detail::require_within("rain_mm_per_h", atmosphere.rain_mm_per_h, 0.0, max_rain_mm_per_h, "mm/h");
}

/// The losses of one atmosphere at one frequency, prepared once. Default-constructed it takes nothing: every factor is
/// exactly 1, every matrix stays as it is, bit for bit.
///
/// Rain drops are flat, so rain attenuates a horizontal field more than a vertical one, as a rule. The tilt is that of
/// the polarization against the horizontal (0 for φ̂, 90° for θ̂), the elevation that of the path; only its cos² counts,
/// so it does not matter at which end or in which sense it is taken. Lengths are finite and ≥ 0, angles finite, else
/// std::invalid_argument.
class AirLoss {
 public:
  AirLoss() = default;

  /// Throws std::invalid_argument for what validate() refuses, and for a frequency outside 1…1000 GHz where there is
  /// gas or rain.
  AirLoss(const Atmosphere& atmosphere, double frequency_hz);

  /// Nothing attenuates.
  bool is_lossless() const { return gas_db_per_km_ == 0.0 && rain_mm_per_h_ == 0.0; }

  /// Loss of a path in dB, ≥ 0.
  double loss_db(double length_m, double elevation_rad, double tilt_rad) const;

  /// What is left of the field: 10^(−loss/20), in 0…1.
  double amplitude(double length_m, double elevation_rad, double tilt_rad) const {
    return db_to_amplitude_ratio(-loss_db(length_m, elevation_rad, tilt_rad));
  }

  /// What is left of the power of a wave with horizontal and vertical polarization in equal parts and without a fixed
  /// phase between them: the mean of the two power factors.
  double unpolarized_power(double length_m, double elevation_rad) const;

  /// A transfer matrix (rows receive θ̂, φ̂; columns transmit θ̂, φ̂) after the air. `length_m` is the total unfolded
  /// length; the zeniths are those of the directions that point out of the devices.
  ///
  /// A path of several legs has several elevations and turns its polarization at every interaction; which share of the
  /// length belongs to which is not in the matrix. Entry (a, b) therefore takes the mean of two specific attenuations:
  /// that of transmit component b at the elevation of the departure and that of receive component a at the elevation of
  /// the arrival. On a line of sight both are those of the path itself. The two ends enter alike, so the matrix of the
  /// reverse link, with the zeniths exchanged, is the transpose: as it must be in air, which is reciprocal.
  ComplexMatrix2 damped(const ComplexMatrix2& transfer, double length_m, double departure_zenith_rad,
                        double arrival_zenith_rad) const;

 private:
  double gas_db_per_km_ = 0.0;
  double rain_mm_per_h_ = 0.0;
  RainCoefficients rain_;

  /// γ in dB/km for `share` = cos²(elevation)·cos(2·tilt), see eqs. (4) and (5) of P.838.
  double attenuation_db_per_km(double share) const;

  /// γ in dB/km of θ̂ (index 0, tilt 90°) and φ̂ (index 1, tilt 0) in a direction: cos²(elevation) = sin²(zenith).
  std::array<double, 2> component_attenuations_db_per_km(double zenith_rad) const;
};

inline AirLoss::AirLoss(const Atmosphere& atmosphere, double frequency_hz) {
  validate(atmosphere);
  const Air air{atmosphere.temperature_k, atmosphere.dry_pressure_hpa, atmosphere.water_vapour_g_per_m3};
  if (atmosphere.gas) gas_db_per_km_ = gas_attenuation_db_per_km(frequency_hz, air);
  if (atmosphere.rain_mm_per_h == 0.0) return;
  rain_mm_per_h_ = atmosphere.rain_mm_per_h;
  rain_ = rain_coefficients(frequency_hz);
}

inline double AirLoss::attenuation_db_per_km(double share) const {
  if (rain_mm_per_h_ == 0.0) return gas_db_per_km_;
  return gas_db_per_km_ + detail::mixed_rain_power_law(rain_, share).attenuation_db_per_km(rain_mm_per_h_);
}

inline double AirLoss::loss_db(double length_m, double elevation_rad, double tilt_rad) const {
  detail::require_length(length_m);
  detail::require_finite("elevation_rad", elevation_rad);
  detail::require_finite("tilt_rad", tilt_rad);
  const double cosine = std::cos(elevation_rad);
  return attenuation_db_per_km(cosine * cosine * std::cos(2.0 * tilt_rad)) * (length_m / 1000.0);
}

inline double AirLoss::unpolarized_power(double length_m, double elevation_rad) const {
  const double horizontal = db_to_power_ratio(-loss_db(length_m, elevation_rad, 0.0));
  const double vertical = db_to_power_ratio(-loss_db(length_m, elevation_rad, 0.5 * pi));
  return 0.5 * (horizontal + vertical);
}

inline std::array<double, 2> AirLoss::component_attenuations_db_per_km(double zenith_rad) const {
  const double sine = std::sin(zenith_rad);
  return {attenuation_db_per_km(-sine * sine), attenuation_db_per_km(sine * sine)};
}

inline ComplexMatrix2 AirLoss::damped(const ComplexMatrix2& transfer, double length_m, double departure_zenith_rad,
                                      double arrival_zenith_rad) const {
  detail::require_length(length_m);
  detail::require_finite("departure_zenith_rad", departure_zenith_rad);
  detail::require_finite("arrival_zenith_rad", arrival_zenith_rad);
  if (is_lossless()) return transfer;
  const auto transmit_db_per_km = component_attenuations_db_per_km(departure_zenith_rad);
  const auto receive_db_per_km = component_attenuations_db_per_km(arrival_zenith_rad);
  ComplexMatrix2 result;
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t column = 0; column < 2; ++column) {
      const double mean_db_per_km = 0.5 * (transmit_db_per_km[column] + receive_db_per_km[row]);
      result(row, column) = db_to_amplitude_ratio(-mean_db_per_km * (length_m / 1000.0)) * transfer(row, column);
    }
  }
  return result;
}

}  // namespace dcem
