#pragma once
/// Attenuation by rain: Recommendation ITU-R P.838-3 (03/2005).
///   γ_R = k·R^α   dB/km, R in mm/h                                                                                (1)
///   log10 k = Σ a_j·exp(−((log10 f − b_j)/c_j)²) + m·log10 f + c,  α likewise without the logarithm            (2),
///   (3) k = (k_H + k_V + (k_H − k_V)·cos²θ·cos 2τ)/2 (4) α = (k_H·α_H + k_V·α_V + (k_H·α_H − k_V·α_V)·cos²θ·cos
///   2τ)/(2k)                                               (5)
/// f in GHz; θ is the elevation of the path, τ the tilt of the polarization against the horizontal (0: H, 90°: V on a
/// level path; 45°: circular, or equal parts of both). Good from 1 to 1000 GHz; 1000 mm/h is far above what lasts for
/// more than a minute anywhere.
#include <array>
#include <cmath>
#include <cstddef>

#include "dcem/em/surface/range_check.hpp"

namespace dcem {

inline constexpr double min_rain_frequency_hz = 1e9;
inline constexpr double max_rain_frequency_hz = 1000e9;
inline constexpr double max_rain_mm_per_h = 1000.0;

/// k and α of eq. (1): γ_R in dB/km for R in mm/h.
struct RainPowerLaw {
  double k = 0.0;
  double alpha = 1.0;

  /// γ_R in dB/km at `rain_mm_per_h` ≥ 0; 0 without rain.
  double attenuation_db_per_km(double rain_mm_per_h) const { return k * std::pow(rain_mm_per_h, alpha); }
  friend bool operator==(const RainPowerLaw&, const RainPowerLaw&) = default;
};

/// The power laws of the two linear polarizations on a level path, at one frequency.
struct RainCoefficients {
  RainPowerLaw horizontal;
  RainPowerLaw vertical;
};

namespace detail {

/// One of Tables 1 to 4: rows (a, b, c) and the straight line m·log10 f + c.
template <std::size_t term_count>
struct RainRegression {
  std::array<std::array<double, 3>, term_count> terms;
  double slope, offset;

  double operator()(double log_frequency_ghz) const {
    double sum = slope * log_frequency_ghz + offset;
    for (const auto& [a, b, c] : terms) {
      const double distance = (log_frequency_ghz - b) / c;
      sum += a * std::exp(-distance * distance);
    }
    return sum;
  }
};

/// Table 1: log10 k_H.
inline constexpr RainRegression<4> rain_log_k_horizontal{{{{-5.33980, -0.10008, 1.13098},
                                                           {-0.35351, 1.26970, 0.45400},
                                                           {-0.23789, 0.86036, 0.15354},
                                                           {-0.94158, 0.64552, 0.16817}}},
                                                         -0.18961,
                                                         0.71147};
/// Table 2: log10 k_V.
inline constexpr RainRegression<4> rain_log_k_vertical{{{{-3.80595, 0.56934, 0.81061},
                                                         {-3.44965, -0.22911, 0.51059},
                                                         {-0.39902, 0.73042, 0.11899},
                                                         {0.50167, 1.07319, 0.27195}}},
                                                       -0.16398,
                                                       0.63297};
/// Table 3: α_H.
inline constexpr RainRegression<5> rain_alpha_horizontal{{{{-0.14318, 1.82442, -0.55187},
                                                           {0.29591, 0.77564, 0.19822},
                                                           {0.32177, 0.63773, 0.13164},
                                                           {-5.37610, -0.96230, 1.47828},
                                                           {16.1721, -3.29980, 3.43990}}},
                                                         0.67849,
                                                         -1.95537};
/// Table 4: α_V.
inline constexpr RainRegression<5> rain_alpha_vertical{{{{-0.07771, 2.33840, -0.76284},
                                                         {0.56727, 0.95545, 0.54039},
                                                         {-0.20238, 1.14520, 0.26809},
                                                         {-48.2991, 0.791669, 0.116226},
                                                         {48.5833, 0.791459, 0.116479}}},
                                                       -0.053739,
                                                       0.83433};

}  // namespace detail

/// k_H, α_H, k_V and α_V, eqs. (2) and (3). `frequency_hz` in 1…1000 GHz (closed), else std::invalid_argument.
inline RainCoefficients rain_coefficients(double frequency_hz) {
  detail::require_within("frequency of the attenuation by rain (ITU-R P.838)", frequency_hz / 1e9,
                         min_rain_frequency_hz / 1e9, max_rain_frequency_hz / 1e9, "GHz");
  const double log_frequency_ghz = std::log10(frequency_hz / 1e9);
  return {
      {std::pow(10.0, detail::rain_log_k_horizontal(log_frequency_ghz)),
       detail::rain_alpha_horizontal(log_frequency_ghz)},
      {std::pow(10.0, detail::rain_log_k_vertical(log_frequency_ghz)), detail::rain_alpha_vertical(log_frequency_ghz)}};
}

namespace detail {

/// Eqs. (4) and (5) for `share` = cos²θ·cos 2τ in −1…1: 1 is horizontal, −1 vertical.
inline RainPowerLaw mixed_rain_power_law(const RainCoefficients& coefficients, double share) {
  const auto& [horizontal, vertical] = coefficients;
  const double twice_k = horizontal.k + vertical.k + (horizontal.k - vertical.k) * share;
  const double horizontal_product = horizontal.k * horizontal.alpha;
  const double vertical_product = vertical.k * vertical.alpha;
  const double twice_product = horizontal_product + vertical_product + (horizontal_product - vertical_product) * share;
  return {0.5 * twice_k, twice_product / twice_k};
}

}  // namespace detail

/// The power law for a path with elevation θ and a polarization tilted by τ against the horizontal, eqs. (4) and (5).
/// Both angles finite; the sign of the elevation does not matter.
inline RainPowerLaw rain_power_law(const RainCoefficients& coefficients, double elevation_rad, double tilt_rad) {
  const double cosine = std::cos(elevation_rad);
  return detail::mixed_rain_power_law(coefficients, cosine * cosine * std::cos(2.0 * tilt_rad));
}

/// γ_R in dB/km at once. `rain_mm_per_h` in 0…1000 and `frequency_hz` in 1…1000 GHz (closed), both angles finite, else
/// std::invalid_argument.
inline double rain_attenuation_db_per_km(double frequency_hz, double rain_mm_per_h, double elevation_rad,
                                         double tilt_rad) {
  detail::require_within("rain_mm_per_h", rain_mm_per_h, 0.0, max_rain_mm_per_h, "mm/h");
  detail::require_finite("elevation_rad", elevation_rad);
  detail::require_finite("tilt_rad", tilt_rad);
  return rain_power_law(rain_coefficients(frequency_hz), elevation_rad, tilt_rad).attenuation_db_per_km(rain_mm_per_h);
}

}  // namespace dcem
