#pragma once
/// What two or three edges in a row have together beyond the product of their coefficients: a factor for each choice of
/// one of the terms D1…D4 (em/diffraction/utd.hpp) at every edge. Each term has the L that its edge has when the others
/// are absent, l·r·sin²β0/(l + r) with l and r the whole ways to the two ends; α, β, γ are the √(k·L·a) of the terms.
///
/// Two edges:
///   K_pq  = T(α_p, β_q, ρ_pq)/(F(α_p²)·F(β_q²)),
///   ρ_pq  = ±c·√(l·r/((l + m)(m + r))),   l before the first edge, m between the two, r behind the second
/// (T in em/diffraction/double_transition.hpp). The sign is + where φ at the first edge and φ' at the second lead both
/// away from their boundaries, or both there. Far from the boundaries and far apart K = 1. In the paraxial limit this
/// is Kirchhoff's double integral, for any spacing and height. It is continuous across every boundary of each edge:
/// what jumps there is the field of the other edge alone. The same when the ends are swapped.
///
/// Three edges:
///   K_pqr = K_pq·K_qr + V(β_q)/V(0)·E_pr·αγ/(F(α_p²)·F(γ_r²)),
///   E     = s12·s23/s13·T13 + j/2π·(T12⁺·T23⁺ + T12⁻·T23⁻).
/// Kirchhoff's integral over the middle one is that of e^{−j(2βv + v²)}·f1(v)·f3(v) over v ≥ 0, with f1 and f3 what
/// passes over the others. If f1 and f3 were uncorrelated over that half line it would be K_pq·K_qr. What is missing is
/// known where β = 0: then the two half lines together have the T of the outer edges, ρ13 = ρ12·ρ23, and each gets half
/// of E. (T13 is T/(αγ) at (α, γ), T12 is T/(αβ) at (α, 0), T23 is T/(βγ) at (0, γ), on both sides of the middle
/// boundary.) It falls with the variance V(β) of v under e^{−j(2βv + v²)}. So the field is exact where all three graze,
/// 1/4 for equal spacing, and where one pair is uncoupled; and what jumps at any boundary of parallel edges is the
/// field of the others.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dcem/core/constants.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/double_transition.hpp"
#include "dcem/em/diffraction/utd.hpp"

