#pragma once
/// The four terms of the diffraction coefficient of a wedge (Kouyoumjian & Pathak, Proc. IEEE 62, 1974, eq. 25;
/// McNamara, Pistorius & Malherbe 1990, chapter 6), their derivatives, distance parameters and spreading factors.
///
/// A wedge has the exterior angle nπ, 1 < n ≤ 2. Azimuths about the edge run through the exterior from face 0 (azimuth
/// 0) to face n (azimuth nπ): φ' is where the source stands, φ where the observer stands, as seen from the edge. With
/// P = −e^{−jπ/4}/(2n·√(2πk)·sin β0),
///   D1 = P·cot((π + φ − φ')/2n)·F(k·L·a⁺(φ − φ')),   D2 = P·cot((π − φ + φ')/2n)·F(k·L·a⁻(φ − φ')),
///   D3 = P·cot((π + φ + φ')/2n)·F(k·L·a⁺(φ + φ')),   D4 = P·cot((π − φ − φ')/2n)·F(k·L·a⁻(φ + φ')),
///   a±(b) = 2 cos²(nπN± − b/2),  N± = the integer nearest to (b ± π)/2nπ.
/// D1 and D2 carry the shadow boundary of the direct field, D3 that of the reflection at face n, D4 at face 0.
/// A perfect conductor has D_soft = D1 + D2 − D3 − D4 and D_hard = D1 + D2 + D3 + D4.
///
/// Evaluation. Let δ be the argument of the cotangent less the nearest multiple of π. Then a = 2 sin²(nδ) in all four
/// terms, and cot δ·F(2kL·sin²nδ) = ±√(2kL)·cos δ·(sin nδ/sin δ)·F(x)/√x: nothing grows without bound where the
/// cotangent has its pole. There each term jumps: it has the sign of δ, which is positive on the side where the
/// geometrical field exists. Exactly on a boundary a term has the value of the side without that field, as is right
/// where an edge blocks what touches it.
#include <cmath>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/transition_function.hpp"

namespace dcem {

/// The angles of one diffraction. The edge direction e is that about which azimuths grow (right-hand rule).
struct WedgeAngles {
  double exterior_angle_over_pi;  ///< n, 1 < n ≤ 2
  double incident_azimuth_rad;    ///< φ' in 0…nπ: of the direction from the edge to the source
  double diffracted_azimuth_rad;  ///< φ in 0…nπ: of the direction from the edge to the observer
  double edge_angle_rad;  ///< β0 in (0, π): between e and the propagation direction, the same before and after
};

/// The distance parameter L for each geometrical field. At straight edges of plane faces the three are equal.
struct DistanceParameters {
  double incident_m;     ///< D1 and D2
  double reflected_n_m;  ///< D3
  double reflected_0_m;  ///< D4
};

inline DistanceParameters equal_distances(double distance_parameter_m) {
  return {distance_parameter_m, distance_parameter_m, distance_parameter_m};
}

/// L = s's·sin²β0/(s' + s) of a spherical wave, and of a cylindrical one with distances across the edge and β0 = π/2.
/// `incident_m` s' > 0, infinite for a plane wave; `diffracted_m` s > 0.
inline double spherical_distance_parameter_m(double incident_m, double diffracted_m, double edge_angle_rad) {
  const double sine = std::sin(edge_angle_rad);
  return diffracted_m * sine * sine / (1.0 + diffracted_m / incident_m);
}

/// A = √(ρ_e/(s·(ρ_e + s))) in m^(−1/2): what is left after the distance s of the field at the edge. ρ_e is the radius
/// of curvature of the incident wave front in the plane of edge and ray: s' of a spherical wave, infinite of a plane
/// one and of a cylindrical one whose axis is parallel to the edge.
inline double diffraction_spreading(double edge_plane_radius_m, double diffracted_m) {
  return 1.0 / std::sqrt(diffracted_m * (1.0 + diffracted_m / edge_plane_radius_m));
}

/// The terms D1…D4 in m^(1/2), or one of their derivatives.
struct UtdTerms {
  Complex incident_plus;   ///< D1
  Complex incident_minus;  ///< D2
  Complex reflected_n;     ///< D3
  Complex reflected_0;     ///< D4

