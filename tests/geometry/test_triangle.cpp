#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/triangle_mesh.hpp"

namespace test_triangle {

using namespace dcem;

namespace {

Vec3 random_vector(RandomStream& random, double size) {
  const double x = random.uniform() - 0.5, y = random.uniform() - 0.5, z = random.uniform() - 0.5;
  return 2.0 * size * Vec3(x, y, z);
}

// Closed meshes that are star-shaped around their centre
// ---------------------------------------------------------------

struct ClosedMesh {
  Vec3 centre_m{0.0};
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::size_t, 3>> triangles;

  TriangleCorners corners(std::size_t index) const {
    const auto& triangle = triangles[index];
    return {vertices_m[triangle[0]], vertices_m[triangle[1]], vertices_m[triangle[2]]};
  }
};

/// An octahedron whose triangles were halved into four `levels` times; vertices pushed out and in by `roughness`.
ClosedMesh rough_sphere(int levels, double radius_m, double roughness, const Vec3& centre_m, RandomStream& random) {
  ClosedMesh mesh;
  mesh.centre_m = centre_m;
  std::vector<Vec3> points{Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), points.size());
      if (is_new) points.push_back(glm::normalize(points[a] + points[b]));
      return entry->second;
    };
    std::vector<std::array<std::size_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (const Vec3& point : points) {
    mesh.vertices_m.push_back(centre_m + radius_m * (1.0 + roughness * (random.uniform() - 0.5)) * point);
  }
  return mesh;
}

/// A cube with corners at centre ± half: axis-parallel faces, and diagonals that run exactly through its corners.
ClosedMesh cube(double half_m, const Vec3& centre_m) {
  ClosedMesh mesh;
  mesh.centre_m = centre_m;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices_m.push_back(centre_m + half_m * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 5, 1}, {0, 4, 5},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

/// Shoots at corners and edge points, from inside and from outside straight towards the inside. A closed surface that
/// leaks has no hit ahead.
std::size_t count_leaks(const ClosedMesh& mesh, std::size_t rays, RandomStream& random) {
  std::size_t leaks = 0;
  for (std::size_t index = 0; index < rays; ++index) {
    const auto& triangle = mesh.triangles[random.next() % mesh.triangles.size()];
    const std::size_t side = random.next() % 3;
    const Vec3& a = mesh.vertices_m[triangle[side]];
    const Vec3& b = mesh.vertices_m[triangle[(side + 1) % 3]];
    const double share = index % 4 == 0 ? 0.0 : (index % 4 == 1 ? 0.5 : random.uniform());
    const Vec3 target_m = a + share * (b - a);
    const double size_m = glm::distance(mesh.vertices_m[0], mesh.centre_m);
    Vec3 origin_m = mesh.centre_m;
    if (index % 3 != 0) origin_m += random_vector(random, 0.2 * size_m);
    if (index % 2 == 1) origin_m = target_m + (target_m - origin_m);  // outside, looking in
    const double length = index % 5 == 0 ? 1e-6 : (index % 5 == 1 ? 1e6 : 1.0);
    const WatertightRay ray({origin_m, length * (target_m - origin_m)});
    bool hit = false;
    for (std::size_t other = 0; other < mesh.triangles.size() && !hit; ++other) {
      const std::optional<double> t = ray.intersect(mesh.corners(other));
      hit = t && *t > 0.0;
    }
    leaks += !hit;
  }
  return leaks;
}

// Möller and Trumbore (1997) in long double
// ----------------------------------------------------------------------------

using Long3 = std::array<long double, 3>;

Long3 minus(const Vec3& a, const Vec3& b) {
  return {static_cast<long double>(a.x) - b.x, static_cast<long double>(a.y) - b.y,
          static_cast<long double>(a.z) - b.z};
}
Long3 cross(const Long3& a, const Long3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long double dot(const Long3& a, const Long3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct Barycentric {
  long double smallest;  ///< smallest barycentric coordinate: negative outside
  long double t;
  long double slant;  ///< |cosine| between ray and normal
};

Barycentric moller_trumbore(const Ray<double>& ray, const TriangleCorners& corners) {
  const Long3 one = minus(corners[1], corners[0]), two = minus(corners[2], corners[0]);
  const Long3 direction{ray.direction.x, ray.direction.y, ray.direction.z};
  const Long3 p = cross(direction, two), offset = minus(ray.origin, corners[0]), q = cross(offset, one);
  const long double determinant = dot(one, p);
  const long double u = dot(offset, p) / determinant, v = dot(direction, q) / determinant;
  const Long3 normal = cross(one, two);
  return {std::min({u, v, 1 - u - v}), dot(two, q) / determinant,
          std::abs(determinant) / std::sqrt(dot(normal, normal) * dot(direction, direction))};
}

/// Closest point by Voronoi regions (Ericson, Real-Time Collision Detection, 2005, 5.1.5), in long double.
double distance_by_regions(const TriangleCorners& corners, const Vec3& point) {
  const Long3 ab = minus(corners[1], corners[0]), ac = minus(corners[2], corners[0]);
  const Long3 ap = minus(point, corners[0]), bp = minus(point, corners[1]), cp = minus(point, corners[2]);
  const auto length_of = [&](long double v, long double w) {
    const Long3 rest{ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2]};
    return static_cast<double>(std::sqrt(dot(rest, rest)));
  };
  const long double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                    d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return length_of(0, 0);
  if (d3 >= 0 && d4 <= d3) return length_of(1, 0);
  if (d6 >= 0 && d5 <= d6) return length_of(0, 1);
  const long double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return length_of(d1 / (d1 - d3), 0);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return length_of(0, d2 / (d2 - d6));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const long double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return length_of(1 - w, w);
  }
  return length_of(vb / (va + vb + vc), vc / (va + vb + vc));
}

// A flat patch in space, cut into triangles
// ------------------------------------------------------------------------------

/// A square of n × n cells with jittered inner vertices, tilted and moved; corners in ascending order of their index.
struct Patch {
  std::vector<Vec3> vertices_m;
  std::vector<TriangleCorners> triangles;
  Vec3 normal{0.0};
  int cells = 0;

  const Vec3& at(int x, int y) const { return vertices_m[static_cast<std::size_t>(y * (cells + 1) + x)]; }
};

Patch make_patch(int cells, const Plane& plane, RandomStream& random) {
  Patch patch;
  patch.cells = cells;
  patch.normal = plane.normal;
  const PlaneBasis basis = plane_basis(plane.normal);
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const bool inner = x > 0 && y > 0 && x < cells && y < cells;
      const double u = x + (inner ? 0.6 * (random.uniform() - 0.5) : 0.0);
      const double v = y + (inner ? 0.6 * (random.uniform() - 0.5) : 0.0);
      patch.vertices_m.push_back(plane.point_m + u * basis.u + v * basis.v);
    }
  }
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      // Row after row: ascending index is left to right, then upwards.
      const Vec3 &a = patch.at(x, y), &b = patch.at(x + 1, y), &c = patch.at(x, y + 1), &d = patch.at(x + 1, y + 1);
      if (random.next() % 2 == 0) {
        patch.triangles.push_back({a, b, d});
        patch.triangles.push_back({a, c, d});
      } else {
        patch.triangles.push_back({a, b, c});
        patch.triangles.push_back({b, c, d});
      }
    }
  }
  return patch;
}

