#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/em/antenna/polarization.hpp"

namespace test_polarization {

using namespace dcem;

namespace {

constexpr double rounding = 1e-15;  // a few roundings of numbers up to one

std::vector<Vec3> directions() {
  std::vector<Vec3> result{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0.6, 0, 0.8}, {0, -0.6, -0.8}};
  for (const double azimuth : {0.1, 1.9, -2.7, 3.1})
    for (const double zenith : {1e-9, 0.3, 1.5, 2.9, pi - 1e-7})
      result.emplace_back(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth), std::cos(zenith));
  return result;
}

/// Next to the poles, down to the smallest number there is.
std::vector<Vec3> polar_directions() {
  std::vector<Vec3> result;
  for (const double up : {1.0, -1.0})
    for (const double size : {1e-150, 1e-200, 1e-300, 1e-310, std::numeric_limits<double>::denorm_min()})
      for (const double sign : {1.0, -1.0}) {
        result.emplace_back(sign * size, 0.0, up);
        result.emplace_back(size, sign * size, up);
      }
  return result;
}

void check_right_handed(const Vec3& d) {
  CAPTURE(d.x);
  CAPTURE(d.y);
  CAPTURE(d.z);
  const Vec3 theta = theta_hat(d), phi = phi_hat(d);
  CHECK(std::abs(glm::length(theta) - 1.0) <= rounding);
  CHECK(std::abs(glm::length(phi) - 1.0) <= rounding);
  CHECK(std::abs(glm::dot(theta, phi)) <= rounding);
  CHECK(glm::length(glm::cross(theta, phi) - d / glm::length(d)) <= rounding);
}

}  // namespace

TEST_CASE("θ̂, φ̂ and the direction form a right-handed frame everywhere, next to the poles too") {
  for (const Vec3& d : directions()) check_right_handed(d);
  for (const Vec3& d : polar_directions()) check_right_handed(d);
  for (const Vec3& d : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(-0.0, -0.0, 1), Vec3(-0.0, 0.0, -1)}) check_right_handed(d);
}

TEST_CASE("θ̂ grows with the zenith angle and φ̂ with the azimuth") {
  const double step = 1e-6;
  for (const double azimuth : {0.4, -2.0})
    for (const double zenith : {0.7, 2.2}) {
      const auto direction = [](double z, double a) {
        return Vec3(std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z));
      };
      const Vec3 d = direction(zenith, azimuth);
      const Vec3 along_zenith = (direction(zenith + step, azimuth) - direction(zenith - step, azimuth)) / (2.0 * step);
      const Vec3 along_azimuth = (direction(zenith, azimuth + step) - direction(zenith, azimuth - step)) / (2.0 * step);
      // Central differences: step² and rounding/step, both below 1e-9.
      CHECK(glm::length(theta_hat(d) - along_zenith) <= 1e-9);
      CHECK(glm::length(phi_hat(d) - along_azimuth / std::sin(zenith)) <= 1e-9);
      CHECK(zenith_rad(d) == doctest::Approx(zenith).epsilon(rounding));
      CHECK(azimuth_rad(d) == doctest::Approx(azimuth).epsilon(rounding));
    }
}

TEST_CASE("seen from the other end θ̂ is the same and φ̂ is reversed, bit for bit") {
  for (const Vec3& d : directions()) {
    CHECK(theta_hat(-d) == theta_hat(d));
    CHECK(phi_hat(-d) == -phi_hat(d));
  }
  for (const Vec3& d : polar_directions()) {
    CHECK(theta_hat(-d) == theta_hat(d));
    CHECK(phi_hat(-d) == -phi_hat(d));
  }
}

TEST_CASE("pole rule: φ = 0, whatever the sign of a zero") {
  for (const double x : {0.0, -0.0})
    for (const double y : {0.0, -0.0}) {
      CHECK(theta_hat({x, y, 1}) == Vec3(1, 0, 0));
      CHECK(theta_hat({x, y, -1}) == Vec3(-1, 0, 0));
      CHECK(phi_hat({x, y, 1}) == Vec3(0, 1, 0));
      CHECK(phi_hat({x, y, -1}) == Vec3(0, 1, 0));
      CHECK(azimuth_rad({x, y, -1}) == 0.0);
    }
  CHECK(zenith_rad({0, 0, 1}) == 0.0);
  CHECK(zenith_rad({0, 0, -2}) == pi);
  CHECK_THROWS_AS(theta_hat({0, 0, 0}), InvariantError);
}

TEST_CASE("azimuth lies in (−π, π]: −x has one azimuth") {
  CHECK(azimuth_rad({-1, 0.0, 0}) == pi);
  CHECK(azimuth_rad({-1, -0.0, 0}) == pi);
  CHECK(azimuth_rad({-1, -1e-300, 0}) == pi);
  CHECK(azimuth_rad({0, 1, 5}) == pi / 2);
  CHECK(azimuth_rad({0, -1, 5}) == -pi / 2);
}

