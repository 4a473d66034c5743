#include "dcem/io/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io {
namespace {

using namespace detail;

constexpr Colour ink = picture_ink;
constexpr Colour no_value_grey{217, 217, 217};
constexpr Colour hatch_ground{245, 245, 245};
constexpr Colour wall_colour{15, 15, 15};
constexpr Colour marker_red{213, 47, 30};
constexpr Hatch object_hatch{{105, 105, 105}, 6, 1};
constexpr double marker_radius_px = 8.0;

double share_of_range(double value, const ValueRange& range) {
  return (value - range.low) / (range.high - range.low);
}

// For each pixel along an axis the cell that its middle lies in.
std::vector<std::size_t> cells_of_pixels(int length_px, std::size_t cells) {
  std::vector<std::size_t> result(static_cast<std::size_t>(length_px));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double position = (static_cast<double>(i) + 0.5) / length_px * static_cast<double>(cells);
    result[i] = std::min(static_cast<std::size_t>(position), cells - 1);
  }
  return result;
}

Colour cell_colour(const HeatMap& map, const HeatMapLayout& layout, std::size_t cell) {
  if (!is_valued(map, cell)) return no_value_grey;
  if (!map.categories.empty()) return category_colour(static_cast<std::size_t>(map.values[cell]));
  return layout.range ? viridis(share_of_range(map.values[cell], *layout.range)) : no_value_grey;
}

void draw_cells(const HeatMap& map, const HeatMapLayout& layout, Image& image) {
  const PixelRect& plot = layout.plot;
  const std::vector<std::size_t> columns = cells_of_pixels(plot.width, map.columns);
  const std::vector<std::size_t> rows = cells_of_pixels(plot.height, map.rows);
  for (int y = 0; y < plot.height; ++y) {
    const std::size_t row = rows[static_cast<std::size_t>(plot.height - 1 - y)];
    for (int x = 0; x < plot.width; ++x) {
      const std::size_t cell = row * map.columns + columns[static_cast<std::size_t>(x)];
      const PixelRect dot{plot.x + x, plot.y + y, 1, 1};
      if (is_hatched(map, cell)) {
        image.set_pixel(dot.x, dot.y, hatch_ground);
        image.hatch_rectangle(dot, object_hatch);
      } else {
        image.set_pixel(dot.x, dot.y, cell_colour(map, layout, cell));
      }
    }
  }
}

// A line along an axis is put onto whole pixels, so that it is sharp.
double snap(double position_px, double thickness_px) {
  const double half = 0.5 * std::round(thickness_px);
  return std::round(position_px - half) + half;
}

void draw_wall(const HeatMapLayout& layout, const std::array<double, 4>& wall, Colour colour, double thickness_px,
               double opacity, Image& image) {
  PixelPoint from = layout.point(wall[0], wall[1]);
  PixelPoint to = layout.point(wall[2], wall[3]);
  if (wall[0] == wall[2]) from.x = to.x = snap(from.x, thickness_px);
  if (wall[1] == wall[3]) from.y = to.y = snap(from.y, thickness_px);
  image.draw_line(from, to, colour, thickness_px, opacity);
}

void draw_walls(const HeatMap& map, const HeatMapLayout& layout, Image& image) {
  image.set_clip(layout.plot);
  // A city at one pixel per metre would drown in thick lines.
  const double thickness_px = map.walls_m.size() > 2000 ? 1.0 : 2.0;
  // The pale seam keeps the dark line visible on the dark end of the colours.
  for (const auto& wall : map.walls_m) draw_wall(layout, wall, white, thickness_px + 2.0, 0.35, image);
  for (const auto& wall : map.walls_m) draw_wall(layout, wall, wall_colour, thickness_px, 1.0, image);
  image.remove_clip();
}

