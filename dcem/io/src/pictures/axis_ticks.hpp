#pragma once
/// Round values along the axis of a picture and their labels.
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/src/pictures/canvas.hpp"

namespace dcem::io::detail {

/// Of tick labels, names of axes and legends.
inline constexpr TextStyle label_style{26.0};

/// Length of a text in that style, in whole pixels.
int label_length_px(std::string_view text);

struct Tick {
  double value = 0.0;
  std::string label;
};

/// The smallest of 1, 2, 5 · 10^n that is not below `least` > 0.
double round_step_at_least(double least);

/// Round values from `low` to `high` > `low` at least `gap_px` apart on an axis of `length_px`; the middle of the axis
/// where it is too short for any.
std::vector<Tick> axis_ticks(double low, double high, int length_px, int gap_px);

/// The same for an axis whose labels stand side by side: apart by more than their own length.
std::vector<Tick> horizontal_axis_ticks(double low, double high, int length_px);

/// Length of the longest label in pixels; 0 without ticks.
int longest_label_px(const std::vector<Tick>& ticks);

}  // namespace dcem::io::detail
