#pragma once
/// The axes of a picture: a frame around the plot, ticks with labels, names. Private to dcem::io.
#include <string>
#include <vector>

#include "dcem/io/image.hpp"
#include "dcem/io/src/pictures/axis_ticks.hpp"

namespace dcem::io::detail {

inline constexpr int title_scale = 3;
inline const int label_height_px = text_height_px(label_scale);
inline constexpr int margin_px = 18;
inline constexpr int tick_px = 6;
inline constexpr int gap_px = 8;

inline constexpr Colour picture_ink{30, 30, 30}, white{255, 255, 255};

/// An axis along an edge of a plot.
struct PictureAxis {
  std::vector<Tick> ticks;
  std::string name;  // with its unit
  double low = 0.0;  // at the left or the lower edge of the plot
  double px_per_unit = 1.0;
};

/// `label / unit`, or the label alone where there is no unit.
inline std::string axis_name(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label + " / " + unit;
}

/// Pixels from the left of a picture to its plot: room for the labels of the y axis, its name and half an x label.
int plot_left_px(const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks);

/// Pixels that the x axis takes below the plot.
int x_axis_height_px();

void draw_axes(Image& image, const PixelRect& plot, const PictureAxis& x, const PictureAxis& y);

/// A title set smaller where it is too long, and then cut.
struct FittedTitle {
  std::string text;
  int scale = title_scale;
};
FittedTitle fit_title(const std::string& title, int width_px);

}  // namespace dcem::io::detail
