#include "dcem/io/scatter_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

#include "dcem/core/random.hpp"
#include "dcem/io/src/pictures/picture_axes.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

using namespace detail;

constexpr int plot_width_px = 1280, plot_height_px = 720, legend_row_px = 50, legend_between_px = 44;
constexpr double largest_radius_px = 10.0, smallest_radius_px = 1.6;

struct Bounds {
  double low = 0.0, high = 1.0;
};

void check(const ScatterChart& chart) {
  if (chart.dots.empty()) throw std::invalid_argument("scatter chart: expected at least one dot");
  for (const ScatterChart::Dot& dot : chart.dots) {
    const bool sound = std::abs(dot.x) <= 1e100 && std::abs(dot.y) <= 1e100 && std::abs(dot.value) <= 1e100;
    if (!sound) throw std::invalid_argument("scatter chart: expected finite numbers within 1e100");
  }
}

// The values with a margin on both sides, so that no dot lies on the frame.
template <typename Quantity>
Bounds padded_bounds(const ScatterChart& chart, Quantity&& quantity) {
  Bounds bounds{quantity(chart.dots.front()), quantity(chart.dots.front())};
  for (const ScatterChart::Dot& dot : chart.dots) {
    bounds.low = std::min(bounds.low, quantity(dot));
    bounds.high = std::max(bounds.high, quantity(dot));
  }
  const double size = std::max(std::abs(bounds.low), std::abs(bounds.high));
  // Values that differ by rounding alone count as equal.
  const bool equal = bounds.high - bounds.low <= 1e-9 * size;
  const double pad = equal ? (size > 0.0 ? 0.05 * size : 1.0) : 0.04 * (bounds.high - bounds.low);
  return {bounds.low - pad, bounds.high + pad};
}

struct ScatterPlan {
  PictureFrame frame;
  FittedTitle title;
  int right_px = 0;        // from the plot to the rim of the picture
  double top_value = 0.0;  // of the largest dots
  double radius_px = largest_radius_px;

  PixelPoint point(const ScatterChart::Dot& dot) const { return frame.point(dot.x, dot.y); }
};

// Dots side by side should just touch, however many instants there are.
double largest_radius_for(const ScatterChart& chart) {
  std::vector<double> places;
  for (const ScatterChart::Dot& dot : chart.dots) places.push_back(dot.x);
  std::sort(places.begin(), places.end());
  const auto count = std::unique(places.begin(), places.end()) - places.begin();
  return std::clamp(0.7 * plot_width_px / static_cast<double>(count), 4.0, largest_radius_px);
}

ScatterPlan plan_of(const ScatterChart& chart) {
  ScatterPlan plan;
  const Bounds x = padded_bounds(chart, [](const ScatterChart::Dot& dot) { return dot.x; });
  const Bounds y = padded_bounds(chart, [](const ScatterChart::Dot& dot) { return dot.y; });
  plan.frame.x = {horizontal_axis_ticks(x.low, x.high, plot_width_px), axis_name(chart.x_label, chart.x_unit), x.low,
                  plot_width_px / (x.high - x.low)};
  plan.frame.y = {axis_ticks(y.low, y.high, plot_height_px, 90), axis_name(chart.y_label, chart.y_unit), y.low,
                  plot_height_px / (y.high - y.low)};
  plan.right_px = margin_px + std::max(margin_px, longest_label_px(plan.frame.x.ticks) / 2);
  plan.title = fit_title(chart.title, plot_width_px + plan.right_px - margin_px);
  plan.frame.plot = {plot_left_px(plan.frame.x.ticks, plan.frame.y.ticks), title_bottom_px + plan.title.more_px(),
                     plot_width_px, plot_height_px};
  plan.top_value = chart.dots.front().value;
  for (const ScatterChart::Dot& dot : chart.dots) plan.top_value = std::max(plan.top_value, dot.value);
  plan.top_value = 10.0 * std::ceil(plan.top_value / 10.0);
  plan.radius_px = largest_radius_for(chart);
  return plan;
}

// 1 for the largest values, 0 for the smallest dots.
double strength(const ScatterChart& chart, const ScatterPlan& plan, double value) {
  return std::clamp(1.0 - (plan.top_value - value) / chart.value_span, 0.0, 1.0);
}

double radius_px(const ScatterChart& chart, const ScatterPlan& plan, double value) {
  return smallest_radius_px + strength(chart, plan, value) * (plan.radius_px - smallest_radius_px);
}

Colour colour_of(const ScatterChart::Dot& dot) {
  return dot.is_marked ? Colour{0, 0, 0} : trace_colour(dot.trace);
}

