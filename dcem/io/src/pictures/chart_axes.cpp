#include "dcem/io/src/pictures/chart_axes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dcem/io/text_table.hpp"

namespace dcem::io::detail {
namespace {

void require_chart(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument("line chart: " + message);
}

void check_series(const LineChart::Series& series, bool logarithmic) {
  const std::string name = "series '" + series.name + "': ";
  require_chart(series.x.size() == series.y.size(), name + "expected as many y as x");
  for (std::size_t index = 0; index < series.x.size(); ++index) {
    const double x = series.x[index], y = series.y[index];
    require_chart(std::abs(x) <= 1e100, name + "expected x within 1e100");
    require_chart(index == 0 || x >= series.x[index - 1], name + "expected x that does not descend");
    require_chart(std::isnan(y) || std::abs(y) <= 1e100, name + "expected y within 1e100, or NaN for a gap");
    require_chart(!logarithmic || std::isnan(y) || y >= 1e-100, name + "expected y above zero on a logarithmic axis");
  }
}

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool is_empty() const { return low > high; }
  // Something to draw an axis over, whatever the values: around a single one, and where there is none.
  Span with_length() const {
    if (is_empty()) return {0.0, 1.0};
    const double size = std::max(std::abs(low), std::abs(high));
    if (high - low > 1e-9 * size) return *this;
    const double pad = size > 0.0 ? 0.1 * size : 1.0;
    return {low - pad, high + pad};
  }
};

// A linear axis of round ends.
PictureAxis linear_axis(const Span& values, int length_px, bool is_horizontal) {
  PictureAxis axis;
  const int gap = is_horizontal ? 150 : 56;
  const double step = round_step_at_least((values.high - values.low) * gap / length_px);
  const double low = step * std::floor(values.low / step + 1e-9), high = step * std::ceil(values.high / step - 1e-9);
  axis.low = low;
  axis.px_per_unit = length_px / (high - low);
  axis.ticks = is_horizontal ? horizontal_axis_ticks(low, high, length_px) : axis_ticks(low, high, length_px, gap);
  return axis;
}

std::string power_of_ten_label(int decade) {
  if (decade < -4 || decade > 6) return "1e" + std::to_string(decade);
  return format_fixed(std::pow(10.0, decade), std::max(0, -decade));
}

std::string logarithmic_label(int factor, int decade) {
  const bool is_plain = decade >= -4 && decade <= 6;
  return is_plain ? format_fixed(factor * std::pow(10.0, decade), std::max(0, -decade))
                  : std::to_string(factor) + "e" + std::to_string(decade);
}

// Whole decades; over few of them 2 and 5 are marked as well, over many not every one.
PictureAxis logarithmic_axis(const Span& values, int length_px) {
  const int low = static_cast<int>(std::floor(std::log10(values.low) + 1e-9));
  const int high = std::max(low + 1, static_cast<int>(std::ceil(std::log10(values.high) - 1e-9)));
  PictureAxis axis{{}, {}, static_cast<double>(low), length_px / static_cast<double>(high - low), true};
  const int stride = (high - low + 7) / 8;
  for (int decade = low; decade <= high; decade += stride) {
    axis.ticks.push_back({std::pow(10.0, decade), power_of_ten_label(decade)});
    if (high - low > 2 || decade == high) continue;
    for (const int factor : {2, 5}) {
      axis.ticks.push_back({factor * std::pow(10.0, decade), logarithmic_label(factor, decade)});
    }
  }
  return axis;
}

}  // namespace

void check_charts(std::span<const LineChart> charts) {
  require_chart(!charts.empty(), "expected at least one chart");
  for (const LineChart& chart : charts) {
    require_chart(!chart.series.empty(), "expected at least one series");
    require_chart(chart.series.size() <= maximum_chart_series,
                  "expected at most " + std::to_string(maximum_chart_series) + " series");
    for (const LineChart::Series& series : chart.series) {
      check_series(series, chart.y_scale == ChartScale::logarithmic);
    }
  }
}

PictureAxis chart_x_axis(std::span<const LineChart> charts, int length_px) {
  Span values;
  for (const LineChart& chart : charts) {
    for (const LineChart::Series& series : chart.series) {
      for (const double x : series.x) values.extend(x);
    }
  }
  PictureAxis axis = linear_axis(values.with_length(), length_px, true);
  axis.name = axis_name(charts.back().x_label, charts.back().x_unit);
  return axis;
}

PictureAxis chart_y_axis(const LineChart& chart, int length_px) {
  Span values;
  for (const LineChart::Series& series : chart.series) {
    for (const double y : series.y) values.extend(y);
  }
  if (chart.y_scale == ChartScale::linear_from_zero) values.extend(0.0);
  const bool is_logarithmic = chart.y_scale == ChartScale::logarithmic;
  PictureAxis axis = is_logarithmic ? logarithmic_axis(values.is_empty() ? Span{1.0, 10.0} : values, length_px)
                                    : linear_axis(values.with_length(), length_px, false);
  axis.name = axis_name(chart.y_label, chart.y_unit);
  return axis;
}

}  // namespace dcem::io::detail
