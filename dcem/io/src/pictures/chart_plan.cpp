#include "dcem/io/src/pictures/chart_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/io/src/pictures/chart_axes.hpp"

namespace dcem::io::detail {
namespace {

constexpr int chart_plot_width_px = 1200, chart_plot_height_px = 480, chart_legend_gap_px = 36,
              chart_legend_row_px = 44;
constexpr int panel_page_px = 1285;  // 17 cm
constexpr int panel_height_px = 300, panel_gap_px = 34, panel_legend_px = 44;
constexpr int legend_between_px = 34;

struct SeriesLook {
  Colour colour;
  std::vector<double> dashes_px;  // empty: a full line
};

// Okabe, Ito: "Color Universal Design" (2002), without the yellow, which is too pale on white; each with dashes of its
// own, so that lines can be told apart in grey.
const SeriesLook& series_look(std::size_t series) {
  static const std::array<SeriesLook, maximum_chart_series> looks{{{{0, 114, 178}, {}},
                                                                   {{213, 94, 0}, {18, 8}},
                                                                   {{0, 158, 115}, {4, 6}},
                                                                   {{204, 121, 167}, {24, 6, 4, 6}},
                                                                   {{0, 0, 0}, {10, 6}},
                                                                   {{230, 159, 0}, {32, 10}},
                                                                   {{86, 180, 233}, {18, 6, 4, 6, 4, 6}}}};
  return looks[series];
}

// The points from one gap to the next.
std::vector<ChartPiece> pieces_of(const LineChart& chart, const PictureFrame& frame) {
  std::vector<ChartPiece> pieces;
  for (std::size_t number = 0; number < chart.series.size(); ++number) {
    const LineChart::Series& series = chart.series[number];
    bool goes_on = false;
    for (std::size_t index = 0; index < series.y.size(); ++index) {
      const bool has_value = !std::isnan(series.y[index]);
      if (has_value && !goes_on) pieces.push_back({number});
      if (has_value) pieces.back().points.push_back(frame.point(series.x[index], series.y[index]));
      goes_on = has_value;
    }
  }
  return pieces;
}

std::string legend_name(const LineChart::Series& series) {
  return fit_text(series.name, label_style, longest_name_px);
}

int legend_width_px(const std::string& name) {
  return legend_line_px + gap_px + label_length_px(name);
}

// One below the other, to the right of the plot.
std::vector<ChartLegendItem> upright_legend(const LineChart& chart, const PixelRect& plot) {
  std::vector<ChartLegendItem> items;
  PixelPoint place{double(plot.right() + chart_legend_gap_px), plot.y + 18.0};
  for (std::size_t series = 0; series < chart.series.size(); ++series, place.y += chart_legend_row_px) {
    items.push_back({place, legend_name(chart.series[series]), series});
  }
  return items;
}

// Side by side above the plot, up to its right end; none of a single line, which the panel's title names.
std::vector<ChartLegendItem> level_legend(const LineChart& chart, const PixelRect& plot) {
  std::vector<ChartLegendItem> items;
  if (chart.series.size() < 2) return items;
  double x = plot.right();
  for (std::size_t series = chart.series.size(); series-- > 0;) {
    const std::string name = legend_name(chart.series[series]);
    x -= legend_width_px(name);
    items.push_back({{x, plot.y - 0.5 * panel_legend_px}, name, series});
    x -= legend_between_px;
  }
  return items;
}

// Room for the upright name of the y axis and for its labels; the same for all charts, so that they stand in line.
int common_left_px(const std::vector<PictureAxis>& y_axes, const PictureAxis& x_axis) {
  int left = 0;
  for (const PictureAxis& y : y_axes) left = std::max(left, plot_left_px(x_axis.ticks, y.ticks));
  return left;
}

std::vector<PictureAxis> y_axes_of(std::span<const LineChart> charts, int length_px) {
  std::vector<PictureAxis> axes;
  for (const LineChart& chart : charts) axes.push_back(chart_y_axis(chart, length_px));
  return axes;
}

int widest_legend_px(std::span<const LineChart> charts) {
  int widest = 0;
  for (const LineChart& chart : charts) {
    for (const LineChart::Series& series : chart.series)
      widest = std::max(widest, legend_width_px(legend_name(series)));
  }
  return widest;
}

void draw_chart_series(Canvas& canvas, const ChartPiece& piece) {
  const Stroke stroke = series_stroke(piece.series);
  if (piece.points.size() > 1) return canvas.draw_line(piece.points, stroke);
  canvas.fill_disc(piece.points.front(), 6.0, stroke.colour);
}

void draw_chart(Canvas& canvas, const ChartPlan& chart) {
  draw_grid_lines(canvas, chart.frame);
  for (const ChartPiece& piece : chart.pieces) draw_chart_series(canvas, piece);
  draw_axes(canvas, chart.frame, chart.x_labels);
  for (const ChartLegendItem& item : chart.legend) {
    const PixelPoint end{item.line.x + legend_line_px, item.line.y};
    canvas.draw_line(std::array{item.line, end}, series_stroke(item.series));
    canvas.draw_text({{end.x + gap_px, end.y}}, item.text, label_style);
  }
  draw_title(canvas, chart.title, chart.title_at);
}

}  // namespace

Stroke series_stroke(std::size_t series) {
  const SeriesLook& look = series_look(series);
  return {look.colour, 4.0, 1.0, look.dashes_px};
}

ChartSheet plan_line_charts(std::span<const LineChart> charts) {
  check_charts(charts);
  constexpr int between_px = 24;
  ChartSheet sheet;
  const std::vector<PictureAxis> y_axes = y_axes_of(charts, chart_plot_height_px);
  std::vector<PictureAxis> x_axes;
  int left = 0;
  for (const LineChart& chart : charts) {
    x_axes.push_back(chart_x_axis({&chart, 1}, chart_plot_width_px));
    left = std::max(left, common_left_px(y_axes, x_axes.back()));
  }
  sheet.width_px = left + chart_plot_width_px + chart_legend_gap_px + widest_legend_px(charts) + margin_px;
  for (std::size_t index = 0; index < charts.size(); ++index) {
    const FittedTitle title = fit_title(charts[index].title, sheet.width_px - left - margin_px);
    const int top = sheet.height_px + title_bottom_px + title.more_px();
    const PixelRect plot{left, top, chart_plot_width_px, chart_plot_height_px};
    ChartPlan plan{{plot, x_axes[index], y_axes[index]}};
    plan.pieces = pieces_of(charts[index], plan.frame);
    plan.legend = upright_legend(charts[index], plot);
    plan.title = title;
    plan.title_at = {double(left), sheet.height_px + margin_px + 0.5 * title_style.capital_px()};
    sheet.charts.push_back(std::move(plan));
    sheet.height_px = plot.bottom() + x_axis_height_px() + between_px;
  }
  return sheet;
}

ChartSheet plan_panels(const std::string& title, std::span<const LineChart> charts) {
  check_charts(charts);
  ChartSheet sheet{panel_page_px, title_bottom_px};
  const std::vector<PictureAxis> y_axes = y_axes_of(charts, panel_height_px);
  const int left = common_left_px(y_axes, chart_x_axis(charts, panel_page_px));
  const int width = panel_page_px - left - 2 * margin_px;
  const PictureAxis x_axis = chart_x_axis(charts, width);
  sheet.title = fit_title(title, width);
  sheet.height_px += sheet.title.more_px();
  for (std::size_t index = 0; index < charts.size(); ++index) {
    const PixelRect plot{left, sheet.height_px + panel_legend_px, width, panel_height_px};
    ChartPlan plan{{plot, x_axis, y_axes[index]}};
    if (index + 1 < charts.size()) plan.x_labels = AxisLabels::ticks_alone;
    plan.pieces = pieces_of(charts[index], plan.frame);
    plan.legend = level_legend(charts[index], plot);
    plan.title.text = "(" + std::string(1, static_cast<char>('a' + index)) + ") " + charts[index].title;
    plan.title.style = {label_style.size_px, true};
    plan.title_at = {double(left), plot.y - 0.5 * panel_legend_px};
    sheet.charts.push_back(std::move(plan));
    sheet.height_px = plot.bottom() + panel_gap_px;
  }
  sheet.height_px += x_axis_height_px();
  return sheet;
}

void draw_charts(Canvas& canvas, const ChartSheet& sheet) {
  for (const ChartPlan& chart : sheet.charts) draw_chart(canvas, chart);
  if (!sheet.title.text.empty()) draw_title(canvas, sheet.title, sheet.charts.front().frame.plot.x);
}

}  // namespace dcem::io::detail