void draw_marker(PixelPoint centre, Image& image) {
  image.fill_disc(centre, marker_radius_px + 1.5, white);
  image.fill_disc(centre, marker_radius_px, wall_colour);
  image.fill_disc(centre, marker_radius_px - 2.0, white);
  image.fill_disc(centre, marker_radius_px - 4.5, marker_red);
}

PixelRect marker_area(PixelPoint centre) {
  const int reach = static_cast<int>(marker_radius_px) + 2;
  return {static_cast<int>(centre.x) - reach, static_cast<int>(centre.y) - reach, 2 * reach, 2 * reach};
}

bool is_free(const PixelRect& area, const PixelRect& plot, const std::vector<PixelRect>& taken) {
  const auto overlaps = [&](const PixelRect& other) {
    const PixelRect shared = intersection(area, other);
    return shared.width > 0 && shared.height > 0;
  };
  return intersection(area, plot) == area && std::none_of(taken.begin(), taken.end(), overlaps);
}

// The first free place around the marker: right, left, above, below, then the four corners.
std::optional<PixelRect> place_label(PixelPoint centre, int width, int height, const PixelRect& plot,
                                     const std::vector<PixelRect>& taken) {
  const PixelRect marker = marker_area(centre);
  const int x = static_cast<int>(centre.x);
  const int y = static_cast<int>(centre.y);
  const std::array<std::array<int, 2>, 8> corners{{{marker.right() + 2, y - height / 2},
                                                   {marker.x - 2 - width, y - height / 2},
                                                   {x - width / 2, marker.y - 2 - height},
                                                   {x - width / 2, marker.bottom() + 2},
                                                   {marker.right(), marker.y - height},
                                                   {marker.right(), marker.bottom()},
                                                   {marker.x - width, marker.y - height},
                                                   {marker.x - width, marker.bottom()}}};
  for (const auto& corner : corners) {
    const PixelRect area{corner[0], corner[1], width, height};
    if (is_free(area, plot, taken)) return area;
  }
  return std::nullopt;
}

void draw_transmitters(const HeatMap& map, const HeatMapLayout& layout, Image& image) {
  constexpr int padding_px = 3;
  std::vector<PixelRect> taken;
  std::vector<std::pair<PixelPoint, std::string>> visible;
  for (const auto& transmitter : map.transmitters) {
    const PixelPoint centre = layout.point(transmitter.x_m, transmitter.y_m);
    if (!is_inside(layout, centre)) continue;
    visible.emplace_back(centre, transmitter.label);
    taken.push_back(marker_area(centre));
  }
  for (const auto& [centre, label] : visible) draw_marker(centre, image);
  for (const auto& [centre, label] : visible) {
    if (label.empty()) continue;
    const auto area = place_label(centre, label_length_px(label) + 2 * padding_px, label_height_px + 2 * padding_px,
                                  layout.plot, taken);
    if (!area) continue;
    taken.push_back(*area);
    image.shade_rectangle(*area, white, 0.8);
    image.draw_text(area->x + padding_px, area->y + padding_px, label, wall_colour, label_scale);
  }
}

// A tip above or below the bar: there are values beyond its end.
void draw_bar_tip(const PixelRect& bar, bool upper, Image& image) {
  for (int i = 1; i <= bar_tip_px - 2; ++i) {
    const int inset = i * bar.width / 2 / (bar_tip_px - 2);
    const int y = upper ? bar.y - 1 - i : bar.bottom() + i;
    image.fill_rectangle({bar.x + inset, y, bar.width - 2 * inset, 1}, viridis(upper ? 1.0 : 0.0));
  }
}

