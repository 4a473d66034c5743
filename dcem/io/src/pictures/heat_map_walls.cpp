#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io::detail {
namespace {

/// Liang and Barsky (1984): the part of a line within an area and a seam about it; nothing where there is none. What is
/// far outside would be beyond the coordinates that can be drawn.
std::optional<Segment> clipped_line(const Segment& line, const PixelRect& area, double seam_px) {
  const auto [from, to] = line;
  const double dx = to.x - from.x, dy = to.y - from.y;
  const std::array<std::array<double, 2>, 4> borders{{{-dx, from.x - (area.x - seam_px)},
                                                      {dx, area.right() + seam_px - from.x},
                                                      {-dy, from.y - (area.y - seam_px)},
                                                      {dy, area.bottom() + seam_px - from.y}}};
  double first = 0.0, last = 1.0;
  for (const auto& [outwards, room] : borders) {
    if (outwards == 0.0 && room < 0.0) return std::nullopt;
    if (outwards < 0.0) first = std::max(first, room / outwards);
    if (outwards > 0.0) last = std::min(last, room / outwards);
  }
  if (!(first <= last)) return std::nullopt;
  return Segment{PixelPoint{from.x + first * dx, from.y + first * dy},
                 PixelPoint{from.x + last * dx, from.y + last * dy}};
}

// A line along an axis is put onto whole pixels, so that it is sharp.
double snap(double position_px, double thickness_px) {
  const double half = 0.5 * std::round(thickness_px);
  return std::round(position_px - half) + half;
}

Segment wall_line(const HeatMapLayout& layout, const std::array<double, 4>& wall, double thickness_px) {
  PixelPoint from = layout.point(wall[0], wall[1]);
  PixelPoint to = layout.point(wall[2], wall[3]);
  if (wall[0] == wall[2]) from.x = to.x = snap(from.x, thickness_px);
  if (wall[1] == wall[3]) from.y = to.y = snap(from.y, thickness_px);
  return {from, to};
}

bool is_hatched_at(const HeatMap& map, double x_m, double y_m) {
  const double column = std::round((x_m - map.origin_x_m) / map.spacing_x_m);
  const double row = std::round((y_m - map.origin_y_m) / map.spacing_y_m);
  if (!(column >= 0.0 && row >= 0.0 && column < double(map.columns) && row < double(map.rows))) return false;
  return is_hatched(map, static_cast<std::size_t>(row) * map.columns + static_cast<std::size_t>(column));
}

/// Hatched on both sides all along: a wall between two houses, or within one.
bool is_inner(const HeatMap& map, const std::array<double, 4>& wall) {
  const double dx_m = wall[2] - wall[0], dy_m = wall[3] - wall[1], length_m = std::hypot(dx_m, dy_m);
  if (!(length_m > 0.0)) return false;
  const double aside = std::max(map.spacing_x_m, map.spacing_y_m) / length_m;
  for (const double along : {0.1, 0.5, 0.9}) {
    for (const double side : {-aside, aside}) {
      if (!is_hatched_at(map, wall[0] + along * dx_m - side * dy_m, wall[1] + along * dy_m + side * dx_m)) return false;
    }
  }
  return true;
}

}  // namespace

double wall_thickness_px(const HeatMap& map) {
  return map.walls_m.size() > 2000 ? 2.0 : 4.0;
}

SeenWalls seen_walls(const HeatMap& map, const HeatMapLayout& layout, double seam_px) {
  const double thickness_px = wall_thickness_px(map);
  SeenWalls seen;
  for (const auto& wall : map.walls_m) {
    if (const auto segment = clipped_line(wall_line(layout, wall, thickness_px), layout.plot, seam_px)) {
      (is_inner(map, wall) ? seen.inner : seen.outer).push_back(*segment);
    }
  }
  for (const auto& window : map.windows_m) {
    const auto segment = clipped_line(wall_line(layout, window, thickness_px + 3.0), layout.plot, seam_px);
    if (segment) seen.windows.push_back(*segment);
  }
  return seen;
}

}  // namespace dcem::io::detail
