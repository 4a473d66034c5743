// The cells of a map as pixels.
#include <algorithm>
#include <cmath>

#include "dcem/io/src/pictures/cell_colours.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io {
namespace detail {
namespace {

constexpr double hatch_pitch_px = 13.0;  // across the lines
constexpr double texture_pitch_px = 20.0;

// How much of a pixel a line of this thickness covers whose middle is so far away.
double line_cover(double distance_px, double thickness_px) {
  return std::clamp(0.5 * thickness_px + 0.5 - distance_px, 0.0, 1.0);
}

// From the middle of the next of parallel lines, of which one goes through zero.
double distance_to_lines(double place_px, double pitch_px) {
  return std::abs(place_px - pitch_px * std::round(place_px / pitch_px));
}

double dot_cover(double x, double y, double pitch_px, double radius_px) {
  const double distance = std::hypot(distance_to_lines(x, pitch_px), distance_to_lines(y, pitch_px));
  return std::clamp(radius_px + 0.5 - distance, 0.0, 1.0);
}

// Textures tell things apart whose colours are the same grey: bare, dots, level, upright and falling lines, a lattice,
// large dots.
double texture_cover(std::size_t category, double x, double y) {
  const double level = line_cover(distance_to_lines(y, texture_pitch_px), 2.0);
  const double upright = line_cover(distance_to_lines(x, texture_pitch_px), 2.0);
  switch (category % 7) {
    case 1:
      return dot_cover(x, y, texture_pitch_px, 2.5);
    case 2:
      return level;
    case 3:
      return upright;
    case 4:
      return line_cover(distance_to_lines((x - y) / std::sqrt(2.0), texture_pitch_px), 2.0);
    case 5:
      return std::max(level, upright);
    case 6:
      return dot_cover(x, y, 1.5 * texture_pitch_px, 6.0);
    default:
      return 0.0;
  }
}

// For each pixel along an axis the cell that its middle lies in.
std::vector<std::size_t> cells_of_pixels(int length_px, std::size_t cells) {
  std::vector<std::size_t> result(static_cast<std::size_t>(length_px));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double position = (static_cast<double>(i) + 0.5) / length_px * static_cast<double>(cells);
    result[i] = std::min(static_cast<std::size_t>(position), cells - 1);
  }
  return result;
}

// What is hatched: an even ground, or light and shade where there is a relief. Pale, so that no value looks like it.
Colour ground_colour(const Relief& relief, double x_share, double y_share) {
  if (relief.tones.empty()) return hatch_ground;
  const auto place = [](double share, std::size_t count) {
    return std::min(static_cast<std::size_t>(share * static_cast<double>(count)), count - 1);
  };
  const std::size_t tone = place(y_share, relief.rows) * relief.columns + place(x_share, relief.columns);
  return mix(relief_shade, relief_light, relief.tones[tone]);
}

}  // namespace

Colour hatched_colour(Colour ground, double x_px, double y_px) {
  const double distance = distance_to_lines((x_px + y_px) / std::sqrt(2.0), hatch_pitch_px);
  return mix(ground, hatch_line, line_cover(distance, 2.0));
}

Colour category_pixel(std::size_t category, double x_px, double y_px) {
  const Colour colour = category_colour(category);
  return mix(colour, {0, 0, 0}, 0.6 * texture_cover(category, x_px, y_px));
}

double share_of_range(double value, const ValueRange& range) {
  return (value - range.low) / (range.high - range.low);
}

Image cells_image(const HeatMap& map, const HeatMapLayout& layout) {
  const PixelRect& plot = layout.plot;
  const std::vector<std::size_t> columns = cells_of_pixels(plot.width, map.columns);
  const std::vector<std::size_t> rows = cells_of_pixels(plot.height, map.rows);
  Image image(plot.width, plot.height);
  for (int y = 0; y < plot.height; ++y) {
    const std::size_t row = rows[static_cast<std::size_t>(plot.height - 1 - y)];
    for (int x = 0; x < plot.width; ++x) {
      const std::size_t cell = row * map.columns + columns[static_cast<std::size_t>(x)];
      Colour colour = no_value_ground;
      if (is_hatched(map, cell)) {
        colour = hatched_colour(ground_colour(map.relief, (x + 0.5) / plot.width, 1.0 - (y + 0.5) / plot.height), x, y);
      } else if (is_valued(map, cell) && !map.categories.empty()) {
        colour = category_pixel(static_cast<std::size_t>(map.values[cell]), x, y);
      } else if (is_valued(map, cell) && layout.range) {
        colour = viridis(share_of_range(map.values[cell], *layout.range));
      }
      image.set_pixel(x, y, colour);
    }
  }
  return image;
}

}  // namespace detail

Image draw_cells(const HeatMap& map) {
  return detail::cells_image(map, heat_map_layout(map));
}

}  // namespace dcem::io
