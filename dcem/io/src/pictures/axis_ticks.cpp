#include "dcem/io/src/pictures/axis_ticks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "dcem/io/text_table.hpp"

namespace dcem::io::detail {
namespace {

// Enough digits to tell neighbouring ticks apart; powers of ten where plain numbers would be long.
std::string tick_label(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  if (decimals <= 6 && std::abs(value) < 1e9) return format_fixed(value, decimals);
  if (value == 0.0) return "0";
  const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(step) + 1e-9);
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific,
                                 static_cast<int>(std::clamp(digits, 0.0, 15.0)));
  return {buffer.data(), end.ptr};
}

std::vector<Tick> ticks_with_step(double low, double high, double step) {
  const double slack = 1e-9;  // of a step: a tick on the very end of the axis counts
  std::vector<Tick> ticks;
  for (double k = std::ceil(low / step - slack); k <= high / step + slack; k += 1.0) {
    ticks.push_back({k * step, tick_label(k * step, step)});
    // Coordinates so large that a step is lost in rounding would never end.
    if (k + 1.0 == k || ticks.size() > 100) break;
  }
  return ticks;
}

// An axis too short for any round value is labelled in its middle, with the digits that its length calls for.
std::vector<Tick> middle_tick(double low, double high) {
  const double middle = 0.5 * (low + high);
  return {{middle, tick_label(middle, 0.01 * (high - low))}};
}

}  // namespace

int label_length_px(std::string_view text) {
  return static_cast<int>(std::ceil(text_width_px(text, label_style)));
}

double round_step_at_least(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    // Rounding of the decade must not push an exact step to the next one.
    if (factor * decade >= least * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

int longest_label_px(const std::vector<Tick>& ticks) {
  int longest = 0;
  for (const Tick& tick : ticks) longest = std::max(longest, label_length_px(tick.label));
  return longest;
}

std::vector<Tick> axis_ticks(double low, double high, int length_px, int gap_px) {
  const double unit_per_px = (high - low) / length_px;
  std::vector<Tick> ticks = ticks_with_step(low, high, round_step_at_least(gap_px * unit_per_px));
  return ticks.empty() ? middle_tick(low, high) : ticks;
}

std::vector<Tick> horizontal_axis_ticks(double low, double high, int length_px) {
  // How long the labels are depends on the step, and the step on the labels.
  int gap = 120;
  std::vector<Tick> ticks = axis_ticks(low, high, length_px, gap);
  for (int attempt = 0; attempt < 4 && longest_label_px(ticks) + 40 > gap; ++attempt) {
    gap = longest_label_px(ticks) + 40;
    ticks = axis_ticks(low, high, length_px, gap);
  }
  return ticks;
}

}  // namespace dcem::io::detail
