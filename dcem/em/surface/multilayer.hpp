#pragma once
/// A wall of several homogeneous layers between air and air, with all internal reflections: the product of the
/// characteristic (ABCD) matrices of the layers. One layer gives what em/surface/slab.hpp gives.
///
/// A layer of thickness d has δ = k·d·q, q = √(η − sin²θ), and the matrix
///   [cos δ, j·sin δ/v;  j·v·sin δ, cos δ],  v = q (TE), q/η (TM); in air v_0 = cos θ.
/// With (a, b) the two tangential fields, R = (v_0·a − b)/(v_0·a + b) at the front, where (1, v_0) stands at the back.
///
/// Evaluation. Every matrix is divided by e^{jδ}, so only p = e^{−jδ}, which decays, remains: no thickness overflows.
/// With m = 1 − p² and σ = m/2v
///   a → (1 − m/2)·a + σ·b,   b → σ·v²·a + (1 − m/2)·b.
/// Where little is reflected the difference u = v_0·a − b would lose its digits; there it is carried by its own rule,
///   u → σ·(v_0² − v²)·a + (1 − m/2 − σ·v_0)·u.
/// R refers to the front face, T is the insertion coefficient, as in em/surface/slab.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "dcem/em/surface/fresnel.hpp"
#include "dcem/em/surface/slab.hpp"

namespace dcem {

/// One layer of a wall.
struct Layer {
  Complex permittivity;  ///< η, Im η ≤ 0, 0 < |η| ≤ 1e300
  double thickness_rad;  ///< k·d ≥ 0: thickness times free-space wave number

  friend bool operator==(const Layer&, const Layer&) = default;
};

namespace detail {

/// The stack from one layer to the back, for one polarization.
class LayerRecursion {
 public:
  explicit LayerRecursion(double cos_incidence) : air_(cos_incidence), second_(cos_incidence) {}

  /// Puts a layer in front. `sigma` is σ.
  void prepend(const WaveAlongNormal& wave, const Complex& m, const Complex& sigma, const Complex& insertion_phasor) {
    const Complex diagonal = 1.0 - 0.5 * m;
    const Complex first = diagonal * first_ + sigma * second_;
    const Complex carried = sigma * wave.difference_of_squares * first_ + (diagonal - sigma * air_) * reflected_;
    second_ = sigma * wave.inner * wave.inner * first_ + diagonal * second_;
    first_ = first;
    const Complex difference = air_ * first_ - second_;
    const bool digits_lost = std::abs(difference) < 0.01 * std::abs(second_);
    reflected_ = digits_lost ? carried : difference;
    through_ *= insertion_phasor;
    normalize();
  }

  SlabCoefficients result() const {
    const Complex denominator = air_ * first_ + second_;
    // Nothing there: no contrast at exact grazing.
    if (denominator == 0.0) return {0.0, 1.0};
    return {reflected_ / denominator, 2.0 * air_ * through_ / denominator};
  }

 private:
  /// Many layers of great contrast would leave the range of double.
  void normalize() {
    const double size = std::max({std::abs(first_), std::abs(second_), std::abs(reflected_)});
    if (!(size > 1e100)) return;
    first_ /= size;
    second_ /= size;
    reflected_ /= size;
    through_ /= size;
  }

  double air_;
  Complex first_ = 1.0;      // a
  Complex second_;           // b
  Complex reflected_ = 0.0;  // u
  Complex through_ = 1.0;    // product of the insertion phasors
};

/// m/(2q) with m = 1 − exp(−2j·t·q); its limit is j·t where the wave does not move along the normal.
inline Complex half_m_over_wave_number(const Complex& m, const Complex& q, double thickness_rad) {
  return std::abs(q) < 1e-100 ? Complex(0.0, std::min(thickness_rad, 1e100)) : 0.5 * m / q;
}

}  // namespace detail

/// Reflection and insertion coefficients of a stack. `layers` from the front (where the wave comes from) to the back;
/// `cos_incidence` = |k·n| in 0…1, clamped. No layers: nothing there. Without loss |R|² + |T|² = 1. Turned about, a
/// stack has the same T. Finite for any thickness; never NaN.
inline SurfaceResponse multilayer_response(std::span<const Layer> layers, double cos_incidence) {
  const double cosine = std::clamp(cos_incidence, 0.0, 1.0);
  detail::LayerRecursion te(cosine);
  detail::LayerRecursion tm(cosine);
  for (std::size_t i = layers.size(); i-- > 0;) {
    const Complex& eta = layers[i].permittivity;
    const double thickness_rad = std::clamp(layers[i].thickness_rad, 0.0, std::numeric_limits<double>::max());
    const detail::IncidenceTerms terms = detail::incidence_terms(eta, cosine);
    const auto decay = [thickness_rad](const Complex& wave_number) {
      return Complex(thickness_rad * wave_number.imag(), -thickness_rad * wave_number.real());
    };
    const Complex q = terms.normal_wave_number;
    const Complex m = -exp_minus_one(decay(2.0 * q));
    const Complex sigma = detail::half_m_over_wave_number(m, q, thickness_rad);
    // Thickness and air path in one step: the difference of two large phases would lose digits.
    const Complex insertion_phasor = decaying_exponential(decay(q - cosine));
    te.prepend(terms.te, m, sigma, insertion_phasor);
    tm.prepend(terms.tm, m, sigma * eta, insertion_phasor);
  }
  const auto [te_reflection, te_transmission] = te.result();
  const auto [tm_reflection, tm_transmission] = tm.result();
  return {{te_reflection, tm_reflection}, {te_transmission, tm_transmission}};
}

}  // namespace dcem