void draw_bar(const HeatMap& map, const HeatMapPlan& plan, Image& image) {
  if (!plan.layout.range) return;
  const ValueRange& range = *plan.layout.range;
  const PixelRect& bar = plan.layout.bar;
  for (int y = 0; y < bar.height; ++y) {
    image.fill_rectangle({bar.x, bar.y + y, bar.width, 1}, viridis(1.0 - (y + 0.5) / bar.height));
  }
  image.draw_frame({bar.x - 1, bar.y - 1, bar.width + 2, bar.height + 2}, ink);
  bool below = false;
  bool above = false;
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    below = below || (is_valued(map, cell) && map.values[cell] < range.low);
    above = above || (is_valued(map, cell) && map.values[cell] > range.high);
  }
  if (below) draw_bar_tip(bar, false, image);
  if (above) draw_bar_tip(bar, true, image);
  for (const Tick& tick : plan.bar_ticks) {
    const double share = 1.0 - share_of_range(tick.value, range);
    const int y = bar.y + std::clamp(static_cast<int>(share * bar.height), 0, bar.height - 1);
    image.fill_rectangle({bar.right(), y, tick_px + 1, 1}, ink);
    // Numbers end at one column, so that their digits stand under each other.
    const int x = bar.right() + tick_px + gap_px + longest_label_px(plan.bar_ticks) - label_length_px(tick.label);
    image.draw_text(x, y - 7 * label_scale / 2, tick.label, ink, label_scale);
  }
  const int name_x = bar.right() + tick_px + gap_px + longest_label_px(plan.bar_ticks) + 2 * gap_px;
  const int name_y = bar.y + (bar.height - label_length_px(plan.bar_name)) / 2;
  image.draw_text(name_x, name_y, plan.bar_name, ink, label_scale, TextDirection::upwards);
}

void draw_symbol(const LegendItem& item, const PixelRect& swatch, Image& image) {
  const Symbol symbol = item.symbol;
  const PixelPoint middle{swatch.x + 0.5 * swatch.width, swatch.y + 0.5 * swatch.height};
  if (symbol == Symbol::transmitter) {
    draw_marker(middle, image);
  } else if (symbol == Symbol::wall) {
    image.fill_rectangle({swatch.x, static_cast<int>(middle.y) - 1, swatch.width, 2}, wall_colour);
  } else if (symbol == Symbol::category) {
    image.fill_rectangle(swatch, category_colour(item.category));
    image.draw_frame(swatch, ink);
  } else if (symbol != Symbol::none) {
    image.fill_rectangle(swatch, symbol == Symbol::no_value ? no_value_grey : hatch_ground);
    if (symbol == Symbol::hatched) image.hatch_rectangle(swatch, object_hatch);
    image.draw_frame(swatch, ink);
  }
}

void draw_legend(const HeatMapPlan& plan, Image& image) {
  for (const LegendItem& item : plan.legend) {
    const int x = plan.left_px + item.x;
    const int y = plan.legend_y + item.y;
    draw_symbol(item, {x, y, swatch_px, swatch_px}, image);
    const int text_x = item.symbol == Symbol::none ? x : x + swatch_px + gap_px;
    image.draw_text(text_x, y + (swatch_px - 7 * label_scale) / 2, item.text, ink, label_scale);
  }
}

}  // namespace

HeatMapLayout heat_map_layout(const HeatMap& map) {
  return detail::plan_heat_map(map).layout;
}

Image draw_heat_map(const HeatMap& map) {
  const HeatMapPlan plan = detail::plan_heat_map(map);
  Image image(plan.layout.width_px, plan.layout.height_px, white);
  draw_cells(map, plan.layout, image);
  draw_walls(map, plan.layout, image);
  detail::draw_axes(image, plan.layout.plot, plan.x, plan.y);
  draw_transmitters(map, plan.layout, image);
  draw_bar(map, plan, image);
  draw_legend(plan, image);
  image.draw_text(plan.left_px, margin_px, plan.title.text, ink, plan.title.scale);
  return image;
}

void write_heat_map_png(const HeatMap& map, const std::filesystem::path& path) {
  draw_heat_map(map).write_png(path);
}

void write_heat_map_png(const HeatMap& map, AtomicFile& file) {
  draw_heat_map(map).write_png(file.stream());
}

}  // namespace dcem::io
