/// Where the shortest way over straight edges meets them: against unfolding and minimisers in extended precision that
/// share nothing with the method under test.
#include "dcem/paths/solve/wedge_method.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_wedge_method {

using namespace dcem;
using namespace dcem::test;

namespace {

using Real = long double;
using Point = std::array<Real, 3>;

Point point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

Real distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Real product(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// An edge in extended precision; `along` is normalized again.
struct Line {
  Point start, along;

  explicit Line(const EdgeLine& line) : start(point(line.start_m)), along(point(line.direction)) {
    const Real length = std::sqrt(product(along, along));
    for (Real& part : along) part /= length;
  }
  Point at(Real place) const {
    return {start[0] + place * along[0], start[1] + place * along[1], start[2] + place * along[2]};
  }
};

/// One edge by unfolding: both ends are turned about the line into one plane, on opposite sides of it.
Real unfolded_place(const Vec3& from_m, const EdgeLine& edge, const Vec3& to_m) {
  const Line line(edge);
  const auto along = [&](const Vec3& p) { return product(minus(point(p), line.start), line.along); };
  const auto across = [&](const Vec3& p) { return distance(point(p), line.at(along(p))); };
  // A straight line in the plane (across, along) from (−a, z1) to (b, z2) passes 0 at this height.
  const Real a = across(from_m), b = across(to_m);
  return (along(from_m) * b + along(to_m) * a) / (a + b);
}

Real length_of(const Vec3& from_m, const std::vector<EdgeLine>& edges, const Vec3& to_m,
               const std::vector<Real>& places) {
  Real length = 0;
  Point before = point(from_m);
  for (std::size_t index = 0; index < edges.size(); ++index) {
    const Point here = Line(edges[index]).at(places[index]);
    length += distance(before, here);
    before = here;
  }
  return length + distance(before, point(to_m));
}

/// The least length by golden sections, one place after the other, until no place moves any more.
std::vector<Real> golden_places(const Vec3& from_m, const std::vector<EdgeLine>& edges, const Vec3& to_m) {
  std::vector<Real> places(edges.size(), 0);
  const Real golden = (std::sqrt(Real(5)) - 1) / 2;
  for (int sweep = 0; sweep < 400; ++sweep) {
    Real moved = 0;
    for (std::size_t index = 0; index < edges.size(); ++index) {
      const Real old = places[index];
      const auto length_at = [&](Real place) {
        places[index] = place;
        return length_of(from_m, edges, to_m, places);
      };
      Real low = -4000, high = 4000;
      Real one = high - golden * (high - low), other = low + golden * (high - low);
      Real at_one = length_at(one), at_other = length_at(other);
      while (high - low > 1e-7L) {
        if (at_one < at_other) {
          high = other, other = one, at_other = at_one;
          one = high - golden * (high - low), at_one = length_at(one);
        } else {
          low = one, one = other, at_one = at_other;
          other = low + golden * (high - low), at_other = length_at(other);
        }
      }
      places[index] = (low + high) / 2;
      moved = std::max(moved, std::abs(places[index] - old));
    }
    if (moved < 1e-6L) break;
  }
  return places;
}

/// The difference of the cosines to the edge before and after the place: zero by Keller's law.
double keller_defect(const Vec3& before_m, const EdgeLine& edge, double place_m, const Vec3& after_m) {
  const Line line(edge);
  const Point here = line.at(place_m);
  const Point in = minus(here, point(before_m)), out = minus(point(after_m), here);
  const Real cosine_in = product(in, line.along) / std::sqrt(product(in, in));
  const Real cosine_out = product(out, line.along) / std::sqrt(product(out, out));
  return static_cast<double>(std::abs(cosine_in - cosine_out));
}

double largest_keller_defect(const Vec3& from_m, const std::vector<EdgeLine>& edges, const Vec3& to_m,
                             const EdgePlaces& places_m) {
  double largest = 0.0;
  for (std::size_t index = 0; index < edges.size(); ++index) {
    const Vec3 before_m = index == 0 ? from_m : edges[index - 1].at(places_m[index - 1]);
    const Vec3 after_m = index + 1 == edges.size() ? to_m : edges[index + 1].at(places_m[index + 1]);
    largest = std::max(largest, keller_defect(before_m, edges[index], places_m[index], after_m));
  }
  return largest;
}

double shortest_leg_m(const Vec3& from_m, const std::vector<EdgeLine>& edges, const Vec3& to_m,
                      const EdgePlaces& places_m) {
  double shortest_m = std::numeric_limits<double>::infinity();
  Vec3 before_m = from_m;
  for (std::size_t index = 0; index < edges.size(); ++index) {
    const Vec3 here_m = edges[index].at(places_m[index]);
    shortest_m = std::min(shortest_m, glm::distance(before_m, here_m));
    before_m = here_m;
  }
  return std::min(shortest_m, glm::distance(before_m, to_m));
}

EdgeLine edge_between(const Vec3& start_m, const Vec3& end_m) {
  return {start_m, glm::normalize(end_m - start_m), glm::distance(start_m, end_m)};
}

/// A line of any direction near a point, so long that places are hardly ever beyond its ends.
EdgeLine long_edge(Draw& draw, const Vec3& near_m, double reach_m) {
  const Vec3 middle_m = near_m + reach_m * draw.direction();
  const Vec3 direction = draw.direction();
  return {middle_m - 1500.0 * direction, direction, 3000.0};
}

}  // namespace

TEST_CASE("one edge: the place is where the unfolded path is straight") {
  Draw draw(11);
  for (int round = 0; round < 4000; ++round) {
    const double size_m = draw.magnitude(0.01, 1000.0);
    const Vec3 from_m = size_m * draw.inside(Vec3(-1), Vec3(1)), to_m = size_m * draw.inside(Vec3(-1), Vec3(1));
    const std::vector<EdgeLine> edges{long_edge(draw, Vec3(0.0), size_m)};
    EdgePlaces places_m{};
    REQUIRE(diffraction_places(from_m, edges, to_m, places_m));
    const Real expected = unfolded_place(from_m, edges[0], to_m);
    // Places are counted from 1500 m away: 2e-13 m of rounding, and a few more in the projections.
    CHECK(std::abs(static_cast<double>(places_m[0] - expected)) < 2e-12);
    CHECK(largest_keller_defect(from_m, edges, to_m, places_m) < 1e-9 + 1e-12 / (0.001 * size_m));
  }
}

TEST_CASE("one edge: no place is shorter, found by golden sections of the length") {
  Draw draw(12);
  for (int round = 0; round < 200; ++round) {
    const Vec3 from_m = draw.inside(Vec3(-50), Vec3(50)), to_m = draw.inside(Vec3(-50), Vec3(50));
    const std::vector<EdgeLine> edges{long_edge(draw, Vec3(0.0), 30.0)};
    EdgePlaces places_m{};
    REQUIRE(diffraction_places(from_m, edges, to_m, places_m));
    const std::vector<Real> least = golden_places(from_m, edges, to_m);
    // Golden sections stop where the length no longer changes: √(1e-19) of a hundred metres.
    CHECK(std::abs(static_cast<double>(places_m[0] - least[0])) < 2e-6);
    CHECK(length_of(from_m, edges, to_m, {places_m[0]}) <= length_of(from_m, edges, to_m, least) + 1e-14L);
  }
}

TEST_CASE("two and three skew edges: Keller's law at every place, and the least length of all") {
  Draw draw(13);
  std::size_t compared = 0, close = 0;
  for (const std::size_t count : {2U, 3U}) {
    for (int round = 0; round < 1500; ++round) {
      CAPTURE(count);
      CAPTURE(round);
      const double size_m = draw.magnitude(1.0, 1000.0);
      const Vec3 from_m = size_m * draw.inside(Vec3(-1), Vec3(1)), to_m = size_m * draw.inside(Vec3(-1), Vec3(1));
      std::vector<EdgeLine> edges;
      for (std::size_t index = 0; index < count; ++index) {
        const Vec3 middle_m = 0.7 * size_m * draw.direction(), direction = draw.direction();
        edges.push_back({middle_m - 8.0 * size_m * direction, direction, 16.0 * size_m});
      }
      EdgePlaces places_m{};
      const bool there = diffraction_places(from_m, edges, to_m, places_m);
      CHECK(there);
      if (!there) continue;
      CHECK(largest_keller_defect(from_m, edges, to_m, places_m) < 1e-9);
      std::vector<Real> places(places_m.begin(), places_m.begin() + static_cast<std::ptrdiff_t>(count));
      const Real least = length_of(from_m, edges, to_m, places);
      for (int push = 0; push < 12; ++push) {
        std::vector<Real> pushed = places;
        for (Real& place : pushed) place += size_m * draw.magnitude(1e-4, 1.0) * draw.between(-1, 1);
        CHECK(length_of(from_m, edges, to_m, pushed) > least);
      }
      if (round % 30 != 0) continue;
      const std::vector<Real> golden = golden_places(from_m, edges, to_m);
      // The other minimiser creeps where edges are nearly parallel; never may it find less.
      CHECK(least <= length_of(from_m, edges, to_m, golden) + 1e-13L);
      close += static_cast<double>(length_of(from_m, edges, to_m, golden) - least) < 1e-6 * size_m;
      ++compared;
    }
  }
  CHECK(compared > 90);
  CHECK(close > 80);
}

TEST_CASE("two and three edges far from the origin, as in a scene in map coordinates, keep their places") {
  // Both ends of a leg are rounded to half a unit in the last place of their coordinates, 2^-53 of them, in three axes;
  // a direction, and so the law, is known to that over the leg.
  Draw draw(17);
  for (const double offset_m : {1e3, 1e4, 1e6}) {
    const Vec3 offset = offset_m * Vec3(0.6, 5.4, 0.0);
    for (int round = 0; round < 1000; ++round) {
      CAPTURE(offset_m);
      CAPTURE(round);
      const Vec3 from_m = offset + draw.inside(Vec3(-30, -30, 0), Vec3(-10, 30, 30));
      const Vec3 to_m = offset + draw.inside(Vec3(10, -30, 0), Vec3(30, 30, 30));
      std::vector<EdgeLine> edges;
      for (std::size_t index = 0; index < 2 + draw.below(2); ++index) {
        const Vec3 middle_m = offset + draw.inside(Vec3(-9), Vec3(9)), direction = draw.direction();
        edges.push_back({middle_m - 300.0 * direction, direction, 600.0});
      }
      EdgePlaces places_m{};
      const bool there = diffraction_places(from_m, edges, to_m, places_m);
      CHECK(there);
      if (!there) continue;
      const double rounding_m = 2.0 * std::sqrt(3.0) * 0x1p-53 * glm::length(offset);
      // Twice, for the legs on both sides of an edge.
      const double bound = 1e-9 + 2.0 * rounding_m / shortest_leg_m(from_m, edges, to_m, places_m);
      CHECK(largest_keller_defect(from_m, edges, to_m, places_m) < bound);
    }
  }
}

TEST_CASE("parallel edges: all legs have one slope along them") {
  Draw draw(14);
  for (int round = 0; round < 500; ++round) {
    const Vec3 direction = draw.direction();
    const Vec3 from_m = draw.inside(Vec3(-30), Vec3(30)), to_m = draw.inside(Vec3(-30), Vec3(30));
    std::vector<EdgeLine> edges;
    for (std::size_t index = 0; index < 3; ++index) {
      edges.push_back({draw.inside(Vec3(-30), Vec3(30)) - 500.0 * direction, direction, 1000.0});
    }
    EdgePlaces places_m{};
    REQUIRE(diffraction_places(from_m, edges, to_m, places_m));
    // Unfolded, the way is straight: heights are shared out by the distances across the edges.
    const auto across = [&](const Vec3& a, const Vec3& b) {
      const Vec3 offset = b - a;
      return glm::length(offset - glm::dot(offset, direction) * direction);
    };
    const std::array<Vec3, 5> points_m{from_m, edges[0].at(places_m[0]), edges[1].at(places_m[1]),
                                       edges[2].at(places_m[2]), to_m};
    double whole_m = 0.0, so_far_m = 0.0;
    for (std::size_t leg = 0; leg < 4; ++leg) whole_m += across(points_m[leg], points_m[leg + 1]);
    for (std::size_t leg = 0; leg < 4; ++leg) {
      const double height_m = glm::dot(points_m[leg] - from_m, direction);
      CHECK(height_m ==
            doctest::Approx(glm::dot(to_m - from_m, direction) * so_far_m / whole_m).epsilon(1e-9).scale(10.0));
      so_far_m += across(points_m[leg], points_m[leg + 1]);
    }
  }
}

TEST_CASE("a place at or beyond the end of an edge is none") {
  const Vec3 from_m(3, 0, 1), to_m(-3, 0, 1);  // the place is at height 1
  const auto on = [&](double low_m, double high_m) {
    const std::vector<EdgeLine> edges{edge_between(Vec3(0, 1, low_m), Vec3(0, 1, high_m))};
    EdgePlaces places_m{};
    return diffraction_places(from_m, edges, to_m, places_m);
  };
  CHECK(on(0, 2));
  CHECK(on(2, 0));
  CHECK(on(0.999, 1.001));
  CHECK_FALSE(on(1, 2));
  CHECK_FALSE(on(0, 1));
  CHECK_FALSE(on(1.001, 2));
  CHECK_FALSE(on(-1, 0.999));
}

TEST_CASE("within the guard of either end of an edge there is no place, beyond it there is one") {
  const std::vector<EdgeLine> lines{{Vec3(0), Vec3(0, 0, 1), 1.0}};
  for (const bool at_end : {false, true}) {
    const auto has_place = [&](double from_end_m) {
      const double height_m = at_end ? 1.0 - from_end_m : from_end_m;
      EdgePlaces places_m{};
      return diffraction_places(Vec3(-2, 0, height_m), lines, Vec3(1, 1, height_m), places_m);
    };
    CHECK_FALSE(has_place(0.5 * in_plane_guard_m));  // the rounding of the height is a millionth of the guard
    CHECK(has_place(2.0 * in_plane_guard_m));
  }
}

TEST_CASE("nothing to diffract gives no places and no NaN") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const EdgeLine upright = edge_between(Vec3(0, 0, -10), Vec3(0, 0, 10));
  const EdgeLine point_edge{Vec3(1, 1, 0), Vec3(0, 0, 1), 0.0};
  const EdgeLine no_direction{Vec3(1, 1, 0), Vec3(0.0), 5.0};
  const EdgeLine broken{Vec3(1, 1, 0), Vec3(none), 5.0};
  struct Case {
    Vec3 from_m, to_m;
    std::vector<EdgeLine> edges;
  };
  const std::vector<Case> cases{
      {Vec3(0, 0, 3), Vec3(4, 1, 0), {upright}},     // an end on the edge
      {Vec3(0, 0, 30), Vec3(4, 1, 0), {upright}},    // an end on its line
      {Vec3(4, 1, 0), Vec3(0, 0, -30), {upright}},   // the other
      {Vec3(0, 0, 30), Vec3(0, 0, -30), {upright}},  // both
      {Vec3(0, 0, 3), Vec3(0, 0, 3), {upright}},     // both in one point on it
      {Vec3(4, 0, 0), Vec3(4, 3, 0), {point_edge}},  // an edge without length
      {Vec3(4, 0, 0), Vec3(-4, 3, 0), {no_direction, upright}},
      {Vec3(4, 0, 0), Vec3(-4, 3, 0), {broken}},
      {Vec3(4, 0, 0), Vec3(-4, 3, 0), {upright, broken}},
      {Vec3(4, 0, none), Vec3(-4, 3, 0), {upright}},
      {Vec3(4, 0, 0), Vec3(-4, 3, none), {upright, point_edge}},
      {Vec3(4, 0, 0), Vec3(-4, 3, 0), {upright, upright}},                                       // one edge twice
      {Vec3(4, 0, 0), Vec3(-4, 3, 0), {upright, edge_between(Vec3(0, 0, 12), Vec3(0, 0, 30))}},  // one line
      // Two edges that cross at the origin, where the shortest way meets both.
      {Vec3(4, 0, 0), Vec3(-4, 0, 0), {upright, edge_between(Vec3(0, -9, 0), Vec3(0, 13, 0))}},
      {Vec3(4, 0, 0), Vec3(-4, 0, 0), {upright, edge_between(Vec3(0, -9, 0), Vec3(0, 13, 0)), upright}},
  };
  for (std::size_t index = 0; index < cases.size(); ++index) {
    CAPTURE(index);
    EdgePlaces places_m{};
    CHECK_FALSE(diffraction_places(cases[index].from_m, cases[index].edges, cases[index].to_m, places_m));
  }
}

