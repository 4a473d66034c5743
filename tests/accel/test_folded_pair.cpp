/// Two triangles on one side of a common edge lie on each other: no ray that meets one of them passes.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/accel/wide_index.hpp"
#include "dcem/core/random.hpp"
#include "dcem/geometry/triangle.hpp"

namespace test_folded_pair {

using namespace dcem;

namespace {

/// The same on every machine.
struct Draw {
  RandomStream stream;
  double between(double low, double high) { return low + (high - low) * stream.uniform(); }
  Vec3 inside(const Vec3& low, const Vec3& high) {
    return {between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)};
  }
};

struct Meetings {
  std::size_t met = 0, missed = 0;
};

/// How many segments around two triangles meet one of them, and how many of those the tree says pass.
Meetings meetings(const std::vector<Vec3>& vertices_m, Draw& draw) {
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 1, 3}};
  std::vector<Aabb<double>> boxes;
  for (const auto& triangle : triangles) {
    Aabb<double> box;
    for (const std::uint32_t vertex : triangle) box.extend(vertices_m[vertex]);
    boxes.push_back(box);
  }
  WideIndex index;
  index.build({vertices_m, triangles}, boxes, std::vector<std::uint32_t>{0});
  Meetings found;
  TraversalCounters counters;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 from_m = vertices_m[0] + draw.inside(Vec3(-4), Vec3(4)),
               to_m = vertices_m[1] + draw.inside(Vec3(-4), Vec3(4));
    const Ray<double> leg = segment_between(from_m, to_m);
    const WatertightRay ray(leg);
    bool is_met = false;
    for (const auto& [a, b, c] : triangles) {
      const std::optional<double> t = ray.intersect({vertices_m[a], vertices_m[b], vertices_m[c]});
      is_met = is_met || (t && *t >= 0.0 && *t <= 1.0);
    }
    found.met += is_met;
    found.missed += is_met && !index.occluded(leg, {}, &counters);
  }
  return found;
}

}  // namespace

TEST_CASE("folded pair: two upright triangles of one height on one edge block what either blocks") {
  std::size_t met = 0, missed = 0, leaky = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Draw draw{RandomStream(seed)};
    // Upright, on an edge along the ground in any direction: their normals are as long as each other but for rounding.
    const double turn_rad = draw.between(-3.14, 3.14), height_m = draw.between(0.5, 3.0);
    const Vec3 along_m = draw.between(1.0, 3.0) * Vec3(std::cos(turn_rad), std::sin(turn_rad), 0.0);
    const Vec3 foot_m = draw.inside(Vec3(-5, -5, 0), Vec3(5, 5, 0)), up_m(0, 0, height_m);
    const Meetings found = meetings({foot_m, foot_m + along_m, foot_m + draw.between(0.0, 0.4) * along_m + up_m,
                                     foot_m + draw.between(0.6, 1.0) * along_m + up_m},
                                    draw);
    met += found.met;
    missed += found.missed;
    leaky += found.missed > 0;
  }
  MESSAGE(met << " met, " << missed << " of them missed, in " << leaky << " of 400");
  CHECK(missed == 0);
  CHECK(met > 2'000);
}

}  // namespace test_folded_pair
