#include "dcem/io/src/pictures/picture_axes.hpp"

#include <algorithm>

namespace dcem::io::detail {
namespace {

void draw_x_axis(Image& image, const PixelRect& plot, const PictureAxis& axis) {
  const int label_y = plot.bottom() + tick_px + gap_px;
  for (const Tick& tick : axis.ticks) {
    const double place = plot.x + (tick.value - axis.low) * axis.px_per_unit;
    const int x = std::clamp(static_cast<int>(place), plot.x, plot.right() - 1);
    image.fill_rectangle({x, plot.bottom(), 1, tick_px + 1}, picture_ink);
    image.draw_text(x - label_length_px(tick.label) / 2, label_y, tick.label, picture_ink, label_scale);
  }
  const int name_x = plot.x + (plot.width - label_length_px(axis.name)) / 2;
  image.draw_text(name_x, label_y + label_height_px + gap_px, axis.name, picture_ink, label_scale);
}

void draw_y_axis(Image& image, const PixelRect& plot, const PictureAxis& axis) {
  for (const Tick& tick : axis.ticks) {
    const double place = plot.bottom() - (tick.value - axis.low) * axis.px_per_unit;
    const int y = std::clamp(static_cast<int>(place), plot.y, plot.bottom() - 1);
    image.fill_rectangle({plot.x - 1 - tick_px, y, tick_px + 1, 1}, picture_ink);
    const int x = plot.x - tick_px - gap_px - label_length_px(tick.label);
    image.draw_text(x, y - 7 * label_scale / 2, tick.label, picture_ink, label_scale);
  }
  const int name_y = plot.y + (plot.height - label_length_px(axis.name)) / 2;
  image.draw_text(margin_px, name_y, axis.name, picture_ink, label_scale, TextDirection::upwards);
}

}  // namespace

int plot_left_px(const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks) {
  const int left = margin_px + label_height_px + gap_px + longest_label_px(y_ticks) + gap_px + tick_px;
  return std::max(left, margin_px + longest_label_px(x_ticks) / 2);
}

int x_axis_height_px() {
  return tick_px + 2 * label_height_px + 3 * gap_px;
}

void draw_axes(Image& image, const PixelRect& plot, const PictureAxis& x, const PictureAxis& y) {
  image.draw_frame({plot.x - 1, plot.y - 1, plot.width + 2, plot.height + 2}, picture_ink);
  draw_x_axis(image, plot, x);
  draw_y_axis(image, plot, y);
}

FittedTitle fit_title(const std::string& title, int width_px) {
  if (text_length_px(title, title_scale) <= width_px) return {title, title_scale};
  FittedTitle fitted{title, label_scale};
  std::string kept = title;
  while (!kept.empty() && label_length_px(fitted.text) > width_px) {
    kept.pop_back();
    fitted.text = kept + "...";
  }
  return fitted;
}

}  // namespace dcem::io::detail
