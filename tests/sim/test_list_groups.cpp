/// Which points of a list look at the scene together.
#include "dcem/sim/detail/list_groups.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dcem/core/random.hpp"

namespace test_list_groups {

using namespace dcem;

namespace {

std::vector<Vec3> scattered_points(std::size_t count) {
  RandomStream random(7);
  std::vector<Vec3> points_m;
  for (std::size_t index = 0; index < count; ++index) {
    points_m.emplace_back(60.0 * random.uniform() - 30.0, 40.0 * random.uniform() - 20.0, 12.0 * random.uniform());
  }
  return points_m;
}

}  // namespace

TEST_CASE("each point is in one group, at most 16 of them within 8 m, one free step after the other") {
  const std::vector<Vec3> points_m = scattered_points(2'000);
  std::vector<char> open(points_m.size(), 1);
  for (std::size_t point = 0; point < open.size(); point += 10) open[point] = 0;
  const auto is_free = [](std::size_t from, std::size_t to) { return (from + to) % 3 != 0; };
  const auto groups = detail::list_groups(points_m, open, is_free);
  std::vector<int> seen(points_m.size(), 0);
  for (const std::vector<std::size_t>& group : groups) {
    REQUIRE(!group.empty());
    CHECK(group.size() <= 16);
    for (std::size_t at = 0; at < group.size(); ++at) {
      ++seen[group[at]];
      if (group.size() > 1) CHECK(open[group[at]] == 1);
      if (at > 0) CHECK(is_free(group[at - 1], group[at]));
      const Vec3 apart_m = glm::abs(points_m[group[at]] - points_m[group[0]]);
      CHECK(std::max({apart_m.x, apart_m.y, apart_m.z}) <= 8.0);
    }
  }
  CHECK(std::ranges::all_of(seen, [](int count) { return count == 1; }));
  CHECK(groups.size() < points_m.size());
}

TEST_CASE("a route is cut into stretches, and without free steps every point looks for itself") {
  std::vector<Vec3> route_m;
  for (int step = 0; step < 64; ++step) route_m.emplace_back(0.25 * step, 1.0, 1.5);
  const std::vector<char> open(route_m.size(), 1);
  const auto stretches = detail::list_groups(route_m, open, [](std::size_t, std::size_t) { return true; });
  CHECK(stretches.size() == 4);
  for (const auto& stretch : stretches) CHECK(stretch.back() - stretch.front() == 15);
  CHECK(detail::list_groups(route_m, open, [](std::size_t, std::size_t) { return false; }).size() == 64);
  CHECK(detail::list_groups({}, {}, [](std::size_t, std::size_t) { return true; }).empty());
}

}  // namespace test_list_groups
