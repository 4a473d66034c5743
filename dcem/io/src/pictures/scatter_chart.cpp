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

constexpr int plot_width_px = 860, plot_height_px = 480, legend_row_px = 30, legend_between_px = 28;
constexpr double largest_radius_px = 6.0, smallest_radius_px = 1.0;

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
  PixelRect plot;
  PictureAxis x, y;
  double top_value = 0.0;  // of the largest dots
  double radius_px = largest_radius_px;

  PixelPoint point(const ScatterChart::Dot& dot) const {
    return {plot.x + (dot.x - x.low) * x.px_per_unit, plot.bottom() - (dot.y - y.low) * y.px_per_unit};
  }
};

// Dots side by side should just touch, however many instants there are.
double largest_radius_for(const ScatterChart& chart) {
  std::vector<double> places;
  for (const ScatterChart::Dot& dot : chart.dots) places.push_back(dot.x);
  std::sort(places.begin(), places.end());
  const auto count = std::unique(places.begin(), places.end()) - places.begin();
  return std::clamp(0.7 * plot_width_px / static_cast<double>(count), 2.5, largest_radius_px);
}

ScatterPlan plan_of(const ScatterChart& chart) {
  ScatterPlan plan;
  const Bounds x = padded_bounds(chart, [](const ScatterChart::Dot& dot) { return dot.x; });
  const Bounds y = padded_bounds(chart, [](const ScatterChart::Dot& dot) { return dot.y; });
  plan.x = {horizontal_axis_ticks(x.low, x.high, plot_width_px), axis_name(chart.x_label, chart.x_unit), x.low,
            plot_width_px / (x.high - x.low)};
  plan.y = {axis_ticks(y.low, y.high, plot_height_px, 50), axis_name(chart.y_label, chart.y_unit), y.low,
            plot_height_px / (y.high - y.low)};
  plan.plot = {plot_left_px(plan.x.ticks, plan.y.ticks), margin_px + text_height_px(title_scale) + 2 * gap_px,
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

void draw_lines(Image& image, const ScatterChart& chart, const ScatterPlan& plan) {
  std::unordered_map<std::uint64_t, const ScatterChart::Dot*> last;
  for (const ScatterChart::Dot& dot : chart.dots) {
    const auto before = last.find(dot.trace);
    if (dot.joins_last && before != last.end()) {
      image.draw_line(plan.point(*before->second), plan.point(dot), colour_of(dot), 1.0,
                      0.3 + 0.5 * strength(chart, plan, dot.value));
    }
    last[dot.trace] = &dot;
  }
}

void draw_dots(Image& image, const ScatterChart& chart, const ScatterPlan& plan) {
  std::vector<const ScatterChart::Dot*> order;
  for (const ScatterChart::Dot& dot : chart.dots) order.push_back(&dot);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->value < b->value; });
  for (const ScatterChart::Dot* dot : order) {
    image.fill_disc(plan.point(*dot), radius_px(chart, plan, dot->value), colour_of(*dot));
  }
}

// A dot with a text to its right; returns where the next one may begin.
int draw_legend_dot(Image& image, int x, int y, double radius, Colour colour, const std::string& text) {
  image.fill_disc({x + largest_radius_px, y + 0.5 * text_height_px(label_scale)}, radius, colour);
  const int text_x = x + static_cast<int>(2.0 * largest_radius_px) + gap_px + 2;
  image.draw_text(text_x, y, text, picture_ink, label_scale);
  return text_x + label_length_px(text) + legend_between_px;
}

void draw_legend(Image& image, const ScatterChart& chart, const ScatterPlan& plan) {
  int x = plan.plot.x, y = plan.plot.bottom() + x_axis_height_px() + gap_px;
  const std::string name = chart.value_label + ":";
  image.draw_text(x, y, name, picture_ink, label_scale);
  x += label_length_px(name) + legend_between_px;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double value = plan.top_value - share * chart.value_span;
    const std::string text = format_fixed(value, 0) + (chart.value_unit.empty() ? "" : " " + chart.value_unit) +
                             (share == 1.0 ? " and less" : "");
    x = draw_legend_dot(image, x, y, radius_px(chart, plan, value), {90, 90, 90}, text);
  }
  y += legend_row_px;
  const std::string colours = "one colour per " + chart.trace_label;
  image.draw_text(plan.plot.x, y, colours, picture_ink, label_scale);
  if (chart.marked_label.empty()) return;
  x = plan.plot.x + label_length_px(colours) + legend_between_px;
  draw_legend_dot(image, x, y, largest_radius_px, {0, 0, 0}, chart.marked_label);
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

Image draw_scatter_chart(const ScatterChart& chart) {
  check(chart);
  const ScatterPlan plan = plan_of(chart);
  const int width = plan.plot.right() + margin_px + std::max(margin_px, longest_label_px(plan.x.ticks) / 2);
  const int height = plan.plot.bottom() + x_axis_height_px() + gap_px + 2 * legend_row_px + gap_px;
  Image image(width, height, white);
  for (const Tick& tick : plan.x.ticks) {
    const int x = static_cast<int>(plan.plot.x + (tick.value - plan.x.low) * plan.x.px_per_unit);
    image.fill_rectangle(intersection({x, plan.plot.y, 1, plan.plot.height}, plan.plot), {225, 225, 225});
  }
  for (const Tick& tick : plan.y.ticks) {
    const int y = static_cast<int>(plan.plot.bottom() - (tick.value - plan.y.low) * plan.y.px_per_unit);
    image.fill_rectangle(intersection({plan.plot.x, y, plan.plot.width, 1}, plan.plot), {225, 225, 225});
  }
  image.set_clip(plan.plot);
  draw_lines(image, chart, plan);
  draw_dots(image, chart, plan);
  image.remove_clip();
  draw_axes(image, plan.plot, plan.x, plan.y);
  draw_legend(image, chart, plan);
  const FittedTitle title = fit_title(chart.title, width - plan.plot.x - margin_px);
  image.draw_text(plan.plot.x, margin_px, title.text, picture_ink, title.scale);
  return image;
}

void write_scatter_chart_png(const ScatterChart& chart, const std::filesystem::path& path) {
  draw_scatter_chart(chart).write_png(path);
}

void write_scatter_chart_png(const ScatterChart& chart, AtomicFile& file) {
  draw_scatter_chart(chart).write_png(file.stream());
}

}  // namespace dcem::io
