#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dcem/em/antenna/polarization.hpp"
#include "dcem/em/diffraction/edge_basis.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "dcem/em/dyad.hpp"
#include "dcem/em/surface/slab.hpp"

namespace test_wedge_continuity {

using namespace dcem;

// The total field of a point source at a wedge, as a vector in space: geometrical optics from em/dyad.hpp with images,
// which knows nothing of edge bases, plus the diffracted field. Each boundary is crossed in steps ±ε.
namespace {

using FaceModel = std::function<SurfaceResponse(double)>;

constexpr double wave_number = 600.0;  // 28.6 GHz

struct FacedWedge {
  double n;
  FaceModel face_0, face_n;
  bool one_sheet = false;  ///< n = 2: the two faces are the two sides of one sheet
};

struct NamedWedge {
  std::string name;
  FacedWedge wedge;
};

FaceModel conductor() {
  return [](double) { return SurfaceResponse{perfect_conductor_reflection(), {}}; };
}
FaceModel constant(double rho, double through) {
  return [=](double) { return SurfaceResponse{{-rho, rho}, {through, through}}; };
}
FaceModel half_space(Complex eta) {
  return [=](double cosine) { return SurfaceResponse{half_space_reflection(eta, cosine), {}}; };
}
FaceModel slab(Complex eta, double thickness_rad) {
  return [=](double cosine) { return slab_response(eta, thickness_rad, cosine); };
}

std::vector<NamedWedge> wedges() {
  const FaceModel concrete = half_space({5.24, -0.39});
  const FaceModel wet = half_space({20.0, -15.0});
  return {{"conductor", {1.5, conductor(), conductor()}},
          {"constant", {1.5, constant(0.8, 0.0), constant(0.7, 0.0)}},
          {"lossy dielectric", {1.5, concrete, wet}},
          {"lossy dielectric, blunt", {1.2, wet, concrete}},
          {"constant, penetrable", {1.5, constant(0.7, 0.1), constant(0.74, 0.5623413251903491)}},
          {"slabs", {1.5, slab({5.24, -0.39}, 12.0), slab({6.31, -0.2}, 3.0)}},
          {"free edge, 20 dB", {2.0, constant(0.7, 0.1), constant(0.7, 0.1), true}},
          {"free edge, 5 dB", {2.0, constant(0.74, 0.5623413251903491), constant(0.74, 0.5623413251903491), true}},
          {"free edge, slab", {2.0, slab({6.31, -0.2}, 3.0), slab({6.31, -0.2}, 3.0), true}},
          {"free edge, conductor", {2.0, conductor(), conductor(), true}}};
}

Vec3 at(double radius, double azimuth, double height) {
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), height};
}

struct EdgeLink {
  double source_azimuth, observer_azimuth;
  double height;  ///< of the observer over the source
  double source_radius = 3.0;
  double observer_radius = 5.0;

  Vec3 source() const { return at(source_radius, source_azimuth, 0.0); }
  Vec3 observer() const { return at(observer_radius, observer_azimuth, height); }
};

/// What the source sends in a direction: transverse, turning with the direction, without spreading and phase.
ComplexVector3 sent(const JonesVector& jones, const Vec3& direction) {
  return scaled(theta_hat(direction), jones[0]) + scaled(phi_hat(direction), jones[1]);
}

Complex spherical(double length) {
  return unit_phasor(-wave_number * length) / length;
}

PolarizedCoefficients reflection_of(const FaceModel& surface, double cosine) {
  return surface(cosine).reflection;
}

/// Normals of face 0 and face n.
Vec3 normal_of(const FacedWedge& wedge, WedgeFace face) {
  if (face == WedgeFace::zero) return {0, 1, 0};
  const double end = wedge.n * pi;
  return {std::sin(end), -std::cos(end), 0};
}

