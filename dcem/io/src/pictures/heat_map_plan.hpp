#pragma once
/// The layout of a map's picture: computed first, from the map alone, so that drawing has nothing left to decide.
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/io/heat_map.hpp"
#include "dcem/io/src/pictures/picture_axes.hpp"

namespace dcem::io::detail {

inline constexpr int bar_tip_px = 24;
inline constexpr int swatch_px = 36;

/// What stands before a text of the legend.
enum class Symbol { no_value, hatched, wall, window, transmitter, category, contour, none };

struct LegendItem {
  Symbol symbol = Symbol::none;
  std::string text;
  int x = 0;  // upper left corner, counted from that of the legend
  int y = 0;
  std::size_t category = 0;
};

/// Everything that the drawing needs to know.
struct HeatMapPlan {
  HeatMapLayout layout;
  FittedTitle title;  // to the width of the picture
  std::string bar_name;
  PictureFrame frame;  // the plot and its axes
  std::vector<Tick> bar_ticks;
  std::vector<LegendItem> legend;
  int legend_y = 0;
  int left_px = 0;  // where title, plot and legend begin
};

/// Checks the map (`std::invalid_argument`) and lays out its picture.
HeatMapPlan plan_heat_map(const HeatMap& map);

/// The cell is inside an object or on a wall.
bool is_hatched(const HeatMap& map, std::size_t cell);
/// The cell has a value to be shown.
bool is_valued(const HeatMap& map, std::size_t cell);
/// Lines of equal value are drawn; categories have none.
bool draws_contours(const HeatMap& map);
/// The place lies in the plot.
bool is_inside(const HeatMapLayout& layout, PixelPoint place);

}  // namespace dcem::io::detail
