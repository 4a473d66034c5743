#pragma once
/// Line charts as SVG: a result over time, several runs side by side.
///
/// The bytes depend on the chart alone. Colours are those of Okabe and Ito (2002), which colour-blind readers can tell
/// apart; each line has dashes of its own as well.
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

/// What the y axis of a chart spans.
enum class ChartScale {
  linear,            ///< from the lowest to the highest value
  linear_from_zero,  ///< the same with zero in it
  logarithmic        ///< base ten; every value must be above zero
};

/// One chart. The axes end at round numbers around the values.
struct LineChart {
  /// One line. Where y is NaN the line has a gap; a value alone between gaps is a dot.
  struct Series {
    std::string name;         ///< for the legend
    std::vector<double> x{};  ///< in `x_unit`, never descending
    std::vector<double> y{};  ///< in `y_unit`, one per x
  };

  std::string title;
  std::string x_label = "time";
  std::string x_unit = "s";  ///< without a unit: empty
  std::string y_label;
  std::string y_unit{};
  ChartScale y_scale = ChartScale::linear;
  std::vector<Series> series{};
};

/// So many lines have a colour and dashes of their own.
inline constexpr std::size_t maximum_chart_series = 7;

/// The SVG text of charts, one below the other, each about 800 × 400 pixels with its legend on the right. The frame of
/// each plot is a `rect` of class "plot", each line a `polyline` or, for a value alone, a `circle`, of class "series".
/// Throws std::invalid_argument without a chart, for a chart without series or with too many, for x and y of different
/// lengths, for x that descends or is NaN, for numbers that are infinite or beyond ±1e100, and for values on a
/// logarithmic axis that are not above zero (1e-100 at least).
std::string line_chart_svg(std::span<const LineChart> charts);
/// The same for a single chart.
std::string line_chart_svg(const LineChart& chart);

/// `line_chart_svg` into a file that appears only when complete. Throws as that does, and `OutputError`.
void write_line_chart_svg(std::span<const LineChart> charts, const std::filesystem::path& path);

}  // namespace dcem::io
