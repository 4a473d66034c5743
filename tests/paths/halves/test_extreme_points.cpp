/// What is left of points side by side is the corners of their hull: no linear function is larger at another one.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dcem/paths/halves/extreme_points.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_extreme_points {

using namespace dcem;
using namespace dcem::test;

namespace {

double largest(const std::vector<Vec3>& points_m, const Vec3& direction) {
  double result = -1e300;
  for (const Vec3& point_m : points_m) result = std::max(result, glm::dot(point_m, direction));
  return result;
}

}  // namespace

TEST_CASE("a linear function of level points is largest at one of the extreme ones, which are among them") {
  Draw draw(5);
  for (int round = 0; round < 2'000; ++round) {
    std::vector<Vec3> points_m, extreme_m;
    const bool is_grid = draw.below(2) == 0;
    for (std::size_t point = 1 + draw.below(16); point > 0; --point) {
      const Vec3 point_m = draw.inside(Vec3(-4, -4, 2), Vec3(4, 4, 2));
      points_m.push_back(is_grid ? Vec3(glm::round(point_m)) : point_m);
    }
    take_extreme_points(points_m, extreme_m);
    for (const Vec3& point_m : extreme_m) CHECK(std::ranges::find(points_m, point_m) != points_m.end());
    for (int question = 0; question < 20; ++question) {
      const Vec3 direction = draw.direction();
      CHECK(largest(extreme_m, direction) == doctest::Approx(largest(points_m, direction)).epsilon(1e-12));
    }
  }
}

TEST_CASE("of a grid the four corners are left, of points in a line the two ends") {
  std::vector<Vec3> grid_m, line_m, extreme_m;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) grid_m.emplace_back(2.0 * x, 2.0 * y, 1.5);
    line_m.emplace_back(2.0 * x, 1.0 * x, 1.5);
  }
  take_extreme_points(grid_m, extreme_m);
  CHECK(extreme_m.size() == 4);
  take_extreme_points(line_m, extreme_m);
  CHECK(extreme_m.size() == 2);
}

TEST_CASE("points at different heights stay as they are") {
  const std::vector<Vec3> points_m{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 1}, {0.2, 0.2, 0}};
  std::vector<Vec3> extreme_m;
  take_extreme_points(points_m, extreme_m);
  CHECK(extreme_m == points_m);
}

}  // namespace test_extreme_points