TEST_CASE("edges that meet in a corner: every result is a law of diffraction, either way round") {
  Draw draw(15);
  std::size_t found = 0;
  for (int round = 0; round < 4000; ++round) {
    CAPTURE(round);
    const Vec3 corner_m = draw.inside(Vec3(-5), Vec3(5));
    std::vector<EdgeLine> edges;
    for (std::size_t index = 0; index < 2 + draw.below(2); ++index) {
      const Vec3 far_m = corner_m + draw.between(1, 30) * draw.direction();
      edges.push_back(draw.below(2) == 0 ? edge_between(corner_m, far_m) : edge_between(far_m, corner_m));
    }
    const Vec3 from_m = draw.inside(Vec3(-20), Vec3(20)), to_m = draw.inside(Vec3(-20), Vec3(20));
    EdgePlaces places_m{}, back_m{};
    const bool there = diffraction_places(from_m, edges, to_m, places_m);
    std::vector<EdgeLine> reversed(edges.rbegin(), edges.rend());
    CHECK(diffraction_places(to_m, reversed, from_m, back_m) == there);
    if (!there) continue;
    ++found;
    CHECK(largest_keller_defect(from_m, edges, to_m, places_m) < 1e-9);
    for (std::size_t index = 0; index < edges.size(); ++index) {
      CHECK(std::abs(places_m[index] - back_m[edges.size() - 1 - index]) < 1e-8);
    }
  }
  CHECK(found > 100);
}

