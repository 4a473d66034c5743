/// Walls of any heights that end at one vertical line, with the same x and y, let no ray through between them.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "dcem/accel/brute_force_index.hpp"
#include "dcem/accel/wide_index.hpp"
#include "dcem/geometry/triangle.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_vertical_joints {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A wall that ends at a vertical line, with corners on it and two away from it.
struct Wall {
  std::vector<double> heights_m;  ///< on the line, ascending
  Vec3 far_low_m, far_high_m;

  double low_m() const { return heights_m.front(); }
  double high_m() const { return heights_m.back(); }
  std::vector<TriangleCorners> triangles_m(double x_m, double y_m) const {
    std::vector<TriangleCorners> triangles{
        {Vec3(x_m, y_m, high_m()), Vec3(far_low_m), Vec3(far_high_m)},
    };
    for (std::size_t at = 1; at < heights_m.size(); ++at) {
      triangles.push_back({Vec3(x_m, y_m, heights_m[at - 1]), Vec3(x_m, y_m, heights_m[at]), Vec3(far_low_m)});
    }
    return triangles;
  }
};

/// Two walls on either side of the line as seen from an origin, which sees it along x, y, or anything between.
struct Joint {
  Vec3 origin_m;
  double x_m, y_m;
  std::array<Wall, 2> walls;

  double low_m() const { return std::max(walls[0].low_m(), walls[1].low_m()); }
  double high_m() const { return std::min(walls[0].high_m(), walls[1].high_m()); }
  std::vector<TriangleCorners> triangles_m() const {
    std::vector<TriangleCorners> all = walls[0].triangles_m(x_m, y_m);
    for (const TriangleCorners& corners_m : walls[1].triangles_m(x_m, y_m)) all.push_back(corners_m);
    return all;
  }
};

/// `side`: 1 where it stands left of the way to the line. Some walls are all but in line with the way, some are narrow.
Wall some_wall(Draw& draw, const Vec3& line_m, double away_rad, double side, bool is_cut_at_zero) {
  Wall wall;
  const double low_m = line_m.z - draw.between(0.5, 20.0), high_m = line_m.z + draw.between(0.5, 20.0);
  wall.heights_m = {low_m, high_m};
  for (std::size_t more = draw.below(4); more > 0; --more) wall.heights_m.push_back(draw.between(low_m, high_m));
  if (is_cut_at_zero) wall.heights_m.push_back(line_m.z);
  std::ranges::sort(wall.heights_m);
  const double beside_rad = draw.below(2) == 0 ? draw.between(0.02, pi - 0.02) : draw.magnitude(1e-3, 1.0);
  const double turn_rad = away_rad + side * (draw.below(2) == 0 ? beside_rad : pi - beside_rad);
  const double long_m = draw.magnitude(0.05, 100.0);
  const Vec3 foot_m = line_m + long_m * Vec3(std::cos(turn_rad), std::sin(turn_rad), 0.0);
  wall.far_low_m = foot_m + draw.inside(Vec3(0, 0, -20), Vec3(0, 0, 0));
  wall.far_high_m = foot_m + draw.inside(Vec3(0, 0, 0.1), Vec3(0, 0, 20));
  return wall;
}

Joint some_joint(Draw& draw) {
  const std::array<double, 6> offsets_m{0.0, 3.0, 1e4, 1e5, 3e5, 1e6};
  const double offset_m = offsets_m[draw.below(offsets_m.size())];
  const Vec3 line_m = draw.inside(Vec3(-1.0), Vec3(1.0)) * Vec3(offset_m + 10.0, offset_m + 10.0, 10.0);
  // Along an axis, or close to it, or anywhere: x and y change roles at 45°.
  const std::array<double, 4> turns_rad{draw.between(-pi, pi), 0.5 * pi * static_cast<double>(draw.below(4)),
                                        0.25 * pi * static_cast<double>(draw.below(8)), draw.between(-1e-9, 1e-9)};
  const double away_rad = turns_rad[draw.below(turns_rad.size())];
  const double away_m = draw.magnitude(0.3, 3e3);
  Joint joint;
  joint.x_m = line_m.x;
  joint.y_m = line_m.y;
  joint.origin_m = line_m - away_m * Vec3(std::cos(away_rad), std::sin(away_rad), 0.0);
  const bool is_cut_at_zero = draw.below(4) == 0;
  joint.walls = {some_wall(draw, line_m, away_rad, 1.0, is_cut_at_zero),
                 some_wall(draw, line_m, away_rad, -1.0, draw.below(4) == 0)};
  return joint;
}

/// So many of the smallest steps away.
double moved(double value, int steps) {
  const double towards = std::copysign(std::numeric_limits<double>::infinity(), static_cast<double>(steps));
  for (int step = 0; step < std::abs(steps); ++step) value = std::nextafter(value, towards);
  return value;
}

/// A ray through the line, or past it by a few units in the last place, where both walls stand. `slope`: how much it
/// rises per length along x or y, whichever is larger. Half of the rays start there, beyond the walls' height perhaps.
Ray<double> some_ray(Draw& draw, const Joint& joint, double slope) {
  const auto step = [&] { return draw.below(2) == 0 ? 0 : static_cast<int>(draw.below(9)) - 4; };
  const double above_m = 0.05 * (joint.high_m() - joint.low_m());
  const Vec3 aim_m(moved(joint.x_m, step()), moved(joint.y_m, step()),
                   draw.between(joint.low_m() + above_m, joint.high_m() - above_m));
  Vec3 from_m = joint.origin_m;
  from_m.z = aim_m.z - slope * std::max(std::abs(aim_m.x - from_m.x), std::abs(aim_m.y - from_m.y));
  const double scale = draw.below(2) == 0 ? 1.0 : draw.magnitude(1e-3, 1e3);
  return {from_m, scale * (aim_m - from_m)};
}

