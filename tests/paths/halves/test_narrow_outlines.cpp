/// Outlines narrower than points are apart hide nothing from all of them: what says so early says it of none of which
/// something would be left, and of most others.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/extreme_points.hpp"
#include "dcem/paths/halves/inset.hpp"
#include "dcem/paths/halves/joined_outlines.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_narrow_outlines {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Offsets from the first of some points side by side, some of them at one height.
std::vector<Vec3> some_offsets(Draw& draw, double size_m) {
  const double high_m = draw.below(3) == 0 ? size_m : 0.0;
  std::vector<Vec3> points_m, extreme_m;
  for (std::size_t count = 1 + draw.below(8); count > 0; --count) {
    points_m.push_back(draw.inside(Vec3(-size_m, -size_m, -high_m), Vec3(size_m, size_m, high_m)));
  }
  take_extreme_points(points_m, extreme_m);
  return extreme_m;
}

/// A convex polygon around a point: corners on an ellipse, in order.
std::vector<Vec3> some_outline(Draw& draw, const Plane& plane, double size_m) {
  const Vec3 first =
      glm::normalize(glm::cross(plane.normal, std::abs(plane.normal.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 second = glm::cross(plane.normal, first);
  const double long_m = draw.magnitude(0.1, 1.0) * size_m, wide_m = draw.magnitude(0.1, 1.0) * size_m;
  const std::size_t corners = 3 + draw.below(5);
  std::vector<Vec3> outline_m;
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const double turn =
        2.0 * pi * (static_cast<double>(corner) + draw.between(0.1, 0.9)) / static_cast<double>(corners);
    outline_m.push_back(plane.point_m + long_m * std::cos(turn) * first + wide_m * std::sin(turn) * second);
  }
  return outline_m;
}

bool leaves_something(std::span<const Vec3> corners_m, const Plane& plane, const Vec3& from_m,
                      std::span<const Vec3> offsets_m) {
  dcem::detail::MovedSides sides;
  dcem::detail::InsetOutline inside;
  return sides_moved_in(corners_m, plane, from_m, offsets_m, sides) &&
         inset_outline(corners_m, from_m, sides.all(), inside);
}

/// What was said early of outlines that hide nothing, and of those that hide something.
struct Tally {
  std::size_t said = 0, empty = 0, left = 0, lost = 0;

  void add(bool says_nothing_is_left, bool leaves) {
    said += says_nothing_is_left ? 1U : 0U;
    (leaves ? left : empty) += 1U;
    lost += leaves && says_nothing_is_left ? 1U : 0U;
  }
  void tell(const char* what) const {
    MESSAGE(said << what << " of " << empty << " that hide nothing, and " << left << " that hide something");
  }
};

/// Of two façades that meet on a vertical line: corners from the line on.
struct Corner {
  std::array<std::array<Vec3, 4>, 2> corners_m;
  std::array<Plane, 2> planes;

  JoinedOutline outline(std::size_t of) const { return {corners_m[of], planes[of], 3, 0.0}; }
};

Corner some_corner(Draw& draw, const Vec3& line_m) {
  Corner corner;
  const double turn = draw.between(-pi, pi), bend = draw.between(0.2, 1.9) * pi, high_m = draw.between(1, 20);
  for (const std::size_t of : {0U, 1U}) {
    const double towards = turn + (of == 0 ? 0.0 : bend);
    const Vec3 along = draw.magnitude(0.3, 30) * Vec3(std::cos(towards), std::sin(towards), 0), up(0, 0, high_m);
    // The last side, from the fourth corner to the first, is that on the line.
    corner.corners_m[of] = {line_m, line_m + along, line_m + along + up, line_m + up};
    corner.planes[of] = {line_m, glm::normalize(glm::cross(along, up))};
  }
  return corner;
}

}  // namespace

TEST_CASE("an outline called narrower than points are apart hides nothing from all of them") {
  Draw draw(7);
  Tally tally;
  for (int round = 0; round < 100'000; ++round) {
    const double size_m = draw.magnitude(0.1, 5.0);
    const std::vector<Vec3> offsets_m = some_offsets(draw, size_m);
    const Vec3 from_m = draw.inside(Vec3(-50, -50, 0), Vec3(50, 50, 20));
    const double turn = draw.between(-pi, pi);
    const Vec3 normal = draw.below(2) == 0   ? Vec3(std::cos(turn), std::sin(turn), 0)
                        : draw.below(3) == 0 ? Vec3(0, 0, 1)
                                             : draw.direction();
    const Plane plane{from_m + draw.magnitude(1, 100) * draw.direction(), normal};
    const std::vector<Vec3> corners_m = some_outline(draw, plane, 4.0 * size_m);
    const bool leaves = leaves_something(corners_m, plane, from_m, offsets_m);
    const bool is_narrow = dcem::detail::is_narrower(corners_m, plane, from_m, offsets_m);
    tally.add(is_narrow, leaves);
  }
  tally.tell(" narrow ones");
  CHECK(tally.lost == 0);
  CHECK(tally.left > 10'000);
  CHECK(tally.said > tally.empty / 3);  // or it would not be worth asking
}

TEST_CASE("façades whose far sides are said to close the slit between them leave nothing of it") {
  Draw draw(9);
  Tally tally;
  for (int round = 0; round < 100'000; ++round) {
    const std::vector<Vec3> offsets_m = some_offsets(draw, draw.magnitude(0.1, 5.0));
    const Vec3 from_m = draw.inside(Vec3(-50, -50, 0), Vec3(50, 50, 20));
    const Corner corner = some_corner(draw, draw.inside(Vec3(-50, -50, -5), Vec3(50, 50, 5)));
    const JoinedOutline one = corner.outline(0), other = corner.outline(1);
    const dcem::detail::PointsAround points(from_m, offsets_m);
    const double more = draw.magnitude(1e-3, 0.05);
    const auto slit = dcem::detail::SlitFrame::of(one, points, more);
    dcem::detail::InsetOutline both;
    if (!slit || !slit_around(one, other, points, *slit, more, both) || opens(one, other, points)) continue;
    const bool is_closed = is_closed_between(one, other, points, *slit);
    const bool leaves = keep_inside(one, other, points, both);
    tally.add(is_closed, leaves);
  }
  tally.tell(" closed ones");
  CHECK(tally.lost == 0);
  CHECK(tally.left > 1'000);
  CHECK(tally.said > tally.empty / 2);
}

}  // namespace test_narrow_outlines
