/// Receivers that look together find what each of them finds by trying every sequence.
#include "dcem/paths/halves/crowd_joiner.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/halves/crowds.hpp"

namespace test_crowd_joiner {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("a crowd finds every path of each of its points, and the same bits") {
  const std::size_t found =
      check_town_crowds(0, 120, [](Draw& draw) { return Asked{static_cast<int>(draw.below(3))}; });
  CHECK(found > 3'000);
}

TEST_CASE("points in planes of sheets and on lines of edges find together what each finds by itself") {
  std::size_t found = 0;
  for (std::uint64_t seed = 5000; seed < 5080; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(town_on_grid(draw));
    Asked asked{static_cast<int>(draw.below(2))};
    asked.free_edges = true;
    const LinkEnd from = traced.end(point_on_grid(draw));
    std::vector<Vec3> points_m;
    const Vec3 first_m = point_on_grid(draw);
    for (int step = 0; step < 6; ++step) {
      const Vec3 point_m = first_m + Vec3(step % 3, step / 3, 0);
      if (point_m != from.position_m && traced.end(point_m).mounted_on.empty()) points_m.push_back(point_m);
    }
    if (points_m.empty()) continue;
    CAPTURE(seed);
    found += check_crowd(traced, from, points_m, asked, 128);
  }
  CHECK(found > 1'000);
}

TEST_CASE("a transmitter far away is joined as one nearby") {
  std::size_t found = 0;
  for (std::uint64_t seed = 6000; seed < 6040; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = far_away(traced, draw);
    const std::vector<Vec3> points_m =
        points_beside(draw, draw.inside(Vec3(-20, -20, 1), Vec3(20, 20, 6)), Vec3(3, 3, 0), 8);
    CAPTURE(seed);
    found += check_crowd(traced, from, points_m, {}, 256);
  }
  CHECK(found > 500);
}

}  // namespace test_crowd_joiner
