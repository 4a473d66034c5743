#pragma once
/// The axes of line charts, which end at round numbers around the values. Private to dcem::io.
#include <span>

#include "dcem/io/line_chart.hpp"
#include "dcem/io/src/pictures/picture_axes.hpp"

namespace dcem::io::detail {

/// Throws std::invalid_argument for what cannot be drawn, as `write_line_charts` says.
void check_charts(std::span<const LineChart> charts);

/// The axis below the plots of these charts, `length_px` long.
PictureAxis chart_x_axis(std::span<const LineChart> charts, int length_px);
PictureAxis chart_y_axis(const LineChart& chart, int length_px);

}  // namespace dcem::io::detail
