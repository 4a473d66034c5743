#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>
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

using Polygon = std::vector<Vec3>;

/// A visible part as an integrand hands it out.
struct Part {
  Polygon corners_m;
  std::uint32_t number = 0;
};

/// A function of the point, and of the number of the visible part, with a bound of its own for each tile.
struct Field {
  std::function<double(const Vec3&)> at;
  std::function<double(const Tile&)> highest;   ///< no less than the function anywhere on the tile
  std::function<double(const Tile&)> finest_m;  ///< the longest edge that shows what the function does there
  /// What is visible of a piece; false where it is to be halved. Absent: all of everything.
  std::function<bool(const Tile&, std::vector<Part>&)> find_parts{};
  std::vector<double> factors{1.0};  ///< by the number of the part; none is above 1
  std::vector<Vec3> seen{};
  std::size_t asked = 0;  ///< pieces of which the visible parts were asked for

  double limit_per_m2(const Tile& tile) const { return highest(tile); }
  double resolution_m(const Tile& tile) const { return finest_m(tile); }
  template <typename Visit>
  bool visit_parts(const Tile& piece, Visit&& visit) {
    ++asked;
    CHECK(piece.state == Tile::State::unseen);
    CHECK(piece.is_piece);
    if (!find_parts) {
      visit(std::span<const Vec3>(piece.corners_m), 0U);
      return true;
    }
    std::vector<Part> parts;
    if (!find_parts(piece, parts)) return false;
    for (const Part& part : parts) visit(std::span<const Vec3>(part.corners_m), part.number);
    return true;
  }
  double density(const Tile& tile, const Vec3& point_m) {
    seen.push_back(point_m);
    return factors.at(tile.part) * at(point_m);
  }
};

/// One of which nobody says that it is smooth on visible parts: foliage makes kinks.
struct KinkedField : Field {
  std::function<bool(const Tile&)> where_smooth = [](const Tile&) { return false; };
  bool is_smooth(const Tile& tile) const { return where_smooth(tile); }
};

constexpr double unlimited_m = std::numeric_limits<double>::infinity();

/// Where the rule is exact, what it misses and what it says it may miss are both of the size of rounding, and either
/// may be the larger: so much of the exact value is put on top of an estimate before they are compared.
constexpr double rounding = 1e-14;

Field field(std::function<double(const Vec3&)> at, double highest) {
  return {std::move(at), [highest](const Tile&) { return highest; }, [](const Tile&) { return unlimited_m; }};
}

TileSettings to(double tolerance, std::size_t budget = 1'000'000, double longest_edge_m = unlimited_m) {
  return {tolerance, longest_edge_m, budget};
}

/// The square |x|, |y| ≤ half in the plane z = 0, as two triangles.
template <typename Integrand>
void add_square(AdaptiveTiles<Integrand>& tiles, double half_m) {
  const Vec3 a(-half_m, -half_m, 0), b(half_m, -half_m, 0), c(half_m, half_m, 0), d(-half_m, half_m, 0);
  tiles.add({a, b, c}, 0);
  tiles.add({a, c, d}, 1);
}