  Complex soft() const { return incident_plus + incident_minus - reflected_n - reflected_0; }
  Complex hard() const { return incident_plus + incident_minus + reflected_n + reflected_0; }
};

/// A coefficient with the derivatives that slope diffraction needs.
template <typename Coefficient>
struct WithSlopes {
  Coefficient value;
  Coefficient by_diffracted;  ///< ∂/∂φ, per rad
  Coefficient by_incident;    ///< ∂/∂φ', per rad
  Coefficient by_both;        ///< ∂²/∂φ∂φ', per rad²
};

namespace detail {

/// cot δ·F and what stands for its first and second derivative with respect to δ: −csc²δ·F_s and 2·cot δ·csc²δ·F_c.
struct CotangentTerm {
  Complex value, first, second;
};

/// `argument_rad` is (π ± b)/2n, `wave_distance` is k·L.
inline CotangentTerm cotangent_term(double argument_rad, double wave_distance, double n) {
  const double delta = argument_rad - pi * std::round(argument_rad / pi);
  const double sine_ratio = delta == 0.0 ? n : std::sin(n * delta) / std::sin(delta);
  // √a·√(kL)/|sin δ|: the transition functions are taken without the powers of sin δ that cancel the poles.
  const double scale = std::sqrt(2.0 * wave_distance) * sine_ratio;
  const double root_of_x = scale * std::sin(delta);
  const ReducedTransition reduced = reduced_transition(root_of_x * root_of_x);
  const double signed_cosine = delta > 0.0 ? std::cos(delta) : -std::cos(delta);
  return {signed_cosine * scale * reduced.value, -scale * scale * reduced.slope,
          2.0 * signed_cosine * scale * scale * scale * reduced.curvature};
}

struct CotangentTerms {
  CotangentTerm incident_plus, incident_minus, reflected_n, reflected_0;
};

inline CotangentTerms cotangent_terms(const WedgeAngles& angles, double wave_number_rad_per_m,
                                      const DistanceParameters& distances) {
  const double n = angles.exterior_angle_over_pi;
  const double difference = angles.diffracted_azimuth_rad - angles.incident_azimuth_rad;
  const double sum = angles.diffracted_azimuth_rad + angles.incident_azimuth_rad;
  const auto term = [n, wave_number_rad_per_m](double twice_n_argument, double distance_m) {
    return cotangent_term(twice_n_argument / (2.0 * n), wave_number_rad_per_m * distance_m, n);
  };
  return {term(pi + difference, distances.incident_m), term(pi - difference, distances.incident_m),
          term(pi + sum, distances.reflected_n_m), term(pi - sum, distances.reflected_0_m)};
}

/// P at the head of this file.
inline Complex utd_factor(const WedgeAngles& angles, double wave_number_rad_per_m) {
  const double n = angles.exterior_angle_over_pi;
  DCEM_ASSERT(n > 1.0 && n <= 2.0);
  DCEM_ASSERT(wave_number_rad_per_m > 0.0);
  const double sine = std::sin(angles.edge_angle_rad);
  DCEM_ASSERT(sine > 0.0);
  const double size = 1.0 / (2.0 * n * std::sqrt(2.0 * pi * wave_number_rad_per_m) * sine);
  return Complex(-std::sqrt(0.5), std::sqrt(0.5)) * size;
}

}  // namespace detail

/// D1…D4. `wave_number_rad_per_m` k > 0; distances finite and > 0. Broken preconditions are DCEM_ASSERTs.
inline UtdTerms utd_terms(const WedgeAngles& angles, double wave_number_rad_per_m,
                          const DistanceParameters& distances) {
  const Complex factor = detail::utd_factor(angles, wave_number_rad_per_m);
  const auto terms = detail::cotangent_terms(angles, wave_number_rad_per_m, distances);
  return {factor * terms.incident_plus.value, factor * terms.incident_minus.value, factor * terms.reflected_n.value,
          factor * terms.reflected_0.value};
}

/// D1…D4 with their slopes. As usual in slope diffraction the derivatives are those of the cotangents, with F_s and F_c
/// of em/diffraction/transition_function.hpp in place of F: outside the transition zones they are the derivatives, at a
/// boundary they keep its leading term. What is left out against the derivative of D itself is bounded by (2 +
/// n²)/3·|F_s − F| beside csc²δ.
inline WithSlopes<UtdTerms> utd_terms_with_slopes(const WedgeAngles& angles, double wave_number_rad_per_m,
                                                  const DistanceParameters& distances) {
  const Complex factor = detail::utd_factor(angles, wave_number_rad_per_m);
  const auto [d1, d2, d3, d4] = detail::cotangent_terms(angles, wave_number_rad_per_m, distances);
  // dδ/dφ = +, −, +, − and dδ/dφ' = −, +, +, − times 1/2n.
  const Complex once = factor / (2.0 * angles.exterior_angle_over_pi);
  const Complex twice = once / (2.0 * angles.exterior_angle_over_pi);
  return {{factor * d1.value, factor * d2.value, factor * d3.value, factor * d4.value},
          {once * d1.first, -once * d2.first, once * d3.first, -once * d4.first},
          {-once * d1.first, once * d2.first, once * d3.first, -once * d4.first},
          {-twice * d1.second, -twice * d2.second, twice * d3.second, twice * d4.second}};
}

/// The coefficient of a perfectly conducting wedge for a scalar field that vanishes on it (soft: E along the edge).
inline WithSlopes<Complex> soft_coefficient(const WithSlopes<UtdTerms>& terms) {
  return {terms.value.soft(), terms.by_diffracted.soft(), terms.by_incident.soft(), terms.by_both.soft()};
}

/// The same for a field whose normal derivative vanishes on it (hard: H along the edge).
inline WithSlopes<Complex> hard_coefficient(const WithSlopes<UtdTerms>& terms) {
  return {terms.value.hard(), terms.by_diffracted.hard(), terms.by_incident.hard(), terms.by_both.hard()};
}

}  // namespace dcem
