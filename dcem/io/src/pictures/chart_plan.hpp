#pragma once
/// Where the parts of line charts lie: computed first, so that drawing has nothing left to decide. Private to dcem::io.
#include <span>
#include <string>
#include <vector>

#include "dcem/io/line_chart.hpp"
#include "dcem/io/src/pictures/picture_axes.hpp"

namespace dcem::io::detail {

/// A piece of a line between two gaps, in pixels; a single point is a dot.
struct ChartPiece {
  std::size_t series = 0;
  std::vector<PixelPoint> points{};
};

/// A line of the legend and its name to the right of it.
struct ChartLegendItem {
  PixelPoint line;  // its left end
  std::string text;
  std::size_t series = 0;
};

/// One chart.
struct ChartPlan {
  PictureFrame frame;
  AxisLabels x_labels = AxisLabels::all;
  std::vector<ChartPiece> pieces{};
  std::vector<ChartLegendItem> legend{};
  FittedTitle title{};
  PixelPoint title_at{};  // left end, middle of its capitals
};

/// A picture of charts.
struct ChartSheet {
  int width_px = 0, height_px = 0;
  FittedTitle title{};  // of all; may be empty
  std::vector<ChartPlan> charts{};
};

inline constexpr int legend_line_px = 70;

/// Colour and dashes of a series.
Stroke series_stroke(std::size_t series);

/// Checks the charts (std::invalid_argument) and lays them out one below the other.
ChartSheet plan_line_charts(std::span<const LineChart> charts);
/// The same as panels of one page over one x axis.
ChartSheet plan_panels(const std::string& title, std::span<const LineChart> charts);

void draw_charts(Canvas& canvas, const ChartSheet& sheet);

}  // namespace dcem::io::detail
