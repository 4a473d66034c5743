#pragma once
/// One, two or three diffractions in a row: the field diffracted at one edge falls on the next, with its astigmatic
/// wave front, and near shadow boundaries over both edges at once.
///
/// Wave front. Behind an edge the radii of curvature are s (across the edge, from the edge itself) and ρ_e + s. At the
/// next edge, with c = φ̂'·φ̂ the alignment of its basis with that of the edge before,
///   1/ρ_e = (1 − c²)/s + c²/(ρ_e + s),   A = √(ρ_e/(s(ρ_e + s))).
/// Parallel edges have |c| = 1, and all of them together the spreading 1/√(s1·s2·…·(s1 + s2 + …)).
///
/// Terms. Each edge has the four terms D1…D4 of em/diffraction/utd.hpp with the L that it has when the others are
/// absent, and with the matrices M_p beside them the field is
///   V = Σ over p, q, … of K_pq…·M_q·D_q·(arrival)·M_p·D_p,
/// with a factor K for each choice of a term at every edge, from em/diffraction/coupled_edges.hpp.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/coupled_edges.hpp"
#include "dcem/em/diffraction/edge_basis.hpp"
#include "dcem/em/diffraction/utd.hpp"

namespace dcem {

/// A cascade has no more edges.
inline constexpr std::size_t most_cascade_edges = 3;

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

/// The whole way over some edges, from `first_leg_m` on.
template <typename Transfer>
double way_m(double first_leg_m, std::span<const CascadeEdge<Transfer>> edges) {
  double sum = first_leg_m;
  for (const auto& edge : edges) sum += edge.leg_m;
  return sum;
}

/// What an edge makes of each field that leaves the one before, term by term.
template <typename Transfer>
std::array<Transfer, 4> cascade_steps(const CascadeEdge<Transfer>& edge, const std::array<Complex, 4>& coefficients) {
  std::array<Transfer, 4> steps;
  for (std::size_t p = 0; p < 4; ++p) steps[p] = coefficients[p] * (edge.factors[p] * edge.arrival);
  return steps;
}

/// One edge has nothing in common with another: its coefficients are all that is needed.
template <typename Transfer>
Transfer single_edge(double wave_number_rad_per_m, double first_leg_m, const CascadeEdge<Transfer>& edge) {
  const auto steps =
      cascade_steps(edge, cascade_coefficients(edge.angles, wave_number_rad_per_m, first_leg_m, edge.leg_m));
  return steps[0] + steps[1] + steps[2] + steps[3];
}

/// The terms of two or three edges, and what each makes of the fields that leave the one before.
template <typename Transfer>
struct CascadeSums {
  std::array<CascadeTerms, most_cascade_edges> terms;
  std::array<EdgeCoupling, most_cascade_edges - 1> couplings;  ///< of each edge from the second on with the one before
  std::array<std::array<Transfer, 4>, most_cascade_edges> steps;

  CascadeSums(double wave_number_rad_per_m, double first_leg_m, std::span<const CascadeEdge<Transfer>> edges) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const double before_m = way_m(first_leg_m, edges.first(i)), after_m = way_m(0.0, edges.subspan(i));
      terms[i] = cascade_terms(edges[i].angles, wave_number_rad_per_m, before_m, after_m);
      steps[i] = cascade_steps(edges[i], terms[i].coefficients);
      if (i == 0) continue;
      const double leg_m = edges[i - 1].leg_m;
      couplings[i - 1] = edge_coupling(way_m(first_leg_m, edges.first(i - 1)), leg_m, after_m, edges[i].alignment);
    }
  }

  Transfer two() const {
    const PairFactors factors = pair_factors(terms[0], terms[1], couplings[0]);
    Transfer field{};
    for (std::size_t q = 0; q < 4; ++q) {
      Transfer arriving{};
      for (std::size_t p = 0; p < 4; ++p) arriving = arriving + factors[p][q] * steps[0][p];
      field = field + steps[1][q] * arriving;
    }
    return field;
  }

  Transfer three() const {
    const TripleFactors factors(terms[0], terms[1], terms[2], couplings[0], couplings[1]);
    std::array<Transfer, 4> arriving{};
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = 0; q < 4; ++q) {
        const Transfer over_two = steps[1][q] * steps[0][p];
        for (std::size_t r = 0; r < 4; ++r) arriving[r] = arriving[r] + factors(p, q, r) * over_two;
      }
    Transfer field{};
    for (std::size_t r = 0; r < 4; ++r) field = field + steps[2][r] * arriving[r];
    return field;
  }
};

}  // namespace detail

/// Field at the observer, in the diffracted basis of the last edge, per unit field at 1 m from the source (1/m): all
/// diffractions and spreading, without the phase e^{−jk(s1 + s2 + …)}. `first_leg_m` s1 > 0; one to three edges, none
/// met or left along its own direction. Broken preconditions are DCEM_ASSERTs.
template <typename Transfer>
Transfer cascade_transfer(double wave_number_rad_per_m, double first_leg_m,
                          std::span<const CascadeEdge<Transfer>> edges) {
  DCEM_ASSERT(!edges.empty() && edges.size() <= most_cascade_edges);
  const Complex spreading(cascade_spreading(first_leg_m, edges));
  if (edges.size() == 1) return spreading * detail::single_edge(wave_number_rad_per_m, first_leg_m, edges.front());
  const detail::CascadeSums<Transfer> sums(wave_number_rad_per_m, first_leg_m, edges);
  return spreading * (edges.size() == 2 ? sums.two() : sums.three());
}

}  // namespace dcem
