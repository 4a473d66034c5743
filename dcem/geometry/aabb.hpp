#pragma once
/// Axis-aligned bounding box.
#include <algorithm>
#include <concepts>
#include <limits>

#include "dcem/geometry/vector.hpp"

namespace dcem {

/// A box as its two extreme corners, metres. A new box is empty: it holds nothing and grows from nothing.
template <std::floating_point Scalar>
struct Aabb {
  Vector3<Scalar> min{std::numeric_limits<Scalar>::infinity()};
  Vector3<Scalar> max{-std::numeric_limits<Scalar>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }

  void extend(const Vector3<Scalar>& point) {
    min = {std::min(min.x, point.x), std::min(min.y, point.y), std::min(min.z, point.z)};
    max = {std::max(max.x, point.x), std::max(max.y, point.y), std::max(max.z, point.z)};
  }
  void extend(const Aabb& box) {
    min = {std::min(min.x, box.min.x), std::min(min.y, box.min.y), std::min(min.z, box.min.z)};
    max = {std::max(max.x, box.max.x), std::max(max.y, box.max.y), std::max(max.z, box.max.z)};
  }

  bool contains(const Vector3<Scalar>& point) const {
    return point.x >= min.x && point.y >= min.y && point.z >= min.z && point.x <= max.x && point.y <= max.y &&
           point.z <= max.z;
  }
  bool contains(const Aabb& box) const { return box.empty() || (contains(box.min) && contains(box.max)); }
  bool overlaps(const Aabb& box) const {
    return min.x <= box.max.x && box.min.x <= max.x && min.y <= box.max.y && box.min.y <= max.y && min.z <= box.max.z &&
           box.min.z <= max.z;
  }

  /// Precondition: the box is not empty.
  Vector3<Scalar> center() const { return (min + max) * Scalar(0.5); }
  Vector3<Scalar> extent() const { return empty() ? Vector3<Scalar>(0) : max - min; }

  /// Half of the surface: what the surface-area heuristic compares; 0 for an empty box.
  Scalar half_area() const {
    const Vector3<Scalar> size = extent();
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }

  friend bool operator==(const Aabb&, const Aabb&) = default;
};

/// The box grown by `margin` on every side.
template <std::floating_point Scalar>
Aabb<Scalar> inflated(const Aabb<Scalar>& box, Scalar margin) {
  return {box.min - Vector3<Scalar>(margin), box.max + Vector3<Scalar>(margin)};
}

}  // namespace dcem