double covered_rad(const Patch& patch, const Vec3& point_m) {
  double sum_rad = 0.0;
  for (const TriangleCorners& triangle : patch.triangles) {
    sum_rad += contact(triangle, patch.normal, point_m, in_plane_guard_m).covered_rad;
  }
  return sum_rad;
}

bool contained(const Patch& patch, const Vec3& point_m) {
  return std::any_of(patch.triangles.begin(), patch.triangles.end(), [&](const TriangleCorners& triangle) {
    return contains_projected(triangle, patch.normal, point_m);
  });
}

}  // namespace

// WatertightRay
// --------------------------------------------------------------------------------------------------------

TEST_CASE("no ray leaks through an edge or a corner of a closed mesh: a million rays") {
  RandomStream random(20);
  CHECK(count_leaks(cube(1.0, Vec3(0.0)), 200'000, random) == 0);
  CHECK(count_leaks(cube(3.3, Vec3(4321.1, -8765.4, 12.3)), 200'000, random) == 0);
  CHECK(count_leaks(rough_sphere(1, 1.0, 0.3, Vec3(0.0), random), 200'000, random) == 0);
  CHECK(count_leaks(rough_sphere(1, 0.01, 0.3, Vec3(-9999.9, 9999.9, 55.5), random), 200'000, random) == 0);
  CHECK(count_leaks(rough_sphere(2, 250.0, 0.1, Vec3(1e3, 2e3, 3e3), random), 200'000, random) == 0);
}

TEST_CASE("a ray through the middle of an edge meets both of its triangles, one through a corner all of them") {
  // The roof x + |y| style: whole numbers, so the ray is exactly on the edge.
  const TriangleCorners left{Vec3(0, -4, 0), Vec3(0, 4, 0), Vec3(-4, 0, 0)};
  const TriangleCorners right{Vec3(0, -4, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  for (const double y : {-4.0, -1.0, 0.0, 3.0, 4.0}) {
    const WatertightRay ray({Vec3(0, y, 2), Vec3(0, 0, -0.5)});
    for (const TriangleCorners& triangle : {left, right}) {
      const std::optional<double> t = ray.intersect(triangle);
      REQUIRE(t);
      CHECK(*t == 4.0);  // in units of the direction
    }
  }
  const WatertightRay beside({Vec3(1e-9, 0, 2), Vec3(0, 0, -1)});
  CHECK_FALSE(beside.intersect(left));
  CHECK(beside.intersect(right));
}

TEST_CASE("the line may meet the triangle behind its origin: t is negative then") {
  const TriangleCorners triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  CHECK(WatertightRay({Vec3(1, 1, 3), Vec3(0, 0, 1)}).intersect(triangle) == -3.0);
  CHECK(WatertightRay({Vec3(1, 1, 0), Vec3(0, 0, 1)}).intersect(triangle) == 0.0);
}

TEST_CASE("a line in the plane of a triangle does not meet it; a triangle without area is never met") {
  const TriangleCorners flat{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  CHECK_FALSE(WatertightRay({Vec3(-1, 1, 0), Vec3(1, 0, 0)}).intersect(flat));
  CHECK_FALSE(WatertightRay({Vec3(-1, -1, 0), Vec3(1, 1, 0)}).intersect(flat));
  CHECK_FALSE(WatertightRay({Vec3(-1, 1, 1e-9), Vec3(1, 0, 0)}).intersect(flat));
  const TriangleCorners needle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(2, 0, 0)};
  CHECK_FALSE(WatertightRay({Vec3(1, 0, 1), Vec3(0, 0, -1)}).intersect(needle));
}

TEST_CASE("winding and the order of the corners change nothing but rounding, and not the answer") {
  RandomStream random(21);
  for (int repeat = 0; repeat < 5000; ++repeat) {
    TriangleCorners corners{random_vector(random, 1.0), random_vector(random, 1.0), random_vector(random, 1.0)};
    const Vec3 origin = random_vector(random, 3.0), direction = random_vector(random, 1.0);
    const WatertightRay ray({origin, direction});
    const std::optional<double> first = ray.intersect(corners);
    std::array<int, 3> order{0, 1, 2};
    while (std::next_permutation(order.begin(), order.end())) {
      const auto corner = [&](std::size_t index) { return corners[static_cast<std::size_t>(order[index])]; };
      const std::optional<double> other = ray.intersect({corner(0), corner(1), corner(2)});
      REQUIRE_UNARY(first.has_value() == other.has_value());
    }
  }
}

TEST_CASE("away from edges the answer is that of Moeller and Trumbore in long double") {
  RandomStream random(22);
  int compared = 0, hits = 0;
  for (int repeat = 0; repeat < 200'000; ++repeat) {
    const Vec3 base = repeat % 2 == 0 ? Vec3(0.0) : Vec3(5e3, -7e3, 20.0);
    const double size = repeat % 3 == 0 ? 1.0 : (repeat % 3 == 1 ? 30.0 : 0.05);
    TriangleCorners corners;
    for (Vec3& corner : corners) corner = base + random_vector(random, size);
    Vec3 weights(random.uniform(), random.uniform(), random.uniform());
    weights /= weights.x + weights.y + weights.z;
    const Vec3 near = weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
    const Vec3 target = near + random_vector(random, 0.3 * size);
    const Vec3 origin = base + random_vector(random, 5.0 * size);
    const Ray<double> ray{origin, 1.7 * (target - origin)};
    const Barycentric expected = moller_trumbore(ray, corners);
    const double sharpest = 2.0 * size * size;  // only triangles whose shape does not amplify rounding
    if (glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) < 0.02 * sharpest) continue;
    // Offsets have the rounding of their size, 1e-15; divided by slant and shape that is 1e-11 at most here.
    if (expected.slant < 0.01 || std::abs(expected.smallest) < 1e-10) continue;
    ++compared;
    const std::optional<double> t = WatertightRay(ray).intersect(corners);
    REQUIRE_UNARY(t.has_value() == (expected.smallest > 0));
    if (!t) continue;
    ++hits;
    CHECK_UNARY(std::abs(*t - static_cast<double>(expected.t)) < 1e-11 * std::max(1.0, std::abs(*t)));
  }
  CHECK(compared > 100'000);  // the comparison is no empty one
  CHECK(hits > 20'000);
  CHECK(compared - hits > 20'000);
}

// contact
// --------------------------------------------------------------------------------------------------------------

TEST_CASE("a triangle covers a full turn inside, half on an edge, its angle at a corner, nothing outside") {
  const TriangleCorners corners{Vec3(0, 0, 5), Vec3(3, 0, 5), Vec3(0, 4, 5)};  // angles 90°, atan(4/3), atan(3/4)
  for (const double side : {1.0, -1.0}) {
    const Vec3 normal(0, 0, side);
    const auto touch = [&](double x, double y) { return contact(corners, normal, Vec3(x, y, 7), 1e-9); };
    CHECK(touch(1, 1).covered_rad == 2 * pi);
    CHECK(touch(1, 0).covered_rad == pi);
    CHECK(touch(0, 1).covered_rad == pi);
    CHECK(touch(1.5, 2).covered_rad == pi);
    CHECK(touch(0, 0).covered_rad == doctest::Approx(pi / 2).epsilon(1e-14));
    CHECK(touch(3, 0).covered_rad == doctest::Approx(std::atan2(4.0, 3.0)).epsilon(1e-14));
    CHECK(touch(0, 4).covered_rad == doctest::Approx(std::atan2(3.0, 4.0)).epsilon(1e-14));
    for (const auto& [x, y] :
         {std::pair(-1e-8, 1.0), std::pair(1.0, -1e-8), std::pair(2.0, 2.0), std::pair(-5.0, -5.0)}) {
      CHECK(touch(x, y).covered_rad == 0.0);
      CHECK_FALSE(touch(x, y).contains);
    }
    for (const auto& [x, y] : {std::pair(1.0, 1.0), std::pair(1.0, 0.0), std::pair(0.0, 0.0), std::pair(3.0, 0.0)}) {
      CHECK(touch(x, y).contains);
    }
  }
}

TEST_CASE("the rim has the width it is given, on both sides of an edge") {
  const TriangleCorners corners{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 4, 0)};
  const auto covered = [&](double y, double rim) {
    return contact(corners, Vec3(0, 0, 1), Vec3(1, y, 0), rim).covered_rad;
  };
  CHECK(covered(0.09, 0.1) == pi);
  CHECK(covered(0.11, 0.1) == 2 * pi);
  CHECK(covered(-0.09, 0.1) == pi);
  CHECK(covered(-0.11, 0.1) == 0.0);
  CHECK(covered(1e-12, 0.0) == 2 * pi);
  CHECK(covered(-1e-12, 0.0) == 0.0);
}

TEST_CASE("the triangles of a patch cover what the patch covers, however it is cut") {
  RandomStream random(23);
  for (int repeat = 0; repeat < 40; ++repeat) {
    const Plane plane{repeat % 2 == 0 ? Vec3(0.0) : Vec3(500, -800, 30), glm::normalize(random_vector(random, 1.0))};
    const int cells = 3;
    const Patch patch = make_patch(cells, plane, random);
    // The rim is 1e-9 m, roundings are 1e-13 m at 800 m: angles of corners are right to 1e-12.
    const auto is_near = [](double value, double expected) { return std::abs(value - expected) < 1e-11; };
    for (int y = 0; y <= cells; ++y) {
      for (int x = 0; x <= cells; ++x) {
        const int rims = (x == 0 || x == cells) + (y == 0 || y == cells);
        CHECK_UNARY(is_near(covered_rad(patch, patch.at(x, y)), rims == 0 ? 2 * pi : (rims == 1 ? pi : pi / 2)));
      }
    }
    for (const TriangleCorners& triangle : patch.triangles) {
      const double s = random.uniform(), t = random.uniform();
      const Vec3 centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
      CHECK_UNARY(is_near(covered_rad(patch, centre), 2 * pi));
      for (std::size_t side = 0; side < 3; ++side) {
        const Vec3 &a = triangle[side], &b = triangle[(side + 1) % 3];
        const Vec3 on_edge = a + (0.01 + 0.98 * s) * (b - a);
        const double sum_rad = covered_rad(patch, on_edge);
        CHECK_UNARY((is_near(sum_rad, 2 * pi) || is_near(sum_rad, pi)));  // inner edge, or the patch's border
        // Lifted off the plane: the foot decides.
        CHECK_UNARY(covered_rad(patch, on_edge + (t - 0.5) * plane.normal) == doctest::Approx(sum_rad).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("no point of a patch falls between its triangles: on shared edges and at shared corners") {
  RandomStream random(24);
  std::size_t lost = 0, tested = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Plane plane{repeat % 2 == 0 ? Vec3(0.0) : Vec3(5000, -8000, 30), glm::normalize(random_vector(random, 1.0))};
    const int cells = 4;
    const Patch patch = make_patch(cells, plane, random);
    for (int y = 1; y < cells; ++y) {
      for (int x = 1; x < cells; ++x) {
        lost += !contained(patch, patch.at(x, y));
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)}) {
          const Vec3 along = patch.at(x + dx, y + dy) - patch.at(x, y);
          for (int point = 0; point < 10; ++point, ++tested) {
            lost += !contained(patch, patch.at(x, y) + (0.02 + 0.96 * random.uniform()) * along);
          }
        }
      }
    }
  }
  CHECK(lost == 0);
  CHECK(tested > 30'000);
}

// Distances -----------------------------------------------------------------------------------------------------------

TEST_CASE("the distance to a segment: beside it, beyond its ends, and where it is a point") {
  const Vec3 from(0, 0, 0), to(10, 0, 0);
  CHECK(distance_to_segment_m(Vec3(4, 3, 4), from, to) == 5.0);
  CHECK(distance_to_segment_m(Vec3(-3, 4, 0), from, to) == 5.0);
  CHECK(distance_to_segment_m(Vec3(13, 0, -4), from, to) == 5.0);
  CHECK(distance_to_segment_m(Vec3(7, 0, 0), from, to) == 0.0);
  CHECK(distance_to_segment_m(Vec3(3, 4, 0), from, from) == 5.0);
}

TEST_CASE("the distance to a triangle: face, each edge, each corner") {
  const TriangleCorners corners{Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(0, 6, 0)};
  CHECK(distance_to_triangle_m(corners, Vec3(1, 1, -2)) == 2.0);
  CHECK(distance_to_triangle_m(corners, Vec3(1, 1, 0)) == 0.0);
  CHECK(distance_to_triangle_m(corners, Vec3(3, -3, 4)) == 5.0);
  CHECK(distance_to_triangle_m(corners, Vec3(-3, 2, 4)) == 5.0);
  CHECK(distance_to_triangle_m(corners, Vec3(4, 4, 0)) == doctest::Approx(std::sqrt(2.0)).epsilon(1e-15));
  CHECK(distance_to_triangle_m(corners, Vec3(-3, -4, 0)) == 5.0);
  CHECK(distance_to_triangle_m(corners, Vec3(9, 0, 4)) == 5.0);
  CHECK(distance_to_triangle_m(corners, Vec3(0, 9, -4)) == 5.0);
}

TEST_CASE("the distance to a triangle is that by Voronoi regions in long double, whatever the order of the corners") {
  RandomStream random(25);
  double largest_error_m = 0.0, largest_far_m = 0.0, largest_needle_m = 0.0;
  for (int repeat = 0; repeat < 50'000; ++repeat) {
    const bool far = repeat % 2 == 0, needle = repeat % 7 == 0;
    const Vec3 base = far ? Vec3(5e3, -7e3, 20.0) : Vec3(0.0);
    TriangleCorners corners;
    for (Vec3& corner : corners) corner = base + random_vector(random, 2.0);
    if (needle) corners[2] = corners[0] + 0.3 * (corners[1] - corners[0]) + random_vector(random, 1e-5);
    const Vec3 point = base + random_vector(random, 5.0);
    const double expected_m = distance_by_regions(corners, point);
    double& largest_m = needle ? largest_needle_m : (far ? largest_far_m : largest_error_m);
    for (int order = 0; order < 3; ++order) {
      largest_m = std::max(largest_m, std::abs(distance_to_triangle_m(corners, point) - expected_m));
      std::swap(corners[0], corners[static_cast<std::size_t>(1 + order % 2)]);
    }
  }
  CHECK(largest_error_m < 1e-14);  // a few roundings of lengths up to 15 m
  CHECK(largest_far_m < 3e-12);    // a foot is written in coordinates with steps of 9e-13 m
  // A needle 1e-5 m high: its normal, from a product of 1e-15 in 1e-5, may lean by 1e-10; times 15 m.
  CHECK(largest_needle_m < 2e-9);
}

TEST_CASE("a triangle without area is as far as its longest edge, and the distance is a number") {
  CHECK(distance_to_triangle_m({Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(4, 0, 0)}, Vec3(4, 3, 4)) == 5.0);
  CHECK(distance_to_triangle_m({Vec3(1), Vec3(1), Vec3(1)}, Vec3(1, 4, 5)) == 5.0);
}

}  // namespace test_triangle
