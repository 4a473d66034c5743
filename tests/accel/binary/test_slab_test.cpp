#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dcem/accel/binary/slab_test.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_slab_test {

using namespace dcem;

namespace {

template <class Scalar>
constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();

/// Whether the ray certainly meets the box, in long double: 64 bits of mantissa against the 24 or 53 under test. The
/// differences, quotients and comparisons here are exact to 1e-19, so a margin of that size decides nothing.
template <class Scalar>
bool meets_exactly(const Ray<Scalar>& ray, const Aabb<Scalar>& box) {
  long double entry = ray.t_min;
  long double exit = ray.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const long double low = static_cast<long double>(box.min[axis]) - static_cast<long double>(ray.origin[axis]);
    const long double high = static_cast<long double>(box.max[axis]) - static_cast<long double>(ray.origin[axis]);
    const auto direction = static_cast<long double>(ray.direction[axis]);
    if (direction == 0.0L) {
      if (low > 0.0L || high < 0.0L) return false;
      continue;
    }
    entry = std::max(entry, std::min(low / direction, high / direction));
    exit = std::min(exit, std::max(low / direction, high / direction));
  }
  return entry <= exit;
}

}  // namespace

TEST_CASE_TEMPLATE("no box that a ray meets is refused, and hardly another is taken", Scalar, float, double) {
  RandomStream random(7);
  int met = 0;
  int extra = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    auto ray = dcem_test::random_ray<Scalar>(random);
    const auto box = dcem_test::random_box<Scalar>(random);
    // Two in three rays aim at the box's middle on the axes along which they move at all.
    for (int axis = 0; axis < 3 && trial % 3 != 0; ++axis) {
      if (ray.direction[axis] != 0) ray.direction[axis] = box.center()[axis] - ray.origin[axis];
      if (ray.direction[axis] == 0) ray.origin[axis] = box.min[axis];
    }
    const bool exact = meets_exactly(ray, box);
    const SlabTest<Scalar> slab(ray);
    const bool tested = slab.meets(box, slab.t_max());
    if (exact) ++met;
    if (exact && !tested) FAIL("a box that is met was refused");
    if (tested && !exact && trial % 3 == 0) ++extra;
  }
  CHECK(met > 50000);
  // The padding takes in a rounding step around each box. Rays that are not aimed meet it by chance, on whole-numbered
  // planes and corners that they pass exactly: below 1 in 1000.
  CHECK(extra < 66);
}

TEST_CASE_TEMPLATE("a ray aimed at an edge or a corner meets the box", Scalar, float, double) {
  RandomStream random(8);
  for (int trial = 0; trial < 100000; ++trial) {
    const auto box = dcem_test::random_box<Scalar>(random);
    const auto origin = dcem_test::random_point<Scalar>(random, 12.0);
    Vector3<Scalar> target;
    for (int axis = 0; axis < 3; ++axis) target[axis] = random.uniform() < 0.5 ? box.min[axis] : box.max[axis];
    const Ray<Scalar> ray{origin, target - origin};
    // The direction was rounded: only rays that still meet the corner exactly are a test.
    if (meets_exactly(ray, box) && !SlabTest<Scalar>(ray).meets(box, ray.t_max)) FAIL("slipped past a corner");
  }
}

TEST_CASE_TEMPLATE("a ray inside a plane of the box meets the box", Scalar, float, double) {
  using V = Vector3<Scalar>;
  const Aabb<Scalar> box{V(1), V(2)};
  for (const Scalar plane : {Scalar(1), Scalar(2)}) {
    for (const Scalar zero : {Scalar(0), -Scalar(0)}) {
      CHECK(SlabTest<Scalar>({V(plane, plane, 0), V(zero, zero, 1)}).meets(box, infinity<Scalar>));
      CHECK(SlabTest<Scalar>({V(plane, plane, 3), V(zero, zero, -1)}).meets(box, infinity<Scalar>));
      CHECK_FALSE(SlabTest<Scalar>({V(plane, plane, 3), V(zero, zero, 1)}).meets(box, infinity<Scalar>));
    }
  }
  const Scalar outside = std::nextafter(Scalar(2), Scalar(3)) + Scalar(1e-5);
  CHECK_FALSE(SlabTest<Scalar>({V(outside, 1, 0), V(0, 0, 1)}).meets(box, infinity<Scalar>));
}

