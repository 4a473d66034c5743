#include <doctest/doctest.h>

#include <limits>

#include "dcem/geometry/ray.hpp"

namespace test_ray {

using namespace dcem;

TEST_CASE_TEMPLATE("a segment runs from one end at 0 to the other at 1", Scalar, float, double) {
  const Vector3<Scalar> from(1, 2, 3), to(-5, 4, 7);
  const Ray<Scalar> segment = segment_between(from, to);
  CHECK(segment.t_min == 0);
  CHECK(segment.t_max == 1);
  CHECK(segment.at(0) == from);
  CHECK(segment.at(1) == to);  // small whole numbers: no rounding
  CHECK(segment.at(Scalar(0.5)) == Vector3<Scalar>(-2, 3, 5));
}

TEST_CASE("a ray has no end, and t counts in lengths of its direction") {
  const Ray<double> ray{Vec3(1, 0, 0), Vec3(0, 2, 0)};
  CHECK(ray.t_min == 0.0);
  CHECK(ray.t_max == std::numeric_limits<double>::infinity());
  CHECK(ray.at(3.0) == Vec3(1, 6, 0));
}

}  // namespace test_ray