ComplexVector3 direct_field(const FacedWedge& wedge, const EdgeLink& link, const JonesVector& jones) {
  const Vec3 ray = link.observer() - link.source();
  const Vec3 direction = glm::normalize(ray);
  ComplexVector3 field = sent(jones, direction);
  if (std::abs(link.observer_azimuth - link.source_azimuth) >= pi) {
    const bool forward = link.observer_azimuth > link.source_azimuth;
    const auto cross = [&](WedgeFace face) {
      const Vec3 normal = normal_of(wedge, face);
      const FaceModel& surface = face == WedgeFace::zero ? wedge.face_0 : wedge.face_n;
      field = transmit(field, direction, normal, surface(std::abs(glm::dot(direction, normal))).transmission);
    };
    cross(forward ? WedgeFace::zero : WedgeFace::n);
    if (!wedge.one_sheet) cross(forward ? WedgeFace::n : WedgeFace::zero);
  }
  return spherical(glm::length(ray)) * field;
}

ComplexVector3 mirrored_field(const FacedWedge& wedge, const EdgeLink& link, const JonesVector& jones, WedgeFace face) {
  const bool zero = face == WedgeFace::zero;
  const double end = wedge.n * pi;
  const double sum =
      zero ? link.source_azimuth + link.observer_azimuth : 2.0 * end - link.source_azimuth - link.observer_azimuth;
  if (sum >= pi) return {};
  const Vec3 normal = normal_of(wedge, face);
  const Vec3 image = link.source() - 2.0 * glm::dot(link.source(), normal) * normal;
  const Vec3 ray = link.observer() - image;
  const Vec3 incident = reflected_direction(glm::normalize(ray), normal);
  const double cosine = std::abs(glm::dot(incident, normal));
  return spherical(glm::length(ray)) *
         reflect(sent(jones, incident), incident, normal, reflection_of(zero ? wedge.face_0 : wedge.face_n, cosine));
}

std::optional<ComplexMatrix2> transmission_of(const FacedWedge& wedge, const WedgeAngles& angles) {
  const auto t_0 = [&](double cosine) { return wedge.face_0(cosine).transmission; };
  const auto t_n = [&](double cosine) { return wedge.face_n(cosine).transmission; };
  if (wedge.one_sheet) return face_transmission_matrix(angles, WedgeFace::zero, t_0);
  return wedge_transmission_matrix(angles, t_0, t_n);
}

ComplexMatrix2 matrix_of(const FacedWedge& wedge, const WedgeAngles& angles, double distance, LossyWedge variant) {
  const auto r_0 = [&](double cosine) { return reflection_of(wedge.face_0, cosine); };
  const auto r_n = [&](double cosine) { return reflection_of(wedge.face_n, cosine); };
  return diffraction_matrix(angles, wave_number, equal_distances(distance),
                            wedge_matrices(angles, r_0, r_n, variant, transmission_of(wedge, angles)));
}

ComplexVector3 edge_field(const FacedWedge& wedge, const EdgeLink& link, const JonesVector& jones, LossyWedge variant) {
  const double share = link.source_radius / (link.source_radius + link.observer_radius);
  const Vec3 point(0, 0, share * link.height);
  const Vec3 incident = glm::normalize(point - link.source());
  const Vec3 diffracted = glm::normalize(link.observer() - point);
  const double before = glm::distance(point, link.source());
  const double after = glm::distance(point, link.observer());
  // The azimuths are those of the link: the kernel is tested, not the rounding of atan2.
  const double edge_angle = std::acos(incident.z);
  const WedgeAngles angles{wedge.n, link.source_azimuth, link.observer_azimuth, edge_angle};
  const ComplexMatrix2 m = matrix_of(wedge, angles, spherical_distance_parameter_m(before, after, edge_angle), variant);
  const Complex factor = diffraction_spreading(before, after) / before * unit_phasor(-wave_number * (before + after));
  return factor * diffract(sent(jones, incident), edge_bases({0, 0, 1}, incident, diffracted), m);
}

ComplexVector3 total_field(const FacedWedge& wedge, const EdgeLink& link, const JonesVector& jones,
                           LossyWedge variant) {
  return direct_field(wedge, link, jones) + mirrored_field(wedge, link, jones, WedgeFace::zero) +
         mirrored_field(wedge, link, jones, WedgeFace::n) + edge_field(wedge, link, jones, variant);
}

