#include "dcem/io/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/io/src/pictures/cell_colours.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/pictures/contours.hpp"
#include "dcem/io/src/pictures/heat_map_plan.hpp"
#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace {

using namespace detail;

constexpr Colour wall_colour{15, 15, 15};
constexpr Colour window_colour{225, 240, 250};
constexpr Colour marker_red{213, 47, 30};
const Stroke inner_stroke{{150, 150, 150}, 1.5};
const Stroke contour_stroke{{0, 0, 0}, 2.0}, contour_seam{white, 5.0, 0.55};

void draw_window_lines(Canvas& canvas, std::span<const Segment> lines, double wall_px) {
  canvas.draw_segments(lines, {wall_colour, wall_px + 3.0});
  canvas.draw_segments(lines, {window_colour, wall_px});
}

void draw_walls(Canvas& canvas, const HeatMap& map, const HeatMapLayout& layout) {
  constexpr double seam_px = 20.0;
  const double thickness_px = wall_thickness_px(map);
  const SeenWalls seen = seen_walls(map, layout, seam_px);
  canvas.draw_segments(seen.inner, inner_stroke);
  // The pale seam keeps the dark line visible on the dark end of the colours.
  canvas.draw_segments(seen.outer, {white, thickness_px + 3.0, 0.35});
  canvas.draw_segments(seen.outer, {wall_colour, thickness_px});
  draw_window_lines(canvas, seen.windows, thickness_px);
}

// A text on a pale plate.
void draw_plate(Canvas& canvas, const PixelRect& area, const std::string& text, const TextStyle& style) {
  canvas.fill(area, white, 0.8);
  canvas.draw_text({{area.x + label_padding_px + 0.0, area.y + 0.5 * area.height}}, text, style);
}

double length_of(std::span<const PixelPoint> points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y);
  }
  return length;
}

void label_contour(Canvas& canvas, std::span<const PixelPoint> points, double level, TakenPlaces& places) {
  const TextStyle small{22.0, false, wall_colour};
  std::string text;
  append_number(text, std::round(level * 1e6) / 1e6);  // a multiple of the step, but for rounding
  const PixelRect plate = plate_about(points[points.size() / 2], text, small);
  if (length_of(points) < 6.0 * plate.width || !places.is_free(plate)) return;
  places.take(plate);
  draw_plate(canvas, plate, text, small);
}

// Seams first, then lines, then labels: none of them is crossed by another's seam.
void draw_contours(Canvas& canvas, const HeatMap& map, const HeatMapLayout& layout, TakenPlaces& places) {
  if (!draws_contours(map) || !layout.range) return;
  const std::vector<ContourLine> lines = contour_lines(map, *layout.range, *map.contour_step);
  std::vector<std::vector<PixelPoint>> drawn;
  for (const ContourLine& line : lines) {
    drawn.emplace_back();
    for (const auto& [x_m, y_m] : line.points) drawn.back().push_back(layout.point(x_m, y_m));
  }
  for (const auto& points : drawn) canvas.draw_line(points, contour_seam);
  for (const auto& points : drawn) canvas.draw_line(points, contour_stroke);
  for (std::size_t index = 0; index < lines.size(); ++index) {
    label_contour(canvas, drawn[index], lines[index].level, places);
  }
}

void draw_marker(Canvas& canvas, PixelPoint centre) {
  canvas.fill_disc(centre, marker_radius_px + 3.0, white);
  canvas.fill_disc(centre, marker_radius_px, wall_colour);
  canvas.fill_disc(centre, marker_radius_px - 4.0, white);
  canvas.fill_disc(centre, marker_radius_px - 8.0, marker_red);
}

// From the symbol to the nearest point of a label that is not beside it.
void draw_lead(Canvas& canvas, const SeenMarker& marker) {
  const PixelRect& plate = *marker.plate;
  const PixelPoint end{std::clamp(marker.centre.x, double(plate.x), double(plate.right())),
                       std::clamp(marker.centre.y, double(plate.y), double(plate.bottom()))};
  const std::array<PixelPoint, 2> line{marker.centre, end};
  canvas.draw_line(line, {white, 5.0, 0.6});
  canvas.draw_line(line, {wall_colour, 2.0});
}

// Lines below symbols, and names above all.
void draw_transmitters(Canvas& canvas, const std::vector<SeenMarker>& markers) {
  for (const SeenMarker& marker : markers) {
    if (marker.plate && marker.is_led) draw_lead(canvas, marker);
  }
  for (const SeenMarker& marker : markers) draw_marker(canvas, marker.centre);
  for (const SeenMarker& marker : markers) {
    if (marker.plate) draw_plate(canvas, *marker.plate, marker.label, {label_style.size_px, false, wall_colour});
  }
}

// A tip above or below the bar: there are values beyond its end.
void draw_bar_tip(Canvas& canvas, const PixelRect& bar, bool upper) {
  const double foot = upper ? bar.y - 3.0 : bar.bottom() + 3.0, top = upper ? bar.y - 22.0 : bar.bottom() + 22.0;
  const std::array<PixelPoint, 3> corners{
      {{double(bar.x), foot}, {double(bar.right()), foot}, {bar.x + 0.5 * bar.width, top}}};
  canvas.fill_polygon(corners, viridis(upper ? 1.0 : 0.0));
  canvas.draw_line(corners, ink_stroke, true);
}

