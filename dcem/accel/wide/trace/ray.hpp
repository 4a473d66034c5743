#pragma once
/// A ray prepared for nodes of eight boxes and leaves of eight quads, in single precision.
///
/// Single precision never decides against double precision: a box that the double ray meets is met, and of a quad the
/// answer is a certain miss, a certain hit, or undecided.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/four_lanes.hpp"
#include "dcem/accel/wide/trace/quad_hits.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

inline namespace DCEM_ISA {

class WideRay {
 public:
  /// `extent_m`: no bound of the tree's boxes is larger, counted from its origin.
  WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m);

  /// False where single precision does not do: numbers that are not finite or beyond 1e12, a direction shorter than
  /// 1e-12, an origin farther away than 1e5 times the size of the tree, t_min below 0 or above t_max.
  bool usable() const { return usable_; }

  /// Where the ray begins, rounded down, and ends, rounded up: an entry that reaches t_max is within `t_max()`. Zeros
  /// have no sign.
  float t_min() const { return t_min_; }
  float t_max() const { return t_max_; }
  static float padded(double t) { return static_cast<float>(std::min(t, 1e30)) * (1.0F + 8 * rounding) + 0.0F; }

  /// What a run of node tests keeps in registers.
  struct BoxTest {
    Float8 near_origin_m[3], far_origin_m[3], minus_reciprocal[3];
    std::size_t near_row[3], far_row[3];  ///< byte offsets in WideNode::bounds_m
    Float8 t_min, t_max;

    /// `t_max` padded.
    [[gnu::always_inline]] BoxTest(const WideRay& ray, float t_max);

    /// Which boxes of the node the ray misses between t_min and t_max. `entry`: where it enters the others, from t_min
    /// on.
    ///
    /// Formula: the slab method, each bound as (o − b)·(−r) with r = 1/d. Errors: o, d, r, difference and product are
    /// each rounded by a unit u = 2⁻²⁴, so a bound is off by less than 5 u (|o| + extent) of the axis, as if the box
    /// were moved. Therefore the origin is moved outwards by 8 u (|o| + extent), for the near and for the far planes. A
    /// direction that is all but zero on an axis is taken for 1e-25; that leads astray by at most 1e-13 of the way,
    /// because the longest axis has 1e-12 or more, and no way ends beyond 4e5 extents: 0.7 u extents.
    [[gnu::always_inline]] Mask8 misses(const WideNode& node, Float8& entry) const;
  };

  /// Bit i: the ray may meet quad i of the leaf between t_min and `t_max` (padded).
  ///
  /// Formula: the edge functions of the sheared corners as in WatertightRay; inside where all four have one sign; t
  /// from the plane of the quad. Error: a sheared coordinate is off by at most δ = 16 units of (distance + size) and
  /// 2⁻⁴⁸ of the farthest coordinate, which are what double precision leaves of them; an edge function of a
  /// quadrilateral that holds the origin by at most 10·diameter·δ + 2δ² (its corners are within two diameters); a bent
  /// pair adds its bend to δ. Diameter and bend are the largest of the leaf. The plane is off by 2δ + bend along its
  /// normal, which t feels divided by the slope.
  ///
  /// `asks_early`: whether the line passes beside all of them is asked before t is worked out. Where rays do not
  /// resemble those before them no processor foresees that, and a wrong guess takes longer than t.
  template <bool asks_early>
  [[gnu::always_inline]] std::uint32_t meets(const QuadLeaf& leaf, float t_max, QuadHits& hits) const;

 private:
  friend struct BoxTest;
  static constexpr float rounding = 0x1p-24F;  ///< relative error of one rounding
  static constexpr float least_slope = 1e-25F;

  /// The axes in the order in which quads see them: the last one is the ray's main axis.
  struct AxisOrder {
    Int4 order;                        ///< which axis comes first, second, last
    std::array<std::uint32_t, 3> row;  ///< byte offsets of their rows in QuadLeaf::corner_m[corner]
  };

  // Left without initial values: each ray would pay for them.
  Float4 near_origin_m_, far_origin_m_;
  Float4 minus_reciprocal_;
  Float4 origin_m_, origin_low_m_;  ///< from the tree's origin: rounded, and what the rounding has left
  Float4 direction_;                ///< in the order of the axes, as the next
  Float4 minus_shear_;              ///< direction over that along the main axis, times −1
  const std::uint32_t* rows_;
  const AxisOrder* axes_;
  float t_min_, t_max_;
  float far_error_m_;  ///< of double precision: origin and corners are counted from the tree's origin
  bool usable_;
};

}  // namespace DCEM_ISA

// ---------------------------------------------------------------------------------------------------------------------

