#include <doctest/doctest.h>

#include <vector>

#include "dcem/em/antenna/polarization.hpp"
#include "dcem/em/dyad.hpp"
#include "dcem/em/surface/slab.hpp"

namespace test_dyad {

using namespace dcem;

namespace {

// A dozen operations on components up to one.
constexpr double rounding = 1e-14;

struct Bounce {
  Vec3 propagation, normal;
};

/// Incidence from grazing to normal, tilted surfaces, and angles on both sides of the branch at 1e-9.
std::vector<Bounce> bounces() {
  std::vector<Bounce> result;
  for (const Vec3& raw_normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.3, -0.5, 0.7), Vec3(-1, 2, 0.01)}) {
    const Vec3 normal = glm::normalize(raw_normal);
    const PlaneBasis basis = plane_basis(normal);
    for (const double angle_rad : {0.0, 1e-12, 0.9e-9, 1.1e-9, 1e-8, 1e-6, 0.01, 0.5, 1.2, 1.57, 1.5707963})
      for (const double turn_rad : {0.0, 0.8, 2.5}) {
        const Vec3 along = std::cos(turn_rad) * basis.u + std::sin(turn_rad) * basis.v;
        result.push_back({glm::normalize(std::sin(angle_rad) * along - std::cos(angle_rad) * normal), normal});
      }
  }
  return result;
}

ComplexVector3 transverse_field(const Vec3& propagation) {
  const PlaneBasis basis = plane_basis(propagation);
  return scaled(basis.u, Complex(0.6, 0.1)) + scaled(basis.v, Complex(-0.3, 0.7));
}

double size(const ComplexVector3& field) {
  return std::sqrt(norm_squared(field));
}

PolarizedCoefficients concrete(const Bounce& bounce) {
  return half_space_reflection({5.24, -0.4}, std::abs(glm::dot(bounce.propagation, bounce.normal)));
}

/// Rounding, and the 1e-9 by which a direction taken as normal may differ from it.
double bound(const Bounce& bounce) {
  const double sine = glm::length(glm::cross(bounce.propagation, bounce.normal));
  return sine < 1e-9 ? rounding + 4.0 * sine : rounding;
}

/// The field in (θ̂, φ̂) of `from`, turned by a 2×2 rotation into (perpendicular, parallel) of the surface.
ComplexMatrix2 rotation(const Vec3& perpendicular, const Vec3& parallel, const Vec3& theta, const Vec3& phi) {
  return {{{{glm::dot(perpendicular, theta), glm::dot(perpendicular, phi)},
            {glm::dot(parallel, theta), glm::dot(parallel, phi)}}}};
}

}  // namespace

TEST_CASE("perfect conductor: E_r = 2(n·E)n − E, at every angle and for both polarizations") {
  for (const Bounce& bounce : bounces()) {
    const ComplexVector3 incident = transverse_field(bounce.propagation);
    const ComplexVector3 expected = scaled(bounce.normal, 2.0 * dot(incident, bounce.normal)) - incident;
    const ComplexVector3 got = reflect(incident, bounce.propagation, bounce.normal, perfect_conductor_reflection());
    CHECK(size(got - expected) <= bound(bounce));
    // Hence no tangential field on the surface: TE and TM parts cancel there.
    const PlaneBasis basis = plane_basis(bounce.normal);
    CHECK(std::abs(dot(incident + got, basis.u)) <= bound(bounce));
    CHECK(std::abs(dot(incident + got, basis.v)) <= bound(bounce));
  }
}

TEST_CASE("the reflected field is transverse to the reflected ray, and nothing depends on the sign of the normal") {
  for (const Bounce& bounce : bounces()) {
    const ComplexVector3 incident = transverse_field(bounce.propagation);
    const ComplexVector3 got = reflect(incident, bounce.propagation, bounce.normal, concrete(bounce));
    const Vec3 onward = reflected_direction(bounce.propagation, bounce.normal);
    CHECK(std::abs(glm::length(onward) - 1.0) <= rounding);
    CHECK(std::abs(dot(got, onward)) <= bound(bounce));
    CHECK(size(got - reflect(incident, bounce.propagation, -bounce.normal, concrete(bounce))) <= rounding);
    CHECK(size(got) <= size(incident) + rounding);
  }
}

TEST_CASE("through nothing the field passes unchanged; a sheet keeps it transverse") {
  for (const Bounce& bounce : bounces()) {
    const ComplexVector3 incident = transverse_field(bounce.propagation);
    CHECK(size(transmit(incident, bounce.propagation, bounce.normal, {1.0, 1.0}) - incident) <= rounding);
    const double cos_incidence = std::abs(glm::dot(bounce.propagation, bounce.normal));
    const auto slab = slab_response({6.31, -0.2}, 3.0, cos_incidence);
    const ComplexVector3 behind = transmit(incident, bounce.propagation, bounce.normal, slab.transmission);
    CHECK(std::abs(dot(behind, bounce.propagation)) <= rounding);
    CHECK(size(behind - transmit(incident, bounce.propagation, -bounce.normal, slab.transmission)) <= rounding);
    // No more power behind and in front than came.
    const ComplexVector3 back = reflect(incident, bounce.propagation, bounce.normal, slab.reflection);
    CHECK(norm_squared(behind) + norm_squared(back) <= norm_squared(incident) + rounding);
  }
}

