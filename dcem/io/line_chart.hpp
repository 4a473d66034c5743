#pragma once
/// Line charts: a result over time, several runs side by side, panels of a drive on one page.
///
/// Colours are those of Okabe and Ito (2002), which colour-blind readers can tell
/// apart; each line has dashes of its own as well.
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/picture_format.hpp"

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

/// Draws charts, one below the other, each with a plot of about 1200 × 480 pixels (of the PNG; SVG and PDF have 192 of
/// them to the inch) and its legend on the right.
/// Throws std::invalid_argument without a chart, for a chart without series or with too many, for x and y of different
/// lengths, for x that descends or is NaN, for numbers that are infinite or beyond ±1e100, and for values on a
/// logarithmic axis that are not above zero (1e-100 at least); `OutputError` also where this build cannot draw.
void write_line_charts(std::span<const LineChart> charts, AtomicFile& file, PictureFormat format);
/// The same into a file that appears only when complete; its ending says the format.
void write_line_charts(std::span<const LineChart> charts, const std::filesystem::path& path);

/// Draws charts over the same x as panels (a), (b), (c)… of one page 17 cm wide, the width of a page of a paper, under
/// one title: one x axis below, the legend of each panel above it. The x axis spans all of their values. Throws as
/// `write_line_charts`.
void write_panels(const std::string& title, std::span<const LineChart> charts, AtomicFile& file, PictureFormat format);
void write_panels(const std::string& title, std::span<const LineChart> charts, const std::filesystem::path& path);

}  // namespace dcem::io
