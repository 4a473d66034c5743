#include <doctest/doctest.h>

#include <limits>

#include "dcem/geometry/aabb.hpp"

namespace test_aabb {

using namespace dcem;

TEST_CASE_TEMPLATE("a new box holds nothing and is the neutral element of growing", Scalar, float, double) {
  Aabb<Scalar> box;
  CHECK(box.empty());
  CHECK(box.half_area() == 0);
  CHECK(box.extent() == Vector3<Scalar>(0));
  CHECK_FALSE(box.contains(Vector3<Scalar>(0)));
  const Aabb<Scalar> other{Vector3<Scalar>(-1, 0, 2), Vector3<Scalar>(3, 0, 4)};
  CHECK_FALSE(box.overlaps(other));
  CHECK_FALSE(other.overlaps(box));
  CHECK_FALSE(box.overlaps(box));
  CHECK(other.contains(box));
  CHECK_FALSE(box.contains(other));
  box.extend(other);
  CHECK(box == other);
  box.extend(Aabb<Scalar>{});
  CHECK(box == other);
}

TEST_CASE("a box of one point is not empty, holds the point, and has no area") {
  Aabb<double> box;
  box.extend(Vec3(1, 2, 3));
  CHECK_FALSE(box.empty());
  CHECK(box.contains(Vec3(1, 2, 3)));
  CHECK(box.half_area() == 0.0);
  CHECK(box.center() == Vec3(1, 2, 3));
}

TEST_CASE("a box is empty where one axis is the wrong way round") {
  for (int axis = 0; axis < 3; ++axis) {
    Aabb<double> box{Vec3(0), Vec3(1)};
    CHECK_FALSE(box.empty());
    box.min[axis] = 2.0;
    CHECK(box.empty());
    box.min[axis] = std::numeric_limits<double>::quiet_NaN();
    CHECK(box.empty());
  }
}

TEST_CASE("half the surface of a brick 2 by 3 by 5") {
  const Aabb<double> brick{Vec3(1, 1, 1), Vec3(3, 4, 6)};
  CHECK(brick.half_area() == 2 * 3 + 3 * 5 + 5 * 2);
  CHECK(brick.extent() == Vec3(2, 3, 5));
  CHECK(brick.center() == Vec3(2, 2.5, 3.5));
}

TEST_CASE("the surface belongs to the box; each of the six sides bounds it") {
  const Aabb<double> box{Vec3(-1), Vec3(1)};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 inside(0.5), outside(0.5);
      inside[axis] = side;
      outside[axis] = side * (1 + 1e-15);
      CHECK(box.contains(inside));
      CHECK_FALSE(box.contains(outside));
      Aabb<double> touching{Vec3(-0.5), Vec3(0.5)}, apart = touching;
      touching.min[axis] = touching.max[axis] = side;
      apart.min[axis] = apart.max[axis] = outside[axis];
      CHECK(box.overlaps(touching));
      CHECK(touching.overlaps(box));
      CHECK_FALSE(box.overlaps(apart));
      CHECK_FALSE(apart.overlaps(box));
      CHECK(box.contains(touching));
      CHECK_FALSE(box.contains(apart));
    }
  }
}

TEST_CASE("an inflated box is larger by the margin on every side; an empty one stays empty") {
  CHECK(inflated(Aabb<double>{Vec3(0), Vec3(1)}, 0.5) == Aabb<double>{Vec3(-0.5), Vec3(1.5)});
  CHECK(inflated(Aabb<double>{}, 1e9).empty());
}

}  // namespace test_aabb
