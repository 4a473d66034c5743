#include "dcem/io/line_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "dcem/io/src/pictures/axis_ticks.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

using detail::Tick;

struct LineStyle {
  const char* colour;
  const char* dashes;  // empty: a full line
};

// Okabe, Ito: "Color Universal Design" (2002), without the yellow, which is too pale on white.
constexpr std::array<LineStyle, maximum_chart_series> line_styles{{{"#0072B2", ""},
                                                                   {"#D55E00", "9 4"},
                                                                   {"#009E73", "2 3"},
                                                                   {"#CC79A7", "12 3 2 3"},
                                                                   {"#000000", "5 3"},
                                                                   {"#E69F00", "16 5"},
                                                                   {"#56B4E9", "9 3 2 3 2 3"}}};

// All sizes in pixels. Widths of letters are those of wide fonts, so that texts have room in any.
constexpr int plot_top = 52, plot_width = 680, plot_height = 280;
constexpr int chart_height = plot_top + plot_height + 68;
constexpr int letter_width = 9, legend_gap = 20, legend_line = 38, legend_row = 24;

// An axis: where its ends are in the picture, and what they mean. A logarithmic one counts in decades.
struct Axis {
  double low = 0.0, high = 1.0;
  int low_px = 0, high_px = 1;
  bool logarithmic = false;
  std::vector<Tick> ticks{};

  double position_px(double value) const {
    const double place = logarithmic ? std::log10(value) : value;
    return low_px + (place - low) / (high - low) * (high_px - low_px);
  }
};

std::string pixels(double value) {
  return format_fixed(value, 2);
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      // XML has no way to write a control character.
      default:
        result += static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f ? ' ' : letter;
    }
  }
  return result;
}

void require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument("line chart: " + message);
}

void check(const LineChart::Series& series, bool logarithmic) {
  const std::string name = "series '" + series.name + "': ";
  require(series.x.size() == series.y.size(), name + "expected as many y as x");
  for (std::size_t index = 0; index < series.x.size(); ++index) {
    const double x = series.x[index], y = series.y[index];
    require(std::abs(x) <= 1e100, name + "expected x within 1e100");
    require(index == 0 || x >= series.x[index - 1], name + "expected x that does not descend");
    require(std::isnan(y) || std::abs(y) <= 1e100, name + "expected y within 1e100, or NaN for a gap");
    require(!logarithmic || std::isnan(y) || y >= 1e-100, name + "expected y above zero on a logarithmic axis");
  }
}

void check(const LineChart& chart) {
  require(!chart.series.empty(), "expected at least one series");
  require(chart.series.size() <= maximum_chart_series,
          "expected at most " + std::to_string(maximum_chart_series) + " series");
  for (const LineChart::Series& series : chart.series) check(series, chart.y_scale == ChartScale::logarithmic);
}

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // Something to draw an axis over, whatever the values: around a single one, and where there is none.
  Span with_length() const {
    if (low > high) return {0.0, 1.0};
    const double size = std::max(std::abs(low), std::abs(high));
    if (high - low > 1e-9 * size) return *this;
    const double pad = size > 0.0 ? 0.1 * size : 1.0;
    return {low - pad, high + pad};
  }
};

// A linear axis of round ends.
Axis linear_axis(const Span& values, int low_px, int high_px, bool is_horizontal) {
  Axis axis{values.low, values.high, low_px, high_px};
  const int length_px = std::abs(high_px - low_px), gap_px = is_horizontal ? 90 : 45;
  const double step = detail::round_step_at_least((axis.high - axis.low) * gap_px / length_px);
  axis.low = step * std::floor(axis.low / step + 1e-9);
  axis.high = step * std::ceil(axis.high / step - 1e-9);
  axis.ticks = is_horizontal ? detail::horizontal_axis_ticks(axis.low, axis.high, length_px)
                             : detail::axis_ticks(axis.low, axis.high, length_px, gap_px);
  return axis;
}

std::string power_of_ten_label(int decade) {
  if (decade < -4 || decade > 6) return "1e" + std::to_string(decade);
  return format_fixed(std::pow(10.0, decade), std::max(0, -decade));
}

