#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/surfaces/convex_hull.hpp"

namespace test_convex_hull {

using namespace dcem;

namespace {

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

void shuffle(std::vector<Vec2>& points, RandomStream& random) {
  for (std::size_t last = points.size(); last > 1; --last) std::swap(points[last - 1], points[random.next() % last]);
}

void check_is_hull(const std::vector<Vec2>& hull, const std::vector<Vec2>& points, double tolerance) {
  for (std::size_t index = 0; index < hull.size(); ++index) {
    const Vec2& a = hull[index];
    const Vec2& b = hull[(index + 1) % hull.size()];
    const Vec2& c = hull[(index + 2) % hull.size()];
    CHECK_UNARY(turn(a, b, c) > 0.0);  // corners only, counter-clockwise
    CHECK_UNARY(std::find(points.begin(), points.end(), a) != points.end());
    for (const Vec2& point : points) CHECK_UNARY(turn(a, b, point) >= -tolerance);
  }
}

}  // namespace

TEST_CASE("the hull of a filled square is its four corners, whatever stands on its edges or twice") {
  std::vector<Vec2> points;
  for (int x = 0; x <= 6; ++x) {
    for (int y = 0; y <= 6; ++y) points.insert(points.end(), 2, Vec2(x, y));
  }
  RandomStream random(6);
  for (int repeat = 0; repeat < 20; ++repeat) {
    shuffle(points, random);
    const std::vector<Vec2> hull = convex_hull(points);
    REQUIRE(hull.size() == 4);
    check_is_hull(hull, points, 0.0);  // whole numbers: no rounding
    CHECK(hull == std::vector<Vec2>{{0, 0}, {6, 0}, {6, 6}, {0, 6}});
  }
}

TEST_CASE("points inside a known polygon never become corners") {
  // A regular 24-gon on the unit circle: its chords stay 1 − cos(7.5°) = 0.0086 inside, so radius 0.99 is inside.
  RandomStream random(7);
  std::vector<Vec2> corners, points;
  for (int corner = 0; corner < 24; ++corner) {
    corners.emplace_back(std::cos(corner * 3.14159265358979323846 / 12),
                         std::sin(corner * 3.14159265358979323846 / 12));
  }
  points = corners;
  for (int index = 0; index < 2000; ++index) {
    const double angle = 6.283185307179586 * random.uniform(), radius = 0.99 * std::sqrt(random.uniform());
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  shuffle(points, random);
  std::vector<Vec2> hull = convex_hull(points);
  REQUIRE(hull.size() == 24);
  CHECK(std::is_permutation(hull.begin(), hull.end(), corners.begin()));
}

TEST_CASE("all points are inside the hull, for random, gridded and nearly collinear clouds, at 10 km too") {
  RandomStream random(8);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const double far = repeat % 2 == 0 ? 0.0 : 1e4;
    const double height = repeat % 3 == 0 ? 1e-9 : 1.0;  // a needle or a cloud
    const int count = 3 + static_cast<int>(random.next() % 200);
    std::vector<Vec2> points;
    for (int index = 0; index < count; ++index) {
      const double x = repeat % 5 == 0 ? static_cast<double>(random.next() % 8) : random.uniform();
      const double y = repeat % 5 == 0 ? static_cast<double>(random.next() % 8) : random.uniform();
      points.emplace_back(far + x, -far + height * y);
    }
    const std::vector<Vec2> hull = convex_hull(points);
    // Differences of coordinates are exact to their own last place; a turn of sides up to 10 rounds at 1e-14.
    if (hull.size() >= 3) check_is_hull(hull, points, 1e-13);
    std::vector<Vec2> shuffled = points;
    for (int again = 0; again < 3; ++again) {
      shuffle(shuffled, random);
      CHECK_UNARY(convex_hull(shuffled) == hull);
    }
  }
}

TEST_CASE("fewer than three corners where there is no area") {
  CHECK(convex_hull({}).empty());
  CHECK(convex_hull({Vec2(1, 2)}) == std::vector<Vec2>{{1, 2}});
  CHECK(convex_hull({Vec2(1, 2), Vec2(1, 2), Vec2(1, 2)}).size() == 1);
  CHECK(convex_hull({Vec2(1, 2), Vec2(0, 0)}) == std::vector<Vec2>{{0, 0}, {1, 2}});
  CHECK(convex_hull({Vec2(2, 2), Vec2(0, 0), Vec2(1, 1), Vec2(3, 3), Vec2(1, 1)}) == std::vector<Vec2>{{0, 0}, {3, 3}});
  CHECK(convex_hull({Vec2(0, 3), Vec2(0, 1), Vec2(0, 2)}) == std::vector<Vec2>{{0, 1}, {0, 3}});
}

TEST_CASE("the hull on a plane goes around its normal and brings the corners back") {
  RandomStream random(9);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const auto part = [&] { return random.uniform() - 0.5; };
    const double nx = part(), ny = part(), nz = part();
    const Plane plane{Vec3(300, -200, 50), glm::normalize(Vec3(nx, ny, nz))};
    const PlaneBasis basis = plane_basis(plane.normal);
    std::vector<Vec3> corners;
    for (const Vec2& corner : {Vec2(0, 0), Vec2(7, 1), Vec2(9, 8), Vec2(-2, 6)}) {
      corners.push_back(plane.point_m + corner.x * basis.u + corner.y * basis.v);
    }
    std::vector<Vec3> points = corners;
    points.push_back(0.3 * corners[0] + 0.3 * corners[1] + 0.4 * corners[2]);
    points.push_back(corners[2] + 1e-3 * plane.normal);  // strays from the plane: its foot is corner 2
    const std::vector<Vec3> hull = convex_hull_on_plane(plane, points);
    Vec3 twice_area(0.0);
    for (std::size_t index = 0; index < hull.size(); ++index) {
      twice_area += glm::cross(hull[index] - plane.point_m, hull[(index + 1) % hull.size()] - plane.point_m);
      CHECK(std::abs(signed_distance_m(plane, hull[index])) < 1e-12);  // steps of 5.7e-14 m at 300 m
    }
    // Shoelace of the four corners: 7·8 − 9·1 + 9·6 + 2·8 = 117.
    CHECK(glm::dot(twice_area, plane.normal) == doctest::Approx(117.0).epsilon(1e-12));
    for (const Vec3& corner : corners) {
      CHECK(std::any_of(hull.begin(), hull.end(),
                        [&](const Vec3& point) { return glm::distance(point, corner) < 1e-12; }));
    }
  }
}

}  // namespace test_convex_hull
