/// Antennas that are turned: the field turns with them, as a vector.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/em/antenna/antenna.hpp"

namespace test_antenna_orientation {

using namespace dcem;

namespace {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  Vec3 direction() {
    const double z = between(-1.0, 1.0), azimuth = between(-pi, pi), across = std::sqrt(1.0 - z * z);
    return {across * std::cos(azimuth), across * std::sin(azimuth), z};
  }
  /// Made of two directions, not of the angles under test.
  Mat3 rotation() {
    const Vec3 x = direction(), z = glm::normalize(glm::cross(x, direction()));
    return Mat3(x, glm::cross(z, x), z);
  }

 private:
  RandomStream random_;
};

/// The field of a port as a vector in the world.
ComplexVector3 field(const Antenna& antenna, const Vec3& direction, std::size_t port, const Mat3& rotation) {
  const JonesVector jones = antenna.port_jones(direction, port, rotation);
  return scaled(theta_hat(direction), jones[0]) + scaled(phi_hat(direction), jones[1]);
}

ComplexVector3 turned(const Mat3& rotation, const ComplexVector3& vector) {
  return scaled(rotation[0], vector.x) + scaled(rotation[1], vector.y) + scaled(rotation[2], vector.z);
}

std::vector<Antenna> all_antennas() {
  const auto table = std::make_shared<const PatternTable>(tabulated(Tr38901Element{}, 18, 13));
  std::vector<Antenna> antennas;
  for (const AntennaPattern& pattern :
       std::vector<AntennaPattern>{IsotropicPattern{}, HalfWaveDipole{}, Tr38901Element{}, TabulatedPattern{table}}) {
    for (const auto kind :
         {PolarizationKind::vertical, PolarizationKind::horizontal, PolarizationKind::slant,
          PolarizationKind::right_circular, PolarizationKind::left_circular, PolarizationKind::dual}) {
      antennas.push_back({3.0, {kind, 0.6}, pattern});
    }
  }
  return antennas;
}

/// What two antennas on a line of sight make of a field of amplitude 1: diag(1, -1) between their components.
Complex coupling(const Antenna& transmit, const Mat3& transmit_rotation, const Antenna& receive,
                 const Mat3& receive_rotation, const Vec3& direction) {
  return port_coupling(receive.port_jones(-direction, 0, receive_rotation), diagonal_matrix(1.0, -1.0),
                       transmit.port_jones(direction, 0, transmit_rotation));
}

double power(const JonesVector& jones) {
  return std::norm(jones[0]) + std::norm(jones[1]);
}

}  // namespace

TEST_CASE("turning the antenna and the world together changes nothing but the axes") {
  Draw draw(1);
  for (const Antenna& antenna : all_antennas()) {
    for (int trial = 0; trial < 50; ++trial) {
      const Mat3 world = draw.rotation(), rotation = trial == 0 ? Mat3(1.0) : draw.rotation();
      const Vec3 direction = draw.direction();
      for (std::size_t port = 0; port < antenna.port_count(); ++port) {
        const ComplexVector3 expected = turned(world, field(antenna, direction, port, rotation));
        const ComplexVector3 found = field(antenna, world * direction, port, world * rotation);
        // Directions carry 1e-15, which a basis magnifies by 1/sin of the angle to a pole (here above 0.01) and a
        // pattern by its slope.
        CHECK(norm_squared(found - expected) < 1e-24);
      }
    }
  }
}

TEST_CASE(
    "an antenna that is not turned, or turned about z alone, has the Jones vector of its polarization to the bit") {
  const Vec3 direction = glm::normalize(Vec3(0.3, -0.8, 0.4));
  for (const auto kind : {PolarizationKind::vertical, PolarizationKind::horizontal, PolarizationKind::slant,
                          PolarizationKind::right_circular, PolarizationKind::left_circular}) {
    const Antenna antenna{20.0, {kind, 0.7}};
    const JonesVector unit = *jones_vector({kind, 0.7});
    const JonesVector expected{10.0 * unit[0], 10.0 * unit[1]};  // 20 dBi
    CHECK(antenna.jones(direction) == expected);
    for (const double yaw : {0.0, 0.3, -2.0, pi}) {
      CHECK(antenna.jones(direction, rotation_matrix(Orientation{yaw})) == expected);
      CHECK(antenna.jones(Vec3(0, 0, 1), rotation_matrix(Orientation{yaw})) == expected);
    }
  }
}

