#pragma once
/// What wide trees are built from: boxes in single precision, four numbers at a time, and the binary tree over them.
///
/// The boxes steer splits only, so their rounding costs nothing but quality.
#include <cstdint>
#include <limits>

#include "dcem/core/simd.hpp"

namespace dcem {

namespace detail {

/// Of a box of so many metres along the axes.
inline float half_area_of(const Float4& size_m) {
  const Float4 faces_m2 = size_m * __builtin_shufflevector(size_m, size_m, 1, 2, 0, 3);
  return faces_m2[0] + faces_m2[1] + faces_m2[2];
}

}  // namespace detail

/// What the tree is built from.
struct WideItem {
  static constexpr std::uint32_t no_kind = 0xffffffffU;  ///< of an item that shares a leaf with nothing

  Float4 low, high;  ///< the box; an empty one is a point at 0. The fourth numbers: 0, and what `note_size` says
  std::uint32_t index = 0;
  std::uint32_t kind = no_kind;  ///< items of one kind may share a leaf

  /// Makes half the surface a fourth coordinate. Items are divided by it, too: the ground of a city is as large as all
  /// else together, and wherever its centre lies the box of what is beside it would be everything.
  void note_size() {
    constexpr float most_m2 = 1e32F;  // more than any tree has; the sum of two is still a number
    const float half_area_m2 = detail::half_area_of(high - low);
    high[3] = half_area_m2 < most_m2 ? half_area_m2 : most_m2;
  }

  /// And the size, as the fourth number.
  Float4 twice_centre() const { return low + high; }
};

/// A node of the binary tree. Children stand behind their parents.
struct WideSplit {
  float half_area_m2 = 0.0F;
  std::uint32_t left = 0, right = 0;   ///< 0: a leaf
  std::uint32_t first = 0, count = 0;  ///< positions of the items below

  bool is_leaf() const { return left == 0; }
};

namespace detail {

/// A box in single precision, empty at first; the fourth number is of no account.
struct FloatBox {
  Float4 low = Float4{} + std::numeric_limits<float>::infinity();
  Float4 high = Float4{} - std::numeric_limits<float>::infinity();

  void extend(const Float4& other_low, const Float4& other_high) {
    low = low < other_low ? low : other_low;
    high = high > other_high ? high : other_high;
  }
  void extend(const FloatBox& other) { extend(other.low, other.high); }
  float half_area() const {
    const Float4 size = high - low;
    return size[0] >= 0.0F ? half_area_of(size) : 0.0F;
  }
  friend bool operator==(const FloatBox& one, const FloatBox& other) {
    const Int4 differ = (one.low != other.low) | (one.high != other.high);
    return (differ[0] | differ[1] | differ[2]) == 0;
  }
};

}  // namespace detail

}  // namespace dcem
