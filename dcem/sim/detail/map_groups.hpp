#pragma once
/// Which points of a map look at the scene together.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/scene/device.hpp"

namespace dcem::detail {

/// How many neighbours along one axis share a view. Farther apart than some metres they see too much together.
inline std::size_t group_side(double spacing_m) {
  constexpr double widest_m = 8.0;
  constexpr std::size_t most = 4;
  const double steps = spacing_m > 0.0 ? widest_m / spacing_m : static_cast<double>(most);
  return std::min(most, 1 + static_cast<std::size_t>(std::min(steps, static_cast<double>(most))));
}

/// The open points of a grid in groups of at most 16: what is joined by free straight steps, tile by tile. Cells are
/// counted row by row. `open` holds what is not 0 for an open cell; `free(cell, cell)` says whether a step is free.
template <typename Free>
std::vector<std::vector<std::size_t>> map_groups(const ReceiverGrid& grid, std::span<const char> open, Free&& free) {
  const std::size_t columns = grid.columns(), rows = grid.rows();
  const std::array<std::size_t, 2> side{group_side(grid.spacing_m[0]), group_side(grid.spacing_m[1])};
  std::vector<std::vector<std::size_t>> groups;
  std::vector<char> taken(grid.size(), 0);
  for (std::size_t tile_row = 0; tile_row < rows; tile_row += side[1]) {
    for (std::size_t tile_column = 0; tile_column < columns; tile_column += side[0]) {
      const std::size_t end_row = std::min(rows, tile_row + side[1]);
      const std::size_t end_column = std::min(columns, tile_column + side[0]);
      for (std::size_t at = 0; at < (end_row - tile_row) * (end_column - tile_column); ++at) {
        const std::size_t width = end_column - tile_column;
        const std::size_t seed = (tile_row + at / width) * columns + tile_column + at % width;
        if (open[seed] == 0 || taken[seed] != 0) continue;
        std::vector<std::size_t> group{seed};
        taken[seed] = 1;
        const auto take = [&](std::size_t from, std::size_t to) {
          if (open[to] == 0 || taken[to] != 0 || !free(from, to)) return;
          taken[to] = 1;
          group.push_back(to);
        };
        for (std::size_t next = 0; next < group.size(); ++next) {
          const std::size_t cell = group[next], row = cell / columns, column = cell % columns;
          if (column > tile_column) take(cell, cell - 1);
          if (column + 1 < end_column) take(cell, cell + 1);
          if (row > tile_row) take(cell, cell - columns);
          if (row + 1 < end_row) take(cell, cell + columns);
        }
        std::ranges::sort(group);
        groups.push_back(std::move(group));
      }
    }
  }
  return groups;
}

}  // namespace dcem::detail
