#include "dcem/io/src/pictures/picture_axes.hpp"

#include <algorithm>
#include <array>

namespace dcem::io::detail {
namespace {

void draw_segment(Canvas& canvas, PixelPoint from, PixelPoint to, const Stroke& stroke) {
  canvas.draw_line(std::array{from, to}, stroke);
}

void draw_x_axis(Canvas& canvas, const PictureFrame& frame, AxisLabels labels) {
  const PixelRect& plot = frame.plot;
  const double label_y = plot.bottom() + tick_px + gap_px + 0.5 * label_style.capital_px();
  for (const Tick& tick : frame.x.ticks) {
    const double x = std::clamp(plot.x + frame.x.offset_px(tick.value), double(plot.x), double(plot.right()));
    draw_segment(canvas, {x, plot.bottom() + 1.0}, {x, plot.bottom() + 1.0 + tick_px}, ink_stroke);
    if (labels == AxisLabels::all) canvas.draw_text({{x, label_y}, Anchor::middle}, tick.label, label_style);
  }
  if (labels != AxisLabels::all) return;
  const PixelPoint middle{plot.x + 0.5 * plot.width, label_y + label_height_px + gap_px};
  canvas.draw_text({middle, Anchor::middle}, frame.x.name, label_style);
}

void draw_y_axis(Canvas& canvas, const PictureFrame& frame) {
  const PixelRect& plot = frame.plot;
  for (const Tick& tick : frame.y.ticks) {
    const double y = std::clamp(plot.bottom() - frame.y.offset_px(tick.value), double(plot.y), double(plot.bottom()));
    draw_segment(canvas, {plot.x - 1.0 - tick_px, y}, {plot.x - 1.0, y}, ink_stroke);
    canvas.draw_text({{double(plot.x - tick_px - gap_px), y}, Anchor::right}, tick.label, label_style);
  }
  const double name_x = margin_px + 0.5 * label_style.capital_px();
  canvas.draw_text({{name_x, plot.y + 0.5 * plot.height}, Anchor::middle, TextDirection::upwards}, frame.y.name,
                   label_style);
}

// Where the characters of valid UTF-8 begin, and where the last one ends.
std::vector<std::size_t> character_begins(const std::string& text) {
  std::vector<std::size_t> begins;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if ((static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U) begins.push_back(at);
  }
  begins.push_back(text.size());
  return begins;
}

}  // namespace

int plot_left_px(const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks) {
  const int left = margin_px + label_height_px + gap_px + longest_label_px(y_ticks) + gap_px + tick_px;
  return std::max(left, margin_px + longest_label_px(x_ticks) / 2);
}

int x_axis_height_px() {
  return tick_px + 2 * label_height_px + 3 * gap_px;
}

void draw_grid_lines(Canvas& canvas, const PictureFrame& frame) {
  const PixelRect& plot = frame.plot;
  const Stroke pale{grid_grey, frame_px};
  for (const Tick& tick : frame.x.ticks) {
    const double x = plot.x + frame.x.offset_px(tick.value);
    if (x > plot.x && x < plot.right()) draw_segment(canvas, {x, double(plot.y)}, {x, double(plot.bottom())}, pale);
  }
  for (const Tick& tick : frame.y.ticks) {
    const double y = plot.bottom() - frame.y.offset_px(tick.value);
    if (y > plot.y && y < plot.bottom()) draw_segment(canvas, {double(plot.x), y}, {double(plot.right()), y}, pale);
  }
}

void draw_axes(Canvas& canvas, const PictureFrame& frame, AxisLabels x_labels) {
  draw_frame(canvas, frame.plot, ink_stroke, 0.5 * frame_px);
  draw_x_axis(canvas, frame, x_labels);
  draw_y_axis(canvas, frame);
}

std::string fit_text(const std::string& text, const TextStyle& style, int width_px) {
  if (text_width_px(text, style) <= width_px) return text;
  const std::string whole = drawable_text(text);
  const std::vector<std::size_t> begins = character_begins(whole);
  std::string fitted;
  for (std::size_t kept = begins.size() - 1; kept > 0; --kept) {
    const std::size_t head = begins[(kept + 1) / 2], tail = begins[begins.size() - 1 - kept / 2];
    fitted = whole.substr(0, head) + "..." + whole.substr(tail);
    if (text_width_px(fitted, style) <= width_px) break;
  }
  return fitted;
}

FittedTitle fit_title(const std::string& title, int width_px) {
  if (text_width_px(title, title_style) <= width_px) return {title};
  const TextStyle smaller{label_style.size_px, true};
  if (text_width_px(title, smaller) <= width_px) return {title, smaller};
  std::size_t end = title.rfind(' ');
  while (end != std::string::npos && end > 0 && text_width_px(title.substr(0, end), smaller) > width_px) {
    end = title.rfind(' ', end - 1);
  }
  if (end == std::string::npos || end == 0) return {fit_text(title, smaller, width_px), smaller};
  return {title.substr(0, end), smaller, fit_text(title.substr(end + 1), smaller, width_px)};
}

void draw_title(Canvas& canvas, const FittedTitle& title, PixelPoint at) {
  canvas.draw_text({at, Anchor::left}, title.text, title.style);
  if (title.second_line.empty()) return;
  canvas.draw_text({{at.x, at.y + title.more_px()}, Anchor::left}, title.second_line, title.style);
}

void draw_title(Canvas& canvas, const FittedTitle& title, int left_px) {
  draw_title(canvas, title, {double(left_px), margin_px + 0.5 * title_style.capital_px()});
}

}  // namespace dcem::io::detail