// Whole decades; over few of them 2 and 5 are marked as well, over many not every one.
Axis logarithmic_axis(const Span& values, int low_px, int high_px) {
  const int low = static_cast<int>(std::floor(std::log10(values.low) + 1e-9));
  const int high = std::max(low + 1, static_cast<int>(std::ceil(std::log10(values.high) - 1e-9)));
  Axis axis{static_cast<double>(low), static_cast<double>(high), low_px, high_px, true};
  const int stride = (high - low + 7) / 8;
  for (int decade = low; decade <= high; decade += stride) {
    axis.ticks.push_back({std::pow(10.0, decade), power_of_ten_label(decade)});
    if (high - low > 2 || decade == high) continue;
    for (const int factor : {2, 5}) {
      const double value = factor * std::pow(10.0, decade);
      const bool is_plain = decade >= -4 && decade <= 6;
      axis.ticks.push_back({value, is_plain ? format_fixed(value, std::max(0, -decade))
                                            : std::to_string(factor) + "e" + std::to_string(decade)});
    }
  }
  return axis;
}

Axis x_axis(const LineChart& chart, int plot_left) {
  Span values;
  for (const LineChart::Series& series : chart.series) {
    for (const double x : series.x) values.extend(x);
  }
  return linear_axis(values.with_length(), plot_left, plot_left + plot_width, true);
}

Axis y_axis(const LineChart& chart) {
  Span values;
  for (const LineChart::Series& series : chart.series) {
    for (const double y : series.y) values.extend(y);
  }
  const int low_px = plot_top + plot_height;
  if (chart.y_scale == ChartScale::logarithmic) {
    return logarithmic_axis(values.low > values.high ? Span{1.0, 10.0} : values, low_px, plot_top);
  }
  if (chart.y_scale == ChartScale::linear_from_zero) values.extend(0.0);
  return linear_axis(values.with_length(), low_px, plot_top, false);
}

std::string text_element(double x, double y, const std::string& attributes, std::string_view text) {
  return "<text x=\"" + pixels(x) + "\" y=\"" + pixels(y) + "\"" + attributes + ">" + escaped(text) + "</text>\n";
}

std::string line_element(double x0, double y0, double x1, double y1, const std::string& attributes) {
  return "<line x1=\"" + pixels(x0) + "\" y1=\"" + pixels(y0) + "\" x2=\"" + pixels(x1) + "\" y2=\"" + pixels(y1) +
         "\" " + attributes + "/>\n";
}

std::string stroke(const LineStyle& style) {
  std::string text = "stroke=\"" + std::string(style.colour) + "\" stroke-width=\"2\"";
  if (*style.dashes != '\0') text += " stroke-dasharray=\"" + std::string(style.dashes) + "\"";
  return text;
}

std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label + " (" + unit + ")";
}

constexpr const char* grid_stroke = "stroke=\"#dddddd\"";

std::string draw_axes(const LineChart& chart, const Axis& x, const Axis& y) {
  const int plot_left = x.low_px, right = x.high_px, bottom = plot_top + plot_height;
  std::string svg;
  for (const Tick& tick : x.ticks) {
    const double place = x.position_px(tick.value);
    svg += line_element(place, plot_top, place, bottom + 5, grid_stroke);
    svg += text_element(place, bottom + 21, " text-anchor=\"middle\"", tick.label);
  }
  for (const Tick& tick : y.ticks) {
    const double place = y.position_px(tick.value);
    svg += line_element(plot_left - 5, place, right, place, grid_stroke);
    svg += text_element(plot_left - 10, place + 5, " text-anchor=\"end\"", tick.label);
  }
  svg += "<rect class=\"plot\" x=\"" + pixels(plot_left) + "\" y=\"" + pixels(plot_top) + "\" width=\"" +
         pixels(plot_width) + "\" height=\"" + pixels(plot_height) + "\" fill=\"none\" stroke=\"#333333\"/>\n";
  svg += text_element(plot_left + plot_width / 2, bottom + 46, " text-anchor=\"middle\"",
                      with_unit(chart.x_label, chart.x_unit));
  const std::string upright =
      " text-anchor=\"middle\" transform=\"rotate(-90 20 " + pixels(plot_top + plot_height / 2) + ")\"";
  return svg + text_element(20, plot_top + plot_height / 2, upright, with_unit(chart.y_label, chart.y_unit));
}

