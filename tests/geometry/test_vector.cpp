#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace test_vector {

using namespace dcem;

TEST_CASE("a vector is finite where all of its parts are") {
  CHECK(is_finite(Vec3(1, -2, 1e300)));
  for (const double bad : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_FALSE(is_finite(Vec3(bad, 0, 0)));
    CHECK_FALSE(is_finite(Vec3(0, bad, 0)));
    CHECK_FALSE(is_finite(Vec3(0, 0, bad)));
  }
}

TEST_CASE("lexicographic order looks at x, then y, then z, and is strict") {
  std::vector<Vec3> points;
  for (int index = 0; index < 27; ++index) points.emplace_back(index / 9, index / 3 % 3, index % 3);
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = 0; b < points.size(); ++b) CHECK(lexicographic_less(points[a], points[b]) == (a < b));
  }
  CHECK_FALSE(lexicographic_less(Vec3(0.0), Vec3(-0.0)));
  CHECK_FALSE(lexicographic_less(Vec3(-0.0), Vec3(0.0)));
}

}  // namespace test_vector