/// The jump between ±offset about a boundary, relative to the free-space field.
double jump(const FacedWedge& wedge, EdgeLink link, double boundary, double offset, const JonesVector& jones,
            LossyWedge variant) {
  link.observer_azimuth = boundary - offset;
  const ComplexVector3 before = total_field(wedge, link, jones, variant);
  link.observer_azimuth = boundary + offset;
  const ComplexVector3 after = total_field(wedge, link, jones, variant);
  return std::sqrt(norm_squared(after - before)) * glm::distance(link.source(), link.observer());
}

/// Azimuths of the observer at which something begins or ends, inside the exterior.
std::vector<double> boundaries(double n, double source) {
  std::vector<double> all;
  for (const double azimuth : {source + pi, source - pi, pi - source, (2.0 * n - 1.0) * pi - source})
    if (azimuth > 0.02 && azimuth < n * pi - 0.02) all.push_back(azimuth);
  return all;
}

const std::vector<JonesVector> jones_vectors{
    {1.0, 0.0}, {0.0, 1.0}, {Complex(0.6, 0.1), Complex(-0.3, 0.72)}, {std::sqrt(0.5), Complex(0.0, -std::sqrt(0.5))}};

constexpr LossyWedge variants[] = {LossyWedge::holm_reciprocal, LossyWedge::reciprocal, LossyWedge::luebbers84};

}  // namespace

TEST_CASE("continuity: geometrical optics and diffraction join at every shadow and reflection boundary") {
  double worst = 0.0;
  int crossed = 0;
  for (const NamedWedge& named : wedges())
    for (const LossyWedge variant : variants)
      for (const double height : {0.0, 3.0, -9.0, 20.0})
        for (const double source : {0.4, 1.1, 2.0, 3.5}) {
          if (source > named.wedge.n * pi - 0.1) continue;
          const EdgeLink link{source, 0.0, height};
          for (const double boundary : boundaries(named.wedge.n, source))
            for (const JonesVector& jones : jones_vectors) {
              CAPTURE(named.name);
              CAPTURE(static_cast<int>(variant));
              CAPTURE(height);
              CAPTURE(source);
              CAPTURE(boundary);
              const double wide = jump(named.wedge, link, boundary, 1e-5, jones, variant);
              const double narrow = jump(named.wedge, link, boundary, 1e-8, jones, variant);
              // Linear: a thousandth of the step, a thousandth of the jump. The slope is that of the field itself,
              // some k·r per radian; phases of 1e4 rad are rounded to 2e-12.
              REQUIRE(wide <= 4.0 * wave_number * 5.0 * 1e-5);
              REQUIRE(narrow <= 1.1e-3 * wide + 1e-11);
              worst = std::max(worst, narrow);
              ++crossed;
            }
        }
  MESSAGE(crossed << " crossings, largest jump over 2e-8 rad: " << worst);
  CHECK(crossed > 2000);
}