/// What a point at a height over the plane sees: the integral over a surface is its solid angle. It changes over the
/// distance from the eye.
Field solid_angle_seen_from(const Vec3& eye_m) {
  const auto at = [eye_m](const Vec3& point_m) {
    return std::abs(eye_m.z) / std::pow(glm::distance(point_m, eye_m), 3);
  };
  const auto highest = [eye_m](const Tile& tile) {
    return std::abs(eye_m.z) / std::pow(distance_to_triangle_m(tile.corners_m, eye_m), 3);
  };
  return {at, highest, [eye_m](const Tile& tile) { return distance_to_triangle_m(tile.corners_m, eye_m); }};
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

/// Solid angle of a triangle: A. Van Oosterom and J. Strackee 1983.
double triangle_solid_angle(const Vec3& eye_m, const Vec3& a_m, const Vec3& b_m, const Vec3& c_m) {
  const Vec3 a = glm::normalize(a_m - eye_m), b = glm::normalize(b_m - eye_m), c = glm::normalize(c_m - eye_m);
  return 2.0 *
         std::atan2(std::abs(glm::dot(a, glm::cross(b, c))), 1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

/// Of a convex polygon, as a fan.
double solid_angle(const Vec3& eye_m, const Polygon& corners_m) {
  double sum = 0.0;
  for (std::size_t corner = 1; corner + 1 < corners_m.size(); ++corner) {
    sum += triangle_solid_angle(eye_m, corners_m[0], corners_m[corner], corners_m[corner + 1]);
  }
  return sum;
}

/// The half plane n·(x, y) < shift of the plane z = 0.
struct HalfPlane {
  Vec3 normal{1, 0, 0};
  double shift_m = 0.0;

  HalfPlane opposite() const { return {-normal, -shift_m}; }
};

HalfPlane half_plane_at(double angle_rad, double shift_m) {
  return {Vec3(std::cos(angle_rad), std::sin(angle_rad), 0), shift_m};
}

/// What of a convex polygon is in a half plane; fewer than three corners: nothing.
Polygon clipped(const Polygon& polygon, const HalfPlane& half) {
  Polygon kept;
  for (std::size_t index = 0; index < polygon.size(); ++index) {
    const Vec3 &here = polygon[index], &next = polygon[(index + 1) % polygon.size()];
    const double in = half.shift_m - glm::dot(half.normal, here), next_in = half.shift_m - glm::dot(half.normal, next);
    if (in >= 0.0) kept.push_back(here);
    if ((in > 0.0 && next_in < 0.0) || (in < 0.0 && next_in > 0.0)) {
      kept.push_back(here + in / (in - next_in) * (next - here));
    }
  }
  return kept;
}

Polygon polygon_of(const Tile& tile) {
  return {tile.corners_m.begin(), tile.corners_m.end()};
}

const Polygon square_m{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};

/// Area of |x|, |y| ≤ 1 in a half plane, in closed form: the fourfold difference of a square.
double lit_area_m2(const HalfPlane& half) {
  const double a = std::abs(half.normal.x), b = std::abs(half.normal.y);
  const auto square = [](double x) { return x > 0.0 ? x * x : 0.0; };
  const double s = half.shift_m;
  return (square(s + a + b) - square(s + a - b) - square(s - a + b) + square(s - a - b)) / (2.0 * a * b);
}

/// Hands out what is in one half plane.
auto parts_within(const HalfPlane& half) {
  return [half](const Tile& piece, std::vector<Part>& parts) {
    Polygon lit = clipped(polygon_of(piece), half);
    if (lit.size() >= 3) parts.push_back({std::move(lit), 0});
    return true;
  };
}

std::vector<Tile> leaves(const AdaptiveTiles<Field>& tiles) {
  std::vector<Tile> result;
  for (const Tile& tile : tiles.tiles()) {
    if (tile.state != Tile::State::replaced) result.push_back(tile);
  }
  return result;
}

double area_m2(const std::vector<Tile>& tiles) {
  double sum = 0.0;
  for (const Tile& tile : tiles) sum += tile.area_m2();
  return sum;
}

int depth_of(std::uint64_t place) {
  return static_cast<int>(std::bit_width(place)) - 1;
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

TEST_CASE("adaptive tiles: seven points within the triangle, whose weights add up to one, in pairs of three alike") {
  const TriangleCorners corners_m{Vec3(1, 2, -1), Vec3(4, 0, 2), Vec3(-2, 3, 5)};
  const auto points_m = TileRule::points_m(corners_m);
  double sum = 0.0;
  Vec3 mean_m(0.0);
  for (std::size_t point = 0; point < TileRule::points; ++point) {
    CHECK(TileRule::weight(point) > 0.0);
    CHECK(distance_to_triangle_m(corners_m, points_m[point]) < 1e-15);
    sum += TileRule::weight(point);
    mean_m += TileRule::weight(point) * points_m[point];
  }
  CHECK(sum == doctest::Approx(1.0).epsilon(1e-15));
  CHECK(glm::distance(mean_m, (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0) < 1e-15);
  // Radon's numbers.
  CHECK(TileRule::near_corner == doctest::Approx((6.0 - std::sqrt(15.0)) / 21.0).epsilon(1e-15).scale(0.0));
  CHECK(TileRule::near_edge == doctest::Approx((6.0 + std::sqrt(15.0)) / 21.0).epsilon(1e-15));
  CHECK(TileRule::of_near_corner == doctest::Approx((155.0 - std::sqrt(15.0)) / 1200.0).epsilon(1e-15).scale(0.0));
  CHECK(TileRule::of_near_edge == doctest::Approx((155.0 + std::sqrt(15.0)) / 1200.0).epsilon(1e-15).scale(0.0));
  for (std::size_t corner = 0; corner < 3; ++corner) {
    // Numbered by their corner: the second three are near the middles of the edges across.
    const Vec3 across_m = 0.5 * (corners_m[(corner + 1) % 3] + corners_m[(corner + 2) % 3]);
    for (std::size_t other = 1; other < TileRule::points; ++other) {
      if (other != 1 + corner) {
        CHECK(glm::distance(points_m[1 + corner], corners_m[corner]) <
              glm::distance(points_m[other], corners_m[corner]));
      }
      if (other != 4 + corner) {
        CHECK(glm::distance(points_m[4 + corner], across_m) < glm::distance(points_m[other], across_m));
      }
    }
  }
}

TEST_CASE("adaptive tiles: a linear function is integrated without error, whatever was halved") {
  // Over the square of side 2 the mean of 3 + x − 2y is 3.
  Field linear = field([](const Vec3& p) { return 3.0 + p.x - 2.0 * p.y; }, 6.0);
  const auto check = [&](double tolerance, double longest_m) {
    AdaptiveTiles<Field> tiles(to(tolerance, 1'000'000, longest_m), linear);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(12.0).epsilon(1e-13));
    CHECK(tiles.error() <= tolerance * tiles.total());
  };
  for (const double tolerance : {1.0, 0.1, 1e-2, 1e-3}) check(tolerance, unlimited_m);
  // A tolerance that leaves out none of many tiles.
  for (const double longest_m : {0.9, 0.2, 0.05}) check(1e-9, longest_m);
}

TEST_CASE("adaptive tiles: polynomials up to the fifth degree are integrated without error, whatever was halved") {
  RandomStream random(12);
  for (int draw = 0; draw < 40; ++draw) {
    std::array<std::array<double, 6>, 6> factor{};
    double highest = 0.0;
    for (std::size_t i = 0; i <= 5; ++i) {
      for (std::size_t j = 0; i + j <= 5; ++j) {
        factor[i][j] = 2.0 * random.uniform() - 1.0;
        highest += std::abs(factor[i][j]);
      }
    }
    factor[0][0] += highest;  // so that it is nowhere negative
    double exact = 0.0;       // ∫ x^i y^j over |x|, |y| ≤ 1
    for (std::size_t i = 0; i <= 5; i += 2) {
      for (std::size_t j = 0; i + j <= 5; j += 2) {
        exact += factor[i][j] * 4.0 / (static_cast<double>(i + 1) * static_cast<double>(j + 1));
      }
    }
    const auto value = [&](const Vec3& p) {
      double sum = 0.0;
      for (std::size_t i = 0; i <= 5; ++i) {
        for (std::size_t j = 0; i + j <= 5; ++j) {
          sum += factor[i][j] * std::pow(p.x, static_cast<double>(i)) * std::pow(p.y, static_cast<double>(j));
        }
      }
      return sum;
    };
    Field polynomial = field(value, 2.0 * highest);
    // By the estimate some are halved many times, and others not at all.
    const double tolerance = std::pow(10.0, -4.0 - 3.0 * random.uniform());
    AdaptiveTiles<Field> tiles(to(tolerance, 1'000'000, draw % 2 == 0 ? unlimited_m : 3.0 * random.uniform() + 0.5),
                               polynomial);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(exact).epsilon(1e-13));
    CHECK(tiles.error() <= tolerance * tiles.total());
  }
}

TEST_CASE("adaptive tiles: of the second degree the estimate is rounding, of the third it is not") {
  // What the two rules have in common says nothing, and the first term in which they differ all.
  const auto error_of = [](int power) {
    Field integrand = field([power](const Vec3& p) { return std::pow(1.0 + p.x, power); }, 32.0);
    AdaptiveTiles<Field> tiles(to(0.5), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.evaluated() == 2);
    return tiles.error() / tiles.total();
  };
  for (int power = 0; power <= 2; ++power) CHECK(error_of(power) < 1e-15);
  for (int power = 3; power <= 5; ++power) CHECK(error_of(power) > 1e-3);
}

TEST_CASE("adaptive tiles: smooth integrands with closed forms, to the tolerance and within the estimated error") {
  struct Case {
    std::string name;
    std::function<double(const Vec3&)> density;
    double highest, exact;  // over |x|, |y| ≤ 1
  };
  const std::vector<Case> cases{
      {"x² + y²", [](const Vec3& p) { return p.x * p.x + p.y * p.y; }, 2.0, 8.0 / 3.0},
      {"x⁶ + y⁸", [](const Vec3& p) { return std::pow(p.x, 6) + std::pow(p.y, 8); }, 2.0, 4.0 / 7.0 + 4.0 / 9.0},
      {"1/(4 + x)", [](const Vec3& p) { return 1.0 / (4.0 + p.x); }, 1.0 / 3.0, 2.0 * std::log(5.0 / 3.0)},
      {"1 + sin 5x sin 3y", [](const Vec3& p) { return 1.0 + std::sin(5.0 * p.x) * std::sin(3.0 * p.y); }, 2.0, 4.0}};
  for (const Case& one : cases) {
    CAPTURE(one.name);
    for (const double tolerance : {0.1, 0.03, 0.01, 1e-3, 1e-5, 1e-7}) {
      CAPTURE(tolerance);
      Field integrand = field(one.density, one.highest);
      AdaptiveTiles<Field> tiles(to(tolerance), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      const double error = std::abs(tiles.total() - one.exact);
      CHECK(tiles.error() <= tolerance * tiles.total());
      CHECK(error <= tolerance * one.exact);
      CHECK(error <= tiles.error() + rounding * one.exact);
    }
  }
}

TEST_CASE("adaptive tiles: solid angles, from far away to a hundredth of the side above the surface") {
  for (const Vec3 eye_m :
       {Vec3(0, 0, 30), Vec3(3, 1, 4), Vec3(0, 0, 1), Vec3(0.3, -0.4, 0.2), Vec3(0.9, 0.1, 0.02), Vec3(0, 0, 0.02)}) {
    CAPTURE(eye_m.z);
    const double exact = square_solid_angle(1.0, eye_m);
    std::size_t before = 0;
    for (const double tolerance : {0.2, 0.05, 0.01, 0.002, 1e-5}) {
      Field integrand = solid_angle_seen_from(eye_m);
      AdaptiveTiles<Field> tiles(to(tolerance), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      CHECK(std::abs(tiles.total() - exact) <= std::min(tiles.error() + rounding * exact, tolerance * exact));
      CHECK(tiles.evaluated() >= before);
      CHECK(TileRule::points * tiles.evaluated() == integrand.seen.size());
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
    CHECK(std::abs(tiles.total() - exact) <= tiles.error() + rounding * exact);
    // Halves are evaluated both or neither, so the last pair may go one beyond the budget. A budget of a few tiles goes
    // on cutting those that are too large to show the peak.
    CHECK((tiles.evaluated() >= budget || (budget < 30 && tiles.tiles().size() >= 2 + 8 * budget)));
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

TEST_CASE("adaptive tiles: an estimate is no more than the bound, and what may be anything counts with it") {
  // Between a bound of 1e-6 and what the rules differ by, 1e-2 of it at least, the bound is the less.
  Field integrand = field([](const Vec3& p) { return p.x > 0.3 ? 1.0 : 0.0; }, 1e-6);
  AdaptiveTiles<Field> tiles(to(1e-9, 50), integrand);
  add_square(tiles, 1.0);
  tiles.refine();
  for (const Tile& tile : leaves(tiles)) CHECK(tile.error <= tile.bound());
  CHECK(tiles.error() <= 4e-6 * (1.0 + 1e-12));
}

// What is not smooth --------------------------------------------------------------------------------------------------

TEST_CASE("adaptive tiles: a kink, as foliage makes it, is summed to the tolerance and within the estimated error") {
  RandomStream random(5);
  for (int draw = 0; draw < test::all_or(60, 20); ++draw) {
    const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
    const double a = std::abs(half.normal.x), b = std::abs(half.normal.y), s = half.shift_m;
    // ∫ max(0, s − n·p): the fourfold difference of a cube.
    const auto cube = [](double x) { return x > 0.0 ? x * x * x : 0.0; };
    const double exact = 4.0 + (cube(s + a + b) - cube(s + a - b) - cube(s - a + b) + cube(s - a - b)) / (6.0 * a * b);
    for (const double tolerance : {0.1, 0.01, 1e-3}) {
      KinkedField kinked{field([&](const Vec3& p) { return 1.0 + std::max(0.0, s - glm::dot(half.normal, p)); },
                               1.0 + std::abs(s) + a + b)};
      AdaptiveTiles<KinkedField> tiles(to(tolerance), kinked);
      add_square(tiles, 1.0);
      tiles.refine();
      const double error = std::abs(tiles.total() - exact);
      CHECK(tiles.error() <= tolerance * tiles.total());
      CHECK(error <= tolerance * exact);
      CHECK(error <= tiles.error());
    }
  }
}

TEST_CASE("adaptive tiles: where the longest edge is given, a step errs by no more than the tiles it cuts") {
  RandomStream random(3);
  for (int draw = 0; draw < test::all_or(60, 6); ++draw) {
    const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
    const double exact = lit_area_m2(half), longest_m = 0.07;
    KinkedField lit{field([&](const Vec3& p) { return glm::dot(half.normal, p) < half.shift_m ? 1.0 : 0.0; }, 1.0)};
    AdaptiveTiles<KinkedField> tiles(to(1e-3, 1'000'000, longest_m), lit);
    add_square(tiles, 1.0);
    tiles.refine();
    // Only tiles within one edge of the boundary, which is no longer than 2√2, can be wrong, each by at most its area.
    CHECK(std::abs(tiles.total() - exact) <= 2.0 * std::sqrt(2.0) * longest_m);
    CHECK(tiles.total() <= 4.0 * (1.0 + 1e-12));
  }
}

TEST_CASE("adaptive tiles: a surface that is dark at every point that was looked at is not taken for a dark one") {
  // Lit is a corner of 1e-6 m along the diagonal, 1e-12 m².
  const HalfPlane half = half_plane_at(0.25 * pi, -std::sqrt(2.0) + 1e-6);
  for (const std::size_t budget : {2U, 10U, 100U, 1000U}) {
    KinkedField lit{field([&](const Vec3& p) { return glm::dot(half.normal, p) < half.shift_m ? 1.0 : 0.0; }, 1.0)};
    AdaptiveTiles<KinkedField> tiles(to(1e-3, budget), lit);
    add_square(tiles, 1.0);
    tiles.refine();
    REQUIRE(tiles.total() == 0.0);
    CHECK(tiles.error() > 1e-12);
  }
}

TEST_CASE("adaptive tiles: a step is summed to the tolerance") {
  RandomStream random(7);
  for (int draw = 0; draw < test::all_or(60, 20); ++draw) {
    const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
    KinkedField lit{field([&](const Vec3& p) { return glm::dot(half.normal, p) < half.shift_m ? 1.0 : 0.1; }, 1.0)};
    const double exact = 0.9 * lit_area_m2(half) + 0.4;
    for (const double tolerance : {0.1, 0.02}) {
      AdaptiveTiles<KinkedField> tiles(to(tolerance), lit);
      add_square(tiles, 1.0);
      tiles.refine();
      CHECK(std::abs(tiles.total() - exact) <= tolerance * exact);
      CHECK(std::abs(tiles.total() - exact) <= tiles.error());
    }
  }
}

TEST_CASE("adaptive tiles: what is dark at the points of large tiles is looked at again, where it is not smooth") {
  // A bright stripe of a hundredth of the square between dark halves: the first tiles see nothing of it.
  for (const double left : {-0.7, -0.31, 0.05, 0.44}) {
    KinkedField stripe{field([=](const Vec3& p) { return p.x > left && p.x < left + 0.02 ? 1.0 : 0.0; }, 1.0)};
    AdaptiveTiles<KinkedField> tiles(to(0.02, 20'000), stripe);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() > 0.0);
  }
}

TEST_CASE("adaptive tiles: doubt ends where it is smooth, and smooth all over it is as if nobody had asked") {
  const auto points_of = [](auto integrand) {
    AdaptiveTiles<decltype(integrand)> tiles(to(1e-3), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(square_solid_angle(1.0, Vec3(0.3, -0.4, 0.2))).epsilon(1e-3));
    return integrand.seen;
  };
  const Field plain = solid_angle_seen_from(Vec3(0.3, -0.4, 0.2));
  KinkedField nowhere{plain}, half{plain}, everywhere{plain};
  nowhere.where_smooth = [](const Tile&) { return true; };
  half.where_smooth = [](const Tile& tile) {
    return std::ranges::all_of(tile.corners_m, [](const Vec3& corner_m) { return corner_m.x >= 0.0; });
  };
  CHECK(points_of(nowhere) == points_of(plain));
  CHECK(points_of(half).size() > points_of(plain).size());
  CHECK(points_of(everywhere).size() > points_of(half).size());
  // More of them on the left, though most of the integral is on the right.
  const std::vector<Vec3> seen = points_of(half);
  const auto left = std::ranges::count_if(seen, [](const Vec3& point_m) { return point_m.x < 0.0; });
  CHECK(left > std::ssize(seen) - left);
}

// Visible parts -------------------------------------------------------------------------------------------------------

TEST_CASE("adaptive tiles: behind an edge of shadow what is lit has its area, to rounding, however finely it is cut") {
  RandomStream random(3);
  for (int draw = 0; draw < test::all_or(60, 20); ++draw) {
    const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
    const double exact = lit_area_m2(half), slope = std::abs(half.normal.x * half.normal.y);
    for (const double longest_m : {unlimited_m, 0.7, 0.07}) {
      Field lit = field([](const Vec3&) { return 1.0; }, 1.0);
      lit.find_parts = parts_within(half);
      AdaptiveTiles<Field> tiles(to(1e-14, 1'000'000, longest_m), lit);
      add_square(tiles, 1.0);
      tiles.refine();
      // The closed form loses digits along the axes, by 1/ab.
      CHECK(std::abs(tiles.total() - exact) <= 1e-13 * (exact + 0.1 / slope));
      CHECK(std::abs(area_m2(leaves(tiles)) - exact) <= 1e-13 * (exact + 0.1 / slope));
      CHECK(tiles.error() <= 1e-14 * tiles.total());
      for (const Vec3& point_m : lit.seen) CHECK(glm::dot(half.normal, point_m) < half.shift_m);
    }
  }
}

TEST_CASE("adaptive tiles: the solid angle of what is lit, to the tolerance and within the estimated error") {
  RandomStream random(4);
  for (const Vec3 eye_m : {Vec3(0, 0, 30), Vec3(3, 1, 4), Vec3(0.3, -0.4, 0.2), Vec3(0.9, 0.1, 0.02)}) {
    for (int draw = 0; draw < 5; ++draw) {
      const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
      const Polygon lit_m = clipped(square_m, half);
      const double exact = solid_angle(eye_m, lit_m);
      for (const double tolerance : {0.1, 0.01, 1e-4}) {
        Field integrand = solid_angle_seen_from(eye_m);
        integrand.find_parts = parts_within(half);
        AdaptiveTiles<Field> tiles(to(tolerance), integrand);
        add_square(tiles, 1.0);
        tiles.refine();
        const double error = std::abs(tiles.total() - exact);
        CHECK(error <= tolerance * exact);
        CHECK(error <= tiles.error() + rounding * exact);
      }
    }
  }
}

TEST_CASE("adaptive tiles: a lit stripe of a hundredth of the square is not overlooked, and has its area") {
  for (const double left : {-0.7, -0.31, 0.05, 0.44}) {
    Field stripe = field([](const Vec3&) { return 1.0; }, 1.0);
    stripe.find_parts = [&](const Tile& piece, std::vector<Part>& parts) {
      Polygon lit = clipped(polygon_of(piece), HalfPlane{Vec3(1, 0, 0), left + 0.02});
      lit = clipped(lit, HalfPlane{Vec3(1, 0, 0), left}.opposite());
      if (lit.size() >= 3) parts.push_back({std::move(lit), 0});
      return true;
    };
    AdaptiveTiles<Field> tiles(to(0.02, 20'000), stripe);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(tiles.total() == doctest::Approx(0.04).epsilon(1e-13).scale(0.0));
    CHECK(tiles.error() <= 0.02 * tiles.total());
    CHECK(stripe.asked == 2);
  }
}

TEST_CASE("adaptive tiles: pieces that are refused are halved until they are not, and nothing is lost") {
  RandomStream random(6);
  for (int draw = 0; draw < 20; ++draw) {
    const HalfPlane half = half_plane_at(2.0 * pi * random.uniform(), 1.6 * random.uniform() - 0.8);
    const double longest_m = 0.05 + random.uniform(), slope = std::abs(half.normal.x * half.normal.y);
    Field lit = field([](const Vec3& p) { return 2.0 + p.x * p.x; }, 3.0);
    std::size_t refused = 0;
    lit.find_parts = [&](const Tile& piece, std::vector<Part>& parts) {
      if (piece.longest_edge_m() > longest_m) {
        ++refused;
        parts.push_back({polygon_of(piece), 0});  // not said to anybody
        return false;
      }
      return parts_within(half)(piece, parts);
    };
    AdaptiveTiles<Field> tiles(to(1e-14), lit);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(refused >= 2);
    CHECK(lit.asked > refused);
    CHECK(std::abs(area_m2(leaves(tiles)) - lit_area_m2(half)) <= 1e-13 * (4.0 + 0.1 / slope));
    for (const Tile& tile : leaves(tiles)) {
      CHECK(tile.state == Tile::State::evaluated);
      CHECK(tile.longest_edge_m() <= longest_m);
      CHECK(tile.place > 1);
    }
    // ∫ 2 + x² over the lit part, of the second degree: three points in the middles of the edges of a fan are exact.
    double exact = 0.0;
    const Polygon whole_m = clipped(square_m, half);
    for (std::size_t corner = 1; corner + 1 < whole_m.size(); ++corner) {
      const std::array<Vec3, 3> fan{whole_m[0], whole_m[corner], whole_m[corner + 1]};
      const double fan_m2 = 0.5 * glm::length(glm::cross(fan[1] - fan[0], fan[2] - fan[0]));
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const double x = 0.5 * (fan[edge].x + fan[(edge + 1) % 3].x);
        exact += fan_m2 / 3.0 * (2.0 + x * x);
      }
    }
    CHECK(tiles.total() == doctest::Approx(exact).epsilon(1e-12));
  }
}

TEST_CASE("adaptive tiles: where every piece is refused the budget ends it, and the bound stands for all") {
  Field dark = field([](const Vec3&) { return 1.0; }, 1.5);
  dark.find_parts = [](const Tile&, std::vector<Part>&) { return false; };
  AdaptiveTiles<Field> tiles(to(0.02, 100), dark);
  add_square(tiles, 1.0);
  tiles.refine();
  CHECK(tiles.evaluated() == 0);
  CHECK(tiles.total() == 0.0);
  CHECK(tiles.error() == doctest::Approx(6.0).epsilon(1e-13));
  CHECK(tiles.tiles().size() <= 1000);
  CHECK(dark.seen.empty());
}

TEST_CASE("adaptive tiles: a piece without a visible part brings nothing, and is done") {
  Field dark = field([](const Vec3&) { return 1.0; }, 1.0);
  dark.find_parts = [](const Tile&, std::vector<Part>&) { return true; };
  AdaptiveTiles<Field> tiles(to(1e-6, 20'000), dark);
  add_square(tiles, 1.0);
  tiles.refine();
  CHECK(dark.asked == 2);
  CHECK(dark.seen.empty());
  CHECK(tiles.evaluated() == 0);
  CHECK(tiles.total() == 0.0);
  CHECK(tiles.error() == 0.0);
  CHECK(leaves(tiles).empty());
  // Beside one that has one.
  Field half_dark = field([](const Vec3&) { return 1.0; }, 1.0);
  half_dark.find_parts = [](const Tile& piece, std::vector<Part>& parts) {
    if (piece.source == 1) parts.push_back({polygon_of(piece), 0});
    return true;
  };
  AdaptiveTiles<Field> others(to(1e-6, 20'000), half_dark);
  add_square(others, 1.0);
  others.refine();
  CHECK(others.total() == doctest::Approx(2.0).epsilon(1e-15));
  CHECK(others.error() <= 1e-6 * others.total());
  for (const Tile& tile : leaves(others)) CHECK(tile.source == 1);
}

TEST_CASE("adaptive tiles: every part has its number, its own integrand, and its halves keep both") {
  // Two half planes cut the square in four; one of the four is dark, the others let a share pass.
  const HalfPlane one = half_plane_at(0.3, 0.2), other = half_plane_at(1.9, -0.1);
  const std::vector<std::pair<HalfPlane, HalfPlane>> quarters{
      {one, other}, {one, other.opposite()}, {one.opposite(), other}};
  const std::vector<double> factors{1.0, 0.5, 0.25, 1e-3};
  const Vec3 eye_m(0.2, 0.1, 0.15);
  double exact = 0.0;
  for (std::size_t quarter = 0; quarter < 3; ++quarter) {
    exact += factors[quarter + 1] *
             solid_angle(eye_m, clipped(clipped(square_m, quarters[quarter].first), quarters[quarter].second));
  }
  for (const double finest_m : {10.0, 0.5}) {  // some pieces are refused
    for (const double tolerance : {0.1, 1e-3, 1e-6}) {
      Field integrand = solid_angle_seen_from(eye_m);
      integrand.factors = factors;
      const auto highest = integrand.highest;
      integrand.highest = [&](const Tile& tile) { return factors.at(tile.part) * highest(tile); };
      integrand.find_parts = [&](const Tile& piece, std::vector<Part>& parts) {
        for (std::uint32_t quarter = 0; quarter < 3; ++quarter) {
          Polygon lit = clipped(clipped(polygon_of(piece), quarters[quarter].first), quarters[quarter].second);
          if (lit.size() >= 3) parts.push_back({std::move(lit), quarter + 1});
        }
        return piece.longest_edge_m() <= finest_m || parts.size() < 2;
      };
      AdaptiveTiles<Field> tiles(to(tolerance), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      const double error = std::abs(tiles.total() - exact);
      CHECK(error <= tolerance * exact);
      CHECK(error <= tiles.error() + rounding * exact);
      std::array<double, 4> covered_m2{};
      for (const Tile& tile : leaves(tiles)) {
        REQUIRE((tile.part >= 1 && tile.part <= 3));
        covered_m2[tile.part] += tile.area_m2();
        const auto& [first, second] = quarters[tile.part - 1];
        CHECK(glm::dot(first.normal, tile.centroid_m()) < first.shift_m);
        CHECK(glm::dot(second.normal, tile.centroid_m()) < second.shift_m);
      }
      for (std::size_t quarter = 0; quarter < 3; ++quarter) {
        const Polygon all = clipped(clipped(square_m, quarters[quarter].first), quarters[quarter].second);
        double sum = 0.0;
        for (std::size_t corner = 1; corner + 1 < all.size(); ++corner) {
          sum += 0.5 * glm::length(glm::cross(all[corner] - all[0], all[corner + 1] - all[0]));
        }
        CHECK(covered_m2[quarter + 1] == doctest::Approx(sum).epsilon(1e-12));
      }
      tiles.for_each_point([&](const Tile& tile, const Vec3& point_m, double, double density) {
        CHECK(density == factors[tile.part] * integrand.at(point_m));
      });
    }
  }
}

TEST_CASE("adaptive tiles: a part keeps its piece's place, all of a piece is a piece, and so are its halves") {
  Field integrand = solid_angle_seen_from(Vec3(0.1, 0.05, 0.05));
  const HalfPlane half = half_plane_at(0.7, 0.3);
  integrand.find_parts = [&](const Tile& piece, std::vector<Part>& parts) {
    if (piece.longest_edge_m() > 0.6) return false;
    return parts_within(half)(piece, parts);
  };
  AdaptiveTiles<Field> tiles(to(1e-5), integrand);
  add_square(tiles, 1.0);
  tiles.refine();
  std::map<std::pair<std::uint32_t, std::uint64_t>, TriangleCorners> pieces;
  for (const Tile& tile : tiles.tiles()) {
    if (!tile.is_piece) continue;
    const auto [entry, is_new] = pieces.emplace(std::pair(tile.source, tile.place), tile.corners_m);
    CHECK(entry->second == tile.corners_m);  // as a piece, and as what is visible of it
    CHECK(tile.area_m2() == doctest::Approx(std::ldexp(2.0, -depth_of(tile.place))).epsilon(1e-12).scale(0.0));
  }
  std::size_t whole = 0, cut = 0, halved_parts = 0;
  for (const Tile& tile : tiles.tiles()) {
    if (tile.is_piece) {
      whole += tile.state == Tile::State::evaluated;
      continue;
    }
    ++cut;
    const auto piece = pieces.find({tile.source, tile.place});
    REQUIRE(piece != pieces.end());
    for (const Vec3& corner_m : tile.corners_m) CHECK(distance_to_triangle_m(piece->second, corner_m) < 1e-14);
    CHECK(tile.area_m2() < std::ldexp(2.0, -depth_of(tile.place)));
    halved_parts += tile.state == Tile::State::replaced;
  }
  CHECK(whole > 20);
  CHECK(cut > 20);
  CHECK(halved_parts > 5);
}

TEST_CASE("adaptive tiles: the points are those that were evaluated, with areas that add up to what is lit") {
  for (const bool is_cut : {false, true}) {
    const HalfPlane half = half_plane_at(2.2, 0.1);
    Field integrand = solid_angle_seen_from(Vec3(0.3, -0.4, 0.2));
    if (is_cut) integrand.find_parts = parts_within(half);
    AdaptiveTiles<Field> tiles(to(1e-4), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    double covered_m2 = 0.0, sum = 0.0;
    std::size_t count = 0;
    std::map<std::array<double, 3>, int> seen;
    for (const Vec3& point_m : integrand.seen) ++seen[{point_m.x, point_m.y, point_m.z}];
    tiles.for_each_point([&](const Tile& tile, const Vec3& point_m, double point_m2, double density) {
      CHECK(tile.state == Tile::State::evaluated);
      CHECK(point_m2 > 0.0);
      CHECK(density == integrand.at(point_m));
      CHECK(seen.contains({point_m.x, point_m.y, point_m.z}));
      CHECK(place_of(tile, point_m) == 1);
      covered_m2 += point_m2;
      sum += point_m2 * density;
      ++count;
    });
    CHECK(count % TileRule::points == 0);
    CHECK(count < TileRule::points * tiles.evaluated());  // what was halved is not among them
    CHECK(covered_m2 == doctest::Approx(is_cut ? lit_area_m2(half) : 4.0).epsilon(1e-13));
    CHECK(sum == doctest::Approx(tiles.total()).epsilon(1e-13));
  }
}

// What steers the work ------------------------------------------------------------------------------------------------

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
    CHECK(tiles.total() == doctest::Approx(4e-3 + pi * 1e-4).epsilon(0.01).scale(0.0));
    CHECK(tiles.error() <= 0.01 * tiles.total());
  }
}

TEST_CASE("adaptive tiles: a tile that is too large to show a peak may be wrong by all of its bound") {
  // The peak is between the seven points of the only tile: nothing of it would be seen.
  const Vec3 peak(0.123, 0.271, 0);
  const auto bell_at = [](double distance_m) { return std::exp(-distance_m * distance_m / 1e-6); };
  Field bell{[=](const Vec3& p) { return bell_at(glm::distance(p, peak)); },
             [=](const Tile& tile) { return bell_at(distance_to_triangle_m(tile.corners_m, peak)); },
             [=](const Tile& tile) { return 1e-3 + 0.3 * distance_to_triangle_m(tile.corners_m, peak); }};
  for (const std::size_t budget : {1U, 3U, 10U, 100U}) {
    AdaptiveTiles<Field> tiles(to(0.01, budget), bell);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(std::abs(tiles.total() - pi * 1e-6) <= tiles.error());
  }
}

TEST_CASE("adaptive tiles: no tile that counts is longer than the longest edge, and none is evaluated before") {
  for (const double longest_m : {3.0, 1.0, 0.3, 0.11}) {
    for (const bool is_cut : {false, true}) {
      Field integrand = solid_angle_seen_from(Vec3(0.2, 0.1, 0.5));
      if (is_cut) integrand.find_parts = parts_within(half_plane_at(1.1, 0.3));
      AdaptiveTiles<Field> tiles(to(0.5, 1'000'000, longest_m), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      for (const Tile& tile : tiles.tiles()) {
        if (tile.state == Tile::State::evaluated) CHECK(tile.longest_edge_m() <= longest_m);
        if (tile.value > 0.0) CHECK(tile.longest_edge_m() <= longest_m);
        if (tile.value > 0.0) CHECK((tile.state == Tile::State::evaluated || tile.state == Tile::State::replaced));
      }
    }
  }
}

TEST_CASE("adaptive tiles: the tiles that count cover the domain once, and their places say how they were cut") {
  Field integrand = solid_angle_seen_from(Vec3(0.9, 0.1, 0.02));
  AdaptiveTiles<Field> tiles(to(1e-6), integrand);
  add_square(tiles, 1.0);
  tiles.refine();
  const std::vector<Tile> counted = leaves(tiles);
  REQUIRE(counted.size() > 300);
  double covered_m2 = 0.0;
  std::map<std::pair<std::uint32_t, std::uint64_t>, Tile> by_place, counted_by_place;
  for (const Tile& tile : tiles.tiles()) {
    // A piece, and what is visible of it, which here is all.
    const auto [entry, is_new] = by_place.emplace(std::pair(tile.source, tile.place), tile);
    CHECK(entry->second.corners_m == tile.corners_m);
    if (!is_new) CHECK(entry->second.state == Tile::State::replaced);
  }
  for (const Tile& tile : counted) {
    CHECK(counted_by_place.emplace(std::pair(tile.source, tile.place), tile).second);
    CHECK(tile.state == Tile::State::evaluated);
    CHECK(tile.is_piece);
    covered_m2 += tile.area_m2();
    // A half has half of the area: 2^−depth of its triangle.
    CHECK(tile.area_m2() == doctest::Approx(std::ldexp(2.0, -depth_of(tile.place))).epsilon(1e-12).scale(0.0));
  }
  CHECK(covered_m2 == doctest::Approx(4.0).epsilon(1e-12));
  for (const auto& [key, tile] : by_place) {
    const auto one_at = by_place.find({key.first, 2 * key.second}),
               other_at = by_place.find({key.first, 2 * key.second + 1});
    // Cut or counted, and never both.
    CHECK((one_at == by_place.end()) == counted_by_place.contains(key));
    CHECK((other_at == by_place.end()) == counted_by_place.contains(key));
    if (one_at == by_place.end() || other_at == by_place.end()) continue;
    const Tile &one = one_at->second, &other = other_at->second;
    CHECK(one.area_m2() == doctest::Approx(other.area_m2()).epsilon(1e-12).scale(0.0));
    CHECK(one.area_m2() + other.area_m2() == doctest::Approx(tile.area_m2()).epsilon(1e-12).scale(0.0));
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
  for (const bool is_cut : {false, true}) {
    const auto run = [&](double factor) {
      Field integrand = solid_angle_seen_from(Vec3(0.3, -0.4, 0.2));
      const auto at = integrand.at;
      const auto highest = integrand.highest;
      integrand.at = [=](const Vec3& p) { return factor * at(p); };
      integrand.highest = [=](const Tile& tile) { return factor * highest(tile); };
      if (is_cut) integrand.find_parts = parts_within(half_plane_at(0.4, 0.1));
      AdaptiveTiles<Field> tiles(to(1e-5), integrand);
      add_square(tiles, 1.0);
      tiles.refine();
      return std::pair(tiles.total(), integrand.seen);
    };
    const auto [total, seen] = run(1.0);
    CHECK(seen.size() > 300);
    CHECK(run(1.0) == std::pair(total, seen));
    // A power of two changes no digit, so the same tiles are halved in the same order.
    CHECK(run(0x1p-60) == std::pair(0x1p-60 * total, seen));
  }
}

TEST_CASE("adaptive tiles: work goes where the power is, and nowhere where there can be none") {
  // e^(8x) on the first triangle, 1e-4 of 1 on the second, nothing on the third.
  Field integrand = field([](const Vec3& p) { return p.x > 3.0 ? 0.0 : p.y < 1.5 ? std::exp(8.0 * p.x) : 1e-4; }, 0.0);
  integrand.highest = [](const Tile& tile) { return tile.source == 0 ? std::exp(8.0) : tile.source == 1 ? 1e-4 : 0.0; };
  AdaptiveTiles<Field> tiles(to(1e-3), integrand);
  tiles.add({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, 0);
  tiles.add({Vec3(0, 2, 0), Vec3(1e-2, 2, 0), Vec3(0, 2.01, 0)}, 1);
  tiles.add({Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)}, 2);
  tiles.refine();
  std::map<std::uint32_t, std::size_t> evaluated;
  for (const Tile& tile : tiles.tiles()) evaluated[tile.source] += tile.state == Tile::State::evaluated ? 1 : 0;
  CHECK(evaluated[0] >= 7);
  CHECK(evaluated[1] <= 1);
  CHECK(evaluated[2] == 0);
  for (const Tile& tile : tiles.tiles()) CHECK((tile.source != 2 || tile.state == Tile::State::unseen));
  // ∫ (1 − x) e^(8x) from 0 to 1.
  CHECK(tiles.total() == doctest::Approx((std::exp(8.0) - 9.0) / 64.0).epsilon(1e-3));
}

TEST_CASE("adaptive tiles: an empty domain brings nothing, and is done") {
  Field integrand = field([](const Vec3&) { return 1.0; }, 1.0);
  AdaptiveTiles<Field> tiles(to(0.01), integrand);
  tiles.refine();
  CHECK(tiles.total() == 0.0);
  CHECK(tiles.error() == 0.0);
  CHECK(tiles.evaluated() == 0);
  CHECK(tiles.tiles().empty());
  tiles.for_each_point([](const Tile&, const Vec3&, double, double) { FAIL("no tile, no point"); });
}

TEST_CASE("adaptive tiles: the estimate covers integrands that change along one direction more than along the other") {
  // A cut along the direction in which nothing changes shows no difference, and yet the halves err.
  const auto check = [](Field integrand, double tolerance, double exact) {
    CAPTURE(tolerance);
    AdaptiveTiles<Field> tiles(to(tolerance), integrand);
    add_square(tiles, 1.0);
    tiles.refine();
    CHECK(std::abs(tiles.total() - exact) <= tolerance * exact);
    CHECK(std::abs(tiles.total() - exact) <= tiles.error() + rounding * exact);
  };
  for (const double tolerance : {0.1, 0.03, 0.01, 1e-3, 1e-6}) {
    check(field([](const Vec3& p) { return std::exp(p.x + 2.0 * p.y); }, std::exp(3.0)), tolerance,
          2.0 * std::sinh(1.0) * std::sinh(2.0));
    check(field([](const Vec3& p) { return std::pow(p.x, 4); }, 1.0), tolerance, 0.8);
    check(field([](const Vec3& p) { return std::pow(p.x, 8); }, 1.0), tolerance, 4.0 / 9.0);
    Field steep = field([](const Vec3& p) { return 1.0 / (1.05 - p.x); }, 20.0);
    steep.finest_m = [](const Tile& tile) {
      const auto& [a, b, c] = tile.corners_m;
      return 1.05 - std::max({a.x, b.x, c.x});
    };
    check(steep, tolerance, 2.0 * std::log(2.05 / 0.05));
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
