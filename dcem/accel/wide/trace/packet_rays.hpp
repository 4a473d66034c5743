#pragma once
/// The rays of a packet as rows of numbers, eight rays at a time: which of them meet a box, and how far they ask.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/trace/ray.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Rays with a common origin. Left without initial values: each packet would pay for them.
class PacketRays {
 public:
  static constexpr std::size_t capacity = 32;
  static constexpr float rounding = 0x1p-24F;  ///< relative error of one rounding
  using Numbers = std::array<float, capacity>;

  std::size_t asked, count;       ///< rays, and those with the last one repeated: a multiple of eight
  Float4 origin_m, origin_low_m;  ///< from the tree's origin: rounded, and what the rounding has left
  float extent_m, farthest_m;     ///< of the tree, and of the origin along an axis
  alignas(32) std::array<Numbers, 3> direction, reciprocal;
  alignas(32) Numbers size, ahead, limit;  ///< of the directions: the longest axis, and the way along the cone's middle

  /// Writes eight numbers to a row.
  [[gnu::always_inline]] static void put(Numbers& row, std::size_t first, const Float8& numbers) {
    std::memcpy(&row[first], &numbers, sizeof numbers);
  }

  /// Directions as rows of numbers; the last ray fills the rest of the last eight.
  [[gnu::always_inline]] bool prepare(const WideArrays& tree, std::span<const RayQuery> queries) {
    const Vec3& at = queries.front().ray.origin;
    const Double4 origin =
        Double4{at.x, at.y, at.z, 0.0} - Double4{tree.origin_m.x, tree.origin_m.y, tree.origin_m.z, 0.0};
    origin_m = narrowed(origin);
    origin_low_m = remainder(origin, origin_m);
    const Float4 distance = absolute(origin_m);
    extent_m = tree.extent_m;
    farthest_m = std::max(distance[0], std::max(distance[1], distance[2]));
    asked = queries.size();
    count = (queries.size() + simd_lanes - 1) / simd_lanes * simd_lanes;
    bool is_usable = farthest_m <= std::min(1e12F, 1e5F * extent_m);
    for (std::size_t first = 0; first < count; first += simd_lanes) {
      is_usable = prepare_eight(queries.subspan(first), first) && is_usable;
    }
    return is_usable;
  }

  /// The way ahead beyond which no ray asks for anything.
  [[gnu::always_inline]] float farthest_limit_m() const {
    Float8 farthest(0.0F);
    for (std::size_t ray = 0; ray < count; ray += simd_lanes) {
      farthest = simd::maximum(farthest, Float8::load(&limit[ray]) * Float8::load(&ahead[ray]));
    }
    float result = 0.0F;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) result = std::max(result, farthest[lane]);
    return result * 1.0001F;
  }

  /// Bit i: ray i may meet a box within its limit. Errors as in WideRay::BoxTest.
  [[gnu::always_inline]] std::uint32_t that_meet(const WideNode& node, std::uint32_t lane) const {
    std::array<Float8, 3> low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float at_m = float_at(origin_m, axis), room_m = 8 * rounding * (std::abs(at_m) + extent_m) + 1e-20F;
      low[axis] = (node.bounds_m[2 * axis][lane] - at_m) - room_m;
      high[axis] = (node.bounds_m[2 * axis + 1][lane] - at_m) + room_m;
    }
    std::uint32_t met = 0;
    for (std::size_t ray = 0; ray < count; ray += simd_lanes) {
      Float8 entry(0.0F), exit = Float8::load(&limit[ray]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Float8 by = Float8::load(&reciprocal[axis][ray]);
        const Float8 one = low[axis] * by, other = high[axis] * by;
        entry = simd::maximum(simd::minimum(one, other), entry);
        exit = simd::minimum(simd::maximum(one, other), exit);
      }
      met |= (entry <= exit).bits() << ray;
    }
    return met & static_cast<std::uint32_t>((std::uint64_t{1} << asked) - 1);
  }

 private:
  /// Eight rays side by side, those of `queries` and then its last one.
  [[gnu::always_inline]] bool prepare_eight(std::span<const RayQuery> queries, std::size_t first) {
    std::array<Float4, simd_lanes> ways;
    std::array<const float*, simd_lanes> places;
    bool is_usable = true;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const Ray<double>& own = queries[std::min(lane, queries.size() - 1)].ray;
      Double4 way;
      static_assert(sizeof own == 64);
      std::memcpy(&way, &own.direction.x, sizeof way);  // x y z, t_min
      ways[lane] = narrowed(way);
      places[lane] = reinterpret_cast<const float*>(&ways[lane]);
      is_usable = is_usable && own.t_max >= 0.0;
      limit[first + lane] = WideRay::padded(own.t_max);
    }
    const std::array<Float8, 4> turned = simd::turned(places);
    // A quotient by nothing is infinite, on both sides alike, or no number, which neither minimum nor maximum keeps.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(direction[axis], first, turned[axis]);
      put(reciprocal[axis], first, Float8(1.0F) / turned[axis]);
    }
    const Float8 longest =
        simd::maximum(simd::absolute(turned[0]), simd::maximum(simd::absolute(turned[1]), simd::absolute(turned[2])));
    put(size, first, longest);
    return ((longest > Float8(1e-12F)) & (longest < Float8(1e12F))).bits() == 0xffU && is_usable;
  }
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
