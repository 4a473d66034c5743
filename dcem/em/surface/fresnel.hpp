#pragma once
/// Reflection at a plane half space (ITU-R P.2040-3, section 2.2.2), seen from air.
///
/// Signs: with θ from the normal, c = cos θ, η the complex relative permittivity and q = √(η − sin²θ),
///   R_te = (c − q)/(c + q),   R_tm = (η·c − q)/(η·c + q).
/// A perfect conductor has R_te = −1 and R_tm = +1; at normal incidence R_te = −R_tm. Books on optics often print R_tm
/// with the other sign, together with the opposite direction of the reflected parallel vector (see em/dyad.hpp).
#include <algorithm>
#include <cmath>

#include "dcem/core/constants.hpp"
#include "dcem/em/complex.hpp"

namespace dcem {

/// One coefficient (of the field, not of power) for each polarization with respect to the plane of incidence.
struct PolarizedCoefficients {
  Complex te;  ///< electric field perpendicular to the plane of incidence
  Complex tm;  ///< electric field in the plane of incidence

  friend bool operator==(const PolarizedCoefficients&, const PolarizedCoefficients&) = default;
};

/// Reflection of a perfect electric conductor at every angle.
inline PolarizedCoefficients perfect_conductor_reflection() {
  return {-1.0, 1.0};
}

/// Free-space wave number k = 2πf/c in rad/m.
inline double wave_number_rad_per_m(double frequency_hz) {
  return 2.0 * pi * frequency_hz / speed_of_light_mps;
}

/// Free-space wavelength c/f in metres.
inline double wavelength_m(double frequency_hz) {
  return speed_of_light_mps / frequency_hz;
}

/// Complex relative permittivity η = ε' − jσ/(ωε₀) for exp(+jωt): Im η ≤ 0 in a passive medium.
/// `conductivity_s_per_m` σ in S/m, `frequency_hz` > 0. Source: ITU-R P.2040-3, section 2.1, where σ/(ωε₀) is printed
/// as 17.98·σ/f_GHz; here with all digits of ε₀.
inline Complex complex_permittivity(double relative_permittivity, double conductivity_s_per_m, double frequency_hz) {
  const double omega_rad_per_s = 2.0 * pi * frequency_hz;
  return {relative_permittivity, -conductivity_s_per_m / (omega_rad_per_s * vacuum_permittivity_f_per_m)};
}

/// The square root with Im ≤ 0, so that exp(−jk√(…)·z) decays into the medium; on the real axis it is ≥ 0.
inline Complex decaying_square_root(const Complex& value) {
  const Complex root = std::sqrt(value);
  return root.imag() > 0.0 ? -root : root;
}

namespace detail {

/// What both the half space and the slab are made of, for one polarization: r = (outer − inner)/(outer + inner), where
/// `outer` and `inner` are proportional to the wave admittances (TE) or impedances (TM) along the normal in air and in
/// the medium. `difference_of_squares` = outer² − inner², from its factors: subtracting the squares would lose all
/// digits where η is near 1 or the angle near grazing.
struct WaveAlongNormal {
  Complex outer, inner, difference_of_squares;
};

/// The quantities that belong to one angle of incidence.
struct IncidenceTerms {
  Complex normal_wave_number;  ///< q = √(η − sin²θ), in units of the free-space wave number
  WaveAlongNormal te, tm;
};

inline IncidenceTerms incidence_terms(const Complex& permittivity, double cos_incidence) {
  const double cosine = std::clamp(cos_incidence, 0.0, 1.0);
  const Complex contrast = permittivity - 1.0;
  // η − sin²θ written with the contrast: equal to cos²θ without rounding for η = 1.
  const Complex q = decaying_square_root(contrast + cosine * cosine);
  const Complex tm_difference =
      quotient(contrast, permittivity) * quotient((permittivity + 1.0) * (cosine * cosine) - 1.0, permittivity);
  return {q, {cosine, q, -contrast}, {cosine, quotient(q, permittivity), tm_difference}};
}

inline Complex boundary_reflection(const WaveAlongNormal& wave) {
  const Complex sum = wave.outer + wave.inner;
  // Only η = 1 at exact grazing: there is no surface, so nothing comes back.
  if (sum == 0.0) return 0.0;
  return quotient(quotient(wave.difference_of_squares, sum), sum);
}

}  // namespace detail

/// Field reflection coefficients of a half space; formulas and signs at the head of this file.
/// `permittivity` η with Im η ≤ 0 and 0 < |η| ≤ 1e300; `cos_incidence` = |k·n| in 0…1, clamped (rounding).
/// At grazing incidence R_te = R_tm = −1 for any η ≠ 1; η = 1 gives 0 at every angle. Never NaN.
inline PolarizedCoefficients half_space_reflection(const Complex& permittivity, double cos_incidence) {
  const detail::IncidenceTerms terms = detail::incidence_terms(permittivity, cos_incidence);
  return {detail::boundary_reflection(terms.te), detail::boundary_reflection(terms.tm)};
}

}  // namespace dcem
