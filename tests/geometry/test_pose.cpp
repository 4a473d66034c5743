#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "dcem/core/random.hpp"
#include "dcem/geometry/pose.hpp"

namespace test_pose {

using namespace dcem;

namespace {

using Matrix = std::array<std::array<long double, 3>, 3>;  // [row][column]

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

/// The right-handed turn about axis 0, 1 or 2.
Matrix turn(std::size_t axis, long double angle_rad) {
  Matrix m{};
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  m[axis][axis] = 1;
  m[i][i] = m[j][j] = std::cos(angle_rad);
  m[j][i] = std::sin(angle_rad);
  m[i][j] = -std::sin(angle_rad);
  return m;
}

Matrix independent(const Pose& pose) {
  return product(product(turn(2, pose.yaw_rad), turn(1, pose.pitch_rad)), turn(0, pose.roll_rad));
}

Pose random_pose(RandomStream& random) {
  const auto angle = [&] { return 8.0 * (random.uniform() - 0.5); };
  const double yaw = angle(), pitch = angle(), roll = angle();
  return {Vec3(0.0), yaw, pitch, roll};
}

}  // namespace

TEST_CASE("the rotation is Rz(yaw)·Ry(pitch)·Rx(roll), by a product of matrices in long double") {
  RandomStream random(3);
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const Pose pose = random_pose(random);
    const Mat3 got = rotation_matrix(pose);
    const Matrix expected = independent(pose);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        // Products of up to three sines, each rounded at 1.1e-16.
        CHECK_UNARY(std::abs(got[column][row] -
                             static_cast<double>(
                                 expected[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)])) < 5e-16);
      }
    }
  }
}

TEST_CASE("yaw turns forward to the left, positive pitch puts the nose down, positive roll the left side up") {
  const Vec3 forward(1, 0, 0), left(0, 1, 0);
  const double small = 1e-3;
  CHECK((rotation_matrix({Vec3(0), small, 0, 0}) * forward).y == doctest::Approx(std::sin(small)).scale(0.0));
  CHECK((rotation_matrix({Vec3(0), 0, small, 0}) * forward).z == doctest::Approx(-std::sin(small)).scale(0.0));
  CHECK((rotation_matrix({Vec3(0), 0, 0, small}) * left).z == doctest::Approx(std::sin(small)).scale(0.0));
  // Pitch acts in the turned frame: a car that faces north and dips its nose looks north and down.
  const Vec3 nose = rotation_matrix({Vec3(0), pi / 2, pi / 4, 0}) * forward;
  CHECK(glm::distance(nose, Vec3(0, std::sqrt(0.5), -std::sqrt(0.5))) < 1e-15);
}

TEST_CASE("a pose without angles is the identity, to the bit") {
  const Mat3 rotation = rotation_matrix(Pose{});
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) CHECK(rotation[column][row] == (row == column ? 1.0 : 0.0));
  }
}

TEST_CASE("the rotation vector is the finite difference of the rotation, for all three rates at once") {
  RandomStream random(4);
  constexpr long double step_s = 1e-5L;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const Pose pose = random_pose(random), rates = random_pose(random);
    const auto at = [&](long double time_s) {
      const auto angle = [&](double start, double rate) { return start + time_s * rate; };
      return product(
          product(turn(2, angle(pose.yaw_rad, rates.yaw_rad)), turn(1, angle(pose.pitch_rad, rates.pitch_rad))),
          turn(0, angle(pose.roll_rad, rates.roll_rad)));
    };
    const Matrix before = at(-step_s), now = at(0), after = at(step_s);
    Matrix rate{}, transposed{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        rate[i][j] = (after[i][j] - before[i][j]) / (2 * step_s);
        transposed[j][i] = now[i][j];
      }
    }
    const Matrix skew = product(rate, transposed);  // [ω]×
    const Vec3 expected(static_cast<double>(skew[2][1]), static_cast<double>(skew[0][2]),
                        static_cast<double>(skew[1][0]));
    // Central difference: step²/6 times the cube of a rate up to 12 rad/s: 3e-8; rounding 1e-19/1e-5.
    CHECK(glm::distance(angular_velocity(pose, rates.yaw_rad, rates.pitch_rad, rates.roll_rad), expected) < 5e-8);
  }
}

TEST_CASE("a point of a turning body moves with v + ω × r") {
  const RigidVelocity velocity{Vec3(10, 0, 0), Vec3(0, 0, 2)};
  CHECK(velocity_at(velocity, Vec3(100, 100, 0), Vec3(100, 100, 0)) == Vec3(10, 0, 0));
  CHECK(velocity_at(velocity, Vec3(100, 100, 0), Vec3(103, 100, 5)) == Vec3(10, 6, 0));
  CHECK(velocity_at(velocity, Vec3(100, 100, 0), Vec3(100, 101, 5)) == Vec3(8, 0, 0));
}

}  // namespace test_pose
