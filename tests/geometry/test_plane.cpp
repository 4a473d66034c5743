#include <doctest/doctest.h>

#include <cmath>

#include "dcem/core/random.hpp"
#include "dcem/geometry/plane.hpp"

namespace test_plane {

using namespace dcem;

namespace {

Vec3 random_vector(RandomStream& random, double size) {
  const double x = random.uniform() - 0.5, y = random.uniform() - 0.5, z = random.uniform() - 0.5;
  return 2.0 * size * Vec3(x, y, z);
}

}  // namespace

TEST_CASE("the distance to a plane has the sign of the side to which the normal points") {
  const Plane roof{Vec3(5, 5, 10), Vec3(0, 0, 1)};
  CHECK(signed_distance_m(roof, Vec3(-100, 7, 12.5)) == 2.5);
  CHECK(signed_distance_m(roof, Vec3(1, 1, 4)) == -6.0);
  CHECK(signed_distance_m(roof, Vec3(1, 1, 10)) == 0.0);
}

TEST_CASE("a mirror image is a reflection: known case, own inverse, isometry, fixed plane") {
  const double s = std::sqrt(0.5);
  const Vec3 image = mirrored({Vec3(1, 0, 0), Vec3(s, s, 0)}, Vec3(3, 4, 9));  // x + y = 1 swaps and negates
  // A few roundings at size 10.
  CHECK(glm::distance(image, Vec3(-3, -2, 9)) < 1e-14);
  RandomStream random(1);
  for (int repeat = 0; repeat < 500; ++repeat) {
    const Plane plane{random_vector(random, 1e3), glm::normalize(random_vector(random, 1.0))};
    const Vec3 a = random_vector(random, 1e3), b = random_vector(random, 1e3);
    // Coordinates up to 4e3 with roundings of 4.5e-13 each, about ten of them.
    CHECK(glm::distance(mirrored(plane, mirrored(plane, a)), a) < 1e-11);
    CHECK(std::abs(glm::distance(mirrored(plane, a), mirrored(plane, b)) - glm::distance(a, b)) < 1e-11);
    CHECK(std::abs(signed_distance_m(plane, mirrored(plane, a)) + signed_distance_m(plane, a)) < 1e-11);
    const Vec3 middle = 0.5 * (a + mirrored(plane, a));
    CHECK(std::abs(signed_distance_m(plane, middle)) < 1e-11);
    CHECK(glm::length(glm::cross(mirrored(plane, a) - a, plane.normal)) < 1e-11);
  }
}

TEST_CASE("a plane far away keeps its distances: 10 km off, a micrometre is seen to a nanometre's hundredth") {
  const Plane wall{Vec3(1e4, -1e4, 0), glm::normalize(Vec3(1, 2, 3))};
  // Coordinates of 1e4 have steps of 1.8e-12 m.
  CHECK(std::abs(signed_distance_m(wall, wall.point_m + 1e-6 * wall.normal) - 1e-6) < 1e-11);
}

TEST_CASE("a plane's basis is orthonormal and right-handed for every normal, also along the axes") {
  RandomStream random(2);
  for (int repeat = 0; repeat < 1000; ++repeat) {
    Vec3 normal = random_vector(random, 1.0);
    if (repeat < 27) normal = Vec3(repeat / 9 - 1, repeat / 3 % 3 - 1, repeat % 3 - 1);
    if (repeat == 13) continue;  // the zero vector
    normal = glm::normalize(normal);
    const PlaneBasis basis = plane_basis(normal);
    // Unit vectors: a few roundings of 1.1e-16; the helper axis is at least 54° from the normal.
    CHECK(std::abs(glm::length(basis.u) - 1.0) < 1e-15);
    CHECK(std::abs(glm::length(basis.v) - 1.0) < 1e-15);
    CHECK(std::abs(glm::dot(basis.u, normal)) < 1e-15);
    CHECK(std::abs(glm::dot(basis.u, basis.v)) < 1e-15);
    CHECK(glm::distance(glm::cross(basis.u, basis.v), normal) < 1e-15);
  }
}

}  // namespace test_plane
