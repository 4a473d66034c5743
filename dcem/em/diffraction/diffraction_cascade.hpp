#pragma once
/// Two, three or more diffractions in a row: the field diffracted at one edge falls on the next, with its astigmatic
/// wave front and its slope across the ray.
///
/// Wave front. Behind an edge the radii of curvature are s (across the edge, from the edge itself) and ρ_e + s. At the
/// next edge, with c = φ̂'·φ̂ the alignment of its basis with that of the edge before,
///   1/ρ_e = (1 − c²)/s + c²/(ρ_e + s),   A = √(ρ_e/(s(ρ_e + s))).
/// Parallel edges have |c| = 1, and all of them together the spreading 1/√(s1·s2·…·(s1 + s2 + …)).
///
/// Slope (Luebbers, AP-37 1989; Andersen, AP-45 1997). A field that grows by E_n per metre along φ̂' adds
/// (1/(jk·sin β0))·∂M/∂φ'·E_n. Behind the edge the slope is ∂/∂φ divided by s·sin β0, times c at the next edge:
///   V = M·X + (∂M/∂φ')·Y/(jk·sin β0),   V_φ = (∂M/∂φ)·X + (∂²M/∂φ∂φ')·Y/(jk·sin β0),
///   X_next = arrival·V·A,               Y_next = c/(s·sin β0)·arrival·V_φ·A.
///
/// Open choices, stated because the sources leave them: the reflection and transmission matrices of the faces are held
/// in the derivatives; the change of the field along β̂0 (skew edges) adds nothing; the spherical wave that meets the
/// first edge has no slope.
///
/// Known limits. With an edge close to the shadow boundary of the one before, the field is not ray-optical. N grazing
/// screens, equally spaced, have exactly 1/(N + 1), that is 6.02, 9.54, 12.04 dB; here 6.0, 9.3, 11.7 dB. Against
/// Kirchhoff's integral over two screens the worst of a sweep is 1.1 dB (from_source), 1.9 dB (symmetric) and 4.4 dB
/// (ray_optical), where the line over the two rims grazes and they stand closer to each other than to the ends; 0.2 dB
/// where one rim is clear of the other's shadow.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/edge_basis.hpp"
#include "dcem/em/diffraction/utd.hpp"