namespace dcem {

/// L of an edge from the whole ways to both ends, unfolded; the same to the last bit when the ends are swapped.
inline double cascade_distance_parameter_m(double before_m, double after_m, double edge_angle_rad) {
  return std::sqrt(spherical_distance_parameter_m(before_m, after_m, edge_angle_rad) *
                   spherical_distance_parameter_m(after_m, before_m, edge_angle_rad));
}

/// ρ with the sign of c, and √(1 − ρ²), of two neighbouring edges, from the ways before, between and after them (all >
/// 0) and c.
inline EdgeCoupling edge_coupling(double before_m, double between_m, double after_m, double alignment) {
  const double squared = std::min(alignment * alignment, 1.0);
  const double spans = (before_m + between_m) * (between_m + after_m);
  return {std::copysign(std::sqrt(squared * before_m * after_m / spans), alignment),
          std::sqrt((1.0 - squared) + squared * between_m * (before_m + between_m + after_m) / spans)};
}

namespace detail {

/// What an edge of a cascade has of its own: D1…D4 and where their boundaries are.
struct CascadeTerms {
  std::array<Complex, 4> coefficients;
  std::array<BoundaryDistance, 4> boundaries;
  std::array<Complex, 4> transitions;  ///< F(x)/√x at each
};

/// D1…D4 of an edge from the whole ways to both ends.
inline std::array<Complex, 4> cascade_coefficients(const WedgeAngles& angles, double wave_number_rad_per_m,
                                                   double before_m, double after_m) {
  const double distance_m = cascade_distance_parameter_m(before_m, after_m, angles.edge_angle_rad);
  return utd_terms(angles, wave_number_rad_per_m, equal_distances(distance_m)).in_order();
}

inline CascadeTerms cascade_terms(const WedgeAngles& angles, double wave_number_rad_per_m, double before_m,
                                  double after_m) {
  const double distance_m = cascade_distance_parameter_m(before_m, after_m, angles.edge_angle_rad);
  CascadeTerms terms;
  terms.coefficients = utd_terms(angles, wave_number_rad_per_m, equal_distances(distance_m)).in_order();
  terms.boundaries = boundary_distances(angles, wave_number_rad_per_m, distance_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const double root = terms.boundaries[i].root;
    terms.transitions[i] = reduced_transition_function(root * root);
  }
  return terms;
}

using PairFactors = std::array<std::array<Complex, 4>, 4>;

/// Whether the boundaries of two terms draw the edges together (1) or apart (−1), for c > 0.
inline double coupling_sign(const BoundaryDistance& before, const BoundaryDistance& here) {
  return before.away_with_diffracted * here.away_with_incident;
}

/// K_pq at the head of this file. `coupling` as edge_coupling gives it.
inline PairFactors pair_factors(const CascadeTerms& before, const CascadeTerms& here, const EdgeCoupling& coupling) {
  PairFactors factors;
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t q = 0; q < 4; ++q) {
      const double sign = coupling_sign(before.boundaries[p], here.boundaries[q]);
      factors[p][q] = reduced_double_transition(before.boundaries[p].root, here.boundaries[q].root,
                                                {sign * coupling.correlation, coupling.complement}) /
                      (before.transitions[p] * here.transitions[q]);
    }
  return factors;
}

/// Variance of v ≥ 0 under e^{−j(2βv + v²)} over that at β = 0, −j(1/2 − 1/π).
inline Complex middle_variance_ratio(double root) {
  const Complex at_zero(0.0, 1.0 / pi - 0.5);
  const Complex y(0.0, 2.0 * root);
  if (root > 100.0) return (1.0 - Complex(0.0, 12.0) / (y * y)) / (y * y) / at_zero;
  const Complex whole = reduced_transition_function(root * root) / Complex(0.0, 2.0);
  const Complex mean = (1.0 / whole - y) / Complex(0.0, 2.0);
  return ((1.0 - y * mean) / Complex(0.0, 2.0) - mean * mean) / at_zero;
}

/// The factor of three edges for each choice of terms.
class TripleFactors {
 public:
  TripleFactors(const CascadeTerms& first, const CascadeTerms& middle, const CascadeTerms& last,
                const EdgeCoupling& first_coupling, const EdgeCoupling& last_coupling)
      : first_pair_(pair_factors(first, middle, first_coupling)),
        last_pair_(pair_factors(middle, last, last_coupling)) {
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = 0; q < 4; ++q) {
        first_signs_[p][q] = coupling_sign(first.boundaries[p], middle.boundaries[q]);
        last_signs_[p][q] = coupling_sign(middle.boundaries[p], last.boundaries[q]);
      }
    for (std::size_t q = 0; q < 4; ++q) fall_[q] = middle_variance_ratio(middle.boundaries[q].root);
    const auto first_sides = sides(first, first_coupling), last_sides = sides(last, last_coupling);
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t r = 0; r < 4; ++r)
        for (const std::size_t same : {std::size_t{0}, std::size_t{1}}) {
          const EdgeCoupling onwards = same == 1 ? last_coupling : reversed(last_coupling);
          const Complex halves = first_sides[p][0] * last_sides[r][1 - same] + first_sides[p][1] * last_sides[r][same];
          const Complex around = over_outer(first.boundaries[p].root, last.boundaries[r].root, first_coupling, onwards);
          // 1/2 over the square of F(β²)/β at 0 is −j/2π.
          excess_[same][p][r] =
              (around + Complex(0.0, 0.5 / pi) * halves) / (first.transitions[p] * last.transitions[r]);
        }
  }

  Complex operator()(std::size_t p, std::size_t q, std::size_t r) const {
    const std::size_t same = first_signs_[p][q] * last_signs_[q][r] > 0.0 ? 1 : 0;
    return first_pair_[p][q] * last_pair_[q][r] + fall_[q] * excess_[same][p][r];
  }

 private:
  static EdgeCoupling reversed(const EdgeCoupling& coupling) { return {-coupling.correlation, coupling.complement}; }

  /// T/(αβ) at β = 0 for each term of an outer edge, with the coupling as it is and reversed.
  static std::array<std::array<Complex, 2>, 4> sides(const CascadeTerms& outer, const EdgeCoupling& coupling) {
    std::array<std::array<Complex, 2>, 4> values;
    for (std::size_t p = 0; p < 4; ++p)
      values[p] = {reduced_double_transition(outer.boundaries[p].root, 0.0, coupling),
                   reduced_double_transition(outer.boundaries[p].root, 0.0, reversed(coupling))};
    return values;
  }

  /// s12·s23/s13·T13 at the head of this file.
  static Complex over_outer(double first_root, double last_root, const EdgeCoupling& first, const EdgeCoupling& last) {
    // 1 − ρ12²ρ23² = s12² + ρ12²·s23².
    const EdgeCoupling outer{first.correlation * last.correlation,
                             std::hypot(first.complement, first.correlation * last.complement)};
    return first.complement * last.complement / outer.complement *
           reduced_double_transition(first_root, last_root, outer);
  }

  PairFactors first_pair_, last_pair_;
  std::array<std::array<double, 4>, 4> first_signs_, last_signs_;
  std::array<Complex, 4> fall_;
  std::array<std::array<std::array<Complex, 4>, 4>, 2> excess_;
};

}  // namespace detail

}  // namespace dcem
