#pragma once
/// Pictures of values over a regular grid: coverage maps, delay maps, power over time and delay.
///
/// The picture has axes in metres at true aspect ratio, or two axes of other quantities, each at its own scale; a
/// colour bar with ticks and unit, a title, walls, transmitters and a legend. One grid point is one block of equal
/// pixels, never blended with its neighbours, unless `refined` has put finer ones between the points.
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/image.hpp"
#include "dcem/io/picture_format.hpp"
#include "dcem/io/value_range.hpp"

namespace dcem::io {

/// What the two axes of a picture are.
struct HeatMapAxes {
  std::string x_label = "x";
  std::string x_unit = "m";
  std::string y_label = "y";
  std::string y_unit = "m";
  /// A metre is as long along x as along y. False for axes that have nothing in common, such as time and delay: the
  /// plot then is about 1280 × 640 pixels, and all that this header names with `_m` is in `x_unit` or `y_unit`.
  bool to_scale = true;
};

/// Light on what stands on the ground, seen from above: tones over the whole plot, row by row, that of the smallest y
/// first; 0 is in the shade, 1 in full light.
struct Relief {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<float> tones{};
};

/// A map to be drawn. Grid point (column, row) lies at (origin_x_m + column · spacing_x_m, origin_y_m + row ·
/// spacing_y_m) in the middle of its cell, so the picture reaches half a spacing beyond the outer points.
struct HeatMap {
  /// A place to point out: a symbol with a label beside it.
  struct Marker {
    double x_m = 0.0;
    double y_m = 0.0;
    std::string label;
  };

  std::string title;
  std::string label = "received power";
  std::string unit = "dBm";
  HeatMapAxes axes{};
  std::string no_value_label = "no value";  // what the legend calls cells without a value
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  double spacing_x_m = 1.0;
  double spacing_y_m = 1.0;
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<double>
      values;  // in `unit`, row by row, the row of the smallest y first; not finite, or beyond ±1e100: no value
  std::vector<char> hatched;  // empty, or one per value; not 0 = inside an object or on a wall, hatched
  Relief relief{};            // shows in hatched cells; without tones they have an even ground
  /// Lines where the value, linear between the points, is a multiple of this, in `unit`; absent: none. None either
  /// where there are categories, or more than 1,000 levels.
  std::optional<double> contour_step{};
  std::string hatched_label = "inside an object or on a wall";  // what the legend calls hatched cells
  std::vector<std::array<double, 4>> walls_m;    // segments x0, y0, x1, y1; thin and grey between hatched cells
  std::vector<std::array<double, 4>> windows_m;  // the same: walls that let much through, drawn as a hollow line
  std::vector<Marker> transmitters;
  std::optional<ValueRange> range;  // ends of the colour bar; default: `default_value_range`
  /// Where this is not empty the values are numbers of these names, counted from 0. Each name has a colour and an entry
  /// in the legend, and there is no colour bar. Colours repeat after 21 names.
  std::vector<std::string> categories;
  std::vector<std::string> notes;  ///< what must be known of the values, below the legend
};

/// The colour range of a map that names none: from the 2nd percentile of its values (so that a few deep fades do not
/// take the colours from the rest) to their maximum, both rounded outwards to 5 for units that begin with "dB", else
/// to a tenth of the span rounded to 1, 2 or 5 · 10^n. Never of zero width; nothing where no value is drawn.
/// Throws as `heat_map_layout`.
std::optional<ValueRange> default_value_range(const HeatMap& map);

/// The same for the values of several maps that are to have the same colours.
std::optional<ValueRange> value_range(std::vector<double> values, const std::string& unit);

/// The map with `factor` × `factor` cells in place of each, linear between the points along both axes; within half a
/// cell of the rim, and beside points without a value, from those that there are. Cells without a value and hatched
/// ones stay as they are. Throws std::invalid_argument for a factor of zero and for categories; otherwise as
/// `heat_map_layout`.
HeatMap refined(const HeatMap& map, std::size_t factor);

/// Where the parts of the picture lie, in pixels of the PNG. SVG and PDF have 192 of them to the inch.
struct HeatMapLayout {
  int width_px = 0;
  int height_px = 0;
  PixelRect plot;         // the cells, without the frame around them
  PixelRect bar;          // the colours of the bar; empty where the map has no value
  double left_m = 0.0;    // x of the left edge of the plot
  double bottom_m = 0.0;  // y of its lower edge
  double horizontal_px_per_m = 1.0;
  double vertical_px_per_m = 1.0;  // the same, but for rounding, unless `to_scale` is false
  std::size_t sampling = 1;        // one point in so many along each axis is shown
  bool to_scale = true;  // false where a very long or flat grid was stretched to be seen at all, or `axes` say so
  std::optional<ValueRange> range;  // what the colours mean

  /// Continuous pixel coordinates of a place.
  [[nodiscard]] PixelPoint point(double x_m, double y_m) const {
    return {plot.x + (x_m - left_m) * horizontal_px_per_m, plot.bottom() - (y_m - bottom_m) * vertical_px_per_m};
  }
};

/// The layout of the picture. The longer side of the plot is about 1280 pixels: a whole number of pixels per
/// cell (at most 400), one pixel per cell for up to 2,000 cells, and one cell of k × k, its middle one, beyond. Axes
/// that are not to scale each follow this rule on their own, the upright one for 640 pixels.
/// Throws `std::invalid_argument` where sizes do not fit together, a spacing lies outside 1e-6…1e9 m or is lost beside
/// its origin (below 1e-12 of it), a coordinate is not finite, the range is empty, or a value is no number of a
/// category.
HeatMapLayout heat_map_layout(const HeatMap& map);

/// The cells alone, without axes and text, as many pixels as in the layout's plot. Values outside the colour range take
/// the colour of its end; cells without a value are light grey, cells in objects are hatched.
Image draw_cells(const HeatMap& map);

/// Draws the map into a file that appears only when complete; its ending says the format. Where values lie outside the
/// colour range the bar ends in a tip; the legend below says what there is to see. Labels of transmitters stand beside
/// them or, where others are in the way, above and below with a line to the symbol; those that come first choose first.
/// The legend counts those without room for one. Without Cairo a PNG has the cells alone, and other formats are
/// refused. Throws as `heat_map_layout` and `picture_format_of`, and `OutputError`.
void write_heat_map(const HeatMap& map, const std::filesystem::path& path);
/// The same into a file of an `OutputFolder`; the caller commits.
void write_heat_map(const HeatMap& map, AtomicFile& file, PictureFormat format);

}  // namespace dcem::io
