#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/random.hpp"
#include "dcem/field/diffuse/adaptive_tiles.hpp"
#include "tests/support/all_tests.hpp"

namespace test_adaptive_tiles {

using namespace dcem;

namespace {

/// A function of the point with a bound of its own for each tile.
struct Field {
  std::function<double(const Vec3&)> density;
  std::function<double(const Tile&)> highest;   ///< no less than the density anywhere on the tile
  std::function<double(const Tile&)> finest_m;  ///< the longest edge that shows what the density does there
  std::vector<Vec3> seen{};

  double bound(const Tile& tile) const { return highest(tile) * tile.area_m2(); }
  double resolution_m(const Tile& tile) const { return finest_m(tile); }
  double evaluate(const Tile& tile, std::size_t) {
    seen.push_back(tile.centroid_m());
    return density(tile.centroid_m()) * tile.area_m2();
  }
};

constexpr double unlimited_m = std::numeric_limits<double>::infinity();

Field field(std::function<double(const Vec3&)> density, double highest) {
  return {std::move(density), [highest](const Tile&) { return highest; }, [](const Tile&) { return unlimited_m; }};
}

TileSettings to(double tolerance, std::size_t budget = 1'000'000, double longest_edge_m = unlimited_m) {
  return {tolerance, longest_edge_m, budget};
}

/// The square |x|, |y| ≤ half in the plane z = 0, as two triangles.
void add_square(AdaptiveTiles<Field>& tiles, double half_m) {
  const Vec3 a(-half_m, -half_m, 0), b(half_m, -half_m, 0), c(half_m, half_m, 0), d(-half_m, half_m, 0);
  tiles.add({a, b, c}, 0);
  tiles.add({a, c, d}, 1);
}

/// What a point at a height over the plane sees: the integral over a surface is its solid angle. It changes over the
/// distance from the eye.
Field solid_angle_seen_from(const Vec3& eye_m) {
  const auto density = [eye_m](const Vec3& point_m) {
    return std::abs(eye_m.z) / std::pow(glm::distance(point_m, eye_m), 3);
  };
  const auto highest = [eye_m](const Tile& tile) {
    return std::abs(eye_m.z) / std::pow(distance_to_triangle_m(tile.corners_m, eye_m), 3);
  };
  return {density, highest, [eye_m](const Tile& tile) { return distance_to_triangle_m(tile.corners_m, eye_m); }};
}

/// Solid angle in sr of the rectangle from (0, 0) to (a, b), seen from a height over its corner; odd in a and in b.
double corner_solid_angle(double a, double b, double height) {
  return std::atan(a * b / (height * std::sqrt(a * a + b * b + height * height)));
}

double square_solid_angle(double half_m, const Vec3& eye_m) {
  const double x0 = -half_m - eye_m.x, x1 = half_m - eye_m.x, y0 = -half_m - eye_m.y, y1 = half_m - eye_m.y;
  const auto corner = [&](double x, double y) { return corner_solid_angle(x, y, eye_m.z); };
  return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

std::vector<Tile> leaves(const AdaptiveTiles<Field>& tiles) {
  std::vector<Tile> result;
  for (const Tile& tile : tiles.tiles()) {
    if (!tile.is_halved) result.push_back(tile);
  }
  return result;
}

double longest_edge_m(const Tile& tile) {
  const auto& [a, b, c] = tile.corners_m;
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

/// Whether a point of the plane z = 0 lies strictly inside; −1 outside, 0 on the rim.
int place_of(const Tile& tile, const Vec3& point_m) {
  double least = unlimited_m;
  const double turn = glm::cross(tile.corners_m[1] - tile.corners_m[0], tile.corners_m[2] - tile.corners_m[0]).z;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vec3 along = tile.corners_m[(corner + 1) % 3] - tile.corners_m[corner];
    least = std::min(least, glm::cross(along, point_m - tile.corners_m[corner]).z * (turn > 0.0 ? 1.0 : -1.0));
  }
  return least > 1e-12 ? 1 : least < -1e-12 ? -1 : 0;
}

}  // namespace

TEST_CASE("adaptive tiles: a linear function is integrated without error, whatever was halved") {
  // The centroid rule is exact for it. Over the square of side 2 the mean of 3 + x − 2y is 3.
  Field linear = field([](const Vec3& p) { return 3.0 + p.x - 2.0 * p.y; }, 6.0);
  for (const double tolerance : {1.0, 0.1, 1e-2, 1e-3}) {
    AdaptiveTiles<Field> tiles(to(tolerance), linear);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(12.0).epsilon(1e-13));
    CHECK(tiles.error() <= tolerance * tiles.total());
  }
}

TEST_CASE("adaptive tiles: smooth integrands with closed forms, to the tolerance and within the estimated error") {
  struct Case {
    std::string name;
    std::function<double(const Vec3&)> density;
    double highest, exact;  // over |x|, |y| ≤ 1
  };
  const std::vector<Case> cases{
      {"x² + y²", [](const Vec3& p) { return p.x * p.x + p.y * p.y; }, 2.0, 8.0 / 3.0},
      {"1/(4 + x)", [](const Vec3& p) { return 1.0 / (4.0 + p.x); }, 1.0 / 3.0, 2.0 * std::log(5.0 / 3.0)},
      {"1 + sin 5x sin 3y", [](const Vec3& p) { return 1.0 + std::sin(5.0 * p.x) * std::sin(3.0 * p.y); }, 2.0, 4.0}};
  for (const Case& one : cases) {
    CAPTURE(one.name);
    for (const double tolerance : {0.1, 0.03, 0.01, 1e-3}) {
      CAPTURE(tolerance);
      Field integrand = field(one.density, one.highest);
      AdaptiveTiles<Field> tiles(to(tolerance), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      const double error = std::abs(tiles.total() - one.exact);
      CHECK(tiles.error() <= tolerance * tiles.total());
      CHECK(error <= tolerance * one.exact);
      CHECK(error <= tiles.error() * (1.0 + 1e-9));  // of x² + y² the estimate is the very error
    }
  }
}

TEST_CASE("adaptive tiles: solid angles, from far away to a hundredth of the side above the surface") {
  for (const Vec3 eye_m :
       {Vec3(0, 0, 30), Vec3(3, 1, 4), Vec3(0, 0, 1), Vec3(0.3, -0.4, 0.2), Vec3(0.9, 0.1, 0.02), Vec3(0, 0, 0.02)}) {
    CAPTURE(eye_m.z);
    const double exact = square_solid_angle(1.0, eye_m);
    std::size_t before = 0;
    for (const double tolerance : {0.2, 0.05, 0.01, 0.002}) {
      Field integrand = solid_angle_seen_from(eye_m);
      AdaptiveTiles<Field> tiles(to(tolerance), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      CHECK(std::abs(tiles.total() - exact) <= std::min(tiles.error(), tolerance * exact));
      CHECK(tiles.evaluated() >= before);
      CHECK(tiles.evaluated() == integrand.seen.size());
      before = tiles.evaluated();
    }
  }
}

TEST_CASE("adaptive tiles: whatever the budget, the estimate covers what is missing") {
  const Vec3 eye_m(0.3, -0.4, 0.2);
  const double exact = square_solid_angle(1.0, eye_m);
  for (std::size_t budget = 1; budget < 400; budget += budget < 20 ? 1 : 17) {
    CAPTURE(budget);
    Field integrand = solid_angle_seen_from(eye_m);
    AdaptiveTiles<Field> tiles(to(1e-9, budget), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(std::abs(tiles.total() - exact) <= tiles.error());
    // Halves are evaluated both or neither, so the last pair may go one beyond the budget.
    CHECK(tiles.evaluated() >= budget);
    CHECK(tiles.evaluated() <= budget + 1);
    CHECK(tiles.error() > 1e-9 * tiles.total());
  }
}

TEST_CASE("adaptive tiles: triangles that the budget did not reach count with their bound") {
  Field integrand = field([](const Vec3&) { return 1.0; }, 1.5);
  AdaptiveTiles<Field> tiles(to(0.01, 10), integrand);
  for (std::uint32_t source = 0; source < 100; ++source) {
    const double x = 2.0 * source;
    tiles.add({Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x, 1, 0)}, source);
  }
  tiles.refine();
  CHECK(tiles.evaluated() == 10);
  CHECK(tiles.total() == doctest::Approx(5.0).epsilon(1e-14));
  CHECK(tiles.error() >= 90 * 0.75);
  CHECK(std::abs(50.0 - tiles.total()) <= tiles.error());
}

TEST_CASE("adaptive tiles: where the longest edge is given, an edge of shadow errs by no more than the tiles it cuts") {
  RandomStream random(3);
  for (int draw = 0; draw < test::all_or(60, 20); ++draw) {
    const double angle = 2.0 * pi * random.uniform(), shift = 1.6 * random.uniform() - 0.8, longest_m = 0.07;
    const double nx = std::cos(angle), ny = std::sin(angle);
    // Lit where nx·x + ny·y < shift. The area by 20,000 strips along y, which err by less than 1e-4.
    double exact = 0.0;
    for (int strip = 0; strip < 20'000; ++strip) {
      const double x = -1.0 + (strip + 0.5) * 1e-4, edge = (shift - nx * x) / ny;
      const double length = ny > 0.0 ? std::clamp(edge, -1.0, 1.0) + 1.0 : 1.0 - std::clamp(edge, -1.0, 1.0);
      exact += 1e-4 * length;
    }
    Field lit = field([=](const Vec3& p) { return nx * p.x + ny * p.y < shift ? 1.0 : 0.0; }, 1.0);
    AdaptiveTiles<Field> tiles(to(1e-3, 1'000'000, longest_m), lit);
    add_square(tiles, 1.0);
    tiles.refine();
    // Only tiles within one edge of the boundary, which is no longer than 2√2, can be wrong, each by at most its area.
    CHECK(std::abs(tiles.total() - exact) <= 2.0 * std::sqrt(2.0) * longest_m);
    CHECK(tiles.total() <= 4.0 * (1.0 + 1e-12));
    // A surface that is dark at every point that was looked at is never taken for one that brings nothing.
    if (tiles.total() == 0.0) CHECK(tiles.error() > 0.0);
  }
}

TEST_CASE("adaptive tiles: what is dark at the centroids of large tiles is looked at again") {
  // A lit stripe of a hundredth of the square between dark halves: the first tiles see nothing of it.
  for (const double left : {-0.7, -0.31, 0.05, 0.44}) {
    Field stripe = field([=](const Vec3& p) { return p.x > left && p.x < left + 0.02 ? 1.0 : 0.0; }, 1.0);
    AdaptiveTiles<Field> tiles(to(0.02, 20'000), stripe);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() > 0.0);
  }
}

TEST_CASE("adaptive tiles: no peak is overlooked that is wider than the integrand says it resolves") {
  for (const Vec3 peak : {Vec3(0.61, -0.23, 0), Vec3(-0.9, 0.87, 0), Vec3(0.001, 0.002, 0)}) {
    // A bell of 1e-2 of width on a ground of 1e-3: π·1e-4 against 4e-3.
    const auto bell_at = [](double distance_m) { return 1e-3 + std::exp(-distance_m * distance_m / 1e-4); };
    Field bell{[=](const Vec3& p) { return bell_at(glm::distance(p, peak)); },
               [=](const Tile& tile) { return bell_at(distance_to_triangle_m(tile.corners_m, peak)); },
               [=](const Tile& tile) { return 0.01 + 0.3 * distance_to_triangle_m(tile.corners_m, peak); }};
    AdaptiveTiles<Field> tiles(to(0.01), bell);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(4e-3 + pi * 1e-4).epsilon(0.01));
    CHECK(tiles.error() <= 0.01 * tiles.total());
  }
}

TEST_CASE("adaptive tiles: no tile that counts is longer than the longest edge, and none is evaluated before") {
  for (const double longest_m : {3.0, 1.0, 0.3, 0.11}) {
    Field integrand = solid_angle_seen_from(Vec3(0.2, 0.1, 0.5));
    AdaptiveTiles<Field> tiles(to(0.5, 1'000'000, longest_m), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    for (const Tile& tile : tiles.tiles()) {
      if (tile.is_evaluated) CHECK(longest_edge_m(tile) <= longest_m);
      if (tile.value > 0.0) CHECK(tile.is_evaluated);
    }
  }
}

TEST_CASE("adaptive tiles: the tiles that count cover the domain once, and their places say how they were cut") {
  Field integrand = solid_angle_seen_from(Vec3(0.9, 0.1, 0.02));
  AdaptiveTiles<Field> tiles(to(0.01), integrand);
  add_square(tiles, 1.0);
  tiles.refine();
  const std::vector<Tile> counted = leaves(tiles);
  REQUIRE(counted.size() > 300);
  double area_m2 = 0.0;
  std::map<std::pair<std::uint32_t, std::uint64_t>, Tile> by_place;
  for (const Tile& tile : tiles.tiles()) CHECK(by_place.emplace(std::pair(tile.source, tile.place), tile).second);
  for (const Tile& tile : counted) {
    area_m2 += tile.area_m2();
    // A half has half of the area: 2^−depth of its triangle.
    const int depth = static_cast<int>(std::floor(std::log2(static_cast<double>(tile.place))));
    CHECK(tile.area_m2() == doctest::Approx(std::ldexp(2.0, -depth)).epsilon(1e-12));
  }
  CHECK(area_m2 == doctest::Approx(4.0).epsilon(1e-12));
  for (const auto& [key, tile] : by_place) {
    if (!tile.is_halved) continue;
    const Tile &one = by_place.at({key.first, 2 * key.second}), &other = by_place.at({key.first, 2 * key.second + 1});
    CHECK(one.area_m2() == doctest::Approx(other.area_m2()).epsilon(1e-12));
    CHECK(one.area_m2() + other.area_m2() == doctest::Approx(tile.area_m2()).epsilon(1e-12));
    CHECK(one.is_evaluated);
    CHECK(other.is_evaluated);
  }
  RandomStream random(8);
  for (int draw = 0; draw < 300; ++draw) {
    // Half of the points close to the eye, where the tiles are small.
    const double reach = draw % 2 == 0 ? 0.05 : 2.0;
    const Vec3 point_m =
        glm::clamp(Vec3(0.9 + reach * (random.uniform() - 0.5), 0.1 + reach * (random.uniform() - 0.5), 0),
                   Vec3(-0.999), Vec3(0.999));
    const Vec3 in_plane(point_m.x, point_m.y, 0.0);
    int inside = 0, on_rim = 0;
    for (const Tile& tile : counted) {
      const int place = place_of(tile, in_plane);
      inside += place == 1;
      on_rim += place == 0;
    }
    CHECK((on_rim > 0 || inside == 1));
  }
}

TEST_CASE("adaptive tiles: the same domain gives the same bits, and a factor of the integrand comes out as a factor") {
  const auto run = [](double factor) {
    Field integrand = solid_angle_seen_from(Vec3(0.3, -0.4, 0.2));
    const auto density = integrand.density;
    const auto highest = integrand.highest;
    integrand.density = [=](const Vec3& p) { return factor * density(p); };
    integrand.highest = [=](const Tile& tile) { return factor * highest(tile); };
    AdaptiveTiles<Field> tiles(to(0.003), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    return std::pair(tiles.total(), integrand.seen);
  };
  const auto [total, seen] = run(1.0);
  CHECK(run(1.0) == std::pair(total, seen));
  // A power of two changes no digit, so the same tiles are halved in the same order.
  CHECK(run(0x1p-60) == std::pair(0x1p-60 * total, seen));
}

TEST_CASE("adaptive tiles: work goes where the power is, and nowhere where there can be none") {
  Field integrand = field([](const Vec3& p) { return p.x < 3.0 ? 1.0 + p.x : 0.0; }, 0.0);
  integrand.highest = [](const Tile& tile) { return tile.source == 0 ? 2.0 : tile.source == 1 ? 1e-4 : 0.0; };
  AdaptiveTiles<Field> tiles(to(0.01), integrand);
  tiles.add({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, 0);
  tiles.add({Vec3(0, 2, 0), Vec3(1e-2, 2, 0), Vec3(0, 2.01, 0)}, 1);
  tiles.add({Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)}, 2);
  tiles.refine();
  std::map<std::uint32_t, std::size_t> evaluated;
  for (const Tile& tile : tiles.tiles()) evaluated[tile.source] += tile.is_evaluated ? 1 : 0;
  CHECK(evaluated[0] >= 7);  // the whole and three pairs of halves at least, as 2·8^−3 < 0.01
  CHECK(evaluated[1] <= 1);
  CHECK(evaluated[2] == 0);
  CHECK(tiles.total() == doctest::Approx(0.5 + 1.0 / 6.0).epsilon(0.01));
}

TEST_CASE("adaptive tiles: an empty domain brings nothing, and is done") {
  Field integrand = field([](const Vec3&) { return 1.0; }, 1.0);
  AdaptiveTiles<Field> tiles(to(0.01), integrand);
  tiles.refine();
  CHECK(tiles.total() == 0.0);
  CHECK(tiles.error() == 0.0);
  CHECK(tiles.evaluated() == 0);
  CHECK(tiles.tiles().empty());
}

TEST_CASE("adaptive tiles: the estimate covers integrands that change along one direction more than along the other") {
  // A cut along the direction in which nothing changes shows no difference, and yet the halves err.
  const auto check = [](Field integrand, double tolerance, double exact) {
    CAPTURE(tolerance);
    AdaptiveTiles<Field> tiles(to(tolerance), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(std::abs(tiles.total() - exact) <= tolerance * exact);
    CHECK(std::abs(tiles.total() - exact) <= tiles.error());
  };
  for (const double tolerance : {0.1, 0.03, 0.01, 1e-3}) {
    check(field([](const Vec3& p) { return std::exp(p.x + 2.0 * p.y); }, std::exp(3.0)), tolerance,
          2.0 * std::sinh(1.0) * std::sinh(2.0));
    check(field([](const Vec3& p) { return std::pow(p.x, 4); }, 1.0), tolerance, 0.8);
    const Vec3 eye_m(1.5, 0.2, 0.05);
    check(solid_angle_seen_from(eye_m), tolerance, square_solid_angle(1.0, eye_m));
  }
}

TEST_CASE("adaptive tiles: what is halved unseen is bounded by the budget, too") {
  Field integrand = field([](const Vec3&) { return 1.0; }, 1.0);
  AdaptiveTiles<Field> tiles(to(0.02, 100, 0.02), integrand);
  add_square(tiles, 1.0);
  tiles.refine();
  CHECK(tiles.evaluated() <= 101);
  CHECK(tiles.tiles().size() <= 1000);
  CHECK(std::abs(tiles.total() - 4.0) <= tiles.error());
}

TEST_CASE(
    "adaptive tiles: a bound that is a million million times the integral does not end the work before its time") {
  // The first bound is 4e6 m² · 1e6 m⁻²; running sums lose what is left of it when the tiles are small.
  for (const double height_m : {1e-2, 1e-3, 1e-4, 1e-5}) {
    CAPTURE(height_m);
    const Vec3 eye_m(3.3, -2.7, height_m);
    Field integrand = solid_angle_seen_from(eye_m);
    AdaptiveTiles<Field> tiles(to(0.005, 200'000), integrand);
    add_square(tiles, 1000.0);
    tiles.refine();
    CHECK(tiles.evaluated() < 100'000);
    CHECK(tiles.error() <= 0.005 * tiles.total() * (1.0 + 1e-9));
    CHECK(std::abs(tiles.total() - square_solid_angle(1000.0, eye_m)) <= 0.005 * tiles.total());
  }
}

TEST_CASE("adaptive tiles: a triangle with equal edges is cut in the same way however it is turned") {
  // Turned corners are rounded, and so one of the equal edges may come out longer by a unit of the last place.
  const TriangleCorners corners_m{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const auto cut = [&](const Mat3& rotation) {
    Field flat = field([](const Vec3&) { return 1.0; }, 1.0);
    AdaptiveTiles<Field> tiles(to(1e9, 100, 1.3), flat);  // no more than is halved unseen: two cuts leave 1.23 m
    tiles.add({rotation * corners_m[0], rotation * corners_m[1], rotation * corners_m[2]}, 0);
    tiles.refine();
    std::map<std::uint64_t, Vec3> centroids_m;
    for (const Tile& tile : tiles.tiles()) centroids_m.emplace(tile.place, tile.centroid_m());
    return centroids_m;
  };
  const auto straight_m = cut(Mat3(1.0));
  REQUIRE(straight_m.size() == 7);
  CHECK(glm::distance(straight_m.at(2), Vec3(1.5, 0.5, 1.0) / 3.0) < 1e-15);  // of the first edge's first half
  for (int turn = 1; turn <= 20; ++turn) {
    const double angle_rad = 0.31 * turn, c = std::cos(angle_rad), s = std::sin(angle_rad);
    const Mat3 rotation = Mat3(c, s, 0, -s, c, 0, 0, 0, 1) * Mat3(1, 0, 0, 0, c, s, 0, -s, c);
    const auto turned_m = cut(rotation);
    REQUIRE(turned_m.size() == straight_m.size());
    for (const auto& [place, centroid_m] : straight_m) {
      REQUIRE(turned_m.contains(place));
      CHECK(glm::distance(turned_m.at(place), rotation * centroid_m) < 1e-14);  // lengths of 1: some roundings
    }
  }
}

}  // namespace test_adaptive_tiles
