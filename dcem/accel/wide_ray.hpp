#pragma once
/// A ray prepared for nodes of eight boxes and blocks of eight patches, in single precision.
///
/// Single precision never decides against double precision: a box that the double ray meets is met, and of a patch the
/// answer is "surely not", "surely" or "ask".
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "dcem/accel/simd.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

class WideRay {
 public:
  /// `extent_m`: no bound of the tree's boxes is larger, counted from its origin.
  WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m);

  /// False where single precision does not do: numbers that are not finite or beyond 1e12, a direction shorter than
  /// 1e-12, t_min below 0 or above t_max.
  bool usable() const { return usable_; }

  /// The largest entry that still counts as reaching `t`.
  static float padded(double t) { return static_cast<float>(std::min(t, 1e30)) * (1.0F + 8 * unit); }

  /// Bit i: the ray may meet box i of the node between t_min and `t_max` (padded). `entry`: where it enters, from t_min
  /// on.
  ///
  /// Formula: the slab method, each bound as b·r − o·r with one multiply_add. o·r is rounded: an error of the origin by
  /// a few units of its last place. Therefore the origin is moved outwards for the near and for the far planes, by
  /// 4 units of the largest |o| + extent, which holds without fused operations too; the far bounds are scaled by 1 + 12
  /// units for the roundings of r, of the direction and of the product. A direction that is all but zero on an axis is
  /// taken for 1e-20, which leads astray by at most 1e-8 of that length, because the longest is at least 1e-12.
  std::uint32_t meets(const WideNode& node, float t_max, Float8& entry) const;

  /// What is known of a ray and the patches of a block.
  struct PatchHits {
    Float8 first;           ///< a patch is met no earlier than here
    Float8 last;            ///< and no later than here
    std::uint32_t certain;  ///< bit i: patch i is met, not before t_min
  };

  /// Bit i: the ray may meet patch i of the block between t_min and `t_max` (padded).
  ///
  /// Formula: the edge functions of the sheared corners as in WatertightRay; inside where all four have one sign; t
  /// from the plane of the patch. Error: a sheared coordinate is off by at most δ = 16 units of (distance + size), an
  /// edge function of a quadrilateral that holds the origin by at most 10·diameter·δ + 2δ² (its corners are within two
  /// diameters); a bent pair adds its bend to δ. The plane is off by 2δ + bend along its normal, which t feels divided
  /// by the slope.
  std::uint32_t meets(const PatchBlock& block, float t_max, PatchHits& hits) const;

 private:
  static constexpr float unit = 0x1p-24F;  ///< relative error of one rounding
  static constexpr float least_slope = 1e-20F;

  void shear(const PatchBlock& block, std::size_t corner, float x_shift, float y_shift, Float8& x, Float8& y) const {
    simd::load(x, block.corner_m[corner][axis_[0]].data());
    simd::load(y, block.corner_m[corner][axis_[1]].data());
    Float8 z;
    simd::load(z, block.corner_m[corner][axis_[2]].data());
    Float8 sheared = z;
    simd::multiply_add(sheared, Float8{} - shear_[0], x + x_shift);
    x = sheared;
    sheared = z;
    simd::multiply_add(sheared, Float8{} - shear_[1], y + y_shift);
    y = sheared;
  }

  /// p × q of two sheared corners: positive on one side of the edge between them.
  [[gnu::always_inline]] static void edge(const Float8& px, const Float8& py, const Float8& qx, const Float8& qy,
                                          Float8& result) {
    result = qx;
    simd::multiply_add(result, py, -qy * px);
  }

  void prepare_patches(const Float4& from, const Float4& from_low, const Float4& direction, std::uint32_t z);

  using Axes = std::array<float, 4>;  ///< x, y, z and one more to fill the register

  // Left without initial values: each ray would pay for them.
  alignas(16) Axes near_offset_, far_offset_, reciprocal_, far_reciprocal_;
  alignas(16) Axes direction_, patch_origin_, patch_origin_low_, shear_;  ///< in the order of axis_
  std::array<std::uint32_t, 3> near_;  ///< rows of WideNode::bounds_m that face the ray
  std::array<std::uint32_t, 3> axis_;  ///< the last one is the ray's main axis
  float t_min_;
  bool usable_;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

[[gnu::always_inline]] inline Float4 absolute(const Float4& value) {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(value) & std::int32_t{0x7fffffff});
}
[[gnu::always_inline]] inline Float4 with_sign(const Float4& size, const Int4& sign) {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(size) | sign);
}

}  // namespace detail

