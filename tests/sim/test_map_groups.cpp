/// Points of a map that look at the scene together: each open cell once, few enough, close enough, joined by free
/// steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "dcem/sim/detail/map_groups.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_map_groups {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A grid of which some cells are closed, and some steps between open ones are not free.
struct Streets {
  ReceiverGrid grid;
  std::vector<char> open;
  std::set<std::pair<std::size_t, std::size_t>> walls;

  bool free(std::size_t one, std::size_t other) const { return !walls.contains(std::minmax(one, other)); }
  bool are_beside(std::size_t one, std::size_t other) const {
    const std::size_t columns = grid.columns();
    const auto apart = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
    return apart(one / columns, other / columns) + apart(one % columns, other % columns) == 1;
  }
};

Streets some_streets(Draw& draw) {
  Streets streets;
  streets.grid.count = {1 + draw.below(30), 1 + draw.below(30)};
  streets.grid.spacing_m = {draw.magnitude(0.5, 10), draw.magnitude(0.5, 10)};
  const double share = draw.between(0.2, 1.0), walls = draw.between(0.0, 0.4);
  for (std::size_t cell = 0; cell < streets.grid.size(); ++cell) {
    streets.open.push_back(draw.between(0, 1) < share ? 1 : 0);
    for (const std::size_t next : {cell + 1, cell + streets.grid.columns()}) {
      if (draw.between(0, 1) < walls) streets.walls.insert({cell, next});
    }
  }
  return streets;
}

/// Whether free steps within the group lead from its first point to all others.
bool is_joined(const Streets& streets, const std::vector<std::size_t>& group) {
  std::vector<std::size_t> reached{group.front()};
  for (std::size_t next = 0; next < reached.size(); ++next) {
    for (const std::size_t cell : group) {
      if (std::ranges::find(reached, cell) != reached.end()) continue;
      if (streets.are_beside(cell, reached[next]) && streets.free(cell, reached[next])) reached.push_back(cell);
    }
  }
  return reached.size() == group.size();
}

std::size_t span_of(const std::vector<std::size_t>& group, const auto& place) {
  const auto [low, high] = std::ranges::minmax(group, {}, place);
  return place(high) - place(low);
}

}  // namespace

TEST_CASE("each open cell is in one group of at most 16, ascending, close together and joined by free steps") {
  Draw draw(3);
  std::size_t joined = 0, apart = 0;
  for (int round = 0; round < 400; ++round) {
    const Streets streets = some_streets(draw);
    const auto free = [&](std::size_t one, std::size_t other) { return streets.free(one, other); };
    const auto groups = dcem::detail::map_groups(streets.grid, streets.open, free);
    std::vector<int> times(streets.grid.size(), 0);
    for (const std::vector<std::size_t>& group : groups) {
      REQUIRE(!group.empty());
      CHECK(group.size() <= 16);
      CHECK(std::ranges::is_sorted(group));
      CHECK(is_joined(streets, group));
      const std::size_t columns = streets.grid.columns();
      const std::size_t wide = span_of(group, [&](std::size_t cell) { return cell % columns; });
      const std::size_t high = span_of(group, [&](std::size_t cell) { return cell / columns; });
      CHECK(wide < dcem::detail::group_side(streets.grid.spacing_m[0]) + 2);
      CHECK(high < dcem::detail::group_side(streets.grid.spacing_m[1]) + 2);
      CHECK(static_cast<double>(wide) * streets.grid.spacing_m[0] <= 10.0);
      CHECK(static_cast<double>(high) * streets.grid.spacing_m[1] <= 10.0);
      for (const std::size_t cell : group) ++times[cell];
    }
    for (std::size_t cell = 0; cell < times.size(); ++cell) CHECK(times[cell] == (streets.open[cell] != 0 ? 1 : 0));
    dcem::detail::GridGroups tiles(streets.grid, streets.open);
    tiles.fill_tiles(free);
    joined += groups.size();
    apart += tiles.take().size();
  }
  MESSAGE(joined << " groups, of " << apart << " before small ones joined others");
  CHECK(10 * joined < 9 * apart);  // or joining would not be worth it
}

TEST_CASE("an open square of two by two tiles is four groups of 16") {
  ReceiverGrid grid;
  grid.count = {8, 8};
  grid.spacing_m = {2.0, 2.0};
  const std::vector<char> open(grid.size(), 1);
  const auto groups = dcem::detail::map_groups(grid, open, [](std::size_t, std::size_t) { return true; });
  REQUIRE(groups.size() == 4);
  for (const std::vector<std::size_t>& group : groups) CHECK(group.size() == 16);
}

TEST_CASE("points far apart look at the scene alone") {
  ReceiverGrid grid;
  grid.count = {6, 5};
  grid.spacing_m = {50.0, 50.0};
  const std::vector<char> open(grid.size(), 1);
  CHECK(dcem::detail::map_groups(grid, open, [](std::size_t, std::size_t) { return true; }).size() == 30);
}

}  // namespace test_map_groups
