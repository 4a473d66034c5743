#pragma once
/// Does a ray meet a box? Conservative: a ray that meets the box in exact arithmetic is never refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem {

/// The part of a ray inside a box. `met` is false when there is none.
template <std::floating_point Scalar>
struct SlabEntry {
  Scalar t = 0;  ///< where the ray enters, not before its t_min; meaningless unless met
  bool met = false;
};

/// A ray prepared for tests against many boxes (the slab method).
///
/// Formula: on each axis the ray is between the two planes of the box for t from (near − o)/d to (far − o)/d; it meets
/// the box when the three intervals and [t_min, t_max] have a point in common. Touching counts as meeting.
/// Rounding: each bound carries three roundings (difference, reciprocal, product), a relative error below 1.5 ε, so the
/// larger bound is moved out by 4 ε > 2 · 1.5 ε before the comparison (Ize, "Robust BVH ray traversal", JCGT 2013,
/// pads by 2 ulp for the same reason; Pharr, Jakob, Humphreys, PBRT 3rd ed., 3.9.2: 2 γ₃).
/// Zero direction components: the reciprocal is clamped to the largest finite number and the origin is moved apart by a
/// rounding step for the two planes, so that a ray inside a plane of the box is inside the slab for every t.
/// Inclusion: a box that holds another is met whenever the other is; answers cannot depend on the shape of a tree.
/// Validity: |t| < 1e20 and no underflow of the products; a ray with NaN, an infinite origin or direction, or
/// t_min > t_max meets nothing, nor does any ray meet an empty box.
template <std::floating_point Scalar>
class SlabTest {
 public:
  explicit SlabTest(const Ray<Scalar>& ray) : t_min_(ray.t_min), t_max_(ray.t_max) {
    bool usable = ray.t_min <= ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
      prepare_axis(axis, ray.origin[axis], ray.direction[axis]);
      usable = usable && std::isfinite(ray.origin[axis]) && std::isfinite(ray.direction[axis]);
    }
    if (!usable) t_min_ = std::numeric_limits<Scalar>::quiet_NaN();
    if (ray.direction == Vector3<Scalar>(0)) t_max_ = t_min_;
  }

  /// Where a query along the whole ray starts to narrow: the ray's t_max, but for a ray without direction, which is the
  /// same point for every t, its t_min.
  Scalar t_max() const { return t_max_; }

  /// Where the ray enters `box` on the way to `t_max`.
  /// (Inlined by force: every step of a walk is this, and g++ would call it.)
  [[gnu::always_inline]] SlabEntry<Scalar> enter(const Aabb<Scalar>& box, Scalar t_max) const {
    const Scalar near_x = ((box.*near_corner_[0]).x - near_origin_.x) * reciprocal_.x;
    const Scalar near_y = ((box.*near_corner_[1]).y - near_origin_.y) * reciprocal_.y;
    const Scalar near_z = ((box.*near_corner_[2]).z - near_origin_.z) * reciprocal_.z;
    const Scalar far_x = ((box.*far_corner_[0]).x - far_origin_.x) * reciprocal_.x;
    const Scalar far_y = ((box.*far_corner_[1]).y - far_origin_.y) * reciprocal_.y;
    const Scalar far_z = ((box.*far_corner_[2]).z - far_origin_.z) * reciprocal_.z;
    // std::max keeps its first argument when that is NaN: an unusable ray stays NaN and fails the comparison.
    const Scalar entry = std::max(t_min_, std::max(near_x, std::max(near_y, near_z)));
    const Scalar exit = std::min(t_max, std::min(far_x, std::min(far_y, far_z)));
    return {entry, entry <= padded(exit)};
  }

  bool meets(const Aabb<Scalar>& box, Scalar t_max) const { return enter(box, t_max).met; }

  /// The largest entry that still counts as reaching `t`.
  static Scalar padded(Scalar t) { return t + std::abs(t) * padding; }

 private:
  static constexpr Scalar padding = 4 * std::numeric_limits<Scalar>::epsilon();

  void prepare_axis(int axis, Scalar origin, Scalar direction) {
    constexpr Scalar largest = std::numeric_limits<Scalar>::max();
    const Scalar reciprocal = Scalar(1) / direction;
    const bool parallel = !(std::abs(reciprocal) <= largest);
    const bool backward = !parallel && reciprocal < 0;
    const Scalar step =
        parallel ? std::max(2 * std::numeric_limits<Scalar>::epsilon() * std::abs(origin), Scalar(1e-15)) : Scalar(0);
    reciprocal_[axis] = parallel ? largest : reciprocal;
    near_origin_[axis] = origin + step;
    far_origin_[axis] = origin - step;
    near_corner_[static_cast<std::size_t>(axis)] = backward ? &Aabb<Scalar>::max : &Aabb<Scalar>::min;
    far_corner_[static_cast<std::size_t>(axis)] = backward ? &Aabb<Scalar>::min : &Aabb<Scalar>::max;
  }

  using Corner = Vector3<Scalar> Aabb<Scalar>::*;

  Vector3<Scalar> near_origin_{0};
  Vector3<Scalar> far_origin_{0};
  Vector3<Scalar> reciprocal_{0};
  std::array<Corner, 3> near_corner_{};
  std::array<Corner, 3> far_corner_{};
  Scalar t_min_;
  Scalar t_max_;
};

}  // namespace dcem
