#pragma once
/// Sides of triangles in the order of their places.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dcem::detail {

/// Sides with members a < b, sorted by `<`, which compares a first. `for_each_side(visit)` calls `visit(side)` for each
/// of them, and does so twice: they are counted by a, laid out, and then sorted few by few, which takes a third of the
/// time of sorting all. Precondition: a < `vertices`; fewer than 2^32 sides.
template <typename Side, typename ForEachSide>
std::vector<Side> sorted_sides(std::size_t vertices, ForEachSide&& for_each_side) {
  std::vector<std::uint32_t> end(vertices + 1, 0);
  for_each_side([&](const Side& side) { ++end[side.a + 1]; });
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) end[vertex + 1] += end[vertex];
  std::vector<Side> sides(end.back());
  for_each_side([&](const Side& side) { sides[end[side.a]++] = side; });  // now what was the begin of a list is its end
  std::size_t first = 0;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const std::size_t last = end[vertex];
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(first), sides.begin() + static_cast<std::ptrdiff_t>(last));
    first = last;
  }
  return sides;
}

}  // namespace dcem::detail
