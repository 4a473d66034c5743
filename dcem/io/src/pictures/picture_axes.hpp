#pragma once
/// The axes of a picture: a frame around the plot, ticks with labels, names. Private to dcem::io.
#include <cmath>
#include <string>
#include <vector>

#include "dcem/io/src/pictures/axis_ticks.hpp"
#include "dcem/io/src/pictures/canvas.hpp"

namespace dcem::io::detail {

inline constexpr TextStyle title_style{32.0, true};
inline constexpr int label_height_px = 26;  // from the top of the capitals to the foot of a 'g', about
inline constexpr int margin_px = 28;
inline constexpr int tick_px = 9;
inline constexpr int gap_px = 13;
inline constexpr double frame_px = 2.0;

inline constexpr Colour picture_ink{30, 30, 30}, white{255, 255, 255}, grid_grey{222, 222, 222};
inline const Stroke ink_stroke{picture_ink, frame_px};

/// An axis along an edge of a plot.
struct PictureAxis {
  std::vector<Tick> ticks;
  std::string name;  // with its unit
  double low = 0.0;  // at the left or the lower edge of the plot; of a logarithmic axis in decades
  double px_per_unit = 1.0;
  bool is_logarithmic = false;

  /// From the left or the lower edge of the plot.
  double offset_px(double value) const { return ((is_logarithmic ? std::log10(value) : value) - low) * px_per_unit; }
};

/// A plot and its axes.
struct PictureFrame {
  PixelRect plot;
  PictureAxis x, y;

  PixelPoint point(double x_value, double y_value) const {
    return {plot.x + x.offset_px(x_value), plot.bottom() - y.offset_px(y_value)};
  }
};

/// `label (unit)`, or the label alone where there is no unit.
inline std::string axis_name(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label + " (" + unit + ")";
}

/// Pixels from the left of a picture to its plot: room for the labels of the y axis, its name and half an x label.
int plot_left_px(const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks);

/// Pixels that the x axis takes below the plot.
int x_axis_height_px();

/// Pale lines from tick to tick, below what is drawn.
void draw_grid_lines(Canvas& canvas, const PictureFrame& frame);

/// Which labels of the x axis stand below a plot: none where the plot below has the same axis.
enum class AxisLabels { ticks_alone, all };

/// Frame, ticks, labels and names.
void draw_axes(Canvas& canvas, const PictureFrame& frame, AxisLabels x_labels = AxisLabels::all);

/// Names in legends and beside symbols are no longer than this.
inline constexpr int longest_name_px = 560;

/// The text, with dots in place of its middle where it is too long: ends tell names apart, and hold the units of
/// titles.
std::string fit_text(const std::string& text, const TextStyle& style, int width_px);

/// A title set smaller where it is too long, then on two lines, and then without its middle.
struct FittedTitle {
  std::string text;
  TextStyle style = title_style;
  std::string second_line{};

  /// By how much more what stands below it lies lower.
  int more_px() const { return second_line.empty() ? 0 : label_height_px + gap_px; }
};
FittedTitle fit_title(const std::string& title, int width_px);

/// Draws it; `at` is the left end of its first line, in the middle of the capitals.
void draw_title(Canvas& canvas, const FittedTitle& title, PixelPoint at);
/// The same at the upper edge of a picture, from `left_px` on.
void draw_title(Canvas& canvas, const FittedTitle& title, int left_px);

/// Pixels from the upper edge to where what stands below a title of one line begins.
inline constexpr int title_bottom_px = margin_px + 24 + 2 * gap_px;

}  // namespace dcem::io::detail