inline namespace DCEM_ISA {

[[gnu::always_inline]] inline WideRay::WideRay(const Ray<double>& ray, const Vec3& tree_origin_m, float extent_m) {
  // The rows of a node, by the signs of a direction: near bounds of x, y, z, and far ones.
  static constexpr std::array<std::array<std::uint32_t, 8>, 8> rows_by_sign = [] {
    std::array<std::array<std::uint32_t, 8>, 8> rows{};
    for (std::uint32_t signs = 0; signs < 8; ++signs) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        rows[signs][axis] = (2 * axis + (signs >> axis & 1U)) * 32;
        rows[signs][axis + 3] = (2 * axis + 1 - (signs >> axis & 1U)) * 32;
      }
    }
    return rows;
  }();
  // By the bits x ≥ y, y ≥ z, z ≥ x.
  static constexpr AxisOrder x_last{{1, 2, 0, 0}, {32, 64, 0}}, y_last{{2, 0, 1, 0}, {64, 0, 32}},
      z_last{{0, 1, 2, 0}, {0, 32, 64}};
  static constexpr std::array<AxisOrder, 8> axes_by_length{z_last, x_last, y_last, x_last,
                                                           z_last, z_last, y_last, x_last};
  static_assert(sizeof(ray) == 64);
  detail::Double4 first, last;
  std::memcpy(&first, &ray.origin.x, sizeof first);   // origin x y z, direction x
  std::memcpy(&last, &ray.direction.y, sizeof last);  // direction y z, t_min, t_max
  const detail::Double4 origin = first - detail::Double4{tree_origin_m.x, tree_origin_m.y, tree_origin_m.z, 0.0};
  const Float4 from = detail::narrowed(origin), rest = detail::narrowed(last);
  origin_m_ = from;
  origin_low_m_ = detail::remainder(origin, from);
  const Float4 direction = __builtin_shufflevector(from, rest, 3, 4, 5, 3);
  const Float4 size = detail::absolute(direction), distance = detail::absolute(from);
  const Int4 sign = std::bit_cast<Int4>(direction) & std::int32_t{-0x7fffffff - 1};
  const Float4 least = Float4{} + least_slope;
  minus_reciprocal_ = -1.0F / detail::with_sign(size > least ? size : least, sign);
  const Float4 step = detail::with_sign((distance + extent_m) * (8 * rounding) + 1e-20F, sign);
  near_origin_m_ = from + step;
  far_origin_m_ = from - step;
  rows_ = rows_by_sign[detail::sign_bits(sign) & 7U].data();
  const Float4 next = __builtin_shufflevector(size, size, 1, 2, 0, 3);
  axes_ = &axes_by_length[detail::sign_bits(size >= next) & 7U];
  const Int4 order = axes_->order;
  direction_ = detail::permuted(direction, order);
  minus_shear_ = direction_ * detail::spread<2>(detail::permuted(minus_reciprocal_, order));
  const float farthest = std::max(distance[0], std::max(distance[1], distance[2]));
  far_error_m_ = (farthest + extent_m) * 0x1p-48F;
  const Float4 ends = rest * Float4{1.0F, 1.0F, 1.0F - 8 * rounding, 1.0F + 8 * rounding} + 0.0F;
  t_min_ = ends[2];
  t_max_ = std::min(ends[3], 1e30F);
  // NaN fails every comparison.
  const Float4 largest = Float4{} + 1e12F, farthest_m = Float4{} + std::min(1e12F, 1e5F * extent_m);
  const bool is_in_range = (detail::sign_bits((size < largest) & (distance <= farthest_m)) & 7U) == 7U;
  const bool leads_somewhere = (detail::sign_bits(size > 1e-12F) & 7U) != 0U;
  usable_ = is_in_range && leads_somewhere && ray.t_min >= 0.0 && ray.t_min <= ray.t_max;
}

[[gnu::always_inline]] inline WideRay::BoxTest::BoxTest(const WideRay& ray, float limit)
    : t_min(ray.t_min_), t_max(limit) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    near_origin_m[axis] = detail::float_at(ray.near_origin_m_, axis);
    far_origin_m[axis] = detail::float_at(ray.far_origin_m_, axis);
    minus_reciprocal[axis] = detail::float_at(ray.minus_reciprocal_, axis);
    near_row[axis] = ray.rows_[axis];
    far_row[axis] = ray.rows_[axis + 3];
  }
}

[[gnu::always_inline]] inline Mask8 WideRay::BoxTest::misses(const WideNode& node, Float8& entry) const {
  const auto* const bounds = reinterpret_cast<const char*>(node.bounds_m.data());
  const auto near = [&](std::size_t axis) {
    return (near_origin_m[axis] - Float8::load(bounds + near_row[axis])) * minus_reciprocal[axis];
  };
  const auto far = [&](std::size_t axis) {
    return (far_origin_m[axis] - Float8::load(bounds + far_row[axis])) * minus_reciprocal[axis];
  };
  entry = simd::later(simd::later(near(0), near(1)), simd::later(near(2), t_min));
  return simd::is_later(entry, simd::earlier(simd::earlier(far(0), far(1)), simd::earlier(far(2), t_max)));
}