TEST_CASE_TEMPLATE("a flat box and a point are met by rays through them", Scalar, float, double) {
  using V = Vector3<Scalar>;
  const Aabb<Scalar> square{V(0, 0, 5), V(1, 1, 5)};
  const SlabEntry<Scalar> entry = SlabTest<Scalar>({V(0.5, 0.5, 0), V(0, 0, 2)}).enter(square, infinity<Scalar>);
  CHECK(entry.met);
  CHECK(entry.t == Scalar(2.5));
  CHECK(SlabTest<Scalar>({V(0, 0, 5), V(1, 1, 0)}).meets(square, infinity<Scalar>));
  CHECK(SlabTest<Scalar>({V(1), V(3)}).meets({V(7), V(7)}, infinity<Scalar>));
}

TEST_CASE_TEMPLATE("touching the ends of a segment counts", Scalar, float, double) {
  using V = Vector3<Scalar>;
  const Aabb<Scalar> box{V(1), V(2)};
  const SlabTest<Scalar> slab({V(0, 1.5, 1.5), V(1, 0, 0)});
  CHECK(slab.meets(box, 1));
  CHECK_FALSE(slab.meets(box, Scalar(0.999)));
  CHECK(SlabTest<Scalar>({V(1, 1.5, 1.5), V(1, 0, 0)}).meets(box, 0));
  CHECK(SlabTest<Scalar>({V(0, 1.5, 1.5), V(1, 0, 0), 2}).meets(box, infinity<Scalar>));
  CHECK_FALSE(SlabTest<Scalar>({V(0, 1.5, 1.5), V(1, 0, 0), Scalar(2.001)}).meets(box, infinity<Scalar>));
}

TEST_CASE_TEMPLATE("a ray without direction meets the boxes that hold its origin", Scalar, float, double) {
  using V = Vector3<Scalar>;
  const SlabTest<Scalar> slab({V(1), V(0)});
  CHECK(slab.t_max() == 0);
  CHECK(slab.meets({V(1), V(2)}, slab.t_max()));
  CHECK(slab.meets({V(0), V(1)}, slab.t_max()));
  CHECK_FALSE(slab.meets({V(1, 1, Scalar(1.1)), V(2)}, slab.t_max()));
  CHECK(SlabTest<Scalar>({V(1), V(0, 0, 1)}).t_max() == infinity<Scalar>);
}

TEST_CASE_TEMPLATE("nothing meets an empty box, and a ray with NaN meets nothing", Scalar, float, double) {
  using V = Vector3<Scalar>;
  constexpr Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  RandomStream random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto ray = dcem_test::random_ray<Scalar>(random);
    CHECK_FALSE(SlabTest<Scalar>(ray).meets({}, ray.t_max));
  }
  const Aabb<Scalar> everywhere{V(-1e15f), V(1e15f)};
  const auto meets = [&](const Ray<Scalar>& ray) { return SlabTest<Scalar>(ray).meets(everywhere, ray.t_max); };
  CHECK(meets({V(0), V(1)}));
  CHECK_FALSE(meets({V(0, nan, 0), V(1)}));
  CHECK_FALSE(meets({V(0), V(1, 1, nan)}));
  CHECK_FALSE(meets({V(0), V(1), nan}));
  CHECK_FALSE(meets({V(0), V(1), 0, nan}));
  CHECK_FALSE(meets({V(infinity<Scalar>), V(1)}));
  CHECK_FALSE(meets({V(0), V(infinity<Scalar>)}));
  CHECK_FALSE(meets({V(0), V(1), 2, 1}));
}

TEST_CASE_TEMPLATE("a larger box is met whenever a box inside it is", Scalar, float, double) {
  RandomStream random(10);
  for (int trial = 0; trial < 100000; ++trial) {
    const auto ray = dcem_test::random_ray<Scalar>(random);
    const auto inner = dcem_test::random_box<Scalar>(random);
    auto outer = inner;
    outer.extend(inner.max + static_cast<Scalar>(random.uniform() < 0.5 ? 1e-6 : 1.0) * Vector3<Scalar>(1, 0, 1));
    const SlabTest<Scalar> slab(ray);
    if (slab.meets(inner, ray.t_max) && !slab.meets(outer, ray.t_max)) FAIL("the outer box was refused");
  }
}

}  // namespace test_slab_test
