#pragma once
/// Diffuse scattering by the effective-roughness model (Degli-Esposti 2001; Degli-Esposti et al., AP-55 2007): what a
/// wall does not reflect as a mirror, because of bricks, windowsills and all else that its plane leaves out.
///
/// A surface element dA that reflects the power fraction |Γ|² scatters the share S² of it, and S alone says how much:
///   dP_s/dΩ = (S·|Γ|)²·p_i·cos θ_i·f_s·dA,  ∫ f_s dΩ = 1 over the half space of the incident wave,
/// with p_i the incident power density in W/m². The mirror keeps √(1 − S²) of its amplitude. S is here the share of the
/// REFLECTED power (the convention of 2011 and of Sionna RT); S of the paper of 2007, relative to the incident field,
/// is S·|Γ| here.
///
/// Patterns f_s in 1/sr, with ψ_R the angle to the mirror's direction, ψ_I that to where the wave came from:
///   lambertian      cos θ_s/π
///   directive       ((1 + cos ψ_R)/2)^α_R / F(α_R)
///   backscattering  [Λ·((1 + cos ψ_R)/2)^α_R + (1 − Λ)·((1 + cos ψ_I)/2)^α_I] / [Λ·F(α_R) + (1 − Λ)·F(α_I)]
/// F(α) = 2^−α·Σ_k C(α, k)·I_k,  I_k = 2π/(k + 1)·{1 for even k;  cos θ_i·Σ_{w ≤ (k−1)/2} C(2w, w)·(sin θ_i/2)^{2w} for
/// odd k}: the integral of the lobe over the half space, AP-55 2007, appendix.
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "dcem/core/constants.hpp"

namespace dcem {

enum class ScatteringPattern : std::uint8_t { lambertian, directive, backscattering };

/// How a surface scatters.
struct Scattering {
  double coefficient = 0.0;  ///< S in 0…1, of amplitudes; 0: a perfect mirror
  ScatteringPattern pattern = ScatteringPattern::lambertian;
  int lobe = 4;                ///< α_R, 1…100: the higher, the narrower; `directive` and `backscattering`
  int back_lobe = 4;           ///< α_I, 1…100; `backscattering`
  double forward_share = 0.5;  ///< Λ in 0…1: weight of the forward lobe; `backscattering`

