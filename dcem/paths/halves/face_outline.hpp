#pragma once
/// Convex outlines on a face of a view, and what the pixels of a face hold.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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
    unsigned outside_all = 15U, outside_any = 0U;  // by side, a bit each
    for (std::size_t index = 0; index < count_; ++index) {
      const FacePoint& point = corners_[index];
      const double limit = reach * point.depth;
      const unsigned outside = (limit + point.across < 0.0 ? 1U : 0U) | (limit - point.across < 0.0 ? 2U : 0U) |
                               (limit + point.along < 0.0 ? 4U : 0U) | (limit - point.along < 0.0 ? 8U : 0U);
      outside_all &= outside;
      outside_any |= outside;
    }
    if (outside_all != 0U) count_ = 0;
    for (int side = 0; side < 4 && count_ > 0; ++side) {
      if ((outside_any >> static_cast<unsigned>(side) & 1U) != 0U) clip_by(side, reach);
    }
  }

 private:
  static double inside(const FacePoint& point, int side, double reach) {
    const double offset = side < 2 ? point.across : point.along;
    return reach * point.depth + (side % 2 == 0 ? offset : -offset);
  }

  void clip_by(int side, double reach) {
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

/// 1/depth of a plane over a face: by_column·x + by_row·y + at_origin, in pixels.
struct FaceNearness {
  double by_column, by_row, at_origin;
};

/// What is known of the pixels of a face: `pixels` to a side, row by row, and `tiles` of them to a side.
struct FacePixels {
  static constexpr int tile_pixels = 8;  ///< to a side of a tile

  const float* nearness;  ///< 1/depth of what fills the pixel; 0: nothing does
  float* tile_nearness;   ///< no more than the smallest in a tile …
  char* tile_is_old;      ///< … and whether it may be less
  int pixels, tiles;

  const float* row(int number) const { return nearness + static_cast<std::ptrdiff_t>(number) * pixels; }
};

/// Relative, of nearness in single precision: 80 units of the last place.
inline constexpr double nearness_rounding = 1e-5;

/// What single precision may add to or take from a nearness that is summed over a row.
inline double slack_of(const FaceNearness& nearness, int pixels) {
  return 4e-7 * ((std::abs(nearness.by_column) + std::abs(nearness.by_row)) * pixels + std::abs(nearness.at_origin));
}

}  // namespace detail

}  // namespace dcem