void draw_lines(Canvas& canvas, const ScatterChart& chart, const ScatterPlan& plan) {
  std::unordered_map<std::uint64_t, const ScatterChart::Dot*> last;
  for (const ScatterChart::Dot& dot : chart.dots) {
    const auto before = last.find(dot.trace);
    if (dot.joins_last && before != last.end()) {
      const double opacity = 0.3 + 0.5 * strength(chart, plan, dot.value);
      canvas.draw_line(std::array{plan.point(*before->second), plan.point(dot)}, {colour_of(dot), 2.0, opacity});
    }
    last[dot.trace] = &dot;
  }
}

void draw_dots(Canvas& canvas, const ScatterChart& chart, const ScatterPlan& plan) {
  std::vector<const ScatterChart::Dot*> order;
  for (const ScatterChart::Dot& dot : chart.dots) order.push_back(&dot);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->value < b->value; });
  for (const ScatterChart::Dot* dot : order) {
    canvas.fill_disc(plan.point(*dot), radius_px(chart, plan, dot->value), colour_of(*dot));
  }
}

// A dot with a text to its right; returns where the next one may begin.
int draw_legend_dot(Canvas& canvas, PixelPoint place, double radius, Colour colour, const std::string& text) {
  canvas.fill_disc({place.x + largest_radius_px, place.y}, radius, colour);
  const double text_x = place.x + 2.0 * largest_radius_px + gap_px;
  canvas.draw_text({{text_x, place.y}}, text, label_style);
  return static_cast<int>(text_x) + label_length_px(text) + legend_between_px;
}

void draw_scatter_legend(Canvas& canvas, const ScatterChart& chart, const ScatterPlan& plan) {
  const PixelRect& plot = plan.frame.plot;
  const double row_y = plot.bottom() + x_axis_height_px() + gap_px + 0.5 * legend_row_px;
  const std::string name = chart.value_label + ":";
  canvas.draw_text({{double(plot.x), row_y}}, name, label_style);
  int x = plot.x + label_length_px(name) + legend_between_px;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double value = plan.top_value - share * chart.value_span;
    const std::string text = format_fixed(value, 0) + (chart.value_unit.empty() ? "" : " " + chart.value_unit) +
                             (share == 1.0 ? " and less" : "");
    x = draw_legend_dot(canvas, {double(x), row_y}, radius_px(chart, plan, value), {90, 90, 90}, text);
  }
  const std::string colours = "one colour per " + chart.trace_label;
  const double next_y = row_y + legend_row_px;
  canvas.draw_text({{double(plot.x), next_y}}, colours, label_style);
  if (chart.marked_label.empty()) return;
  const double marked_x = plot.x + label_length_px(colours) + legend_between_px;
  draw_legend_dot(canvas, {marked_x, next_y}, largest_radius_px, {0, 0, 0}, chart.marked_label);
}

void draw_scatter(Canvas& canvas, const ScatterChart& chart, const ScatterPlan& plan) {
  draw_grid_lines(canvas, plan.frame);
  canvas.clip(std::span(&plan.frame.plot, 1));
  draw_lines(canvas, chart, plan);
  draw_dots(canvas, chart, plan);
  canvas.unclip();
  draw_axes(canvas, plan.frame);
  draw_scatter_legend(canvas, chart, plan);
  draw_title(canvas, plan.title, plan.frame.plot.x);
}

}  // namespace

Colour trace_colour(std::uint64_t trace) {
  constexpr std::array<Colour, 6> hues{
      {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {230, 159, 0}, {86, 180, 233}}};
  const std::uint64_t mixed = hash_values(trace, 0x7261636bULL);
  const Colour hue = hues[mixed % hues.size()];
  switch ((mixed / hues.size()) % 4) {
    case 0:
      return hue;
    case 1:
      return mix(hue, {0, 0, 0}, 0.3);
    case 2:
      return mix(hue, {0, 0, 0}, 0.55);
    default:
      return mix(hue, white, 0.25);
  }
}

void write_scatter_chart(const ScatterChart& chart, AtomicFile& file, PictureFormat format) {
  check(chart);
  require_drawing(file);
  const ScatterPlan plan = plan_of(chart);
  const PixelRect& plot = plan.frame.plot;
  const int width = plot.right() + plan.right_px;
  const int height = plot.bottom() + x_axis_height_px() + gap_px + 2 * legend_row_px + gap_px;
  draw_picture(file.stream(), format, {width, height, chart.title},
               [&](Canvas& canvas) { draw_scatter(canvas, chart, plan); });
}

void write_scatter_chart(const ScatterChart& chart, const std::filesystem::path& path) {
  const PictureFormat format = picture_format_of(path);
  AtomicFile file(path);
  write_scatter_chart(chart, file, format);
  file.commit();
}

}  // namespace dcem::io