TEST_CASE("yaw of an isotropic vertical antenna changes no gain; pitch and roll change no power") {
  Draw draw(2);
  const Antenna antenna{6.0, {PolarizationKind::vertical}};
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 direction = draw.direction();
    const Orientation turned_all{draw.between(-pi, pi), draw.between(-1.5, 1.5), draw.between(-pi, pi)};
    CHECK(std::abs(antenna.jones(direction, rotation_matrix(Orientation{draw.between(-pi, pi)}))[1]) == 0.0);
    // Cosine and sine of one angle: their squares sum to 1 within rounding.
    CHECK(power(antenna.jones(direction, rotation_matrix(turned_all))) ==
          doctest::Approx(std::pow(10.0, 0.6)).epsilon(1e-13));
  }
}

TEST_CASE("a vertical dipole that is laid on its side is a horizontal one at broadside") {
  const Antenna dipole{0.0, {PolarizationKind::vertical}, HalfWaveDipole{}};
  const double broadside = std::sqrt(half_wave_dipole_directivity);
  // Rolled by 90 degrees its upper end points to -y. Upright the field at +x is along -z, away from the upper end; so
  // now it is along +y, which is φ̂ there.
  const Mat3 rolled = rotation_matrix(Orientation{0.0, 0.0, pi / 2});
  const JonesVector ahead = dipole.jones(Vec3(1, 0, 0), rolled);
  CHECK(std::abs(ahead[0]) < 1e-15);
  CHECK(std::abs(ahead[1] - broadside) < 1e-15);
  // Above it the field is along the wire, too: +y again, φ̂ by the pole rule.
  const JonesVector above = dipole.jones(Vec3(0, 0, 1), rolled);
  CHECK(std::abs(above[1] - broadside) < 1e-15);
  CHECK(power(dipole.jones(Vec3(0, 1, 0), rolled)) < 1e-30);  // along the wire
  CHECK(power(dipole.jones(Vec3(0, -1, 0), rolled)) < 1e-30);
  // Pitched by 90 degrees the upper end points to +x: nothing ahead, all of it aside.
  const Mat3 pitched = rotation_matrix(Orientation{0.0, pi / 2, 0.0});
  CHECK(power(dipole.jones(Vec3(1, 0, 0), pitched)) < 1e-30);
  CHECK(std::abs(dipole.jones(Vec3(0, 1, 0), pitched)[1] - broadside) < 1e-15);  // along -x, which is φ̂ at +y
}

TEST_CASE("the beam points where yaw and pitch say: left and down are positive") {
  const Antenna sector{0.0, {PolarizationKind::vertical}, Tr38901Element{}};
  const double yaw = 0.5, down = 0.2;
  const Mat3 rotation = rotation_matrix(Orientation{yaw, down, 0.0});
  const Vec3 boresight(std::cos(down) * std::cos(yaw), std::cos(down) * std::sin(yaw), -std::sin(down));
  const double highest = std::pow(10.0, 0.8);
  CHECK(power(sector.jones(boresight, rotation)) == doctest::Approx(highest).epsilon(1e-12));
  Draw draw(3);
  for (int trial = 0; trial < 100; ++trial) CHECK(power(sector.jones(draw.direction(), rotation)) < highest);
  // 32.5 degrees aside of the beam the power is the half, 3 dB.
  const Mat3 level = rotation_matrix(Orientation{yaw});
  const double edge = yaw + 32.5 * pi / 180.0;
  CHECK(power(sector.jones(Vec3(std::cos(edge), std::sin(edge), 0), level)) ==
        doctest::Approx(highest * std::pow(10.0, -0.3)).epsilon(1e-12));
}

