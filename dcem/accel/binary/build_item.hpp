#pragma once
/// The input of a tree builder.
#include <concepts>
#include <cstdint>
#include <span>
#include <tuple>

#include "dcem/geometry/aabb.hpp"

namespace dcem {

/// What a tree is built from: a box (finite or canonically empty), its centre, and the number the caller knows it by.
template <std::floating_point Scalar>
struct BuildItem {
  Aabb<Scalar> box;
  Vector3<Scalar> center{0};
  std::uint32_t index = 0;

  BuildItem() = default;
  BuildItem(const Aabb<Scalar>& item_box, std::uint32_t item_index)
      : box(item_box), center(item_box.empty() ? Vector3<Scalar>(0) : item_box.center()), index(item_index) {}

  /// A total order along one axis; the index decides only between equal boxes.
  bool before(const BuildItem& other, int axis) const {
    if (center[axis] != other.center[axis]) return center[axis] < other.center[axis];
    const auto key = [](const BuildItem& item) {
      const auto& [low, high] = item.box;
      return std::tuple(low.x, low.y, low.z, high.x, high.y, high.z, item.index);
    };
    return key(*this) < key(other);
  }
};

/// The box around the boxes of `items`.
template <std::floating_point Scalar>
Aabb<Scalar> bounds_of(std::span<const BuildItem<Scalar>> items) {
  Aabb<Scalar> box;
  for (const BuildItem<Scalar>& item : items) box.extend(item.box);
  return box;
}

/// The box around the centres of `items`.
template <std::floating_point Scalar>
Aabb<Scalar> center_bounds_of(std::span<const BuildItem<Scalar>> items) {
  Aabb<Scalar> box;
  for (const BuildItem<Scalar>& item : items) box.extend(item.center);
  return box;
}

}  // namespace dcem
