#pragma once
/// Two, three or more diffractions in a row: the field diffracted at one edge falls on the next, with its astigmatic
/// wave front, and near shadow boundaries over both edges at once.
///
/// Wave front. Behind an edge the radii of curvature are s (across the edge, from the edge itself) and ρ_e + s. At the
/// next edge, with c = φ̂'·φ̂ the alignment of its basis with that of the edge before,
///   1/ρ_e = (1 − c²)/s + c²/(ρ_e + s),   A = √(ρ_e/(s(ρ_e + s))).
/// Parallel edges have |c| = 1, and all of them together the spreading 1/√(s1·s2·…·(s1 + s2 + …)).
///
/// Terms. Each edge has the four terms D1…D4 of em/diffraction/utd.hpp with the L that it has when the others are
/// absent, l·r·sin²β0/(l + r) with l and r the whole ways to the two ends. With the matrices M_p beside them the field
/// is
///   V = Σ over p, q, … of M_q·D_q·K_pq·(arrival)·M_p·D_p,
///   K_pq = T(α_p, β_q, ρ_pq)/(F(α_p²)·F(β_q²)),   α, β = √(k·L·a) of the two terms,
///   ρ_pq = ±c·√(l·r/((l + m)(m + r))),   l before the first edge, m between the two, r behind the second
/// (T in em/diffraction/double_transition.hpp). The sign is + where φ at the first edge and φ' at the second lead both
/// away from their boundaries, or both there. Far from the boundaries and far apart K = 1.
///
/// Two edges: in the paraxial limit this is Kirchhoff's double integral for any spacing and height. It is continuous
/// across every boundary of each edge: what jumps there is the field of the other edge alone. Transposed for the
/// reverse path. Three: the field over edges 1, 2 and that over 2, 3 taken as independent beyond what both owe to edge
/// 2; exact where one of the two pairs is uncoupled, 0.28 dB too weak at three equally spaced grazing screens (exact:
/// 1/4).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/double_transition.hpp"
#include "dcem/em/diffraction/edge_basis.hpp"
#include "dcem/em/diffraction/utd.hpp"

namespace dcem {

/// One edge of a cascade. `Transfer` is ComplexMatrix2 (what stands beside D1…D4 in M of
/// em/diffraction/wedge_diffraction.hpp) or, for a scalar soft or hard field, Complex.
template <typename Transfer>
struct CascadeEdge {
  WedgeAngles angles;
  std::array<Transfer, 4> factors;  ///< of D1…D4
  double leg_m;                     ///< to the next edge or to the observer, unfolded
  Transfer arrival;  ///< from where the field leaves the edge before to the incident basis here; first: identity
  double alignment;  ///< c = φ̂' here · φ̂ of the edge before (carried through mirrors between); first: any
};

/// The factors of a perfect conductor for a scalar field that vanishes on it (soft: E along the edge).
inline constexpr std::array<double, 4> soft_signs{1.0, 1.0, -1.0, -1.0};
/// The same for a field whose normal derivative vanishes on it (hard: H along the edge).
inline constexpr std::array<double, 4> hard_signs{1.0, 1.0, 1.0, 1.0};

/// Basis change along a straight leg: (β0, φ) leaving one edge to (β0', φ') arriving at the next. Where mirrors or
/// sheets lie between, carry the two diffracted unit vectors through them and take the components that arrive.
inline ComplexMatrix2 arrival_matrix(const EdgeBases& before, const EdgeBases& here) {
  const ComplexVector2 beta = incident_components(here, ComplexVector3(before.diffracted_beta));
  const ComplexVector2 phi = incident_components(here, ComplexVector3(before.diffracted_phi));
  return {{{{beta[0], phi[0]}, {beta[1], phi[1]}}}};
}

/// c = φ̂'·φ̂ along a straight leg: −1 for parallel edges of one sense, +1 of opposite senses.
inline double alignment_of(const EdgeBases& before, const EdgeBases& here) {
  return glm::dot(here.incident_phi, before.diffracted_phi);
}

/// L of an edge from the whole ways to both ends, unfolded; the same to the last bit when the ends are swapped.
inline double cascade_distance_parameter_m(double before_m, double after_m, double edge_angle_rad) {
  return std::sqrt(spherical_distance_parameter_m(before_m, after_m, edge_angle_rad) *
                   spherical_distance_parameter_m(after_m, before_m, edge_angle_rad));
}

/// abs ρ and √(1 − ρ²) of two neighbouring edges, from the ways before, between and after them (all > 0) and c.
inline EdgeCoupling edge_coupling(double before_m, double between_m, double after_m, double alignment) {
  const double squared = std::min(alignment * alignment, 1.0);
  const double spans = (before_m + between_m) * (between_m + after_m);
  return {std::sqrt(squared * before_m * after_m / spans),
          std::sqrt((1.0 - squared) + squared * between_m * (before_m + between_m + after_m) / spans)};
}

/// 1/s1·A·A·…: what wave front and distances leave of the field, in 1/m to the power of 1 + half the number of edges.
template <typename Transfer>
double cascade_spreading(double first_leg_m, std::span<const CascadeEdge<Transfer>> edges) {
  double radius_m = first_leg_m;  // ρ_e
  double spreading = diffraction_spreading(radius_m, edges.front().leg_m) / first_leg_m;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const double leg_m = edges[i - 1].leg_m;
    const double squared = edges[i].alignment * edges[i].alignment;
    radius_m = 1.0 / ((1.0 - squared) / leg_m + squared / (radius_m + leg_m));
    spreading *= diffraction_spreading(radius_m, edges[i].leg_m);
  }
  return spreading;
}

