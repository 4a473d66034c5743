#pragma once
/// The diffraction matrix of a wedge with faces of any material: (E_β0', E_φ') arriving at the edge to (E_β0, E_φ)
/// leaving it, in the bases of em/diffraction/edge_basis.hpp. The field at the distance s is
///   E(s) = M·E'·A·e^{−jks},  A = diffraction_spreading(ρ_e, s),  E' the incident field at the edge.
///
/// With the terms D1…D4 of em/diffraction/utd.hpp and the reflection matrices G_0, G_n of the faces,
///   M = −(D1 + D2)·(I − T) + D4·G_0 + D3·G_n          reciprocal, luebbers84
///   M = −D2·(I − T) − D1·G_n·G_0 + D4·G_0 + D3·G_n    holm_reciprocal, φ ≥ φ' (else −D1·(I − T) − D2·G_0·G_n + …).
/// A perfect conductor has G = diag(+1, −1) and M = −diag(D_soft, D_hard) in every variant.
///
/// G_f is the reflection of a ray with the same β0 that comes in at the azimuth a from face f and goes out at π − a;
/// its angle of incidence has cos θ = sin a·sin β0. In the edge-fixed bases, with p = cos a, q = cos β0·sin a,
///   G_0 = [R_tm·q² − R_te·p²,  (R_te + R_tm)·p·q;  −(R_te + R_tm)·p·q,  R_te·q² − R_tm·p²]/(p² + q²),
/// and G_n is the same with the signs of the mixed entries turned. On the boundary of a reflection a is the azimuth of
/// the real ray, so that geometrical optics and diffraction join for any material, incidence and polarization.
///
/// Penetrable faces (Burnside & Burgener, AP-31 1983): behind them the direct field is T times the undisturbed one, so
/// what D has to make up is (I − T). T is a matrix in the basis (β0', φ') of the incident ray, before and after.
///
/// Where φ = φ' at oblique incidence the two reciprocal variants change which of the two rays sets the angle. The mixed
/// entries of G_f jump there (reciprocity admits no other value than 0 on that line); they are small away from RSBs.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>

#include "dcem/core/constants.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/lossy_wedge.hpp"
#include "dcem/em/diffraction/utd.hpp"
#include "dcem/em/surface/fresnel.hpp"

namespace dcem {

/// Field coefficients of a face for cos θ in 0…1: reflection, or insertion coefficients of a crossing. Any callable,
/// for example [&](double cos_incidence) { return table.response(material, cos_incidence).reflection; }. A reduction
/// for roughness or diffuse scattering belongs inside, so that it acts on both sides of a reflection boundary.
template <typename Face>
concept FaceCoefficients = requires(const Face& face, double cos_incidence) {
  { face(cos_incidence) } -> std::convertible_to<PolarizedCoefficients>;
};

enum class WedgeFace : std::uint8_t { zero, n };

namespace detail {

/// Azimuth in 0…π, seen from the face, at which the virtual ray of that face comes in. `source_rad` and `observer_rad`
/// are azimuths from the same face; `from_source` says which of them sets it.
inline double virtual_azimuth_rad(double source_rad, double observer_rad, bool from_source) {
  const double azimuth = std::abs(from_source ? source_rad : pi - observer_rad);
  return azimuth > pi ? 2.0 * pi - azimuth : azimuth;
}

inline double virtual_azimuth_rad(const WedgeAngles& angles, WedgeFace face, LossyWedge variant) {
  const double opening = angles.exterior_angle_over_pi * pi;
  const bool zero = face == WedgeFace::zero;
  const double source = zero ? angles.incident_azimuth_rad : opening - angles.incident_azimuth_rad;
  const double observer = zero ? angles.diffracted_azimuth_rad : opening - angles.diffracted_azimuth_rad;
  if (variant != LossyWedge::luebbers84) return virtual_azimuth_rad(source, observer, source <= observer);
  const bool nearer = zero ? source <= 0.5 * opening : source < 0.5 * opening;
  return virtual_azimuth_rad(source, observer, nearer);
}

/// Whether source and observer stand at one azimuth. On that line the reciprocal variants change which of the two sets
/// an angle, and which of the two terms is the regular one; rounding would choose a side, and not the same one for the
/// reverse path.
inline bool is_level(const WedgeAngles& angles) {
  return std::abs(angles.incident_azimuth_rad - angles.diffracted_azimuth_rad) < 1e-9;
}

/// The plane of incidence of the virtual ray in the edge-fixed basis: e⊥ = (−p, q)/√(p² + q²).
struct IncidencePlane {
  double cos_incidence;
  double p, q;  ///< normalized to p² + q² = 1
};

inline IncidencePlane incidence_plane(double azimuth_rad, const WedgeAngles& angles, WedgeFace face) {
  const double sine = std::sin(azimuth_rad);
  const double p = std::cos(azimuth_rad);
  // Seen from face n the azimuth runs the other way: φ̂ turns about.
  const double q = (face == WedgeFace::zero ? 1.0 : -1.0) * std::cos(angles.edge_angle_rad) * sine;
  const double size = std::hypot(p, q);
  const double cos_incidence = std::abs(sine) * std::sin(angles.edge_angle_rad);
  // At normal incidence every plane will do, because there R_te = −R_tm.
  if (size < 1e-9) return {cos_incidence, 1.0, 0.0};
  return {cos_incidence, p / size, q / size};
}

}  // namespace detail

/// G_f at the head of this file.
template <FaceCoefficients Face>
ComplexMatrix2 face_reflection_matrix(const WedgeAngles& angles, WedgeFace face, LossyWedge variant,
                                      const Face& reflection) {
  const double azimuth = detail::virtual_azimuth_rad(angles, face, variant);
  const auto [cos_incidence, p, q] = detail::incidence_plane(azimuth, angles, face);
  const PolarizedCoefficients r = reflection(cos_incidence);
  const bool jumps = variant != LossyWedge::luebbers84 && detail::is_level(angles);
  const Complex mixed = jumps ? Complex{} : (r.te + r.tm) * (p * q);
  return {{{{r.tm * (q * q) - r.te * (p * p), mixed}, {-mixed, r.te * (q * q) - r.tm * (p * p)}}}};
}

/// What one thin sheet does to the direct ray that crosses it next to the edge, in the basis (β0', φ'), from its
/// insertion coefficients. The angle is that of the ray, source or observer, whose azimuth is nearer to the face; on
/// the shadow boundary both have it. Reciprocal. The matrix of a free edge (n = 2, one sheet) is that of face zero.
template <FaceCoefficients Face>
ComplexMatrix2 face_transmission_matrix(const WedgeAngles& angles, WedgeFace face, const Face& transmission) {
  const double nearer =
      face == WedgeFace::zero
          ? std::min(angles.incident_azimuth_rad, angles.diffracted_azimuth_rad)
          : angles.exterior_angle_over_pi * pi - std::max(angles.incident_azimuth_rad, angles.diffracted_azimuth_rad);
  const auto [cos_incidence, p, q] = detail::incidence_plane(nearer, angles, face);
  const PolarizedCoefficients t = transmission(cos_incidence);
  const Complex mixed = (t.tm - t.te) * (p * q);
  return {{{{t.te * (p * p) + t.tm * (q * q), mixed}, {mixed, t.te * (q * q) + t.tm * (p * p)}}}};
}

/// T of a hollow wedge of two sheets, both crossed by the direct ray: that of the face first met stands on the right.
template <FaceCoefficients Face0, FaceCoefficients FaceN>
ComplexMatrix2 wedge_transmission_matrix(const WedgeAngles& angles, const Face0& face_0, const FaceN& face_n) {
  const ComplexMatrix2 t_0 = face_transmission_matrix(angles, WedgeFace::zero, face_0);
  const ComplexMatrix2 t_n = face_transmission_matrix(angles, WedgeFace::n, face_n);
  return angles.diffracted_azimuth_rad >= angles.incident_azimuth_rad ? t_n * t_0 : t_0 * t_n;
}

/// What stands beside D1…D4 in M.
struct WedgeMatrices {
  ComplexMatrix2 incident_plus, incident_minus, reflected_n, reflected_0;