template <bool asks_early>
[[gnu::always_inline]] inline std::uint32_t WideRay::meets(const QuadLeaf& leaf, float t_max, QuadHits& hits) const {
  const AxisOrder& axes = *axes_;
  const std::size_t x = axes.row[0], y = axes.row[1], z = axes.row[2];
  // From the ray's origin to the centre: rounded relative to their distance, because the centre is exact.
  const Float4 centre_m =
      detail::permuted((detail::load_four(leaf.centre_m.data()) - origin_m_) - origin_low_m_, axes.order);
  const Float4 apart_m = detail::absolute(centre_m);
  const float distance_m = std::max(apart_m[0], std::max(apart_m[1], apart_m[2]));
  const float error_m = 16 * rounding * distance_m + (16 * rounding * leaf.size_m + far_error_m_);
  const Float4 shift_m = centre_m + minus_shear_ * detail::spread<2>(centre_m);
  const Float8 x_shift_m(shift_m[0]), y_shift_m(shift_m[1]);
  const Float8 minus_x_shear(detail::float_at(minus_shear_, 0)), minus_y_shear(detail::float_at(minus_shear_, 1));
  const auto row = [corners = reinterpret_cast<const char*>(leaf.corner_m.data())](std::size_t corner, std::size_t at) {
    return Float8::load(corners + corner * sizeof leaf.corner_m[0] + at);
  };
  /// A corner as the ray sees it: moved so that the ray runs through 0, 0.
  struct Sheared {
    Float8 x, y;
  };
  const auto shear = [&](std::size_t corner) __attribute__((always_inline)) {
    const Float8 along = row(corner, z);
    return Sheared{(along * minus_x_shear + row(corner, x)) + x_shift_m,
                   (along * minus_y_shear + row(corner, y)) + y_shift_m};
  };
  const Sheared a = shear(0), b = shear(1), c = shear(2), d = shear(3);
  /// Positive on one side of the edge between two corners.
  const auto edge = [](const Sheared& p, const Sheared& q) __attribute__((always_inline)) {
    return q.x * p.y - q.y * p.x;
  };
  const Float8 ab = edge(a, b), bc = edge(b, c), cd = edge(c, d), da = edge(d, a);
  const float reach_m = leaf.reach_m, room = (reach_m + 2 * error_m) * (leaf.bend_m + error_m);
  const Float8 error(room), minus_error(-room);
  const Float8 low = simd::minimum(simd::minimum(ab, bc), simd::minimum(cd, da));
  const Float8 high = simd::maximum(simd::maximum(ab, bc), simd::maximum(cd, da));
  // Refusals are asked for, not passes: NaN, from numbers near the limits, refuses nothing.
  const std::uint32_t candidates = leaf.lanes & ~((low < minus_error) & (high > error)).bits();
  if (asks_early && candidates == 0) return 0;
  const auto normal = [rows = reinterpret_cast<const char*>(leaf.normal.data())](std::size_t at) {
    return Float8::load(rows + at);
  };
  const Float8 nx = normal(x), ny = normal(y), nz = normal(z);
  const Float8 steepness = Float8(1.0F) / (nx * direction_[0] + ny * direction_[1] + nz * direction_[2]);
  const Float8 height =
      nx * (row(0, x) + centre_m[0]) + ny * (row(0, y) + centre_m[1]) + nz * (row(0, z) + centre_m[2]);
  const Float8 t = height * steepness;
  const Float8 margin = simd::absolute(Float8(leaf.bend_m + 2 * error_m) * steepness);
  hits.first = t - margin;
  hits.last = t + margin;
  const std::uint32_t met = candidates & ~((hits.first > Float8(t_max)) | (hits.last < Float8(t_min_))).bits();
  if (met == 0) return 0;
  // Far beside a quad the products are rounded by more than the error allows for.
  const Mask8 is_near = (simd::absolute(a.x) < Float8(reach_m)) & (simd::absolute(a.y) < Float8(reach_m));
  // A triangle's fourth corner lies on an edge: that edge's two functions have the triangle's sign as well.
  hits.certain = met & (((low > error) | (high < minus_error)) & is_near & (hits.first > Float8(t_min_))).bits();
  // The diagonal turns with the edges of the first triangle, and against those of the second.
  const Float8 ca = edge(c, a);
  const std::uint32_t left = (ca > error).bits(), right = (ca < minus_error).bits(), turn = (low > error).bits();
  hits.side = {(left & turn) | (right & ~turn), (right & turn) | (left & ~turn)};
  return met;
}

}  // namespace DCEM_ISA

}  // namespace dcem
