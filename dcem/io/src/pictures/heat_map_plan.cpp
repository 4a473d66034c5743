#include "dcem/io/src/pictures/heat_map_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace detail {
namespace {

constexpr int bar_width_px = 44;
constexpr int bar_gap_px = 56;
constexpr int min_plot_px = 130;
constexpr int min_bar_px = 300;
constexpr int min_picture_px = 800;
constexpr double target_plot_px = 1280.0;
constexpr double target_upright_px = 640.0;  // of an axis that is not to the scale of the other
constexpr double max_cell_px = 400.0;
constexpr double max_unsampled_px = 2000.0;

// Differences of larger values could overflow.
constexpr double largest_value = 1e100;

void require(bool condition, const char* problem) {
  if (!condition) throw std::invalid_argument(std::string("HeatMap: ") + problem);
}

void check_axis(double origin_m, double spacing_m) {
  require(spacing_m >= 1e-6 && spacing_m <= 1e9, "a spacing lies outside 1e-6 to 1e9 m");
  require(std::abs(origin_m) * 1e-12 < spacing_m, "an origin is not finite or so large that the spacing is lost");
}

void check_categories(const HeatMap& map) {
  const double count = static_cast<double>(map.categories.size());
  for (std::size_t cell = 0; count > 0.0 && cell < map.values.size(); ++cell) {
    const double value = map.values[cell];
    require(!is_valued(map, cell) || (value >= 0.0 && value < count && value == std::floor(value)),
            "a value is no number of a category");
  }
}

void check(const HeatMap& map) {
  require(map.columns > 0 && map.rows > 0, "the grid has no point; expected at least one column and one row");
  require(map.values.size() / map.columns == map.rows && map.values.size() % map.columns == 0,
          "the number of values is not columns x rows");
  require(map.hatched.empty() || map.hatched.size() == map.values.size(), "hatched has not the size of values");
  check_categories(map);
  check_axis(map.origin_x_m, map.spacing_x_m);
  check_axis(map.origin_y_m, map.spacing_y_m);
  require(!map.contour_step || (*map.contour_step > 0.0 && *map.contour_step <= largest_value),
          "the step of the contours is not above zero");
  require(map.relief.tones.size() == static_cast<std::size_t>(map.relief.columns) * map.relief.rows,
          "the relief has not the size of its tones");
  require(!map.range || (map.range->low >= -largest_value && map.range->high <= largest_value &&
                         map.range->low < map.range->high),
          "the range is empty or not finite");
  for (const auto* walls_m : {&map.walls_m, &map.windows_m}) {
    for (const auto& wall : *walls_m) {
      require(std::isfinite(wall[0] + wall[1] + wall[2] + wall[3]), "a wall has a coordinate that is not finite");
    }
  }
  for (const auto& marker : map.transmitters) {
    require(std::isfinite(marker.x_m + marker.y_m), "a transmitter has a coordinate that is not finite");
  }
}

// Pixels along the smaller spacing of a cell: whole numbers, or one of k cells where the grid is too fine.
double choose_cell_px(double longest_in_cells, double target_px) {
  const double wanted = target_px / longest_in_cells;
  if (wanted < 1.0) {
    return longest_in_cells <= max_unsampled_px ? 1.0 : 1.0 / std::ceil(longest_in_cells / max_unsampled_px);
  }
  const double below = std::floor(wanted);
  return std::min(max_cell_px, wanted / below < (below + 1.0) / wanted ? below : below + 1.0);
}

int legend_item_width(const LegendItem& item) {
  return (item.symbol == Symbol::none ? 0 : swatch_px + gap_px) + label_length_px(item.text);
}

std::string contour_text(const HeatMap& map) {
  std::string text = "every ";
  append_number(text, *map.contour_step);
  // The difference of two levels in dBm is in dB.
  const std::string unit = map.unit.starts_with("dB") ? "dB" : map.unit;
  return text + (unit.empty() ? "" : " " + unit);
}

std::vector<LegendItem> legend_items(const HeatMap& map, const HeatMapLayout& layout,
                                     const std::vector<SeenMarker>& markers) {
  bool any_grey = false;
  bool any_hatched = false;
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    any_hatched = any_hatched || is_hatched(map, cell);
    any_grey = any_grey || !(is_hatched(map, cell) || is_valued(map, cell));
  }
  const SeenWalls walls = seen_walls(map, layout, 0.5 * wall_thickness_px(map));
  const std::size_t outside = map.transmitters.size() - markers.size();
  const auto unnamed = std::count_if(markers.begin(), markers.end(),
                                     [](const SeenMarker& marker) { return !marker.plate && !marker.label.empty(); });
  std::vector<LegendItem> items;
  for (std::size_t index = 0; index < map.categories.size(); ++index) {
    items.push_back({Symbol::category, fit_text(map.categories[index], label_style, longest_name_px), 0, 0, index});
  }
  if (!markers.empty()) items.push_back({Symbol::transmitter, "transmitter"});
  if (!walls.outer.empty()) items.push_back({Symbol::wall, "wall"});
  if (!walls.windows.empty()) items.push_back({Symbol::window, "window, or wall that more than a tenth passes"});
  if (draws_contours(map)) items.push_back({Symbol::contour, contour_text(map)});
  if (any_grey) items.push_back({Symbol::no_value, map.no_value_label});
  if (any_hatched) items.push_back({Symbol::hatched, map.hatched_label});
  if (unnamed > 0) items.push_back({Symbol::none, "transmitters without room for a name: " + std::to_string(unnamed)});
  if (outside > 0) items.push_back({Symbol::none, "transmitters outside the map: " + std::to_string(outside)});
  if (layout.sampling > 1) {
    items.push_back({Symbol::none, "shown: one point in " + std::to_string(layout.sampling) + " along each axis"});
  }
  if (!layout.to_scale && map.axes.to_scale) items.push_back({Symbol::none, "axes not to the same scale"});
  for (const std::string& note : map.notes) items.push_back({Symbol::none, note});
  return items;
}

