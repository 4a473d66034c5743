#pragma once
/// The boxes that trees accept: finite ones and empty ones.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "dcem/geometry/aabb.hpp"

namespace dcem {

/// Largest number of primitives of one tree: positions and slots are 32-bit numbers, and there are two slots each.
inline constexpr std::size_t maximum_primitive_count = std::size_t{1} << 30;

/// Largest coordinate of a box, metres: far beyond any scene, and its surfaces still fit into a float.
inline constexpr double maximum_coordinate_m = 1e15;

/// Every empty box becomes the one empty box: a box turned inside out on one axis would otherwise grow its parents.
template <std::floating_point Scalar>
Aabb<Scalar> canonical_box(const Aabb<Scalar>& box) {
  return box.empty() ? Aabb<Scalar>{} : box;
}

/// Whether a box has min ≤ max and corners within maximum_coordinate_m, as nearly all have. Without branches, for the
/// sake of scenes with many; NaN fails every comparison.
template <std::floating_point Scalar>
bool is_plain_box(const Aabb<Scalar>& box) {
  constexpr auto limit = static_cast<Scalar>(maximum_coordinate_m);
  const auto is_plain = [limit](Scalar low, Scalar high) {
    return static_cast<unsigned>((low >= -limit) & (high <= limit) & (low <= high));
  };
  return (is_plain(box.min.x, box.max.x) & is_plain(box.min.y, box.max.y) & is_plain(box.min.z, box.max.z)) != 0;
}

namespace detail {

/// Looks at boxes four numbers at a time, and only at the end whether all were plain: for scenes with many.
class PlainBoxes {
 public:
  void add(const Aabb<double>& box) {
    static_assert(sizeof box == 48);
    Double4 first, last;  // min and max.x; min.z and max
    std::memcpy(&first, &box, sizeof first);
    std::memcpy(&last, reinterpret_cast<const char*>(&box) + 16, sizeof last);
    const Double4 max = __builtin_shufflevector(first, last, 5, 6, 7, 5);
    holds_ &= (first >= -maximum_coordinate_m) & (first <= maximum_coordinate_m) & (last >= -maximum_coordinate_m) &
              (last <= maximum_coordinate_m) & (first <= max);
  }
  bool all() const { return (holds_[0] & holds_[1] & holds_[2] & holds_[3]) != 0; }

 private:
  using Double4 = double __attribute__((vector_size(32)));
  using Long4 = std::int64_t __attribute__((vector_size(32)));

  Long4 holds_ = ~Long4{};
};

}  // namespace detail

/// The same for numbers of double precision, faster.
inline bool is_plain_box(const Aabb<double>& box) {
  detail::PlainBoxes one;
  one.add(box);
  return one.all();
}

/// True for a plain box, and for an empty one (min > max on some axis) without NaN.
template <std::floating_point Scalar>
bool is_valid_box(const Aabb<Scalar>& box) {
  const auto has_nan = [](const Vector3<Scalar>& corner) {
    return std::isnan(corner.x) || std::isnan(corner.y) || std::isnan(corner.z);
  };
  return is_plain_box(box) || (box.empty() && !has_nan(box.min) && !has_nan(box.max));
}

template <std::floating_point Scalar>
void require_valid_box(const Aabb<Scalar>& box, std::size_t primitive) {
  if (!is_valid_box(box)) {
    throw std::invalid_argument("box of primitive " + std::to_string(primitive) +
                                " has NaN, infinity or a corner beyond 1e15 m");
  }
}

/// Whether all of many boxes are plain.
inline bool are_plain_boxes(std::span<const Aabb<double>> boxes) {
  detail::PlainBoxes plain;
  for (const Aabb<double>& box : boxes) plain.add(box);
  return plain.all();
}

/// Throws std::invalid_argument for a box that is not valid, and for more boxes than a tree can number.
template <std::floating_point Scalar>
void require_valid_boxes(std::span<const Aabb<Scalar>> boxes) {
  if (boxes.size() > maximum_primitive_count) throw std::invalid_argument("a tree holds at most 2^30 primitives");
  if constexpr (std::is_same_v<Scalar, double>) {
    if (are_plain_boxes(boxes)) return;
  }
  for (std::size_t primitive = 0; primitive < boxes.size(); ++primitive) {
    require_valid_box(boxes[primitive], primitive);
  }
}

/// Throws std::invalid_argument unless the primitives come in objects [object_first[i], object_first[i+1]) that start
/// at 0.
inline void require_valid_objects(std::span<const std::uint32_t> object_first, std::size_t primitive_count) {
  std::size_t previous = 0;
  for (const std::uint32_t first : object_first) {
    if (first < previous || first > primitive_count) throw std::invalid_argument("object starts must ascend");
    previous = first;
  }
  const bool starts_at_zero = object_first.empty() ? primitive_count == 0 : object_first.front() == 0;
  if (!starts_at_zero) throw std::invalid_argument("the first object must start at primitive 0");
}

/// The smallest box of another precision that holds `box`: a tree in float over geometry in double must round outward.
template <std::floating_point Target, std::floating_point Source>
Aabb<Target> rounded_outward(const Aabb<Source>& box) {
  Aabb<Target> result;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr Target infinity = std::numeric_limits<Target>::infinity();
    const auto low = static_cast<Target>(box.min[axis]);
    const auto high = static_cast<Target>(box.max[axis]);
    result.min[axis] = static_cast<Source>(low) > box.min[axis] ? std::nextafter(low, -infinity) : low;
    result.max[axis] = static_cast<Source>(high) < box.max[axis] ? std::nextafter(high, infinity) : high;
  }
  return result;
}

}  // namespace dcem