bool is_level_enough(const Ray<double>& ray) {
  const Vec3 size = glm::abs(ray.direction);
  return size.z <= WatertightRay::steepest * std::max(size.x, size.y);
}

bool meets_any(const std::vector<TriangleCorners>& triangles_m, const Ray<double>& ray) {
  const WatertightRay prepared(ray);
  return std::ranges::any_of(triangles_m, [&](const TriangleCorners& corners_m) {
    const auto t = prepared.intersect(corners_m);
    return t && *t > 0.0;
  });
}

double some_slope(Draw& draw) {
  const std::array<double, 4> slopes{draw.between(-1.0, 1.0), draw.between(-3.999, 3.999), 3.9999999, -3.9999999};
  return slopes[draw.below(slopes.size())];
}

}  // namespace

TEST_CASE("no ray that is not steep passes between two walls of other heights that end at one vertical line") {
  Draw draw(101);
  std::size_t slipped = 0, shot = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Joint joint = some_joint(draw);
    const std::vector<TriangleCorners> triangles_m = joint.triangles_m();
    for (int number = 0; number < 25; ++number) {
      const Ray<double> ray = some_ray(draw, joint, some_slope(draw));
      if (!is_level_enough(ray)) continue;
      ++shot;
      slipped += meets_any(triangles_m, ray) ? 0U : 1U;
    }
  }
  MESSAGE(shot << " rays");
  CHECK(slipped == 0);
  CHECK(shot > 400'000);
}

TEST_CASE("between corners whose numbers differ in the last place rays do pass, and so do much steeper ones") {
  Draw draw(102);
  std::size_t through_gap = 0, steep = 0, shot = 0;
  for (int round = 0; round < 4'000; ++round) {
    Joint joint = some_joint(draw);
    const std::vector<TriangleCorners> same_m = joint.triangles_m();
    std::vector<TriangleCorners> apart_m = same_m;
    for (TriangleCorners& corners_m : apart_m) {
      for (Vec3& corner_m : corners_m) {
        if (corner_m.x != joint.x_m || corner_m.y != joint.y_m) continue;
        const Vec3& beside_m = corners_m[1].x == joint.x_m ? corners_m[2] : corners_m[1];
        corner_m.x = moved(corner_m.x, beside_m.x < joint.x_m ? -1 : 1);
        corner_m.y = moved(corner_m.y, beside_m.y < joint.y_m ? -1 : 1);
      }
    }
    for (int number = 0; number < 25; ++number) {
      const Ray<double> ray = some_ray(draw, joint, some_slope(draw));
      if (!is_level_enough(ray)) continue;
      ++shot;
      through_gap += meets_any(apart_m, ray) ? 0U : 1U;
      steep += meets_any(same_m, some_ray(draw, joint, draw.between(20.0, 400.0))) ? 0U : 1U;
    }
  }
  MESSAGE(through_gap << " through the gap, " << steep << " steep ones, of " << shot);
  CHECK(through_gap > shot / 100);
  CHECK(steep > shot / 10'000);
}

namespace {

/// Both walls as they are, without anything that a scene would do to their corners.
template <typename Index>
Index index_of(const std::vector<TriangleCorners>& triangles_m) {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Aabb<double>> boxes;
  for (const TriangleCorners& corners_m : triangles_m) {
    const auto first = static_cast<std::uint32_t>(vertices_m.size());
    vertices_m.insert(vertices_m.end(), corners_m.begin(), corners_m.end());
    triangles.push_back({first, first + 1, first + 2});
    boxes.emplace_back();
    for (const Vec3& corner_m : corners_m) boxes.back().extend(corner_m);
  }
  Index index;
  index.build(TriangleView{vertices_m, triangles}, boxes, std::vector<std::uint32_t>{0});
  return index;
}

}  // namespace

TEST_CASE("nor do trees let it pass, which say of each ray whether it meets a wall as no tree does") {
  Draw draw(103);
  std::size_t slipped = 0, differ = 0, shot = 0;
  for (int round = 0; round < 2'000; ++round) {
    const Joint joint = some_joint(draw);
    const std::vector<TriangleCorners> triangles_m = joint.triangles_m();
    const auto tree = index_of<WideIndex>(triangles_m);
    const auto no_tree = index_of<BruteForceIndex>(triangles_m);
    for (int number = 0; number < 25; ++number) {
      const Ray<double> ray = some_ray(draw, joint, some_slope(draw));
      if (!is_level_enough(ray)) continue;
      ++shot;
      const bool meets = meets_any(triangles_m, ray);
      slipped += meets ? 0U : 1U;
      differ += tree.occluded(ray) != meets || no_tree.occluded(ray) != meets ? 1U : 0U;
    }
  }
  CHECK(slipped == 0);
  CHECK(differ == 0);
  CHECK(shot > 40'000);
}

}  // namespace test_vertical_joints
