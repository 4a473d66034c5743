#pragma once
/// Bodies of list_groups.hpp.
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/list_groups.hpp"

namespace dcem::detail {

/// The box of this side that a point lies in, counted from the origin: no wider than a group on a grid.
inline std::array<double, 3> group_box(const Vec3& point_m) {
  constexpr double widest_m = 8.0;
  return {std::floor(point_m.x / widest_m), std::floor(point_m.y / widest_m), std::floor(point_m.z / widest_m)};
}

/// Takes from `waiting` the first point and, in order, those that a free straight step joins to the one taken before
/// them, up to 16. An empty `waiting` stays so.
inline std::vector<std::size_t> take_group(std::vector<std::size_t>& waiting, const IsFree& free) {
  constexpr std::size_t most = 16;
  std::vector<std::size_t> group, left;
  for (const std::size_t point : waiting) {
    const bool joins = group.empty() || (group.size() < most && free(group.back(), point));
    (joins ? group : left).push_back(point);
  }
  waiting = std::move(left);
  return group;
}

DCEM_INLINE std::vector<std::vector<std::size_t>> list_groups(std::span<const Vec3> points_m,
                                                              std::span<const char> open, const IsFree& free) {
  std::vector<std::vector<std::size_t>> groups;
  std::map<std::array<double, 3>, std::vector<std::size_t>> boxes;
  for (std::size_t point = 0; point < points_m.size(); ++point) {
    if (open[point] == 0) {
      groups.push_back({point});
    } else {
      boxes[group_box(points_m[point])].push_back(point);
    }
  }
  for (auto& [box, waiting] : boxes) {
    while (!waiting.empty()) groups.push_back(take_group(waiting, free));
  }
  return groups;
}

}  // namespace dcem::detail
