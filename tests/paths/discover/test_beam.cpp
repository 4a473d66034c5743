/// A beam is conservative: no point that the apex sees through the window is ever discarded.
#include "dcem/paths/discover/beam.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "dcem/geometry/surfaces/convex_hull.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_beam {

using namespace dcem;
using namespace dcem::test;

namespace {

using Polygon = std::vector<Vec3>;

/// Two directions that span a plane, turned at random: those of `plane_basis` have zeros that hide rounding.
PlaneBasis turned_basis(Draw& draw, const Vec3& normal) {
  const PlaneBasis basis = plane_basis(normal);
  const double angle_rad = draw.between(-pi, pi), c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * basis.u + s * basis.v, c * basis.v - s * basis.u};
}

/// A convex polygon in a plane, corners in order, from random points around a centre.
Polygon random_polygon(Draw& draw, const Plane& plane, const Vec3& centre_m, double radius_m) {
  const PlaneBasis basis = turned_basis(draw, plane.normal);
  const std::size_t corners = 3 + draw.below(5);
  const double start_rad = draw.between(0.0, 2.0 * pi);
  const double flatness = draw.magnitude(1e-3, 1.0);
  Polygon polygon;
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const double angle_rad = start_rad + 2.0 * pi * static_cast<double>(corner) / static_cast<double>(corners);
    polygon.push_back(centre_m + radius_m * std::cos(angle_rad) * basis.u +
                      flatness * radius_m * std::sin(angle_rad) * basis.v);
  }
  return polygon;
}

/// A random point inside a convex polygon, often close to an edge or a corner.
Vec3 point_inside(Draw& draw, const Polygon& polygon) {
  Vec3 sum(0.0);
  double total = 0.0;
  for (const Vec3& corner : polygon) {
    const double weight = draw.magnitude(1e-9, 1.0);
    sum += weight * (corner - polygon.front());
    total += weight;
  }
  return polygon.front() + sum / total;
}

/// How far a point of its plane lies outside a convex polygon with corners in order; 0 inside.
double outside_m(const Polygon& polygon, const Vec3& normal, const Vec3& point_m) {
  double area = 0.0, worst_m = 0.0;
  for (std::size_t index = 1; index + 1 < polygon.size(); ++index) {
    area += glm::dot(normal, glm::cross(polygon[index] - polygon[0], polygon[index + 1] - polygon[0]));
  }
  for (std::size_t index = 0; index < polygon.size(); ++index) {
    const Vec3 edge = polygon[(index + 1) % polygon.size()] - polygon[index];
    if (glm::length(edge) == 0.0) continue;
    const double side = glm::dot(normal, glm::cross(edge, point_m - polygon[index])) / glm::length(edge);
    worst_m = std::max(worst_m, area > 0.0 ? -side : side);
  }
  return worst_m;
}

struct Sight {
  Vec3 apex_m;
  Plane mirror;
  Polygon window_m;
  Plane beyond;
  Polygon polygon_m;
  Vec3 seen_m;  ///< in the polygon, behind a point of the window
};

/// An apex, a window, and a polygon with a point that the apex sees through the window.
Sight random_sight(Draw& draw, double height_low_m, double height_high_m) {
  Sight sight;
  sight.mirror = {draw.inside(Vec3(-500.0), Vec3(500.0)), draw.direction()};
  const PlaneBasis basis = turned_basis(draw, sight.mirror.normal);
  const double side = draw.below(2) == 0 ? 1.0 : -1.0;
  sight.apex_m = sight.mirror.point_m + side * draw.magnitude(height_low_m, height_high_m) * sight.mirror.normal +
                 draw.magnitude(0.01, 300.0) * basis.u;
  sight.window_m = random_polygon(draw, sight.mirror, sight.mirror.point_m, draw.magnitude(1e-4, 30.0));
  const Vec3 through_m = point_inside(draw, sight.window_m);
  sight.seen_m = through_m + draw.magnitude(1e-4, 20.0) * (through_m - sight.apex_m);
  sight.beyond = {sight.seen_m, draw.direction()};
  const double radius_m = draw.magnitude(1e-3, 100.0);
  const PlaneBasis across = plane_basis(sight.beyond.normal);
  const Vec3 centre_m = sight.seen_m + draw.between(-0.4, 0.4) * radius_m * across.u;
  sight.polygon_m = random_polygon(draw, sight.beyond, centre_m, radius_m);
  return sight;
}