[[gnu::always_inline]] inline WideRay::WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m) {
  const Double4 origin = Double4{ray.origin.x, ray.origin.y, ray.origin.z, 0.0} -
                         Double4{tree_origin_m.x, tree_origin_m.y, tree_origin_m.z, 0.0};
  const Float4 from = __builtin_convertvector(origin, Float4);
  const Float4 from_low = __builtin_convertvector(origin - __builtin_convertvector(from, Double4), Float4);
  const Float4 direction =
      __builtin_convertvector((Double4{ray.direction.x, ray.direction.y, ray.direction.z, 1.0}), Float4);
  const Float4 size = detail::absolute(direction), distance = detail::absolute(from);
  const Int4 sign = std::bit_cast<Int4>(direction) & std::int32_t{-0x7fffffff - 1};
  const Float4 least = Float4{} + least_slope;
  const Float4 reciprocal = 1.0F / detail::with_sign(size > least ? size : least, sign);
  const Float4 far_reciprocal = reciprocal * (1.0F + 12 * unit);
  const float farthest = std::max(distance[0], std::max(distance[1], distance[2]));
  const Float4 step = detail::with_sign(Float4{} + ((farthest + extent_m) * (4 * unit) + 1e-20F), sign);
  const Float4 near_offset = -(from + step) * reciprocal, far_offset = -(from - step) * far_reciprocal;
  std::memcpy(reciprocal_.data(), &reciprocal, sizeof reciprocal);
  std::memcpy(far_reciprocal_.data(), &far_reciprocal, sizeof far_reciprocal);
  std::memcpy(near_offset_.data(), &near_offset, sizeof near_offset);
  std::memcpy(far_offset_.data(), &far_offset, sizeof far_offset);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    near_[axis] = static_cast<std::uint32_t>(2 * axis) + (static_cast<std::uint32_t>(sign[axis]) >> 31U);
  }
  const float longest = std::max(size[0], std::max(size[1], size[2]));
  // Without branches, because rays point everywhere; NaN fails every comparison.
  usable_ = ((longest > 1e-12F) & (longest < 1e12F) & (farthest < 1e12F) & (ray.t_min >= 0.0) &
             (ray.t_min <= ray.t_max) & (size[0] <= longest) & (size[1] <= longest) & (size[2] <= longest) &
             (distance[0] <= farthest) & (distance[1] <= farthest) & (distance[2] <= farthest)) != 0;
  t_min_ = static_cast<float>(std::min(ray.t_min, 1e30)) * (1.0F - 8 * unit);
  const std::uint32_t z_is_longest = size[2] > std::max(size[0], size[1]) ? 1U : 0U;
  prepare_patches(from, from_low, direction, 2 * z_is_longest + (1 - z_is_longest) * (size[1] > size[0] ? 1U : 0U));
}

[[gnu::always_inline]] inline void WideRay::prepare_patches(const Float4& from, const Float4& from_low,
                                                            const Float4& direction, std::uint32_t z) {
  constexpr std::array<std::uint32_t, 5> turn{0, 1, 2, 0, 1};
  axis_ = {turn[z + 1], turn[z + 2], z};
  alignas(16) Axes along, at, at_low;
  std::memcpy(along.data(), &direction, sizeof direction);
  std::memcpy(at.data(), &from, sizeof from);
  std::memcpy(at_low.data(), &from_low, sizeof from_low);
  for (std::size_t slot = 0; slot < 3; ++slot) {
    direction_[slot] = along[axis_[slot]];
    patch_origin_[slot] = at[axis_[slot]];
    patch_origin_low_[slot] = at_low[axis_[slot]];
  }
  shear_ = {direction_[0] * reciprocal_[z], direction_[1] * reciprocal_[z], reciprocal_[z], 0.0F};
}