namespace detail {

/// What an edge of a cascade has of its own: D1…D4 and where their boundaries are.
struct CascadeTerms {
  std::array<Complex, 4> coefficients;
  std::array<BoundaryDistance, 4> boundaries;
  std::array<Complex, 4> transitions;  ///< F(x)/√x at each
};

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

/// K_pq at the head of this file. `coupling` with the sign of c.
inline Complex coupling_factor(const CascadeTerms& before, std::size_t p, const CascadeTerms& here, std::size_t q,
                               EdgeCoupling coupling) {
  coupling.correlation *= before.boundaries[p].away_with_diffracted * here.boundaries[q].away_with_incident;
  return reduced_double_transition(before.boundaries[p].root, here.boundaries[q].root, coupling) /
         (before.transitions[p] * here.transitions[q]);
}

template <typename Length>
double way_m(double first_leg_m, Length legs) {
  double sum = first_leg_m;
  for (const auto& edge : legs) sum += edge.leg_m;
  return sum;
}

}  // namespace detail

/// Field at the observer, in the diffracted basis of the last edge, per unit field at 1 m from the source (1/m): all
/// diffractions and spreading, without the phase e^{−jk(s1 + s2 + …)}. `first_leg_m` s1 > 0; at least one edge, none
/// met or left along its own direction.
template <typename Transfer>
Transfer cascade_transfer(double wave_number_rad_per_m, double first_leg_m,
                          std::span<const CascadeEdge<Transfer>> edges) {
  DCEM_ASSERT(!edges.empty());
  const auto before_m = [&](std::size_t edge) { return detail::way_m(first_leg_m, edges.first(edge)); };
  const auto after_m = [&](std::size_t edge) { return detail::way_m(0.0, edges.subspan(edge)); };
  auto terms = detail::cascade_terms(edges[0].angles, wave_number_rad_per_m, before_m(0), after_m(0));
  std::array<Transfer, 4> fields;
  for (std::size_t p = 0; p < 4; ++p) fields[p] = terms.coefficients[p] * edges[0].factors[p];
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const CascadeEdge<Transfer>& here = edges[i];
    const auto next = detail::cascade_terms(here.angles, wave_number_rad_per_m, before_m(i), after_m(i));
    EdgeCoupling coupling = edge_coupling(before_m(i - 1), edges[i - 1].leg_m, after_m(i), here.alignment);
    coupling.correlation = std::copysign(coupling.correlation, here.alignment);
    std::array<Transfer, 4> left;
    for (std::size_t q = 0; q < 4; ++q) {
      Transfer sum{};
      for (std::size_t p = 0; p < 4; ++p) sum = sum + detail::coupling_factor(terms, p, next, q, coupling) * fields[p];
      left[q] = next.coefficients[q] * (here.factors[q] * (here.arrival * sum));
    }
    fields = left;
    terms = next;
  }
  return Complex(cascade_spreading(first_leg_m, edges)) * (fields[0] + fields[1] + fields[2] + fields[3]);
}

}  // namespace dcem
