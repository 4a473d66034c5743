#pragma once
/// A ray prepared for nodes of eight boxes and leaves of eight quads, in single precision.
///
/// Single precision never decides against double precision: a box that the double ray meets is met, and of a quad the
/// answer is "surely not", "surely" or "ask".
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "dcem/accel/wide/node.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// What single precision knows of a ray and a quad that it may meet.
enum class QuadKnowledge : std::uint8_t {
  nothing,
  met,    ///< the line of the ray meets the quad
  first,  ///< it meets the first triangle of the quad
  second
};

class WideRay {
 public:
  /// `extent_m`: no bound of the tree's boxes is larger, counted from its origin.
  WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m);

  /// False where single precision does not do: numbers that are not finite or beyond 1e12, a direction shorter than
  /// 1e-12, an origin farther away than 1e5 times the size of the tree, t_min below 0 or above t_max.
  bool usable() const { return usable_; }

  /// The largest entry that still counts as reaching `t`, from zero on: a zero without a sign.
  static float padded(double t) { return static_cast<float>(std::min(t, 1e30)) * (1.0F + 8 * unit) + 0.0F; }

  /// Which boxes of the node the ray may meet between t_min and `t_max` (padded). `entry`: where it enters them, from
  /// t_min on.
  ///
  /// Formula: the slab method, each bound as b·r − o·r with one multiply_add. o·r is rounded: an error of the origin by
  /// a few units of its last place. Therefore the origin is moved outwards for the near and for the far planes, by
  /// 4 units of |o| + extent on that axis, which holds without fused operations too; the far bounds are scaled by
  /// 1 + 12 units for the roundings of r, of the direction and of the product. A direction that is all but zero on an
  /// axis is taken for 1e-25. That leads astray by at most 1e-13 of the way, because the longest axis has 1e-12 or
  /// more, and no way ends beyond 4e5 extents: a sixth of the 4 units.
  Mask8 meets(const WideNode& node, float t_max, Float8& entry) const;

  /// What is known of a ray and the quads of a leaf.
  struct QuadHits {
    Float8 first;           ///< a quad is met no earlier than here
    Float8 last;            ///< and no later than here
    std::uint32_t certain;  ///< bit i: quad i is met, not before t_min
    /// Bit i: if quad i is met, then it is its first, or its second triangle, by the side of the diagonal on which the
    /// ray passes; neither where that is not sure.
    std::array<std::uint32_t, 2> side;

    QuadKnowledge known(std::uint32_t lane) const {
      const auto bit = [lane](std::uint32_t lanes) { return lanes >> lane & 1U; };
      constexpr std::array answers{QuadKnowledge::nothing, QuadKnowledge::met, QuadKnowledge::first,
                                   QuadKnowledge::second};
      return answers[bit(certain) * (1 + bit(side[0]) + 2 * bit(side[1]))];
    }
  };

  /// Bit i: the ray may meet quad i of the leaf between t_min and `t_max` (padded).
  ///
  /// Formula: the edge functions of the sheared corners as in WatertightRay; inside where all four have one sign; t
  /// from the plane of the quad. Error: a sheared coordinate is off by at most δ = 16 units of (distance + size) and
  /// 2⁻⁴⁸ of the farthest coordinate, which are what double precision leaves of them; an edge function of a
  /// quadrilateral that holds the origin by at most 10·diameter·δ + 2δ² (its corners are within two diameters); a bent
  /// pair adds its bend to δ. Diameter and bend are the largest of the leaf. The plane is off by 2δ + bend along its
  /// normal, which t feels divided by the slope.
  std::uint32_t meets(const QuadLeaf& leaf, float t_max, QuadHits& hits) const;

 private:
  static constexpr float unit = 0x1p-24F;  ///< relative error of one rounding
  static constexpr float least_slope = 1e-25F;

  /// A corner as the ray sees it: moved so that the ray runs through 0, 0.
  struct Sheared {
    Float8 x, y;
  };
  Sheared shear(const QuadLeaf& leaf, std::size_t corner, float x_shift, float y_shift) const {
    const auto& at_m = leaf.corner_m[corner];
    const Float8 z(at_m[axis_[2]]);
    return {simd::multiply_add(z, -shear_[axis_[0]], Float8(at_m[axis_[0]])) + x_shift,
            simd::multiply_add(z, -shear_[axis_[1]], Float8(at_m[axis_[1]])) + y_shift};
  }
  /// Positive on one side of the edge between two corners.
  static Float8 edge(const Sheared& p, const Sheared& q) { return simd::multiply_add(q.x, p.y, -(q.y * p.x)); }

  using Axes = std::array<float, 4>;  ///< x, y, z and one more to fill the register
  template <typename Numbers, typename Vector>
  [[gnu::always_inline]] static void keep(Numbers& numbers, const Vector& vector) {
    std::memcpy(numbers.data(), &vector, sizeof vector);
  }

  // Left without initial values: each ray would pay for them.
  alignas(16) Axes near_offset_, far_offset_, reciprocal_, far_reciprocal_;
  alignas(16) Axes direction_, leaf_origin_, leaf_origin_low_;
  alignas(16) Axes shear_;                         ///< direction over that along the main axis
  alignas(16) std::array<std::uint32_t, 4> near_;  ///< rows of WideNode::bounds_m that face the ray
  alignas(16) std::array<std::uint32_t, 4> axis_;  ///< x, y and z as the quads see them; z is the ray's main axis
  float t_min_;
  float far_error_m_;  ///< of double precision: origin and corners are counted from the tree's origin
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

