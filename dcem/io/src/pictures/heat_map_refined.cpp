// Finer cells between the points of a map.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io {
namespace {

// Two neighbouring points along an axis, and how far the place is on the way from the first to the second.
struct Between {
  std::size_t first = 0, second = 0;
  double share = 0.0;
};

Between between_points(std::size_t fine, std::size_t factor, std::size_t points) {
  const double place = (static_cast<double>(fine) + 0.5) / static_cast<double>(factor) - 0.5;
  const double inside = std::clamp(place, 0.0, static_cast<double>(points - 1));
  const auto first = std::min(static_cast<std::size_t>(inside), points - 1);
  return {first, std::min(first + 1, points - 1), inside - static_cast<double>(first)};
}

double value_between(const HeatMap& map, const Between& column, const Between& row) {
  double sum = 0.0, weights = 0.0;
  const auto add = [&](std::size_t x, std::size_t y, double weight) {
    const std::size_t cell = y * map.columns + x;
    if (weight == 0.0 || !detail::is_valued(map, cell)) return;
    sum += weight * map.values[cell];
    weights += weight;
  };
  add(column.first, row.first, (1.0 - column.share) * (1.0 - row.share));
  add(column.second, row.first, column.share * (1.0 - row.share));
  add(column.first, row.second, (1.0 - column.share) * row.share);
  add(column.second, row.second, column.share * row.share);
  return sum / weights;
}

}  // namespace

HeatMap refined(const HeatMap& map, std::size_t factor) {
  if (factor == 0) throw std::invalid_argument("refined: expected a factor of at least 1");
  if (!map.categories.empty()) throw std::invalid_argument("refined: nothing lies between two categories");
  (void)heat_map_layout(map);  // checks
  HeatMap fine = map;
  const auto parts = static_cast<double>(factor);
  fine.columns = map.columns * factor;
  fine.rows = map.rows * factor;
  fine.spacing_x_m = map.spacing_x_m / parts;
  fine.spacing_y_m = map.spacing_y_m / parts;
  fine.origin_x_m = map.origin_x_m - 0.5 * map.spacing_x_m + 0.5 * fine.spacing_x_m;
  fine.origin_y_m = map.origin_y_m - 0.5 * map.spacing_y_m + 0.5 * fine.spacing_y_m;
  fine.values.clear();
  fine.hatched.clear();
  for (std::size_t row = 0; row < fine.rows; ++row) {
    const Between rows = between_points(row, factor, map.rows);
    for (std::size_t column = 0; column < fine.columns; ++column) {
      const std::size_t cell = row / factor * map.columns + column / factor;
      const bool is_valued = detail::is_valued(map, cell);
      fine.values.push_back(is_valued ? value_between(map, between_points(column, factor, map.columns), rows)
                                      : std::numeric_limits<double>::quiet_NaN());
      if (!map.hatched.empty()) fine.hatched.push_back(map.hatched[cell]);
    }
  }
  return fine;
}

}  // namespace dcem::io
