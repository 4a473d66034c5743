#pragma once
/// What a rough surface leaves of its specular reflection, as a real factor on the reflection coefficient. The height
/// is normally distributed with the standard deviation σ_h; g = 2·k·σ_h·cos θ is the spread of the phase in radians.
///   Ament 1953:                  exp(−g²/2)
///   Miller, Brown & Vegh 1984:   exp(−g²/2)·I0(g²/2)
/// The same factor belongs on the reflection inside the diffraction terms of the face's edges, or the field jumps at
/// the reflection boundary; and it stands instead of √(1 − S²) of a diffuse model, not beside it.
#include <cmath>

#include "dcem/core/constants.hpp"

namespace dcem {

/// g for σ_h in metres, k in rad/m and cos θ = |k·n|.
inline double roughness_phase_spread_rad(double wave_number_rad_per_m, double height_deviation_m,
                                         double cos_incidence) {
  return 2.0 * wave_number_rad_per_m * height_deviation_m * cos_incidence;
}

/// Ament's factor, in 0…1; 1 for a smooth surface. Too small beyond g ≈ 2, where Miller & Brown agree with experiment.
inline double ament_factor(double phase_spread_rad) {
  return std::exp(-0.5 * phase_spread_rad * phase_spread_rad);
}

namespace detail {

/// e^{−x}·I0(x) for x ≥ 0: power series, and above 30 the asymptotic series, whose smallest term is e^{−2x}.
inline double scaled_bessel_i0(double x) {
  double term = 1.0;
  double sum = 1.0;
  if (x > 30.0) {
    for (int k = 1; k < 30; ++k) {
      term *= (2.0 * k - 1.0) * (2.0 * k - 1.0) / (8.0 * k * x);
      sum += term;
    }
    return sum / std::sqrt(2.0 * pi * x);
  }
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= 0.25 * x * x / (static_cast<double>(k) * k);
    sum += term;
  }
  return sum * std::exp(-x);
}

}  // namespace detail

/// The factor of Miller, Brown & Vegh, in 0…1. For large g it falls as 1/(g·√π) only.
inline double miller_brown_factor(double phase_spread_rad) {
  return detail::scaled_bessel_i0(0.5 * phase_spread_rad * phase_spread_rad);
}

/// Rayleigh's criterion: σ_h < λ/(8·cos θ), that is g < π/2.
inline bool is_smooth(double phase_spread_rad) {
  return std::abs(phase_spread_rad) < 0.5 * pi;
}

}  // namespace dcem