  /// As D1…D4.
  std::array<ComplexMatrix2, 4> in_order() const { return {incident_plus, incident_minus, reflected_n, reflected_0}; }

  /// For a wave that comes in along a face, holm_reciprocal: what is left without the terms that a reflection at this
  /// face comes first in. They are the images of the others, and as large.
  WedgeMatrices without_reflection_at(WedgeFace face) const {
    if (face == WedgeFace::zero) return {ComplexMatrix2{}, incident_minus, reflected_n, ComplexMatrix2{}};
    return {incident_plus, ComplexMatrix2{}, ComplexMatrix2{}, reflected_0};
  }

  ComplexMatrix2 combine(const UtdTerms& terms) const {
    return terms.incident_plus * incident_plus + terms.incident_minus * incident_minus +
           terms.reflected_n * reflected_n + terms.reflected_0 * reflected_0;
  }
};

/// `transmission` is T of penetrable faces; absent: opaque. In `holm_reciprocal` the term with G_n·G_0 then carries the
/// mean of (I − T)·G_n·G_0 and G_n·G_0·(I − T), the order that keeps it reciprocal.
template <FaceCoefficients Face0, FaceCoefficients FaceN>
WedgeMatrices wedge_matrices(const WedgeAngles& angles, const Face0& face_0, const FaceN& face_n,
                             LossyWedge variant = LossyWedge::holm_reciprocal,
                             const std::optional<ComplexMatrix2>& transmission = std::nullopt) {
  const ComplexMatrix2 identity = diagonal_matrix(1.0, 1.0);
  const ComplexMatrix2 blocked = transmission ? identity + Complex(-1.0) * *transmission : identity;
  const ComplexMatrix2 g_0 = face_reflection_matrix(angles, WedgeFace::zero, variant, face_0);
  const ComplexMatrix2 g_n = face_reflection_matrix(angles, WedgeFace::n, variant, face_n);
  const ComplexMatrix2 incident = Complex(-1.0) * blocked;
  if (variant != LossyWedge::holm_reciprocal) return {incident, incident, g_n, g_0};
  const bool forward = angles.diffracted_azimuth_rad >= angles.incident_azimuth_rad;
  const ComplexMatrix2 twice = forward ? g_n * g_0 : g_0 * g_n;
  const ComplexMatrix2 regular = Complex(-0.5) * (blocked * twice + twice * blocked);
  if (detail::is_level(angles)) {  // D1 and D2 are the same there
    const ComplexMatrix2 mean = Complex(0.5) * (regular + incident);
    return {mean, mean, g_n, g_0};
  }
  return forward ? WedgeMatrices{regular, incident, g_n, g_0} : WedgeMatrices{incident, regular, g_n, g_0};
}

/// M of one diffraction, in m^(1/2).
inline ComplexMatrix2 diffraction_matrix(const WedgeAngles& angles, double wave_number_rad_per_m,
                                         const DistanceParameters& distances, const WedgeMatrices& matrices) {
  return matrices.combine(utd_terms(angles, wave_number_rad_per_m, distances));
}

/// A face of perfect conductor, as FaceCoefficients.
inline PolarizedCoefficients perfectly_conducting_face(double) {
  return perfect_conductor_reflection();
}

}  // namespace dcem