TEST_CASE("a slanted antenna that rolls about its boresight slants by so much more") {
  const double slant = 0.6, roll = 0.5;  // both turn the field from θ̂ to φ̂ about the outgoing direction
  const Antenna antenna{0.0, {PolarizationKind::slant, slant}};
  const JonesVector jones = antenna.jones(Vec3(1, 0, 0), rotation_matrix(Orientation{0.0, 0.0, roll}));
  CHECK(std::abs(jones[0] - std::cos(slant + roll)) < 1e-15);
  CHECK(std::abs(jones[1] - std::sin(slant + roll)) < 1e-15);
}

TEST_CASE("a circular antenna stays circular however it is turned, and hears its own hand alone") {
  Draw draw(4);
  const Antenna right{0.0, {PolarizationKind::right_circular}}, left{0.0, {PolarizationKind::left_circular}};
  for (int trial = 0; trial < 100; ++trial) {
    const Mat3 a = draw.rotation(), b = draw.rotation();
    const Vec3 direction = draw.direction();
    const JonesVector jones = right.jones(direction, a);
    CHECK(std::abs(jones[1] + Complex(0, 1) * jones[0]) < 1e-14);  // the second is -j times the first
    CHECK(std::abs(coupling(right, a, right, b, direction)) == doctest::Approx(1.0).epsilon(1e-13));
    CHECK(std::abs(coupling(right, a, left, b, direction)) < 1e-14);
  }
}

TEST_CASE("turned antennas are reciprocal: exchanging the ends changes nothing") {
  Draw draw(5);
  const std::vector<Antenna> antennas = all_antennas();
  for (int trial = 0; trial < 300; ++trial) {
    const Antenna& first = antennas[static_cast<std::size_t>(draw.between(0, double(antennas.size())))];
    const Antenna& second = antennas[static_cast<std::size_t>(draw.between(0, double(antennas.size())))];
    const Mat3 a = draw.rotation(), b = draw.rotation();
    const Vec3 direction = draw.direction();
    const Complex there = coupling(first, a, second, b, direction), back = coupling(second, b, first, a, -direction);
    CHECK(std::abs(there - back) < 1e-13 * (1.0 + std::abs(there)));
  }
}

TEST_CASE("two crossed dipoles couple as the cosine of the angle between their wires says") {
  const Antenna dipole{0.0, {PolarizationKind::vertical}, HalfWaveDipole{}};
  for (const double angle : {0.0, 0.4, pi / 4, 1.2, pi / 2}) {
    // Both at broadside on the x axis, the second rolled about it.
    const Complex h = coupling(dipole, Mat3(1.0), dipole, rotation_matrix(Orientation{0.0, 0.0, angle}), Vec3(1, 0, 0));
    CHECK(std::abs(h) == doctest::Approx(half_wave_dipole_directivity * std::abs(std::cos(angle))).epsilon(1e-13));
  }
}

TEST_CASE("an orientation that is not finite, a table that is not there and an array that is none are refused") {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const Antenna& antenna) { CHECK_THROWS_AS(validate(antenna), std::invalid_argument); };
  refused({0.0, {}, IsotropicPattern{}, {std::nan(""), 0.0, 0.0}});
  refused({0.0, {}, IsotropicPattern{}, {0.0, infinity, 0.0}});
  refused({0.0, {}, TabulatedPattern{}});
  refused({0.0, {}, IsotropicPattern{}, {}, {0, 1}});
  refused({0.0, {}, IsotropicPattern{}, {}, {1, 0}});
  refused({0.0, {}, IsotropicPattern{}, {}, {64, 65}});
  refused({0.0, {}, IsotropicPattern{}, {}, {2, 2, 0.0}});
  refused({0.0, {}, IsotropicPattern{}, {}, {2, 2, infinity}});
  CHECK_NOTHROW(validate(Antenna{0.0, {}, Tr38901Element{}, {1.0, 2.0, 3.0}, {64, 64, 0.7}}));
}

}  // namespace test_antenna_orientation