/// Nothing that is seen may be lost. Rounding of the test's own points is below 1e-15 of the largest coordinate (some
/// 10 km), the beam's own slack above 1e-6 m.
void check_survival(const Sight& sight) {
  const Beam beam(sight.apex_m, sight.mirror, sight.window_m);
  Polygon inside_m;
  const bool kept = beam.clip(sight.polygon_m, inside_m);
  if (outside_m(sight.polygon_m, sight.beyond.normal, sight.seen_m) > 0.0) return;  // a thin polygon may miss it
  REQUIRE(kept);
  CHECK(outside_m(inside_m, sight.beyond.normal, sight.seen_m) < 1e-9);
}

}  // namespace

TEST_CASE("a point seen through the window survives the clipping") {
  Draw draw(1);
  for (int trial = 0; trial < 20'000; ++trial) check_survival(random_sight(draw, 1e-2, 300.0));
}

TEST_CASE("nothing is lost where the image lies almost in its mirror's plane") {
  Draw draw(2);
  for (int trial = 0; trial < 20'000; ++trial) check_survival(random_sight(draw, 2e-9, 1e-3));
}

TEST_CASE("nothing is lost where an edge of a far window points at the image") {
  // A device a kilometre off and a tenth of a millimetre above a roof: the side plane of the edge is fixed by a sliver
  // of a triangle, and the difference of two nearly equal vectors must not decide it.
  Draw draw(4);
  int lost = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Plane mirror{draw.inside(Vec3(-500.0), Vec3(500.0)), draw.direction()};
    const PlaneBasis basis = turned_basis(draw, mirror.normal);
    const double length_m = draw.magnitude(2e-3, 1.0), width_m = draw.magnitude(1e-2, 30.0);
    const Vec3 apex_m =
        mirror.point_m - draw.magnitude(100.0, 3000.0) * basis.u + draw.magnitude(1e-7, 1e-2) * mirror.normal;
    const Vec3 along = length_m * basis.u, across = width_m * basis.v;
    const Polygon window_m{mirror.point_m, mirror.point_m + along, mirror.point_m + along + across,
                           mirror.point_m + across};
    const Vec3 through_m = mirror.point_m + draw.between(0.0, 1.0) * along + draw.magnitude(1e-6, 0.5) * across;
    const Vec3 seen_m = through_m + draw.magnitude(0.01, 10.0) * (through_m - apex_m);
    const PlaneBasis small = turned_basis(draw, glm::normalize(through_m - apex_m));
    const Polygon target_m{seen_m - 1e-3 * small.u, seen_m + 1e-3 * small.u, seen_m + 1e-3 * small.v};
    Polygon inside_m;
    lost += !Beam(apex_m, mirror, window_m).clip(target_m, inside_m);
  }
  CHECK(lost == 0);
}

TEST_CASE("every point of a grid over a polygon is kept exactly when the line of sight to it passes the window") {
  Draw draw(3);
  int kept_points = 0, dropped_points = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Plane mirror{Vec3(0.0), Vec3(0, 0, 1)};
    const Polygon window_m = random_polygon(draw, mirror, Vec3(0.0), draw.between(0.5, 3.0));
    const Vec3 apex_m(draw.between(-4, 4), draw.between(-4, 4), draw.between(0.5, 5.0));
    const Plane beyond{Vec3(0, 0, draw.between(-6.0, -0.5)), draw.direction()};
    const Polygon polygon_m = random_polygon(draw, beyond, beyond.point_m, 8.0);
    Polygon inside_m;
    const bool any = Beam(apex_m, mirror, window_m).clip(polygon_m, inside_m);
    for (int sample = 0; sample < 50; ++sample) {
      const Vec3 point_m = point_inside(draw, polygon_m);
      const Vec3 down = point_m - apex_m;
      const bool behind = point_m.z < 0.0;
      const Vec3 through_m = apex_m - apex_m.z / down.z * down;  // where the sight line meets z = 0
      // 1 cm of room on both sides of every decision: the beam may be wider by its slack, 1e-6 m and 1e-6 rad.
      const double miss_m = behind ? outside_m(window_m, Vec3(0, 0, 1), through_m) : 1.0;
      const bool seen = behind && miss_m == 0.0;
      const bool hidden = point_m.z > 0.01 || (behind && miss_m > 0.01);
      const bool kept = any && outside_m(inside_m, beyond.normal, point_m) < 1e-9;
      if (seen) CHECK(kept);
      if (hidden) CHECK_FALSE(kept);
      kept_points += seen;
      dropped_points += hidden;
    }
  }
  CHECK(kept_points > 200);
  CHECK(dropped_points > 500);
}