void draw_bar_tips(Canvas& canvas, const HeatMap& map, const HeatMapLayout& layout) {
  bool below = false;
  bool above = false;
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    below = below || (is_valued(map, cell) && map.values[cell] < layout.range->low);
    above = above || (is_valued(map, cell) && map.values[cell] > layout.range->high);
  }
  if (below) draw_bar_tip(canvas, layout.bar, false);
  if (above) draw_bar_tip(canvas, layout.bar, true);
}

void draw_bar(Canvas& canvas, const HeatMap& map, const HeatMapPlan& plan) {
  if (!plan.layout.range) return;
  const PixelRect& bar = plan.layout.bar;
  Image colours(bar.width, bar.height);
  for (int y = 0; y < bar.height; ++y) {
    for (int x = 0; x < bar.width; ++x) colours.set_pixel(x, y, viridis(1.0 - (y + 0.5) / bar.height));
  }
  canvas.draw_image(bar.x, bar.y, colours);
  draw_frame(canvas, bar, ink_stroke, 0.5 * frame_px);
  draw_bar_tips(canvas, map, plan.layout);
  const double numbers_x = bar.right() + tick_px + gap_px + longest_label_px(plan.bar_ticks);
  for (const Tick& tick : plan.bar_ticks) {
    const double y = bar.bottom() - share_of_range(tick.value, *plan.layout.range) * bar.height;
    canvas.draw_line(std::array{PixelPoint{bar.right() + 1.0, y}, PixelPoint{bar.right() + 1.0 + tick_px, y}},
                     ink_stroke);
    // Numbers end at one column, so that their digits stand under each other.
    canvas.draw_text({{numbers_x, y}, Anchor::right}, tick.label, label_style);
  }
  const PixelPoint name{numbers_x + 2.0 * gap_px + 0.5 * label_style.capital_px(), bar.y + 0.5 * bar.height};
  canvas.draw_text({name, Anchor::middle, TextDirection::upwards}, plan.bar_name, label_style);
}

// The look of cells, as in the map.
Image swatch_of(const LegendItem& item) {
  Image image(swatch_px, swatch_px, no_value_ground);
  for (int y = 0; y < swatch_px && item.symbol != Symbol::no_value; ++y) {
    for (int x = 0; x < swatch_px; ++x) {
      const bool is_category = item.symbol == Symbol::category;
      image.set_pixel(x, y, is_category ? category_pixel(item.category, x, y) : hatched_colour(hatch_ground, x, y));
    }
  }
  return image;
}

void draw_symbol(Canvas& canvas, const LegendItem& item, const PixelRect& swatch) {
  const double middle_y = swatch.y + 0.5 * swatch.height;
  const std::array<PixelPoint, 2> across{{{double(swatch.x), middle_y}, {double(swatch.right()), middle_y}}};
  if (item.symbol == Symbol::transmitter) {
    draw_marker(canvas, {swatch.x + 0.5 * swatch.width, middle_y});
  } else if (item.symbol == Symbol::wall) {
    canvas.draw_line(across, {wall_colour, 4.0});
  } else if (item.symbol == Symbol::window) {
    draw_window_lines(canvas, std::span(&across, 1), 4.0);
  } else if (item.symbol == Symbol::contour) {
    canvas.draw_line(across, contour_stroke);
  } else if (item.symbol != Symbol::none) {
    canvas.draw_image(swatch.x, swatch.y, swatch_of(item));
    draw_frame(canvas, swatch, ink_stroke, 0.0);
  }
}

void draw_legend(Canvas& canvas, const HeatMapPlan& plan) {
  for (const LegendItem& item : plan.legend) {
    const int x = plan.left_px + item.x;
    const int y = plan.legend_y + item.y;
    draw_symbol(canvas, item, {x, y, swatch_px, swatch_px});
    const int text_x = item.symbol == Symbol::none ? x : x + swatch_px + gap_px;
    canvas.draw_text({{double(text_x), y + 0.5 * swatch_px}}, item.text, label_style);
  }
}

void draw_map(Canvas& canvas, const HeatMap& map, const HeatMapPlan& plan) {
  const HeatMapLayout& layout = plan.layout;
  TakenPlaces places(layout.plot);
  for (const SeenMarker& marker : plan.markers) {
    places.take(marker_area(marker.centre));
    if (marker.plate) places.take(*marker.plate);
  }
  canvas.clip(std::span(&layout.plot, 1));
  canvas.draw_image(layout.plot.x, layout.plot.y, cells_image(map, layout));
  draw_walls(canvas, map, layout);
  draw_contours(canvas, map, layout, places);
  canvas.unclip();
  draw_axes(canvas, plan.frame);
  draw_transmitters(canvas, plan.markers);
  draw_bar(canvas, map, plan);
  draw_legend(canvas, plan);
  draw_title(canvas, plan.title, plan.left_px);
}

}  // namespace

HeatMapLayout heat_map_layout(const HeatMap& map) {
  return detail::plan_heat_map(map).layout;
}

void write_heat_map(const HeatMap& map, AtomicFile& file, PictureFormat format) {
  const HeatMapPlan plan = detail::plan_heat_map(map);
  if (!can_draw() && format == PictureFormat::png) return draw_cells(map).write_png(file.stream());
  require_drawing(file);
  draw_picture(file.stream(), format, {plan.layout.width_px, plan.layout.height_px, map.title},
               [&](Canvas& canvas) { draw_map(canvas, map, plan); });
}

void write_heat_map(const HeatMap& map, const std::filesystem::path& path) {
  const PictureFormat format = picture_format_of(path);
  AtomicFile file(path);
  write_heat_map(map, file, format);
  file.commit();
}

}  // namespace dcem::io