  friend bool operator==(const Scattering&, const Scattering&) = default;
};

inline constexpr int highest_scattering_lobe = 100;

/// Throws std::invalid_argument where a number is out of the ranges above.
inline void validate(const Scattering& scattering) {
  const auto check = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  const auto is_lobe = [](int lobe) { return lobe >= 1 && lobe <= highest_scattering_lobe; };
  check(scattering.coefficient >= 0.0 && scattering.coefficient <= 1.0, "scattering coefficient must lie in 0 to 1");
  check(is_lobe(scattering.lobe) && is_lobe(scattering.back_lobe), "scattering lobe must lie in 1 to 100");
  check(scattering.forward_share >= 0.0 && scattering.forward_share <= 1.0,
        "forward share of the scattering must lie in 0 to 1");
}

/// √(1 − S²), by which the reflection coefficient of the mirror is reduced.
inline double specular_share(const Scattering& scattering) {
  return std::sqrt((1.0 - scattering.coefficient) * (1.0 + scattering.coefficient));
}

/// F(α) at the head of this file, in sr: ∫ ((1 + cos ψ)/2)^α dΩ over a half space, ψ counted from a direction at the
/// angle θ_i from its axis. `lobe` ≥ 0, `cos_incidence` in 0…1.
inline double scattering_lobe_integral(int lobe, double cos_incidence) {
  const double quarter_sine_squared = 0.25 * (1.0 - cos_incidence) * (1.0 + cos_incidence);
  double sum = 0.0;
  double binomial = std::pow(0.5, lobe);  // C(α, k)/2^α
  double odd_sum = 0.0, odd_term = 1.0;   // Σ C(2w, w)·(sin²θ_i/4)^w up to w = (k − 1)/2
  for (int k = 0; k <= lobe; ++k) {
    const bool odd = k % 2 == 1;
    if (odd) {
      const double w = 0.5 * (k - 1);
      if (k > 1) odd_term *= 2.0 * (2.0 * w - 1.0) / w * quarter_sine_squared;
      odd_sum += odd_term;
    }
    sum += binomial * 2.0 * pi / (k + 1) * (odd ? cos_incidence * odd_sum : 1.0);
    binomial *= static_cast<double>(lobe - k) / (k + 1);
  }
  return sum;
}

/// The cosines on which a pattern depends, all at the scattering point.
struct ScatteringAngles {
  double cos_incidence = 1.0;      ///< of θ_i, above 0
  double cos_scattered = 1.0;      ///< of θ_s, above 0: on the same side as the incident wave
  double cos_from_mirrored = 1.0;  ///< of ψ_R
  double cos_from_incident = 1.0;  ///< of ψ_I
};

namespace detail {

inline double scattering_lobe(int lobe, double cosine) {
  return std::pow(0.5 * std::fmax(0.0, 1.0 + cosine), lobe);
}

}  // namespace detail

/// f_s in 1/sr.
inline double scattering_density_per_sr(const Scattering& scattering, const ScatteringAngles& angles) {
  if (scattering.pattern == ScatteringPattern::lambertian) return angles.cos_scattered / pi;
  const double forward = detail::scattering_lobe(scattering.lobe, angles.cos_from_mirrored);
  const double forward_integral_sr = scattering_lobe_integral(scattering.lobe, angles.cos_incidence);
  if (scattering.pattern == ScatteringPattern::directive) return forward / forward_integral_sr;
  const double share = scattering.forward_share;
  const double back = detail::scattering_lobe(scattering.back_lobe, angles.cos_from_incident);
  const double back_integral_sr = scattering_lobe_integral(scattering.back_lobe, angles.cos_incidence);
  return (share * forward + (1.0 - share) * back) / (share * forward_integral_sr + (1.0 - share) * back_integral_sr);
}

/// An upper bound of f_s in 1/sr where no cosine is larger than these; that of the incidence plays no part.
inline double scattering_density_limit_per_sr(const Scattering& scattering, const ScatteringAngles& largest) {
  if (scattering.pattern == ScatteringPattern::lambertian) return largest.cos_scattered / pi;
  // The integral is smallest at grazing incidence, where half of the lobe is below the surface.
  const double forward = detail::scattering_lobe(scattering.lobe, largest.cos_from_mirrored);
  const double forward_integral_sr = scattering_lobe_integral(scattering.lobe, 0.0);
  if (scattering.pattern == ScatteringPattern::directive) return forward / forward_integral_sr;
  const double share = scattering.forward_share;
  const double back = detail::scattering_lobe(scattering.back_lobe, largest.cos_from_incident);
  const double back_integral_sr = scattering_lobe_integral(scattering.back_lobe, 0.0);
  return (share * forward + (1.0 - share) * back) / (share * forward_integral_sr + (1.0 - share) * back_integral_sr);
}

/// The angle in rad within which f_s changes: that from the axis of the narrowest lobe to where it has fallen to
/// e^{−1/2}, as ((1 + cos ψ)/2)^α ≈ e^{−αψ²/4}; at most 1.
inline double scattering_width_rad(const Scattering& scattering) {
  if (scattering.pattern == ScatteringPattern::lambertian) return 1.0;
  const bool both = scattering.pattern == ScatteringPattern::backscattering;
  const int narrowest = both && scattering.back_lobe > scattering.lobe ? scattering.back_lobe : scattering.lobe;
  return std::fmin(1.0, std::sqrt(2.0 / narrowest));
}

}  // namespace dcem