TEST_CASE("an edge whose middle lies on the line of its neighbour has its place all the same") {
  // The front roof edge of a low house, and the upright corner of a tower twice as high flush with it: the line of the
  // first runs through the middle of the second.
  const EdgeLine roof = edge_between(Vec3(10, 0, 10), Vec3(30, 0, 10));
  const EdgeLine corner = edge_between(Vec3(10, 0, 0), Vec3(10, 0, 20));
  Draw draw(16);
  std::size_t expected = 0;
  for (int round = 0; round < 400; ++round) {
    CAPTURE(round);
    const Vec3 from_m = draw.inside(Vec3(15, -20, 0), Vec3(45, -1, 10)),
               to_m = draw.inside(Vec3(-10, 1, 12), Vec3(9, 20, 40));
    const std::vector<EdgeLine> edges{roof, corner}, reversed{corner, roof};
    const std::vector<Real> least = golden_places(from_m, edges, to_m);
    // The other minimiser may creep to a halt on its way into the corner where both edges meet; then that is the least.
    const Real over_corner = length_of(from_m, edges, to_m, std::vector<Real>{0.0L, 10.0L});
    if (length_of(from_m, edges, to_m, least) > over_corner) continue;
    const bool inside = least[0] > 0.01L && least[0] < 19.99L && least[1] > 0.01L && least[1] < 19.99L &&
                        std::abs(least[1] - 10) > 0.01L;
    if (!inside) continue;
    ++expected;
    EdgePlaces places_m{};
    CHECK(diffraction_places(to_m, reversed, from_m, places_m));
    CHECK(diffraction_places(from_m, edges, to_m, places_m));
  }
  CHECK(expected > 20);
}

}  // namespace test_wedge_method