// Sets the items into lines no longer than `width_px`; returns the height.
int flow_legend(std::vector<LegendItem>& items, int width_px) {
  constexpr int line_px = 50;
  constexpr int between_px = 44;
  int x = 0;
  int y = 0;
  for (LegendItem& item : items) {
    if (x > 0 && x + legend_item_width(item) > width_px) {
      x = 0;
      y += line_px;
    }
    item.x = x;
    item.y = y;
    x += legend_item_width(item) + between_px;
  }
  return items.empty() ? 0 : y + line_px;
}

// Pixels per unit along x and y.
std::array<double, 2> choose_scales(const HeatMap& map) {
  const double columns = static_cast<double>(map.columns), rows = static_cast<double>(map.rows);
  if (!map.axes.to_scale) {
    return {choose_cell_px(columns, target_plot_px) / map.spacing_x_m,
            choose_cell_px(rows, target_upright_px) / map.spacing_y_m};
  }
  const double cell_m = std::min(map.spacing_x_m, map.spacing_y_m);
  const double longest_m = std::max(map.spacing_x_m * columns, map.spacing_y_m * rows);
  const double px_per_m = choose_cell_px(longest_m / cell_m, target_plot_px) / cell_m;
  return {px_per_m, px_per_m};
}

void size_plot(const HeatMap& map, HeatMapLayout& layout) {
  const double width_m = map.spacing_x_m * static_cast<double>(map.columns);
  const double height_m = map.spacing_y_m * static_cast<double>(map.rows);
  const auto [horizontal, vertical] = choose_scales(map);
  const int true_width = static_cast<int>(std::lround(width_m * horizontal));
  const int true_height = static_cast<int>(std::lround(height_m * vertical));
  layout.plot.width = std::max(min_plot_px, true_width);
  layout.plot.height = std::max(min_plot_px, true_height);
  const double points_per_px = std::max(static_cast<double>(map.columns) / layout.plot.width,
                                        static_cast<double>(map.rows) / layout.plot.height);
  layout.sampling = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(points_per_px)));
  layout.to_scale = map.axes.to_scale && true_width >= min_plot_px && true_height >= min_plot_px;
  layout.left_m = map.origin_x_m - 0.5 * map.spacing_x_m;
  layout.bottom_m = map.origin_y_m - 0.5 * map.spacing_y_m;
  layout.horizontal_px_per_m = layout.plot.width / width_m;
  layout.vertical_px_per_m = layout.plot.height / height_m;
  if (map.categories.empty()) layout.range = map.range ? map.range : default_value_range(map);
}

// The name stands along the bar; one without end is cut.
std::string name_of_bar(const HeatMap& map) {
  const std::string name = axis_name(map.label, map.unit);
  return name.size() <= 60 ? name : name.substr(0, 57) + "...";
}

void choose_ticks(const HeatMap& map, HeatMapPlan& plan) {
  const HeatMapLayout& layout = plan.layout;
  const double right_m = layout.left_m + layout.plot.width / layout.horizontal_px_per_m;
  const double top_m = layout.bottom_m + layout.plot.height / layout.vertical_px_per_m;
  plan.frame.x = {horizontal_axis_ticks(layout.left_m, right_m, layout.plot.width),
                  axis_name(map.axes.x_label, map.axes.x_unit), layout.left_m, layout.horizontal_px_per_m};
  plan.frame.y = {axis_ticks(layout.bottom_m, top_m, layout.plot.height, 90),
                  axis_name(map.axes.y_label, map.axes.y_unit), layout.bottom_m, layout.vertical_px_per_m};
  if (layout.range) plan.bar_ticks = axis_ticks(layout.range->low, layout.range->high, layout.bar.height, 64);
}

