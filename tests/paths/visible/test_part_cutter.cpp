/// Cutting convex polygons along planes: what is cut off and what is left, by area and by points.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tests/paths/visible/visible_trial.hpp"
#include "tests/support/all_tests.hpp"

namespace test_part_cutter {

using namespace dcem;
using namespace dcem::test;

namespace {

using Polygon = std::vector<Vec3>;

constexpr double least_width_m = 1e-4;

/// A rectangle in the plane z = 0, moved and turned into space.
struct Sheet {
  Mat3 turn{1.0};
  Vec3 at_m{0.0};
  Vec3 place(double x_m, double y_m) const { return at_m + turn * Vec3(x_m, y_m, 0); }
  Polygon rectangle(double low_x_m, double low_y_m, double high_x_m, double high_y_m) const {
    return {place(low_x_m, low_y_m), place(high_x_m, low_y_m), place(high_x_m, high_y_m), place(low_x_m, high_y_m)};
  }
  /// What is to the left of the way from one place to another, as a plane that need not be upright on the sheet.
  HullSide left_of(double from_x_m, double from_y_m, double to_x_m, double to_y_m, double lean = 0.0) const {
    const Vec3 normal = glm::normalize(turn * Vec3(from_y_m - to_y_m, to_x_m - from_x_m, 0.0));
    const Vec3 leaning = std::cos(lean) * normal + std::sin(lean) * (turn * Vec3(0, 0, 1));
    return {leaning, glm::dot(leaning, place(from_x_m, from_y_m))};
  }
  /// The sides of a convex polygon, given counter-clockwise.
  std::vector<HullSide> sides(const std::vector<std::pair<double, double>>& corners, double lean = 0.0) const {
    std::vector<HullSide> all;
    for (std::size_t index = 0; index < corners.size(); ++index) {
      const auto& [x, y] = corners[index];
      const auto& [next_x, next_y] = corners[(index + 1) % corners.size()];
      all.push_back(left_of(x, y, next_x, next_y, lean));
    }
    return all;
  }
};

struct Cut {
  PartList outside, inside;
};

Cut cut(const Polygon& polygon, std::span<const HullSide> sides) {
  PartCutter cutter(least_width_m);
  Cut made;
  made.outside.add(polygon, {3, 4});
  cutter.cut(made.outside, sides, [&](std::size_t part, std::span<const Vec3> left, PartList&) {
    CHECK(part == 0);
    made.inside.add(left, {});
  });
  return made;
}

double area_of_m2(const Polygon& polygon) {
  return 0.5 * twice_area_m2(polygon);
}

std::vector<std::pair<double, double>> draw_convex(Draw& draw, double middle_x_m, double middle_y_m, double size_m) {
  const std::size_t count = 3 + draw.below(5);
  std::vector<double> turns_rad;
  for (std::size_t index = 0; index < count; ++index) {
    turns_rad.push_back(2.0 * pi * (double(index) + draw.between(0.1, 0.9)) / double(count));
  }
  std::vector<std::pair<double, double>> corners;  // on an ellipse
  const double flat = draw.magnitude(0.02, 1.0);
  for (const double turn_rad : turns_rad) {
    corners.emplace_back(middle_x_m + size_m * std::cos(turn_rad), middle_y_m + flat * size_m * std::sin(turn_rad));
  }
  return corners;
}

double length_m(std::span<const Vec3> polygon) {
  double longest_m = 0.0;
  for (const Vec3& one : polygon) {
    for (const Vec3& other : polygon) longest_m = std::max(longest_m, glm::distance(one, other));
  }
  return longest_m;
}

double width_m(std::span<const Vec3> polygon) {
  return 0.5 * twice_area_m2(polygon) / length_m(polygon);
}

}  // namespace

TEST_CASE("part cutter: what is inside and what is outside make up the whole, point by point") {
  std::size_t cuts = 0, many = 0, inside_points = 0, outside_points = 0;
  for (std::uint64_t seed = 1; seed <= all_or(5000U, 500U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    const Sheet sheet{rotation_matrix({Vec3(0.0), draw.between(-pi, pi), draw.between(-1, 1), draw.between(-pi, pi)}),
                      draw.inside(Vec3(-500), Vec3(500))};
    Polygon whole;
    for (const auto& [x, y] : draw_convex(draw, 0, 0, draw.magnitude(0.1, 20.0))) whole.push_back(sheet.place(x, y));
    const double lean = draw.between(-0.8, 0.8), size_m = draw.magnitude(0.01, 20.0);
    const std::vector<HullSide> sides =
        sheet.sides(draw_convex(draw, draw.between(-3, 3), draw.between(-3, 3), size_m), lean);
    const Cut made = cut(whole, sides);
    const double whole_m2 = area_of_m2(whole);
    // A sliver that is left out may be as wide as the least width, and is no longer than the whole; there is one for
    // each side.
    const double missing_m2 = whole_m2 - test::area_of_m2(made.outside) - test::area_of_m2(made.inside);
    CHECK(missing_m2 > -1e-9 * (1.0 + whole_m2));
    CHECK(missing_m2 < 1e-9 * whole_m2 + length_m(whole) * least_width_m * double(sides.size()));
    cuts += !made.inside.empty();
    many += made.outside.size() > 2;
    for (const PartList* parts : {&made.outside, &made.inside}) {
      for (std::size_t part = 0; part < parts->size(); ++part) {
        if (parts == &made.outside) CHECK(parts->crossed(part) == PartList::CrossedLists{3, 4});
        if (made.inside.empty() && parts->size() == 1) continue;  // the whole, however narrow
        CHECK(width_m(parts->corners_m(part)) > 0.9 * least_width_m);
      }
    }
    for (int index = 0; index < 40; ++index) {
      const Vec3 point_m = point_of({whole[0], whole[1], whole[2]}, draw);
      double margin_m = std::abs(inside_m(whole, point_m)), deepest_m = 1e9;
      for (const HullSide& side : sides) {
        deepest_m = std::min(deepest_m, glm::dot(side.normal, point_m) - side.offset_m);
        margin_m = std::min(margin_m, std::abs(glm::dot(side.normal, point_m) - side.offset_m));
      }
      if (margin_m < 1e-2) continue;  // slivers
      std::size_t found_outside = 0, found_inside = 0;
      for (std::size_t part = 0; part < made.outside.size(); ++part) {
        const double depth_m = inside_m(made.outside.corners_m(part), point_m);
        margin_m = std::min(margin_m, std::abs(depth_m));
        found_outside += depth_m > 0.0;
      }
      for (std::size_t part = 0; part < made.inside.size(); ++part) {
        found_inside += inside_m(made.inside.corners_m(part), point_m) > 0.0;
      }
      if (margin_m < 1e-2) continue;
      CHECK(found_inside == (deepest_m > 0.0 ? 1U : 0U));
      CHECK(found_outside == (deepest_m > 0.0 ? 0U : 1U));
      ++(deepest_m > 0.0 ? inside_points : outside_points);
    }
  }
  MESSAGE(cuts << " cuts, " << many << " into three pieces and more, " << inside_points << " points inside, "
               << outside_points << " outside");
  CHECK(cuts > 100);
  CHECK(many > 50);
  CHECK(inside_points > 400);
  CHECK(outside_points > 3'000);
}

TEST_CASE("part cutter: a side that only touches, from either side, cuts nothing") {
  const Sheet sheet;
  const Polygon square = sheet.rectangle(0, 0, 2, 2);
  for (const double off_m : {0.0, 1e-9, -1e-9, 9e-8, -9e-8}) {
    CAPTURE(off_m);
    // Left of the square, then all of it but for the touch.
    const Cut beside = cut(square, sheet.sides({{-3, -1}, {off_m, -1}, {off_m, 3}, {-3, 3}}));
    CHECK(beside.inside.empty());
    REQUIRE(beside.outside.size() == 1);
    CHECK(std::ranges::equal(beside.outside.corners_m(0), square));
    const Cut all = cut(square, sheet.sides({{off_m, -1}, {3, -1}, {3, 3}, {off_m, 3}}));
    CHECK(all.outside.empty());
    REQUIRE(all.inside.size() == 1);
    CHECK(std::ranges::equal(all.inside.corners_m(0), square));
  }
  // A corner of the sides in the middle of an edge of the square.
  const Cut corner = cut(square, sheet.sides({{-1, 0}, {0, 1}, {-1, 2}}));
  CHECK(corner.inside.empty());
  CHECK(std::ranges::equal(corner.outside.corners_m(0), square));
}

TEST_CASE("part cutter: corners on a side belong to both pieces") {
  const Sheet sheet;
  const Polygon square = sheet.rectangle(0, 0, 2, 2);
  for (const double off_m : {0.0, 5e-8, -5e-8}) {
    CAPTURE(off_m);
    const std::vector<HullSide> diagonal{sheet.left_of(0, off_m, 2, 2 + off_m), sheet.left_of(-1, -1, 3, -1),
                                         sheet.left_of(-1, 3, -1, -1)};
    const Cut made = cut(square, diagonal);
    REQUIRE(made.inside.size() == 1);
    REQUIRE(made.outside.size() == 1);
    CHECK(std::ranges::equal(made.outside.corners_m(0), Polygon{square[0], square[1], square[2]}));
    CHECK(std::ranges::equal(made.inside.corners_m(0), Polygon{square[0], square[2], square[3]}));
  }
}

TEST_CASE("part cutter: nothing comes out that is narrower than the least width") {
  const Sheet sheet;
  const Polygon square = sheet.rectangle(0, 0, 2, 2);
  for (const double width : {0.1, 0.5, 0.9, 1.1, 2.0}) {
    CAPTURE(width);
    const double strip_m = width * least_width_m;
    // A strip across the square that is so wide: it is taken out where it is a piece, else all stays.
    const Cut strip = cut(square, sheet.sides({{-1, 1}, {3, 1}, {3, 1 + strip_m}, {-1, 1 + strip_m}}));
    CHECK(strip.inside.size() == (width > 1.0 ? 1U : 0U));
    CHECK(strip.outside.size() == (width > 1.0 ? 2U : 1U));
    CHECK(test::area_of_m2(strip.outside) == doctest::Approx(width > 1.0 ? 4.0 - 2.0 * strip_m : 4.0).epsilon(1e-12));
    // A strip that is left at the rim is left out.
    const Cut rim = cut(square, sheet.sides({{strip_m, -1}, {3, -1}, {3, 3}, {strip_m, 3}}));
    CHECK(rim.outside.size() == (width > 1.0 ? 1U : 0U));
    REQUIRE(rim.inside.size() == 1);
    CHECK(test::area_of_m2(rim.inside) == doctest::Approx(4.0 - 2.0 * strip_m).epsilon(1e-12));
    // Of a triangle that is left at the rim the half of its height counts.
    const Cut corner = cut(square, sheet.sides({{-3, -3 * strip_m}, {3, 3 * strip_m}, {3, 9}, {-3, 9}}));
    CHECK(corner.inside.size() == 1);
    CHECK(corner.outside.size() == (width > 1.0 ? 1U : 0U));
  }
}

TEST_CASE("part cutter: each part of a list is cut by itself, and what is inside may go on") {
  const Sheet sheet;
  PartList parts;
  parts.add(sheet.rectangle(0, 0, 1, 1), {1, 0});
  parts.add(sheet.rectangle(1, 0, 2, 1), {2, 0});
  parts.add(sheet.rectangle(5, 0, 6, 1), {3, 0});
  PartCutter cutter(least_width_m);
  std::vector<std::size_t> asked;
  cutter.cut(parts, sheet.sides({{0.5, -1}, {1.5, -1}, {1.5, 2}, {0.5, 2}}),
             [&](std::size_t part, std::span<const Vec3> left, PartList& next) {
               asked.push_back(part);
               next.add(left, {parts.crossed(part)[0], 9});
             });
  CHECK(asked == std::vector<std::size_t>{0, 1});
  REQUIRE(parts.size() == 5);
  const std::array<PartList::CrossedLists, 5> crossed{{{1, 0}, {1, 9}, {2, 0}, {2, 9}, {3, 0}}};
  for (std::size_t part = 0; part < 5; ++part) {
    CHECK(parts.crossed(part) == crossed[part]);
    CHECK(0.5 * twice_area_m2(parts.corners_m(part)) == doctest::Approx(part == 4 ? 1.0 : 0.5).epsilon(1e-12));
  }
}

}  // namespace test_part_cutter