[[gnu::always_inline]] inline bool is_zero(const Int4& lanes) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(lanes);
  return (halves[0] | halves[1]) == 0;
}

}  // namespace detail

[[gnu::always_inline]] inline WideRay::WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m) {
  using Double4 = double __attribute__((vector_size(32)));
  const Double4 origin = Double4{ray.origin.x, ray.origin.y, ray.origin.z, 0.0} -
                         Double4{tree_origin_m.x, tree_origin_m.y, tree_origin_m.z, 0.0};
  const Float4 from = __builtin_convertvector(origin, Float4);
  const Float4 from_low = __builtin_convertvector(origin - __builtin_convertvector(from, Double4), Float4);
  const Float4 direction =
      __builtin_convertvector((Double4{ray.direction.x, ray.direction.y, ray.direction.z, 0.0}), Float4);
  const Float4 size = detail::absolute(direction), distance = detail::absolute(from);
  const Int4 sign = std::bit_cast<Int4>(direction) & std::int32_t{-0x7fffffff - 1};
  const Float4 least = Float4{} + least_slope;
  const Float4 reciprocal = 1.0F / detail::with_sign(size > least ? size : least, sign);
  const Float4 far_reciprocal = reciprocal * (1.0F + 12 * unit);
  const float farthest = std::max(distance[0], std::max(distance[1], distance[2]));
  const Float4 step = detail::with_sign((distance + extent_m) * (4 * unit) + 1e-20F, sign);
  keep(near_offset_, -(from + step) * reciprocal);
  keep(far_offset_, -(from - step) * far_reciprocal);
  keep(reciprocal_, reciprocal);
  keep(far_reciprocal_, far_reciprocal);
  keep(direction_, direction);
  keep(leaf_origin_, from);
  keep(leaf_origin_low_, from_low);
  keep(near_, Int4{0, 2, 4, 0} - (sign >> 31));
  const std::uint32_t z_is_longest = size[2] > std::max(size[0], size[1]) ? 1U : 0U;
  const std::uint32_t z = 2 * z_is_longest + (1 - z_is_longest) * (size[1] > size[0] ? 1U : 0U);
  static constexpr std::array<std::array<std::uint32_t, 4>, 3> turned{{{1, 2, 0, 0}, {2, 0, 1, 0}, {0, 1, 2, 0}}};
  axis_ = turned[z];
  keep(shear_, direction * reciprocal_[z]);
  far_error_m_ = (farthest + extent_m) * 0x1p-48F;
  t_min_ = static_cast<float>(std::min(ray.t_min, 1e30)) * (1.0F - 8 * unit) + 0.0F;
  // Without branches, because rays point everywhere; NaN fails every comparison.
  const bool is_in_range = detail::is_zero(~((size < 1e12F) & (distance < 1e12F)));
  const bool leads_nowhere = detail::is_zero(size > 1e-12F);
  usable_ = (is_in_range & !leads_nowhere & (farthest <= 1e5F * extent_m) & (ray.t_min >= 0.0) &
             (ray.t_min <= ray.t_max)) != 0;
}