TEST_CASE("continuity: what the crossings above rest on would be seen to fail") {
  const FacedWedge concrete{1.5, half_space({5.24, -0.39}), half_space({5.24, -0.39})};
  const EdgeLink link{0.7, 0.0, 6.0};
  const double boundary = pi - 0.7;
  const JonesVector jones{0.6, 0.8};
  CHECK(jump(concrete, link, boundary, 1e-8, jones, LossyWedge::holm_reciprocal) <= 5e-5);  // k·r times 2e-8
  // sin φ' alone for the cosine, without sin β0: the coefficients of another angle in the face terms.
  const double sine = 8.0 / 10.0;
  const auto wrong = [&](double cosine) { return half_space_reflection({5.24, -0.39}, cosine / sine); };
  const auto edge = [&](double azimuth) {
    const WedgeAngles angles{1.5, 0.7, azimuth, std::acos(0.6)};
    const auto right = [](double cosine) { return half_space_reflection({5.24, -0.39}, cosine); };
    const UtdTerms terms = utd_terms(angles, wave_number, equal_distances(1.0));
    return std::sqrt(norm_squared(wedge_matrices(angles, right, right).combine(terms) +
                                  Complex(-1.0) * wedge_matrices(angles, wrong, wrong).combine(terms)));
  };
  // At the boundary the face term alone is √L/2 = 0.5; the mistake is a jump of twice what is shown here.
  CHECK(edge(boundary) > 0.005);
  // A penetrable sheet with the terms of an opaque one jumps by |T| at the shadow boundary.
  const FacedWedge glass{2.0, constant(0.74, 0.56), constant(0.74, 0.56), true};
  FacedWedge opaque = glass;
  opaque.face_0 = opaque.face_n = constant(0.74, 0.0);
  EdgeLink shadow{0.7, 0.7 + pi + 1e-9, 6.0};
  const ComplexVector3 through = direct_field(glass, shadow, jones) + edge_field(opaque, shadow, jones, variants[0]);
  shadow.observer_azimuth = 0.7 + pi - 1e-9;
  const ComplexVector3 lit = direct_field(glass, shadow, jones) + edge_field(opaque, shadow, jones, variants[0]);
  CHECK(std::sqrt(norm_squared(through - lit)) * glm::distance(shadow.source(), shadow.observer()) ==
        doctest::Approx(0.56).epsilon(1e-4));
}

TEST_CASE("reciprocity: the reverse ray has the transposed matrix, but for luebbers84") {
  // Reversed, s' → −s and s → −s': β̂0' → −β̂0, φ̂' → φ̂, so M_rev = Σ·Mᵀ·Σ with Σ = diag(1, −1), and β0 → π − β0.
  const ComplexMatrix2 sign = diagonal_matrix(1.0, -1.0);
  double worst[3] = {0.0, 0.0, 0.0};
  for (const NamedWedge& named : wedges())
    for (const LossyWedge variant : variants)
      for (const double edge_angle : {0.5, 1.2, 0.5 * pi, 2.2})
        for (int i = 1; i < 10; ++i)
          for (int j = 1; j < 12; ++j) {
            const double source = named.wedge.n * pi * i / 10.13;
            const double observer = named.wedge.n * pi * j / 12.07;
            const WedgeAngles there{named.wedge.n, source, observer, edge_angle};
            const WedgeAngles back{named.wedge.n, observer, source, pi - edge_angle};
            const ComplexMatrix2 forward = matrix_of(named.wedge, there, 1.7, variant);
            const ComplexMatrix2 reverse = sign * transposed(matrix_of(named.wedge, back, 1.7, variant)) * sign;
            const double difference =
                std::sqrt(norm_squared(forward + Complex(-1.0) * reverse) / std::max(norm_squared(forward), 1e-6));
            worst[static_cast<int>(variant)] = std::max(worst[static_cast<int>(variant)], difference);
          }
  MESSAGE("holm " << worst[0] << ", reciprocal " << worst[1] << ", luebbers84 " << worst[2]);
  CHECK(worst[0] <= 1e-12);
  CHECK(worst[1] <= 1e-12);
  CHECK(worst[2] > 0.1);
}

TEST_CASE("the three variants are one for a conductor, and a transparent sheet does nothing") {
  for (const double edge_angle : {0.6, 0.5 * pi})
    for (const double observer : {0.3, 1.9, 4.2}) {
      const WedgeAngles angles{1.5, 0.8, observer, edge_angle};
      const FacedWedge metal{1.5, conductor(), conductor()};
      const ComplexMatrix2 holm = matrix_of(metal, angles, 2.0, LossyWedge::holm_reciprocal);
      const UtdTerms terms = utd_terms(angles, wave_number, equal_distances(2.0));
      CHECK(std::sqrt(norm_squared(holm + diagonal_matrix(terms.soft(), terms.hard()))) <= 1e-15);
      for (const LossyWedge variant : variants) {
        const ComplexMatrix2 other = matrix_of(metal, angles, 2.0, variant);
        CHECK(std::sqrt(norm_squared(holm + Complex(-1.0) * other)) <= 1e-15);
        const FacedWedge nothing{1.5, slab(1.0, 4.0), slab(1.0, 9.0)};
        CHECK(norm_squared(matrix_of(nothing, angles, 2.0, variant)) <= 1e-28);
      }
    }
}

