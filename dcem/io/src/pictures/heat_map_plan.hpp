#pragma once
/// The layout of a map's picture: computed first, from the map alone, so that drawing has nothing left to decide.
#include <cstddef>
#include <optional>
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

/// Areas that labels must not cover.
class TakenPlaces {
 public:
  explicit TakenPlaces(const PixelRect& plot) : plot_(plot) {}

  void take(const PixelRect& area) { taken_.push_back(area); }
  bool is_free(const PixelRect& area) const;

 private:
  PixelRect plot_;
  std::vector<PixelRect> taken_;
};

/// A transmitter within the plot.
struct SeenMarker {
  PixelPoint centre;
  std::string label{};               // as it is written; may be empty
  std::optional<PixelRect> plate{};  // where it is written: nothing where no place is free
  bool is_led = false;               // a line leads from the symbol to a label that is not beside it
};

/// What is drawn of walls, in pixels.
struct SeenWalls {
  std::vector<Segment> outer, inner, windows;  // `inner`: thin and grey, between hatched cells
};

/// Everything that the drawing needs to know.
struct HeatMapPlan {
  HeatMapLayout layout;
  FittedTitle title;  // to the width of the picture
  std::string bar_name;
  PictureFrame frame;  // the plot and its axes
  std::vector<Tick> bar_ticks;
  std::vector<SeenMarker> markers;
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
/// A city at two pixels per metre would drown in thick lines.
double wall_thickness_px(const HeatMap& map);
/// Walls within the plot and up to `seam_px` beyond its rim.
SeenWalls seen_walls(const HeatMap& map, const HeatMapLayout& layout, double seam_px);

inline constexpr double marker_radius_px = 15.0;
inline constexpr int label_padding_px = 6;
/// The area of a symbol, and that of a text on a plate about a place.
PixelRect marker_area(PixelPoint centre);
PixelRect plate_about(PixelPoint middle, const std::string& text, const TextStyle& style);
/// The transmitters within the plot, their labels beside them or, where it is crowded, above and below; those that come
/// first choose first.
std::vector<SeenMarker> seen_markers(const HeatMap& map, const HeatMapLayout& layout);

}  // namespace dcem::io::detail
