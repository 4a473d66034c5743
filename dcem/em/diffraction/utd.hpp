#pragma once
/// The four terms of the diffraction coefficient of a wedge (Kouyoumjian & Pathak, Proc. IEEE 62, 1974, eq. 25;
/// McNamara, Pistorius & Malherbe 1990, chapter 6), distance parameters and spreading factors.
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
#include <array>
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

/// The terms D1…D4 in m^(1/2).
struct UtdTerms {
  Complex incident_plus;   ///< D1
  Complex incident_minus;  ///< D2
  Complex reflected_n;     ///< D3
  Complex reflected_0;     ///< D4

  Complex soft() const { return incident_plus + incident_minus - reflected_n - reflected_0; }
  Complex hard() const { return incident_plus + incident_minus + reflected_n + reflected_0; }
  std::array<Complex, 4> in_order() const { return {incident_plus, incident_minus, reflected_n, reflected_0}; }
};

/// Where the rays of one diffraction stand to the boundary that a term carries.
struct BoundaryDistance {
  double root;                  ///< √(k·L·a) ≥ 0, the root of the argument of F; 0 on the boundary
  double away_with_diffracted;  ///< +1 where a growing φ leads away from the boundary, −1 where it leads there
  double away_with_incident;    ///< the same for φ'
};

namespace detail {

/// One of the four: the sign with which φ and φ' stand in 2nδ, and δ.
struct CotangentArgument {
  double delta, by_diffracted, by_incident;
};

/// `argument_rad` is (π ± b)/2n.
inline CotangentArgument cotangent_argument(double argument_rad, double by_diffracted, double by_incident) {
  return {argument_rad - pi * std::round(argument_rad / pi), by_diffracted, by_incident};
}

/// In the order D1…D4.
inline std::array<CotangentArgument, 4> cotangent_arguments(const WedgeAngles& angles) {
  const double twice_n = 2.0 * angles.exterior_angle_over_pi;
  const double difference = angles.diffracted_azimuth_rad - angles.incident_azimuth_rad;
  const double sum = angles.diffracted_azimuth_rad + angles.incident_azimuth_rad;
  return {cotangent_argument((pi + difference) / twice_n, 1.0, -1.0),
          cotangent_argument((pi - difference) / twice_n, -1.0, 1.0),
          cotangent_argument((pi + sum) / twice_n, 1.0, 1.0), cotangent_argument((pi - sum) / twice_n, -1.0, -1.0)};
}

/// cot δ·F, `wave_distance` is k·L.
inline Complex cotangent_term(double delta, double wave_distance, double n) {
  const double sine_ratio = delta == 0.0 ? n : std::sin(n * delta) / std::sin(delta);
  // √a·√(kL)/|sin δ|: the transition function is taken without the power of sin δ that cancels the pole.
  const double scale = std::sqrt(2.0 * wave_distance) * sine_ratio;
  const double root_of_x = scale * std::sin(delta);
  const double signed_cosine = delta > 0.0 ? std::cos(delta) : -std::cos(delta);
  return signed_cosine * scale * reduced_transition_function(root_of_x * root_of_x);
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
  const auto arguments = detail::cotangent_arguments(angles);
  const auto term = [&](std::size_t index, double distance_m) {
    return factor * detail::cotangent_term(arguments[index].delta, wave_number_rad_per_m * distance_m,
                                           angles.exterior_angle_over_pi);
  };
  return {term(0, distances.incident_m), term(1, distances.incident_m), term(2, distances.reflected_n_m),
          term(3, distances.reflected_0_m)};
}

/// How far the boundaries of D1…D4 are, in this order, with one L for all. Exactly on a boundary the observer stands on
/// the side that the terms take.
inline std::array<BoundaryDistance, 4> boundary_distances(const WedgeAngles& angles, double wave_number_rad_per_m,
                                                          double distance_parameter_m) {
  std::array<BoundaryDistance, 4> distances;
  const auto arguments = detail::cotangent_arguments(angles);
  for (std::size_t index = 0; index < 4; ++index) {
    const auto& [delta, by_diffracted, by_incident] = arguments[index];
    const double side = delta > 0.0 ? 1.0 : -1.0;
    const double root = std::sqrt(2.0 * wave_number_rad_per_m * distance_parameter_m) *
                        std::abs(std::sin(angles.exterior_angle_over_pi * delta));
    distances[index] = {root, side * by_diffracted, side * by_incident};
  }
  return distances;
}

}  // namespace dcem
