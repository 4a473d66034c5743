#pragma once
/// A homogeneous slab between air and air with all its internal reflections (ITU-R P.2040-3, section 2.2.2.2).
///
///   R = r(1 − e^{−2jδ})/(1 − r²e^{−2jδ}),  T = (1 − r²)e^{−jδ}/(1 − r²e^{−2jδ}),  δ = k·d·√(η − sin²θ),
/// with r the half-space coefficient of that polarization, d the thickness, k the free-space wave number.
///
/// Phase reference. R refers to the front face. T above leads from the front to the back face along the normal; a ray
/// tracer draws the wall as one sheet without thickness and counts the whole free-space length of the straight path,
/// which already holds the factor exp(−jkd·cos θ) of that piece. What this header returns as transmission is therefore
/// the insertion coefficient T·exp(+jkd·cos θ).
#include <algorithm>
#include <limits>

#include "dcem/em/surface/fresnel.hpp"

namespace dcem {

/// What a surface does to the two polarizations of an incident wave, as field coefficients. `transmission` is the
/// insertion coefficient with respect to the undisturbed straight path; it is zero for an opaque surface.
struct SurfaceResponse {
  PolarizedCoefficients reflection;
  PolarizedCoefficients transmission;

  friend bool operator==(const SurfaceResponse&, const SurfaceResponse&) = default;
};

namespace detail {

struct SlabCoefficients {
  Complex reflection, transmission;
};

/// The formulas at the head of this file, multiplied through by (outer + inner)², which leaves no pole at grazing:
///   N = (outer² + inner²)(1 − p²) + 2·outer·inner(1 + p²),  R = (outer² − inner²)(1 − p²)/N,  T = 4·outer·inner·p/N,
/// p = e^{−jδ}. Only decaying exponentials occur, so a thick conductor ends in R → r and T → 0.
inline SlabCoefficients slab_coefficients(const WaveAlongNormal& wave, const Complex& one_minus_p_squared,
                                          const Complex& insertion_phasor) {
  const Complex product = wave.outer * wave.inner;
  const Complex squares = wave.outer * wave.outer + wave.inner * wave.inner;
  const Complex denominator = squares * one_minus_p_squared + 2.0 * product * (2.0 - one_minus_p_squared);
  // Nothing there: no contrast at exact grazing, or no thickness.
  if (denominator == 0.0) return {0.0, 1.0};
  return {wave.difference_of_squares * one_minus_p_squared / denominator,
          4.0 * product * insertion_phasor / denominator};
}

}  // namespace detail

/// Reflection and insertion coefficients of a slab.
/// `permittivity` η with Im η ≤ 0 and 0 < |η| ≤ 1e300; `thickness_rad` = k·d ≥ 0, the thickness times the free-space
/// wave number; `cos_incidence` = |k·n| in 0…1, clamped.
/// Without loss |R|² + |T|² = 1, with loss less. Finite for any thickness: where e^{−jδ} underflows the slab is a half
/// space. Never NaN.
inline SurfaceResponse slab_response(const Complex& permittivity, double thickness_rad, double cos_incidence) {
  const double electrical_thickness = std::clamp(thickness_rad, 0.0, std::numeric_limits<double>::max());
  const detail::IncidenceTerms terms = detail::incidence_terms(permittivity, cos_incidence);
  const auto decay = [electrical_thickness](const Complex& relative_wave_number) {
    return Complex(electrical_thickness * relative_wave_number.imag(),
                   -electrical_thickness * relative_wave_number.real());
  };
  const Complex one_minus_p_squared = -exp_minus_one(decay(2.0 * terms.normal_wave_number));
  // e^{−jδ}·e^{+jkd·cos θ} in one step: the difference of two large phases would lose digits.
  const Complex insertion_phasor = decaying_exponential(decay(terms.normal_wave_number - terms.te.outer));
  const auto te = detail::slab_coefficients(terms.te, one_minus_p_squared, insertion_phasor);
  const auto tm = detail::slab_coefficients(terms.tm, one_minus_p_squared, insertion_phasor);
  return {{te.reflection, tm.reflection}, {te.transmission, tm.transmission}};
}

}  // namespace dcem