// The columns of the picture from left to right; returns the gap between plot and bar.
int set_columns(HeatMapPlan& plan, const std::string& title) {
  HeatMapLayout& layout = plan.layout;
  const int half_x_label = longest_label_px(plan.frame.x.ticks) / 2;
  plan.left_px = plot_left_px(plan.frame.x.ticks, plan.frame.y.ticks);
  const int bar_gap = std::max(bar_gap_px, half_x_label + gap_px);
  const int bar_px = bar_width_px + tick_px + gap_px + longest_label_px(plan.bar_ticks) + 2 * gap_px + label_height_px;
  const int right = margin_px + (layout.range ? bar_gap + bar_px : half_x_label);
  const int content_px = plan.left_px + layout.plot.width + right;
  const int title_px = plan.left_px + static_cast<int>(text_width_px(title, title_style)) + 2 * margin_px;
  int legend_px = 0;
  for (const LegendItem& item : plan.legend) {
    legend_px = std::max(legend_px, plan.left_px + legend_item_width(item) + margin_px);
  }
  // A tiny map still has room for its title and its legend.
  layout.width_px = std::max({content_px, legend_px, min_picture_px, std::min(title_px, 1400)});
  return bar_gap;
}

// To where the plot is: places are taken before its own is known.
void shift(std::vector<SeenMarker>& markers, const PixelRect& plot) {
  for (SeenMarker& marker : markers) {
    marker.centre = {marker.centre.x + plot.x, marker.centre.y + plot.y};
    if (marker.plate) marker.plate->x += plot.x, marker.plate->y += plot.y;
  }
}

}  // namespace

HeatMapPlan plan_heat_map(const HeatMap& map) {
  check(map);
  HeatMapPlan plan;
  HeatMapLayout& layout = plan.layout;
  size_plot(map, layout);
  plan.bar_name = name_of_bar(map);
  layout.bar.height = layout.range ? std::max({layout.plot.height, min_bar_px, label_length_px(plan.bar_name)}) : 0;
  choose_ticks(map, plan);
  plan.markers = seen_markers(map, layout);
  plan.legend = legend_items(map, layout, plan.markers);
  const int bar_gap = set_columns(plan, map.title);
  const int line_px = layout.width_px - plan.left_px - margin_px;
  plan.title = fit_title(map.title, line_px);

  layout.plot.x = plan.left_px;
  layout.plot.y = title_bottom_px + plan.title.more_px() + bar_tip_px;
  plan.frame.plot = layout.plot;
  shift(plan.markers, layout.plot);
  layout.bar = {layout.plot.right() + bar_gap, layout.plot.y, layout.range ? bar_width_px : 0, layout.bar.height};
  const int axis_bottom = layout.plot.bottom() + x_axis_height_px();
  plan.legend_y = std::max(axis_bottom, layout.bar.bottom() + bar_tip_px) + gap_px;
  const int legend_height = flow_legend(plan.legend, line_px);
  layout.height_px = plan.legend_y + legend_height + (legend_height > 0 ? gap_px : 0);
  return plan;
}

bool is_hatched(const HeatMap& map, std::size_t cell) {
  return !map.hatched.empty() && map.hatched[cell] != 0;
}

bool is_valued(const HeatMap& map, std::size_t cell) {
  return std::abs(map.values[cell]) <= largest_value && !is_hatched(map, cell);
}

bool draws_contours(const HeatMap& map) {
  return map.contour_step && map.categories.empty();
}

}  // namespace detail

std::optional<ValueRange> default_value_range(const HeatMap& map) {
  detail::check(map);
  std::vector<double> values;
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    if (detail::is_valued(map, cell)) values.push_back(map.values[cell]);
  }
  return value_range(std::move(values), map.unit);
}

std::optional<ValueRange> value_range(std::vector<double> values, const std::string& unit) {
  if (values.empty()) return std::nullopt;
  // The rank counts from below, so that a map of fewer than 50 values keeps its lowest one.
  const auto rank = static_cast<std::ptrdiff_t>(0.02 * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const double low = values[static_cast<std::size_t>(rank)];
  const double high = *std::max_element(values.begin(), values.end());
  const bool decibels = unit.rfind("dB", 0) == 0;
  // Values that differ by rounding alone count as equal; equal values get a bar of their own size around them.
  const bool equal = high - low <= 1e-9 * std::max(std::abs(low), std::abs(high));
  const double own_size = high == 0.0 ? 1.0 : std::abs(high);
  const double span = equal ? (decibels ? std::max(1.0, 1e-6 * own_size) : own_size) : high - low;
  const double step = decibels && span < 1000.0 ? 5.0 : detail::round_step_at_least(0.1 * span);
  ValueRange range{std::floor(low / step) * step, std::ceil(high / step) * step};
  if (range.high <= range.low) range = {range.low - step, range.high + step};
  return range;
}

}  // namespace dcem::io
