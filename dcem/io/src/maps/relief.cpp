// Light on buildings, seen from above.
#include <algorithm>
#include <cmath>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/map_writer.hpp"

namespace dcem::io {
namespace {

constexpr double longest_side = 1280.0;  // of the raster, in its own cells

/// The highest surface at each place of a raster, not below the grid.
struct SurfaceHeights {
  double left_m = 0.0, bottom_m = 0.0, cell_m = 1.0;
  std::size_t columns = 1, rows = 1;
  std::vector<double> heights_m;

  double at(std::size_t column, std::size_t row) const { return heights_m[row * columns + column]; }
};

SurfaceHeights level_ground(const ReceiverGrid& grid) {
  const double width_m = static_cast<double>(grid.columns()) * grid.spacing_m[0];
  const double height_m = static_cast<double>(grid.rows()) * grid.spacing_m[1];
  SurfaceHeights ground;
  ground.left_m = grid.origin_m.x - 0.5 * grid.spacing_m[0];
  ground.bottom_m = grid.origin_m.y - 0.5 * grid.spacing_m[1];
  ground.cell_m = std::max(width_m, height_m) / longest_side;
  const auto cells = [&](double length_m) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length_m / ground.cell_m)));
  };
  ground.columns = cells(width_m);
  ground.rows = cells(height_m);
  ground.heights_m.assign(ground.columns * ground.rows, grid.origin_m.z);
  return ground;
}

/// Cells `first` … `last` − 1 whose middles lie within a stretch of one axis.
struct CellSpan {
  std::size_t first = 0, last = 0;
};

CellSpan cells_within(double low_m, double high_m, double origin_m, double cell_m, std::size_t count) {
  const auto index = [&](double place_m) {
    const double place = std::ceil((place_m - origin_m) / cell_m - 0.5);
    return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(count)));
  };
  return {index(low_m), index(high_m)};
}

// Raises the cells below a triangle to it, in some rows. An upright one has no area from above.
void raise(SurfaceHeights& surface, const std::array<Vec3, 3>& corners_m, const CellSpan& in_rows) {
  const auto& [a, b, c] = corners_m;
  const double twice_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  if (twice_area == 0.0) return;
  const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
  const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
  const CellSpan columns = cells_within(low_x, high_x, surface.left_m, surface.cell_m, surface.columns);
  const CellSpan rows = cells_within(low_y, high_y, surface.bottom_m, surface.cell_m, surface.rows);
  for (std::size_t row = std::max(rows.first, in_rows.first); row < std::min(rows.last, in_rows.last); ++row) {
    const double y = surface.bottom_m + (static_cast<double>(row) + 0.5) * surface.cell_m;
    for (std::size_t column = columns.first; column < columns.last; ++column) {
      const double x = surface.left_m + (static_cast<double>(column) + 0.5) * surface.cell_m;
      const double of_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / twice_area;
      const double of_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / twice_area;
      if (of_b < 0.0 || of_c < 0.0 || of_b + of_c > 1.0) continue;
      double& height_m = surface.heights_m[row * surface.columns + column];
      height_m = std::max(height_m, a.z + of_b * (b.z - a.z) + of_c * (c.z - a.z));
    }
  }
}

// What a matt surface of this slope reflects of light that falls from the north-west, half-way up the sky.
double lit_share(double slope_x, double slope_y) {
  constexpr double towards_west = 0.5, towards_north = 0.5, upwards = 0.70710678118654752;
  return std::max(0.0, (towards_west * slope_x - towards_north * slope_y + upwards) /
                           std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0));
}

// The tones of one row.
void light_row(const SurfaceHeights& surface, std::size_t row, Relief& relief) {
  const std::size_t south = row > 0 ? row - 1 : row, north = std::min(row + 1, surface.rows - 1);
  for (std::size_t column = 0; column < surface.columns; ++column) {
    const std::size_t west = column > 0 ? column - 1 : column, east = std::min(column + 1, surface.columns - 1);
    const double rise_x_m = surface.at(east, row) - surface.at(west, row);
    const double rise_y_m = surface.at(column, north) - surface.at(column, south);
    relief.tones[row * surface.columns + column] =
        static_cast<float>(lit_share(rise_x_m / (2.0 * surface.cell_m), rise_y_m / (2.0 * surface.cell_m)));
  }
}

}  // namespace

Relief map_relief(const ReceiverGrid& grid, const Scene& scene, ThreadPool* pool) {
  constexpr std::size_t rows_at_once = 64;  // each thread looks at all triangles for so many
  SurfaceHeights surface = level_ground(grid);
  const auto boxes = scene.triangle_boxes();
  ThreadPool alone(1);
  ThreadPool& threads = pool != nullptr ? *pool : alone;
  threads.for_each((surface.rows + rows_at_once - 1) / rows_at_once, [&](std::size_t block, unsigned) {
    const CellSpan rows{block * rows_at_once, (block + 1) * rows_at_once};
    for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
      if (boxes[triangle].max.z > grid.origin_m.z) raise(surface, scene.corners_m(triangle), rows);
    }
  });
  Relief relief{surface.columns, surface.rows};
  relief.tones.resize(surface.heights_m.size());
  threads.for_each(surface.rows, [&](std::size_t row, unsigned) { light_row(surface, row, relief); });
  return relief;
}

}  // namespace dcem::io
