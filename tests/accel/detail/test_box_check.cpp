#include <doctest/doctest.h>

#include <array>
#include <limits>

#include "dcem/accel/detail/box_check.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_box_check {

using namespace dcem;

TEST_CASE_TEMPLATE("boxes with NaN, infinity or absurd size are refused, empty ones are not", Scalar, float, double) {
  constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
  constexpr Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  using V = Vector3<Scalar>;
  CHECK(is_valid_box(Aabb<Scalar>{}));
  CHECK(is_valid_box(Aabb<Scalar>{V(1), V(1)}));
  CHECK(is_valid_box(Aabb<Scalar>{V(1, 5, 1), V(2, 4, 2)}));
  CHECK_FALSE(is_valid_box(Aabb<Scalar>{V(0), V(1, infinity, 1)}));
  CHECK_FALSE(is_valid_box(Aabb<Scalar>{V(-infinity, 0, 0), V(1)}));
  CHECK_FALSE(is_valid_box(Aabb<Scalar>{V(0, nan, 0), V(1)}));
  CHECK_FALSE(is_valid_box(Aabb<Scalar>{V(0), V(1, 1, nan)}));
  CHECK_FALSE(is_valid_box(Aabb<Scalar>{V(0), V(Scalar(2e15))}));
}

TEST_CASE("every box that is turned inside out on an axis counts as the empty box") {
  CHECK(canonical_box(Aabb<double>{{0, 3, 0}, {1, 2, 1}}) == Aabb<double>{});
  const Aabb<double> box{{0, 2, 0}, {1, 3, 1}};
  CHECK(canonical_box(box) == box);
}

TEST_CASE("objects start at 0 and ascend") {
  const std::array<std::uint32_t, 3> good{0, 4, 4};
  const std::array<std::uint32_t, 2> late{1, 4};
  const std::array<std::uint32_t, 3> falling{0, 4, 3};
  CHECK_NOTHROW(require_valid_objects(good, 4));
  CHECK_NOTHROW(require_valid_objects({}, 0));
  CHECK_THROWS_AS(require_valid_objects(good, 3), std::invalid_argument);
  CHECK_THROWS_AS(require_valid_objects({}, 3), std::invalid_argument);
  CHECK_THROWS_AS(require_valid_objects(late, 4), std::invalid_argument);
  CHECK_THROWS_AS(require_valid_objects(falling, 4), std::invalid_argument);
}

TEST_CASE("a box rounded outward to float holds the box, and rounding it back changes nothing") {
  for (const Aabb<double>& box : dcem_test::random_boxes<double>(2000, 5)) {
    const Aabb<float> outer = rounded_outward<float>(box);
    const Aabb<double> back = rounded_outward<double>(outer);
    CHECK(back.contains(box));
    CHECK(rounded_outward<float>(back) == outer);
    // One rounding step at 18 m is 2⁻¹⁹ m; two sides, two steps.
    CHECK(glm::length(back.extent() - box.extent()) < 4 * 0x1.0p-19);
  }
}

}  // namespace test_box_check