TEST_CASE("polarizations are separated: TE across the plane of incidence, TM in it") {
  // Ray coming down at 45° in the x-z plane on the ground: TE is y, TM lies in the plane.
  const Vec3 propagation = glm::normalize(Vec3(1, 0, -1)), normal(0, 0, 1);
  const PolarizedCoefficients reflection{Complex(-0.5, 0.1), Complex(0.2, -0.3)};
  const ComplexVector3 te = reflect(ComplexVector3(Vec3(0, 1, 0)), propagation, normal, reflection);
  CHECK(size(te - scaled(Vec3(0, 1, 0), reflection.te)) <= rounding);
  // E = (1,0,1)/√2; its tangential part x reflects with −R_tm, its normal part z with +R_tm.
  const ComplexVector3 tm = reflect(ComplexVector3(glm::normalize(Vec3(1, 0, 1))), propagation, normal, reflection);
  CHECK(size(tm - scaled(glm::normalize(Vec3(-1, 0, 1)), reflection.tm)) <= rounding);
}

TEST_CASE("the answer is continuous through normal incidence") {
  const Vec3 normal(0, 0, 1);
  const PolarizedCoefficients reflection = half_space_reflection({5.24, -0.4}, 1.0);
  const ComplexVector3 straight = reflect(ComplexVector3(Vec3(1, 0, 0)), Vec3(0, 0, -1), normal, reflection);
  for (const double angle_rad : {1e-10, 1e-9, 1e-8, 1e-7})
    for (const double turn_rad : {0.0, 1.0, 2.0, 4.0}) {
      const Vec3 propagation(std::sin(angle_rad) * std::cos(turn_rad), std::sin(angle_rad) * std::sin(turn_rad),
                             -std::cos(angle_rad));
      const Vec3 across = glm::normalize(Vec3(1, 0, 0) - propagation.x * propagation);
      const ComplexVector3 tilted = reflect(ComplexVector3(across), propagation, normal, reflection);
      // The directions themselves turn by angle, the reflected one by twice that.
      CHECK(size(tilted - straight) <= 4.0 * angle_rad);
    }
}

TEST_CASE("vectors and 2×2 rotation matrices give the same transfer over three bounces") {
  const Vec3 normals[] = {glm::normalize(Vec3(0.1, 0.9, -0.2)), Vec3(0, 0, 1), glm::normalize(Vec3(-0.8, 0.3, 0.4))};
  const Vec3 departure = glm::normalize(Vec3(0.5, 0.6, -0.7));
  Vec3 direction = departure;
  ComplexVector3 columns[] = {ComplexVector3(theta_hat(departure)), ComplexVector3(phi_hat(departure))};
  ComplexMatrix2 matrix = diagonal_matrix(1.0, 1.0);
  for (const Vec3& normal : normals) {
    const double cos_incidence = std::abs(glm::dot(direction, normal));
    const PolarizedCoefficients reflection = half_space_reflection({5.24, -0.4}, cos_incidence);
    for (ComplexVector3& column : columns) column = reflect(column, direction, normal, reflection);
    // The matrix route: into the basis of the surface, the diagonal of coefficients, out into (θ̂, φ̂) of the next leg.
    const Vec3 onward = reflected_direction(direction, normal);
    const Vec3 perpendicular = glm::normalize(glm::cross(normal, direction));  // the other sign than the engine's
    const ComplexMatrix2 in =
        rotation(perpendicular, glm::cross(perpendicular, direction), theta_hat(direction), phi_hat(direction));
    const ComplexMatrix2 out =
        rotation(perpendicular, glm::cross(perpendicular, onward), theta_hat(onward), phi_hat(onward));
    matrix = transposed(out) * diagonal_matrix(reflection.te, reflection.tm) * in * matrix;
    direction = onward;
  }
  for (std::size_t column = 0; column < 2; ++column) {
    CHECK(std::abs(dot(columns[column], theta_hat(direction)) - matrix(0, column)) <= rounding);
    CHECK(std::abs(dot(columns[column], phi_hat(direction)) - matrix(1, column)) <= rounding);
  }
  CHECK(norm_squared(matrix) > 0.01);  // the comparison is not one of zeros
}

TEST_CASE("reciprocity: the reversed bounce has the transposed transfer in outgoing bases") {
  for (const Bounce& bounce : bounces()) {
    const PolarizedCoefficients reflection = concrete(bounce);
    const Vec3 onward = reflected_direction(bounce.propagation, bounce.normal);
    const auto transfer = [&](const Vec3& first, const Vec3& last) {
      ComplexMatrix2 result;
      const Vec3 transmit_basis[] = {theta_hat(first), phi_hat(first)};
      const Vec3 receive_basis[] = {theta_hat(-last), phi_hat(-last)};
      for (std::size_t column = 0; column < 2; ++column) {
        const auto field = reflect(ComplexVector3(transmit_basis[column]), first, bounce.normal, reflection);
        for (std::size_t row = 0; row < 2; ++row) result(row, column) = dot(field, receive_basis[row]);
      }
      return result;
    };
    const ComplexMatrix2 forward = transfer(bounce.propagation, onward);
    const ComplexMatrix2 backward = transfer(-onward, -bounce.propagation);
    // Next to a pole the bases themselves turn quickly: rounding divided by the distance from it.
    const double off_pole =
        std::min(std::hypot(bounce.propagation.x, bounce.propagation.y), std::hypot(onward.x, onward.y));
    if (off_pole < 1e-3) continue;
    CHECK(std::sqrt(norm_squared(forward + Complex(-1.0) * transposed(backward))) <=
          bound(bounce) + rounding / off_pole);
  }
}

}  // namespace test_dyad