[[gnu::always_inline]] inline Mask8 WideRay::meets(const WideNode& node, float t_max, Float8& entry) const {
  const auto bound = [&](std::size_t axis, std::uint32_t turned) {
    return Float8(node.bounds_m[near_[axis] ^ turned]);
  };
  const auto near = [&](std::size_t axis) {
    return simd::multiply_add(bound(axis, 0), reciprocal_[axis], near_offset_[axis]);
  };
  const auto far = [&](std::size_t axis) {
    return simd::multiply_add(bound(axis, 1), far_reciprocal_[axis], far_offset_[axis]);
  };
  entry = simd::later(simd::later(near(0), near(1)), simd::later(near(2), t_min_));
  return simd::not_later(entry, simd::earlier(simd::earlier(far(0), far(1)), simd::earlier(far(2), t_max)));
}

[[gnu::always_inline]] inline std::uint32_t WideRay::meets(const QuadLeaf& leaf, float t_max, QuadHits& hits) const {
  // From the ray's origin to the centre: rounded relative to their distance, because the centre is exact.
  const auto [x, y, z, unused] = axis_;
  const float x0 = (leaf.centre_m[x] - leaf_origin_[x]) - leaf_origin_low_[x];
  const float y0 = (leaf.centre_m[y] - leaf_origin_[y]) - leaf_origin_low_[y];
  const float z0 = (leaf.centre_m[z] - leaf_origin_[z]) - leaf_origin_low_[z];
  const float distance_m = std::max(std::abs(x0), std::max(std::abs(y0), std::abs(z0)));
  const float error_m = 16 * unit * distance_m + (16 * unit * leaf.size_m + far_error_m_);
  const float x_shift = x0 - shear_[x] * z0, y_shift = y0 - shear_[y] * z0;
  const Sheared a = shear(leaf, 0, x_shift, y_shift), b = shear(leaf, 1, x_shift, y_shift);
  const Sheared c = shear(leaf, 2, x_shift, y_shift), d = shear(leaf, 3, x_shift, y_shift);
  const Float8 ab = edge(a, b), bc = edge(b, c), cd = edge(c, d), da = edge(d, a);
  const float reach = leaf.reach_m;
  const Float8 error((reach + 2 * error_m) * (leaf.bend_m + error_m));
  const Float8 low = simd::minimum(simd::minimum(ab, bc), simd::minimum(cd, da));
  const Float8 high = simd::maximum(simd::maximum(ab, bc), simd::maximum(cd, da));
  // Refusals are asked for, not passes: NaN, from numbers near the limits, refuses nothing.
  const std::uint32_t candidates = leaf.lanes & ~((low < -error) & (high > error)).bits();
  if (candidates == 0) return 0;
  const Float8 nx(leaf.normal[x]), ny(leaf.normal[y]), nz(leaf.normal[z]);
  const Float8 steepness = Float8(1.0F) / (nx * direction_[x] + ny * direction_[y] + nz * direction_[z]);
  const auto& corner_m = leaf.corner_m[0];
  const Float8 ax(corner_m[x]), ay(corner_m[y]), az(corner_m[z]);
  const Float8 t = (nx * (ax + x0) + ny * (ay + y0) + nz * (az + z0)) * steepness;
  const Float8 margin = simd::absolute(Float8(leaf.bend_m + 2 * error_m) * steepness);
  hits.first = t - margin;
  hits.last = t + margin;
  // Far beside a quad the products are rounded by more than the error allows for.
  const Mask8 is_near = (simd::absolute(a.x) < reach) & (simd::absolute(a.y) < reach);
  // A triangle's fourth corner lies on an edge: that edge's two functions have the triangle's sign as well.
  hits.certain = candidates & (((low > error) | (high < -error)) & is_near & (hits.first > t_min_)).bits();
  // The diagonal turns with the edges of the first triangle, and against those of the second.
  const Float8 ca = edge(c, a);
  const std::uint32_t left = (ca > error).bits(), right = (ca < -error).bits(), turn = (low > error).bits();
  hits.side[0] = (left & turn) | (right & ~turn);
  hits.side[1] = (right & turn) | (left & ~turn);
  return candidates & ~((hits.first > t_max) | (hits.last < t_min_)).bits();
}

}  // namespace dcem