namespace dcem {

/// Which distance parameter L an edge of a cascade gets. Outside the transition zones all agree.
enum class CascadeDistances : std::uint8_t {
  symmetric,      ///< geometric mean of the next two: good at grazing and reciprocal
  from_source,    ///< (s1 + … + si)·s(i+1)/(s1 + … + s(i+1)): good at grazing, not reciprocal
  from_observer,  ///< the same for the reverse path
  ray_optical     ///< from the astigmatic radii (K-P): weak at grazing, reciprocal at parallel edges
};

namespace detail {

/// Radii of the wave front at an edge: principal ones, and that in the plane of edge and ray.
struct WaveFrontRadii {
  double first_m, second_m, edge_plane_m;
};

/// Edge-plane radius of the next edge from that of this one, over the leg between them.
inline WaveFrontRadii radii_after_leg(const WaveFrontRadii& before, double leg_m, double alignment) {
  const double first = leg_m;
  const double second = before.edge_plane_m + leg_m;
  const double squared = alignment * alignment;
  return {first, second, 1.0 / ((1.0 - squared) / first + squared / second)};
}

inline double sum_of(std::span<const double> legs_m) {
  double sum = 0.0;
  for (const double leg : legs_m) sum += leg;
  return sum;
}

}  // namespace detail

/// L of a general astigmatic wave, s·(ρ_e + s)·ρ1·ρ2·sin²β0/(ρ_e·(ρ1 + s)·(ρ2 + s)): K-P 1974, eq. 33.
/// Radii > 0, `diffracted_m` s > 0. Equal radii give the spherical value.
inline double astigmatic_distance_parameter_m(double first_radius_m, double second_radius_m, double edge_plane_radius_m,
                                              double diffracted_m, double edge_angle_rad) {
  const double sine = std::sin(edge_angle_rad);
  return diffracted_m * (1.0 + diffracted_m / edge_plane_radius_m) * sine * sine /
         ((1.0 + diffracted_m / first_radius_m) * (1.0 + diffracted_m / second_radius_m));
}

/// L at edge number `edge` (from 0) of a cascade. `legs_m`: from the source to the first edge, between edges, to the
/// observer, one more than there are edges; unfolded where reflections lie between. `alignments`: c at each edge, the
/// first of no meaning; needed for ray_optical alone.
inline double cascade_distance_parameter_m(CascadeDistances choice, std::span<const double> legs_m,
                                           std::span<const double> alignments, std::size_t edge,
                                           double edge_angle_rad) {
  DCEM_ASSERT(edge + 1 < legs_m.size());
  const double from_source =
      spherical_distance_parameter_m(detail::sum_of(legs_m.first(edge + 1)), legs_m[edge + 1], edge_angle_rad);
  const double from_observer =
      spherical_distance_parameter_m(detail::sum_of(legs_m.subspan(edge + 1)), legs_m[edge], edge_angle_rad);
  if (choice == CascadeDistances::from_source) return from_source;
  if (choice == CascadeDistances::from_observer) return from_observer;
  if (choice == CascadeDistances::symmetric) return std::sqrt(from_source * from_observer);
  DCEM_ASSERT(edge < alignments.size());
  detail::WaveFrontRadii radii{legs_m[0], legs_m[0], legs_m[0]};
  for (std::size_t i = 1; i <= edge; ++i) radii = detail::radii_after_leg(radii, legs_m[i], alignments[i]);
  return astigmatic_distance_parameter_m(radii.first_m, radii.second_m, radii.edge_plane_m, legs_m[edge + 1],
                                         edge_angle_rad);
}

/// One edge of a cascade. `Transfer` is ComplexMatrix2 (M of em/diffraction/wedge_diffraction.hpp) or, for a scalar
/// soft or hard field, Complex (D of em/diffraction/utd.hpp).
template <typename Transfer>
struct CascadeEdge {
  WithSlopes<Transfer> diffraction;
  double edge_angle_rad;  ///< β0
  double leg_m;           ///< to the next edge or to the observer, unfolded
  Transfer arrival;       ///< from where the field leaves the edge before to the incident basis here; first: identity
  double alignment;       ///< c = φ̂' here · φ̂ of the edge before (carried through mirrors between); first: any
};

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

/// Field at the observer, in the diffracted basis of the last edge, per unit field at 1 m from the source (1/m): all
/// diffractions and spreading, without the phase e^{−jk(s1 + s2 + …)}. With `use_slope` false the bare cascade of M's.
/// `first_leg_m` s1 > 0; at least one edge.
template <typename Transfer>
Transfer cascade_transfer(double wave_number_rad_per_m, double first_leg_m,
                          std::span<const CascadeEdge<Transfer>> edges, bool use_slope = true) {
  DCEM_ASSERT(!edges.empty());
  detail::WaveFrontRadii radii{first_leg_m, first_leg_m, first_leg_m};
  const CascadeEdge<Transfer>& first = edges.front();
  Transfer value = first.diffraction.value;
  Transfer by_azimuth = first.diffraction.by_diffracted;
  double spreading = diffraction_spreading(radii.edge_plane_m, first.leg_m) / first_leg_m;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const CascadeEdge<Transfer>& before = edges[i - 1];
    const CascadeEdge<Transfer>& here = edges[i];
    const double per_metre = here.alignment / (before.leg_m * std::sin(before.edge_angle_rad));
    const Complex slope_factor(0.0,
                               use_slope ? -per_metre / (wave_number_rad_per_m * std::sin(here.edge_angle_rad)) : 0.0);
    const Transfer field = here.arrival * value;
    const Transfer slope = slope_factor * (here.arrival * by_azimuth);
    value = here.diffraction.value * field + here.diffraction.by_incident * slope;
    by_azimuth = here.diffraction.by_diffracted * field + here.diffraction.by_both * slope;
    radii = detail::radii_after_leg(radii, before.leg_m, here.alignment);
    spreading *= diffraction_spreading(radii.edge_plane_m, here.leg_m);
  }
  return Complex(spreading) * value;
}

}  // namespace dcem