// The points from `first` to the next gap.
std::string draw_piece(const LineChart::Series& series, std::size_t first, std::size_t last, const LineStyle& style,
                       const Axis& x, const Axis& y) {
  const auto place = [&](std::size_t index, const char* between) {
    return pixels(x.position_px(series.x[index])) + between + pixels(y.position_px(series.y[index]));
  };
  if (last - first == 1) {
    return "<circle class=\"series\" cx=\"" + place(first, "\" cy=\"") + "\" r=\"3\" fill=\"" + style.colour + "\"/>\n";
  }
  std::string svg =
      "<polyline class=\"series\" fill=\"none\" stroke-linejoin=\"round\" " + stroke(style) + " points=\"";
  for (std::size_t index = first; index < last; ++index) svg += (index > first ? " " : "") + place(index, ",");
  return svg + "\"/>\n";
}

std::string draw_series(const LineChart::Series& series, const LineStyle& style, const Axis& x, const Axis& y) {
  std::string svg;
  std::size_t first = 0;
  for (std::size_t index = 0; index <= series.y.size(); ++index) {
    if (index < series.y.size() && !std::isnan(series.y[index])) continue;
    if (index > first) svg += draw_piece(series, first, index, style, x, y);
    first = index + 1;
  }
  return svg;
}

std::string draw_legend(const LineChart& chart, int plot_right) {
  const int left = plot_right + legend_gap;
  std::string svg;
  int row = plot_top + 10;
  for (std::size_t index = 0; index < chart.series.size(); ++index, row += legend_row) {
    svg += line_element(left, row, left + legend_line, row, stroke(line_styles[index]));
    svg += text_element(left + legend_line + 8, row + 5, "", chart.series[index].name);
  }
  return svg;
}

std::string draw(const LineChart& chart, int plot_left) {
  const Axis x = x_axis(chart, plot_left), y = y_axis(chart);
  std::string svg = draw_axes(chart, x, y);
  for (std::size_t index = 0; index < chart.series.size(); ++index) {
    svg += draw_series(chart.series[index], line_styles[index], x, y);
  }
  svg += draw_legend(chart, x.high_px);
  return svg + text_element(plot_left, plot_top - 20, " font-size=\"17\" font-weight=\"bold\"", chart.title);
}

// Room for the upright name of the y axis and for its labels; the same for all charts, so that they stand in line.
int plot_left_of(std::span<const LineChart> charts) {
  std::size_t letters = 0;
  for (const LineChart& chart : charts) {
    for (const Tick& tick : y_axis(chart).ticks) letters = std::max(letters, character_count(tick.label));
  }
  return 40 + static_cast<int>(letters) * letter_width;
}

int picture_width(std::span<const LineChart> charts) {
  std::size_t letters = 0;
  for (const LineChart& chart : charts) {
    for (const LineChart::Series& series : chart.series) letters = std::max(letters, character_count(series.name));
  }
  return plot_left_of(charts) + plot_width + legend_gap + legend_line + 8 + static_cast<int>(letters) * letter_width +
         12;
}

}  // namespace

std::string line_chart_svg(std::span<const LineChart> charts) {
  require(!charts.empty(), "expected at least one chart");
  for (const LineChart& chart : charts) check(chart);
  const int plot_left = plot_left_of(charts);
  const std::string width = std::to_string(picture_width(charts));
  const std::string height = std::to_string(chart_height * static_cast<int>(charts.size()));
  std::string svg = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                    width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height +
                    "\" font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\" font-size=\"14\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (std::size_t index = 0; index < charts.size(); ++index) {
    svg += "<g transform=\"translate(0 " + std::to_string(chart_height * static_cast<int>(index)) + ")\">\n";
    svg += draw(charts[index], plot_left) + "</g>\n";
  }
  return svg + "</svg>\n";
}

std::string line_chart_svg(const LineChart& chart) {
  return line_chart_svg(std::span(&chart, 1));
}

void write_line_chart_svg(std::span<const LineChart> charts, const std::filesystem::path& path) {
  AtomicFile file(path);
  file.write(line_chart_svg(charts));
  file.commit();
}

}  // namespace dcem::io