TEST_CASE("lit from either side: the mirrored wedge gives the mirrored field") {
  // Turned about the plane that halves the exterior, faces change places and φ̂ its sign: M → Σ·M·Σ.
  const ComplexMatrix2 sign = diagonal_matrix(1.0, -1.0);
  const FacedWedge wedge{1.5, half_space({5.24, -0.39}), slab({6.31, -0.2}, 3.0)};
  const FacedWedge mirror{1.5, wedge.face_n, wedge.face_0};
  for (const LossyWedge variant : variants)
    for (const double source : {0.3, 1.2, 3.9})
      for (const double observer : {0.9, 2.5, 4.4}) {
        const ComplexMatrix2 first = matrix_of(wedge, {1.5, source, observer, 0.9}, 2.0, variant);
        const ComplexMatrix2 second =
            matrix_of(mirror, {1.5, 1.5 * pi - source, 1.5 * pi - observer, 0.9}, 2.0, variant);
        CHECK(std::sqrt(norm_squared(first + Complex(-1.0) * (sign * second * sign))) <= 1e-13);
        CHECK(std::sqrt(norm_squared(first)) > 1e-4);
      }
}

TEST_CASE("holm: what meets both faces is reflected by the face towards the source first, at oblique incidence, too") {
  // φ ≥ φ': face 0 stands on the right of the product, which belongs to D1; otherwise face n does, and it is D2's.
  const FacedWedge wedge{1.5, half_space({5.24, -0.39}), half_space({15.0, -6.0})};
  for (const bool forward : {true, false}) {
    const WedgeAngles angles{1.5, forward ? 0.7 : 3.1, forward ? 3.1 : 0.7, 0.9};
    const auto reflection = [&](WedgeFace face) {
      const FaceModel& surface = face == WedgeFace::zero ? wedge.face_0 : wedge.face_n;
      return face_reflection_matrix(angles, face, LossyWedge::holm_reciprocal,
                                    [&](double cosine) { return surface(cosine).reflection; });
    };
    const ComplexMatrix2 g_0 = reflection(WedgeFace::zero), g_n = reflection(WedgeFace::n);
    const ComplexMatrix2 expected = forward ? g_n * g_0 : g_0 * g_n;
    const ComplexMatrix2 other_order = forward ? g_0 * g_n : g_n * g_0;
    const WedgeMatrices matrices = wedge_matrices(
        angles, [&](double cosine) { return wedge.face_0(cosine).reflection; },
        [&](double cosine) { return wedge.face_n(cosine).reflection; }, LossyWedge::holm_reciprocal);
    const ComplexMatrix2& twice = forward ? matrices.incident_plus : matrices.incident_minus;
    CHECK(std::sqrt(norm_squared(twice + expected)) <= 1e-15);  // the same products, of numbers up to 1
    CHECK(std::sqrt(norm_squared(twice + other_order)) > 1e-3);
  }
}

TEST_CASE("luebbers84: with the source halfway between the faces one of them, face 0, takes its azimuth") {
  // sin β0 = 1: the cosine of incidence is the sine of the azimuth that a face takes.
  const WedgeAngles angles{1.5, 0.75 * pi, 1.1 * pi, 0.5 * pi};
  const auto cosine_at = [&](WedgeFace face) {
    double asked = 0.0;
    face_reflection_matrix(angles, face, LossyWedge::luebbers84, [&](double cosine) {
      asked = cosine;
      return perfect_conductor_reflection();
    });
    return asked;
  };
  CHECK(cosine_at(WedgeFace::zero) == doctest::Approx(std::sin(0.75 * pi)).epsilon(1e-14));
  CHECK(cosine_at(WedgeFace::n) == doctest::Approx(std::sin(pi - (1.5 - 1.1) * pi)).epsilon(1e-14));
}

}  // namespace test_wedge_continuity