TEST_CASE("a polygon that crosses the mirror's plane keeps the part beyond it, and a hair of slack") {
  const Plane mirror{Vec3(0.0), Vec3(0, 0, 1)};
  const Polygon window_m{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const Beam beam(Vec3(0, 0, 1), mirror, window_m);
  // In the plane x = 0 the beam is |y| <= 1 - z; the polygon is the square |y| <= 0.5, |z| <= 1.
  const Polygon polygon_m{{0, -0.5, -1}, {0, 0.5, -1}, {0, 0.5, 1}, {0, -0.5, 1}};
  Polygon inside_m;
  REQUIRE(beam.clip(polygon_m, inside_m));
  double top = -10.0, bottom = 10.0;
  for (const Vec3& corner : inside_m) {
    top = std::max(top, corner.z);
    bottom = std::min(bottom, corner.z);
  }
  CHECK(top >= 0.0);
  CHECK(top <= 2e-6);  // the slack of 1e-6 m, and its rounding
  CHECK(bottom == -1.0);
}

TEST_CASE("what is on the apex's side of the mirror, or beside the cone, is discarded") {
  const Plane mirror{Vec3(0.0), Vec3(0, 0, 1)};
  const Polygon window_m{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (const double side : {1.0, -1.0}) {
    const Beam beam(Vec3(0, 0, side), mirror, window_m);
    Polygon inside_m;
    const auto square = [&](double x, double z) {
      return Polygon{{x - 0.1, -0.1, z}, {x + 0.1, -0.1, z}, {x + 0.1, 0.1, z}, {x - 0.1, 0.1, z}};
    };
    CHECK_FALSE(beam.clip(square(0.0, side * 0.5), inside_m));
    CHECK_FALSE(beam.clip(square(4.0, -side), inside_m));  // the cone reaches x = 2 there
    CHECK(beam.clip(square(1.9, -side), inside_m));
    CHECK(beam.clip(square(0.0, -side), inside_m));
  }
}

TEST_CASE("a window without width still lets through what lies behind it") {
  const Plane mirror{Vec3(0.0), Vec3(0, 0, 1)};
  const Polygon target_m{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}};
  Polygon inside_m;
  for (const Polygon& window_m :
       {Polygon{{0, 0, 0}}, Polygon{{-0.5, 0, 0}, {0.5, 0, 0}}, Polygon{{0, 0, 0}, {1e-5, 0, 0}, {0, 1e-5, 0}},
        Polygon{{0, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}}}) {
    const Vec3 apex_m(0.05, 0.02, 1.0);
    REQUIRE(Beam(apex_m, mirror, window_m).clip(target_m, inside_m));
    Vec3 centre_m(0.0);
    for (const Vec3& corner : window_m) centre_m += corner / static_cast<double>(window_m.size());
    CHECK(outside_m(inside_m, Vec3(0, 0, 1), apex_m + 2.0 * (centre_m - apex_m)) < 1e-9);
  }
}

}  // namespace test_beam
