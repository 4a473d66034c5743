#pragma once
/// Bodies of extreme_points.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/extreme_points.hpp"

namespace dcem {

DCEM_INLINE void take_extreme_points(std::span<const Vec3> points_m, std::vector<Vec3>& result) {
  result.assign(points_m.begin(), points_m.end());
  const auto is_level = [&](const Vec3& point_m) { return point_m.z == result.front().z; };
  if (result.size() < 4 || !std::ranges::all_of(result, is_level)) return;
  std::ranges::sort(result, {}, [](const Vec3& point_m) { return std::array{point_m.x, point_m.y}; });
  // Andrew's monotone chain: once along the points, once back.
  std::vector<Vec3> hull;
  const auto add = [&](const Vec3& point_m, std::size_t first) {
    while (hull.size() >= first + 2) {
      const Vec3 last = hull.back() - hull[hull.size() - 2], next = point_m - hull.back();
      if (last.x * next.y - last.y * next.x > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(point_m);
  };
  for (const Vec3& point_m : result) add(point_m, 0);
  const std::size_t turn = hull.size() - 1;
  for (auto point = result.rbegin() + 1; point != result.rend(); ++point) add(*point, turn);
  hull.pop_back();  // the first one again
  result = std::move(hull);
}

}  // namespace dcem
