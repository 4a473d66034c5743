/// Planes near a point: none is left out, and few of the others are told.
#include "dcem/paths/halves/plane_index.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_plane_index {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Walls along streets, roofs, and anything, a kilometre across, with a middle that is not the origin.
std::vector<PlaneIndex::Item> city(Draw& draw, std::size_t count) {
  std::vector<PlaneIndex::Item> planes;
  while (planes.size() < count) {
    const double turn_rad = draw.below(2) == 0 ? 0.3 * static_cast<double>(draw.below(5)) : draw.between(-pi, pi);
    const Vec3 level(std::cos(turn_rad), std::sin(turn_rad), 0.0);
    const std::size_t kind = draw.below(4);
    const Vec3 normal = kind < 2    ? level
                        : kind == 2 ? glm::normalize(level + draw.between(0.3, 3.0) * Vec3(0, 0, 1))
                                    : Vec3(0, 0, draw.below(2) == 0 ? 1.0 : -1.0);
    const Vec3 point_m = draw.inside(Vec3(500, -500, 0), Vec3(1500, 500, 40));
    planes.push_back({FacetId(static_cast<std::uint32_t>(planes.size())), {point_m, normal}, draw.between(1e-4, 0.05)});
  }
  return planes;
}

bool holds(const std::vector<std::uint32_t>& told, FacetId facet) {
  return std::ranges::find(told, facet.value) != told.end();
}

}  // namespace

TEST_CASE("no plane near a point is left out, each is told once, and few others are") {
  constexpr std::array<std::size_t, 13> whole{0, 1, 2, 7, 8, 9, 63, 64, 65, 511, 512, 513, 4096};  // eights, and groups
  std::size_t near = 0, told_all = 0, asked = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    const std::vector<PlaneIndex::Item> planes = city(draw, seed < whole.size() ? whole[seed] : 1 + draw.below(6000));
    PlaneIndex index;
    index.build(planes, Vec3(1000, 0, 20));
    for (int point = 0; point < 20; ++point) {
      const double far_m = point < 15 ? 1.0 : 30.0;  // images lie outside of the city
      const Vec3 at_m = Vec3(1000, 0, 20) + far_m * draw.inside(Vec3(-500, -500, -20), Vec3(500, 500, 30));
      const double radius_m = point % 3 == 0 ? draw.between(0.0, 3.0) : 0.0, times = draw.between(1.0, 20.0);
      std::vector<std::uint32_t> told;
      index.for_each_near(at_m, radius_m, times, [&](FacetId facet) { told.push_back(facet.value); });
      for (const PlaneIndex::Item& one : planes) {
        if (std::abs(signed_distance_m(one.plane, at_m)) > radius_m + times * one.lift_m) continue;
        ++near;
        CHECK(holds(told, one.facet));
      }
      told_all += told.size();
      asked += planes.size();
      std::ranges::sort(told);
      CHECK(std::ranges::adjacent_find(told) == told.end());
    }
  }
  MESSAGE(near << " planes near, " << told_all << " told, of " << asked);
  CHECK(near > 1000);
  CHECK(told_all < near + near / 10);  // single precision adds a centimetre, and more far away
}

TEST_CASE("no plane near a point between two is left out") {
  std::size_t near = 0;
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    const std::vector<PlaneIndex::Item> planes = city(draw, 1 + draw.below(3000));
    PlaneIndex index;
    index.build(planes, Vec3(1000, 0, 20));
    for (int line = 0; line < 20; ++line) {
      const Vec3 from_m = draw.inside(Vec3(500, -500, 0), Vec3(1500, 500, 40)),
                 to_m = from_m + draw.inside(Vec3(-20, -20, -5), Vec3(20, 20, 5));
      std::vector<std::uint32_t> told;
      index.for_each_between(from_m, to_m, 3.0, [&](FacetId facet) { told.push_back(facet.value); });
      for (const PlaneIndex::Item& one : planes) {
        const double first_m = signed_distance_m(one.plane, from_m), last_m = signed_distance_m(one.plane, to_m);
        const double nearest_m = first_m * last_m <= 0.0 ? 0.0 : std::min(std::abs(first_m), std::abs(last_m));
        if (nearest_m > 3.0 * one.lift_m) continue;
        ++near;
        CHECK(holds(told, one.facet));
      }
    }
  }
  CHECK(near > 1000);
}

}  // namespace test_plane_index
