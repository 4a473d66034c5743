#pragma once
/// The pixels that a convex outline touches or crosses on a face of a view. It stands under the name of the
/// instructions that it is compiled for, as what is built on it does (view_walk.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "dcem/core/instruction_set.hpp"
#include "dcem/paths/halves/face_outline.hpp"

namespace dcem::detail {

inline namespace DCEM_ISA {

/// A convex outline in pixels, and the rows that it touches or crosses.
class FaceRows {
 public:
  static constexpr int most_pixels = 1024;

  /// Takes an outline; false where it touches no row.
  bool take(const FaceOutline& outline, int pixels);
  int first() const { return first_; }
  int last() const { return last_; }
  /// The box around the outline, in pixels across and along.
  const std::array<double, 2>& low() const { return low_; }
  const std::array<double, 2>& high() const { return high_; }
  /// The largest 1/depth of a corner.
  double nearest() const { return nearest_; }

  /// Works out from where to where the outline touches each row …
  void find_touched() {
    walk(false, [&](int row, float here, float next) {
      from_[at(row)] = std::min(from_[at(row)], std::min(here, next));
      to_[at(row)] = std::max(to_[at(row)], std::max(here, next));
    });
  }
  /// … or crosses the line above each row, that below the last one included.
  void find_crossed() {
    walk(true, [&](int line, float here, float) {
      from_[at(line)] = std::min(from_[at(line)], here);
      to_[at(line)] = std::max(to_[at(line)], here);
    });
  }
  /// What has been found, of a row or a line; nothing where `to` is less than −1e8.
  float from(int number) const { return from_[at(number)]; }
  float to(int number) const { return to_[at(number)]; }

 private:
  static constexpr double hair = 1e-4;  ///< of a pixel: rounding of a corner
  static std::size_t at(int number) { return static_cast<std::size_t>(number); }

  /// Calls `visit` for each side with each row and the places at which the side enters and leaves it, or with each line
  /// and the place at which the side crosses it.
  template <typename Visit>
  void walk(bool lines, Visit&& visit);

  std::array<double, FaceOutline::capacity> x_, y_;
  std::size_t count_ = 0;
  int first_ = 0, last_ = -1;
  std::array<double, 2> low_, high_;
  double nearest_ = 0.0;
  std::array<float, most_pixels + 1> from_, to_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline bool FaceRows::take(const FaceOutline& outline, int pixels) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  low_ = {infinity, infinity};
  high_ = {-infinity, -infinity};
  nearest_ = 0.0;
  count_ = outline.size();
  for (std::size_t index = 0; index < count_; ++index) {
    const double inverse = 1.0 / std::max(outline[index].depth, 1e-6);
    x_[index] = std::clamp((outline[index].across * inverse + 1.0) * 0.5, -0.5, 1.5) * pixels;
    y_[index] = std::clamp((outline[index].along * inverse + 1.0) * 0.5, -0.5, 1.5) * pixels;
    nearest_ = std::max(nearest_, inverse);
    low_ = {std::min(low_[0], x_[index]), std::min(low_[1], y_[index])};
    high_ = {std::max(high_[0], x_[index]), std::max(high_[1], y_[index])};
  }
  first_ = std::max(0, static_cast<int>(std::floor(low_[1] - hair)));
  last_ = std::min(pixels - 1, static_cast<int>(std::floor(high_[1] + hair)));
  return first_ <= last_;
}

template <typename Visit>
void FaceRows::walk(bool lines, Visit&& visit) {
  constexpr float nothing = 1e9F;
  std::fill(from_.begin() + first_, from_.begin() + last_ + 2, nothing);
  std::fill(to_.begin() + first_, to_.begin() + last_ + 2, -nothing);
  for (std::size_t index = 0; index < count_; ++index) {
    std::size_t start = index, end = index + 1 == count_ ? 0 : index + 1;
    if (y_[start] > y_[end]) std::swap(start, end);
    const double x = x_[start], y = y_[start], length = y_[end] - y;
    const bool level = !(length > 1e-12);
    if (lines && level) continue;
    const double slope = level ? 0.0 : (x_[end] - x) / length;
    const int begin = std::max(first_, static_cast<int>(lines ? std::ceil(y) : std::floor(y - hair)));
    const int last = std::min(last_ + (lines ? 1 : 0), static_cast<int>(std::floor(y_[end] + (lines ? 0.0 : hair))));
    const auto place = [&](int line) { return static_cast<float>(x + slope * std::clamp(line - y, 0.0, length)); };
    float here = level ? static_cast<float>(x) : place(begin);
    for (int number = begin; number <= last; ++number) {
      const float next = level ? static_cast<float>(x_[end]) : place(number + 1);
      visit(number, here, next);
      here = next;
    }
  }
}

}  // namespace DCEM_ISA

}  // namespace dcem::detail
