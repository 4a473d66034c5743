/// Progress runs with the work: points that take none do not run ahead of the others.
#include "dcem/sim/detail/map_progress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace test_map_progress {

using namespace dcem;

TEST_CASE("all points are told in the end, each step in proportion to what was solved") {
  std::vector<std::size_t> steps;
  const std::function<void(std::size_t)> note = [&](std::size_t points) { steps.push_back(points); };
  detail::MapProgress progress(note, 40'000, 16'290);
  std::size_t solved = 0, told = 0;
  for (std::size_t group = 1; solved < 16'290; group = group % 16 + 1) {
    const std::size_t size = std::min(group, 16'290 - solved);
    progress.add(size);
    solved += size;
    told += steps.back();
    CHECK(told == solved * 40'000 / 16'290);
  }
  CHECK(told == 40'000);
}

TEST_CASE("a map without a point to solve is told at once, and nobody need listen") {
  std::size_t told = 0;
  const std::function<void(std::size_t)> note = [&](std::size_t points) { told += points; };
  const detail::MapProgress all_inside(note, 12, 0);
  CHECK(told == 12);
  const std::function<void(std::size_t)> nobody;
  detail::MapProgress unheard(nobody, 12, 0);
  CHECK_NOTHROW(unheard.add(3));
}

}  // namespace test_map_progress