[[gnu::always_inline]] inline std::uint32_t WideRay::meets(const WideNode& node, float t_max, Float8& entry) const {
  Float8 near_x, near_y, near_z, far_x, far_y, far_z;
  simd::load(near_x, node.bounds_m[near_[0]].data());
  simd::load(near_y, node.bounds_m[near_[1]].data());
  simd::load(near_z, node.bounds_m[near_[2]].data());
  simd::load(far_x, node.bounds_m[near_[0] ^ 1U].data());
  simd::load(far_y, node.bounds_m[near_[1] ^ 1U].data());
  simd::load(far_z, node.bounds_m[near_[2] ^ 1U].data());
  simd::multiply_add(near_x, Float8{} + reciprocal_[0], Float8{} + near_offset_[0]);
  simd::multiply_add(near_y, Float8{} + reciprocal_[1], Float8{} + near_offset_[1]);
  simd::multiply_add(near_z, Float8{} + reciprocal_[2], Float8{} + near_offset_[2]);
  simd::multiply_add(far_x, Float8{} + far_reciprocal_[0], Float8{} + far_offset_[0]);
  simd::multiply_add(far_y, Float8{} + far_reciprocal_[1], Float8{} + far_offset_[1]);
  simd::multiply_add(far_z, Float8{} + far_reciprocal_[2], Float8{} + far_offset_[2]);
  simd::set_maximum(near_x, near_y);
  simd::set_maximum(near_z, Float8{} + t_min_);
  simd::set_maximum(near_x, near_z);
  simd::set_minimum(far_x, far_y);
  simd::set_minimum(far_z, Float8{} + t_max);
  simd::set_minimum(far_x, far_z);
  entry = near_x;
  return simd::bits(near_x <= far_x);
}

[[gnu::always_inline]] inline std::uint32_t WideRay::meets(const PatchBlock& block, float t_max,
                                                           PatchHits& hits) const {
  // From the ray's origin to the centre: rounded relative to their distance, because the centre is exact.
  const float x0 = (block.centre_m[axis_[0]] - patch_origin_[0]) - patch_origin_low_[0];
  const float y0 = (block.centre_m[axis_[1]] - patch_origin_[1]) - patch_origin_low_[1];
  const float z0 = (block.centre_m[axis_[2]] - patch_origin_[2]) - patch_origin_low_[2];
  const float distance_m = std::max(std::abs(x0), std::max(std::abs(y0), std::abs(z0))) + block.size_m;
  const float error_m = 16 * unit * distance_m;
  const float x_shift = x0 - shear_[0] * z0, y_shift = y0 - shear_[1] * z0;
  Float8 ax, ay, bx, by, cx, cy, dx, dy;
  shear(block, 0, x_shift, y_shift, ax, ay);
  shear(block, 1, x_shift, y_shift, bx, by);
  shear(block, 2, x_shift, y_shift, cx, cy);
  shear(block, 3, x_shift, y_shift, dx, dy);
  Float8 ab, bc, cd, da;
  edge(ax, ay, bx, by, ab);
  edge(bx, by, cx, cy, bc);
  edge(cx, cy, dx, dy, cd);
  edge(dx, dy, ax, ay, da);
  Float8 bend, reach;
  simd::load(bend, block.bend_m.data());
  simd::load(reach, block.reach_m.data());
  const Float8 error = reach * (error_m + bend) + 2 * error_m * error_m;
  Float8 low = ab, high = ab;
  simd::set_minimum(low, bc);
  simd::set_maximum(high, bc);
  Float8 other_low = cd, other_high = cd;
  simd::set_minimum(other_low, da);
  simd::set_maximum(other_high, da);
  simd::set_minimum(low, other_low);
  simd::set_maximum(high, other_high);
  // Refusals are asked for, not passes: NaN, from numbers near the limits, refuses nothing.
  const std::uint32_t candidates = block.lanes & ~simd::bits((low < -error) & (high > error));
  if (candidates == 0) return 0;
  Float8 nx, ny, nz, t;
  simd::load(nx, block.normal[axis_[0]].data());
  simd::load(ny, block.normal[axis_[1]].data());
  simd::load(nz, block.normal[axis_[2]].data());
  simd::load(t, block.offset_m.data());
  const Float8 steepness = 1.0F / (nx * direction_[0] + ny * direction_[1] + nz * direction_[2]);
  t = (t + nx * x0 + ny * y0 + nz * z0) * steepness;
  Float8 margin = (2 * error_m + bend) * steepness;
  margin = margin < 0.0F ? -margin : margin;
  hits.first = t - margin;
  hits.last = t + margin;
  // Far beside a patch the products are rounded by more than the error allows for.
  const Int8 is_near = (ax < reach) & (ax > -reach) & (ay < reach) & (ay > -reach);
  hits.certain = candidates & simd::bits(((low > error) | (high < -error)) & is_near & (hits.first > t_min_));
  return candidates & ~simd::bits((hits.first > t_max) | (hits.last < t_min_));
}

}  // namespace dcem
