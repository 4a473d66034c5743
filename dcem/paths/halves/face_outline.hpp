#pragma once
/// Convex outlines on a face of a cube, and the pixels that they touch or cross.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace dcem {

namespace detail {

/// A point in front of one face of the cube: seen at (across/depth, along/depth), both between −1 and 1 on the face.
struct FacePoint {
  double across, along, depth;
};

/// A convex outline on a face. More corners than that are not looked at.
class FaceOutline {
 public:
  static constexpr std::size_t capacity = 64;
  static constexpr std::size_t most_corners = 48;  ///< before it is clipped

  void add(const FacePoint& point) { corners_[count_++] = point; }
  std::size_t size() const { return count_; }
  const FacePoint& operator[](std::size_t index) const { return corners_[index]; }

  /// Cuts off what lies outside |across|, |along| ≤ reach·depth.
  void clip(double reach) {
    for (int side = 0; side < 4 && count_ > 0; ++side) clip_by(side, reach);
  }

 private:
  static double inside(const FacePoint& point, int side, double reach) {
    const double offset = side < 2 ? point.across : point.along;
    return reach * point.depth + (side % 2 == 0 ? offset : -offset);
  }

  void clip_by(int side, double reach) {
    const auto cut_off = [&](const FacePoint& corner) { return inside(corner, side, reach) < 0.0; };
    if (std::none_of(corners_.begin(), corners_.begin() + static_cast<std::ptrdiff_t>(count_), cut_off)) return;
    std::array<FacePoint, capacity> kept;
    std::size_t count = 0;
    for (std::size_t index = 0; index < count_; ++index) {
      const FacePoint &from = corners_[index], &to = corners_[index + 1 == count_ ? 0 : index + 1];
      const double here = inside(from, side, reach), there = inside(to, side, reach);
      if (here >= 0.0) kept[count++] = from;
      if ((here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0)) {
        const double share = here / (here - there);
        kept[count++] = {from.across + share * (to.across - from.across), from.along + share * (to.along - from.along),
                         from.depth + share * (to.depth - from.depth)};
      }
    }
    std::copy(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(count), corners_.begin());
    count_ = count;
  }

  std::array<FacePoint, capacity> corners_;
  std::size_t count_ = 0;
};

/// The rows of pixels that a convex outline touches, and in each of them from where to where.
struct FaceRows {
  static constexpr int most_pixels = 1024;

  int first = 0, last = -1;
  std::array<float, most_pixels> touched_from, touched_to;      ///< in the whole row
  std::array<float, most_pixels + 1> crossed_from, crossed_to;  ///< on the line above each row
  double nearest = 0.0;                                         ///< the largest 1/depth of a corner

  /// False where the outline touches no row.
  bool find(const FaceOutline& outline, int pixels);
};

}  // namespace detail

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline bool FaceRows::find(const FaceOutline& outline, int pixels) {
  constexpr float nothing = 1e9F;
  constexpr double hair = 1e-4;  // of a pixel: rounding of a corner
  std::array<double, FaceOutline::capacity> x, y;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  nearest = 0.0;
  for (std::size_t index = 0; index < outline.size(); ++index) {
    const double depth = std::max(outline[index].depth, 1e-6);
    x[index] = std::clamp((outline[index].across / depth + 1.0) * 0.5, -0.5, 1.5) * pixels;
    y[index] = std::clamp((outline[index].along / depth + 1.0) * 0.5, -0.5, 1.5) * pixels;
    nearest = std::max(nearest, 1.0 / depth);
    low = std::min(low, y[index]);
    high = std::max(high, y[index]);
  }
  first = std::max(0, static_cast<int>(std::floor(low - hair)));
  last = std::min(pixels - 1, static_cast<int>(std::floor(high + hair)));
  if (first > last) return false;
  const auto at = [](int number) { return static_cast<std::size_t>(number); };
  std::fill(touched_from.begin() + first, touched_from.begin() + last + 1, nothing);
  std::fill(touched_to.begin() + first, touched_to.begin() + last + 1, -nothing);
  std::fill(crossed_from.begin() + first, crossed_from.begin() + last + 2, nothing);
  std::fill(crossed_to.begin() + first, crossed_to.begin() + last + 2, -nothing);
  for (std::size_t index = 0; index < outline.size(); ++index) {
    std::size_t from = index, to = index + 1 == outline.size() ? 0 : index + 1;
    if (y[from] > y[to]) std::swap(from, to);
    const int begin = std::max(first, static_cast<int>(std::floor(y[from] - hair)));
    const int end = std::min(last, static_cast<int>(std::floor(y[to] + hair)));
    const bool level = !(y[to] - y[from] > 1e-12);
    const double slope = level ? 0.0 : (x[to] - x[from]) / (y[to] - y[from]);
    const auto place = [&](double line) { return x[from] + slope * (std::clamp(line, y[from], y[to]) - y[from]); };
    for (int number = begin; number <= end; ++number) {
      double left = level ? x[from] : place(number), right = level ? x[to] : place(number + 1);
      if (left > right) std::swap(left, right);
      touched_from[at(number)] = std::min(touched_from[at(number)], static_cast<float>(left));
      touched_to[at(number)] = std::max(touched_to[at(number)], static_cast<float>(right));
      for (int line = number; line <= number + 1 && !level; ++line) {
        if (line < y[from] || line > y[to]) continue;
        const auto crossing = static_cast<float>(place(line));
        crossed_from[at(line)] = std::min(crossed_from[at(line)], crossing);
        crossed_to[at(line)] = std::max(crossed_to[at(line)], crossing);
      }
    }
  }
  return true;
}

}  // namespace detail

}  // namespace dcem