TEST_CASE("line of sight: V to V keeps its sign, H to H turns it") {
  for (const Vec3& d : directions()) {
    const ComplexMatrix2 sight =
        diagonal_matrix(glm::dot(theta_hat(-d), theta_hat(d)), glm::dot(phi_hat(-d), phi_hat(d)));
    CHECK(std::abs(sight(0, 0) - 1.0) <= rounding);
    CHECK(std::abs(sight(1, 1) + 1.0) <= rounding);
    const JonesVector v = *jones_vector({PolarizationKind::vertical, 0.0});
    const JonesVector h = *jones_vector({PolarizationKind::horizontal, 0.0});
    CHECK(std::abs(port_coupling(v, sight, v) - 1.0) <= rounding);
    CHECK(std::abs(port_coupling(h, sight, h) + 1.0) <= rounding);
    CHECK(std::abs(port_coupling(h, sight, v)) <= rounding);
    // Two equal antennas slanted by 45° face each other crossed.
    const JonesVector slant = *jones_vector({PolarizationKind::slant, pi / 4});
    const JonesVector other = *jones_vector({PolarizationKind::slant, -pi / 4});
    CHECK(std::abs(port_coupling(slant, sight, slant)) <= rounding);
    CHECK(std::abs(port_coupling(other, sight, slant) - 1.0) <= rounding);
  }
}

TEST_CASE("circular: the field of RHC turns from θ̂ to φ̂ in time, right-handed about the direction of travel") {
  const JonesVector right = *jones_vector({PolarizationKind::right_circular, 0.0});
  const JonesVector left = *jones_vector({PolarizationKind::left_circular, 0.0});
  // Real part of c·exp(jωt) a quarter of a period later.
  CHECK((right[0] * unit_phasor(0.0)).real() == doctest::Approx(std::sqrt(0.5)));
  CHECK((right[1] * unit_phasor(pi / 2)).real() == doctest::Approx(std::sqrt(0.5)));
  CHECK((left[1] * unit_phasor(pi / 2)).real() == doctest::Approx(-std::sqrt(0.5)));
  CHECK(std::abs(std::conj(right[0]) * left[0] + std::conj(right[1]) * left[1]) <= rounding);  // orthogonal
}

TEST_CASE("the coupling is c_rxᵀ T c_tx, and the reverse link has the same") {
  const ComplexMatrix2 transfer{{{{Complex(1, 2), Complex(0, 1)}, {Complex(3, 0), Complex(-1, 1)}}}};
  const JonesVector receive{Complex(1, 1), Complex(0, 2)}, transmit{Complex(2, 0), Complex(0, 1)};
  // T·c = (2+4j − 1, 6 − j − 1) = (1+4j, 5−j); (1+j)(1+4j) + 2j(5−j) = −3+5j + 2+10j = −1+15j.
  CHECK(port_coupling(receive, transfer, transmit) == Complex(-1, 15));
  CHECK(port_coupling(transmit, transposed(transfer), receive) == Complex(-1, 15));
}

TEST_CASE("circular: on a line of sight RHC hears RHC and not LHC; one mirror swaps them") {
  const JonesVector right = *jones_vector({PolarizationKind::right_circular, 0.0});
  const JonesVector left = *jones_vector({PolarizationKind::left_circular, 0.0});
  const ComplexMatrix2 sight = diagonal_matrix(1.0, -1.0);
  CHECK(std::abs(port_coupling(right, sight, right)) == doctest::Approx(1.0));
  CHECK(std::abs(port_coupling(left, sight, right)) <= rounding);
  const ComplexMatrix2 mirror = diagonal_matrix(1.0, 1.0);  // V keeps its sign, H takes one more: a perfect conductor
  CHECK(std::abs(port_coupling(right, mirror, right)) <= rounding);
  CHECK(std::abs(port_coupling(left, mirror, right)) == doctest::Approx(1.0));
}

TEST_CASE("Jones vectors have unit length, and dual has none") {
  for (const auto kind : {PolarizationKind::vertical, PolarizationKind::horizontal, PolarizationKind::slant,
                          PolarizationKind::right_circular, PolarizationKind::left_circular}) {
    const auto jones = jones_vector({kind, 0.3});
    REQUIRE(jones);
    CHECK(std::abs(std::norm((*jones)[0]) + std::norm((*jones)[1]) - 1.0) <= rounding);
  }
  CHECK(jones_vector({PolarizationKind::slant, 0.3}) == JonesVector{std::cos(0.3), std::sin(0.3)});
  CHECK_FALSE(jones_vector({PolarizationKind::dual, 0.0}));
}

}  // namespace test_polarization
