#include "dcem/io/src/pictures/contours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io::detail {
namespace {

// An edge between two neighbouring points: twice the number of its lower point, plus one where it runs along y.
using GridEdge = std::uint64_t;

/// The lines of one level.
class LevelLines {
 public:
  LevelLines(const HeatMap& map, double level) : map_(map), level_(level) {
    for (std::size_t row = 0; row + 1 < map.rows; ++row) {
      for (std::size_t column = 0; column + 1 < map.columns; ++column) cut_square(row * map.columns + column);
    }
  }

  /// Chains the pieces: lines with ends first, then closed ones.
  std::vector<ContourLine> take() {
    std::vector<ContourLine> lines;
    for (const auto& [edge, next] : neighbours_) {
      if (next.size() == 1 && !used_[edge]) lines.push_back(chain_from(edge));
    }
    for (const auto& [edge, next] : neighbours_) {
      if (used_[edge]) continue;
      lines.push_back(chain_from(edge));
      lines.back().points.push_back(lines.back().points.front());
    }
    return lines;
  }

 private:
  bool is_above(std::size_t cell) const { return map_.values[cell] >= level_; }

  void join(GridEdge one, GridEdge other) {
    neighbours_[one].push_back(other);
    neighbours_[other].push_back(one);
  }

  // Corners and sides in turn around the square; side k lies between the corners k and k + 1.
  void cut_square(std::size_t cell) {
    const std::array<std::size_t, 4> corners{cell, cell + 1, cell + map_.columns + 1, cell + map_.columns};
    if (!std::all_of(corners.begin(), corners.end(), [&](std::size_t one) { return is_valued(map_, one); })) return;
    const std::array<GridEdge, 4> sides{2 * corners[0], 2 * corners[1] + 1, 2 * corners[3], 2 * corners[0] + 1};
    std::vector<std::size_t> cut;
    for (std::size_t side = 0; side < 4; ++side) {
      if (is_above(corners[side]) != is_above(corners[(side + 1) % 4])) cut.push_back(side);
    }
    if (cut.size() == 2) join(sides[cut[0]], sides[cut[1]]);
    if (cut.size() != 4) return;
    double mean = 0.0;
    for (const std::size_t corner : corners) mean += 0.25 * map_.values[corner];
    // The corners that are on the other side of the level than the middle are cut off.
    const std::size_t first = (mean >= level_) == is_above(corners[0]) ? 0 : 3;
    join(sides[first], sides[(first + 1) % 4]);
    join(sides[(first + 2) % 4], sides[(first + 3) % 4]);
  }

  std::array<double, 2> place_on(GridEdge edge) const {
    const std::size_t low = edge / 2, high = edge % 2 == 0 ? low + 1 : low + map_.columns;
    const double share = (level_ - map_.values[low]) / (map_.values[high] - map_.values[low]);
    const double column = static_cast<double>(low % map_.columns) + (edge % 2 == 0 ? share : 0.0);
    const double row = static_cast<double>(low / map_.columns) + (edge % 2 == 0 ? 0.0 : share);
    return {map_.origin_x_m + column * map_.spacing_x_m, map_.origin_y_m + row * map_.spacing_y_m};
  }

  ContourLine chain_from(GridEdge edge) {
    ContourLine line{level_};
    for (std::optional<GridEdge> at = edge; at;) {
      used_[*at] = true;
      line.points.push_back(place_on(*at));
      const std::vector<GridEdge>& next = neighbours_[*at];
      const auto free = std::find_if(next.begin(), next.end(), [&](GridEdge one) { return !used_[one]; });
      at = free == next.end() ? std::nullopt : std::optional(*free);
    }
    return line;
  }

  const HeatMap& map_;
  double level_;
  std::map<GridEdge, std::vector<GridEdge>> neighbours_;  // each edge has one or two
  std::map<GridEdge, bool> used_;
};

}  // namespace

std::vector<ContourLine> contour_lines(const HeatMap& map, const ValueRange& range, double step) {
  constexpr double most_levels = 1000.0;
  std::vector<ContourLine> lines;
  if ((range.high - range.low) / step > most_levels) return lines;
  for (double number = std::ceil(range.low / step); number * step <= range.high; number += 1.0) {
    for (ContourLine& line : LevelLines(map, number * step).take()) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace dcem::io::detail
