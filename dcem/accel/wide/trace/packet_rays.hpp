#pragma once
/// The rays of a packet as rows of numbers, eight rays at a time: which of them meet a box, and how far they ask.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/trace/packet_source.hpp"
#include "dcem/accel/wide/trace/ray.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Bit i: ray i of a packet.
using RayMask = std::uint64_t;

/// Rays with a common origin. Left without initial values: each packet would pay for them.
class PacketRays {
 public:
  static constexpr std::size_t capacity = 64;
  static constexpr float rounding = 0x1p-24F;  ///< relative error of one rounding
  using Numbers = std::array<float, capacity>;

  std::size_t asked, count;       ///< rays, and those with the last one repeated: a multiple of eight
  Float4 origin_m, origin_low_m;  ///< from the tree's origin: rounded, and what the rounding has left
  float extent_m, farthest_m;     ///< of the tree, and of the origin along an axis
  alignas(32) std::array<Numbers, 3> direction, reciprocal;
  alignas(32) Numbers size, ahead;  ///< of the directions: the longest axis, and the way along the cone's middle
  alignas(32) Numbers limit;        ///< how far a ray asks, padded
  /// A hit between them, exclusively, counts without being asked about.
  alignas(32) Numbers sure_from, sure_to;

  /// Writes eight numbers to a row.
  [[gnu::always_inline]] static void put(Numbers& row, std::size_t first, const Float8& numbers) {
    std::memcpy(&row[first], &numbers, sizeof numbers);
  }

  /// Takes the first of many rays: as many as have the origin of the first one, t_min = 0 and a direction close to its
  /// own. Returns their number, 1 where they are too few or single precision does not do for the first.
  template <typename Source>
  [[gnu::always_inline]] std::size_t gather(const WideArrays& tree, const Source& source) {
    const Vec3 at = source.ray(0).origin;
    const Double4 origin =
        Double4{at.x, at.y, at.z, 0.0} - Double4{tree.origin_m.x, tree.origin_m.y, tree.origin_m.z, 0.0};
    origin_m = narrowed(origin);
    origin_low_m = remainder(origin, origin_m);
    const Float4 distance = absolute(origin_m);
    extent_m = tree.extent_m;
    farthest_m = std::max(distance[0], std::max(distance[1], distance[2]));
    const bool is_near = (sign_bits(distance <= 1e5F * extent_m) & 7U) == 7U;  // false for what is no number
    if (!is_near || !(smallest_m <= extent_m && farthest_m + extent_m <= largest_m)) return 1;
    const std::size_t most = std::min(source.size(), capacity);
    asked = 0;
    for (std::size_t taken = simd_lanes; taken == simd_lanes && asked < most; asked += taken) {
      taken = most - asked >= simd_lanes ? gather_eight<true>(source) : gather_eight<false>(source);
    }
    count = (asked + simd_lanes - 1) / simd_lanes * simd_lanes;
    for (std::size_t ray = asked; 0 < asked && ray < count; ++ray) repeat(asked - 1, ray);
    return std::max<std::size_t>(asked, 1);
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

  /// Rays that may meet a box within their limits. Errors as in WideRay::BoxTest.
  [[gnu::always_inline]] RayMask that_meet(const WideNode& node, std::uint32_t lane) const {
    std::array<Float8, 3> low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float at_m = float_at(origin_m, axis), room_m = 8 * rounding * (std::abs(at_m) + extent_m) + 1e-20F;
      low[axis] = (node.bounds_m[2 * axis][lane] - at_m) - room_m;
      high[axis] = (node.bounds_m[2 * axis + 1][lane] - at_m) + room_m;
    }
    RayMask met = 0;
    for (std::size_t ray = 0; ray < count; ray += simd_lanes) {
      Float8 entry(0.0F), exit = Float8::load(&limit[ray]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Float8 by = Float8::load(&reciprocal[axis][ray]);
        const Float8 one = low[axis] * by, other = high[axis] * by;
        entry = simd::maximum(simd::minimum(one, other), entry);
        exit = simd::minimum(simd::maximum(one, other), exit);
      }
      met |= RayMask{(entry <= exit).bits()} << ray;
    }
    return met;
  }

 private:
  /// Of the angle to the first ray, 39 degrees: wider packets test more boxes that few rays meet.
  static constexpr float least_cosine_squared = 0.6F;
  static constexpr float largest_t = 1e30F;  ///< what single precision counts up to
  /// Of scenes, and of directions along their longest axis: products of two lengths and a direction, and of four
  /// directions, are numbers that single precision has.
  static constexpr float smallest_m = 1e-10F, largest_m = 2e12F, shortest = 1e-9F, longest = 1e9F;

  using Long4 = std::int64_t __attribute__((vector_size(32)));
  template <typename Lanes>
  [[gnu::always_inline]] static void read(const void* from, Lanes& to) {
    std::memcpy(&to, from, sizeof to);
  }

  /// The next rays, up to eight, side by side: all of them where it is `full`. Returns how many belong to the packet.
  template <bool full>
  [[gnu::always_inline]] std::size_t gather_eight(const QueriesInTurn& queries) {
    static_assert(sizeof(Ray<double>) == 64 && offsetof(RayQuery, filter) == 64 && sizeof(RayQuery) == 96);
    constexpr bool fills_register = sizeof(HitFilter) == 32;  // where pointers have eight bytes
    const std::size_t present = full ? simd_lanes : queries.size() - asked;
    Long4 own_origin, own_filter;
    read(&queries.ray(0), own_origin);
    read(&queries.filter(0), own_filter);
    std::array<Float4, simd_lanes> ways;  // direction x y z, t_max
    std::array<const float*, simd_lanes> places;
    Long4 strange{}, other_filter{};
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const RayQuery& query = queries.query(asked + (full || lane < present ? lane : present - 1));
      Long4 begin_bits, end_bits, filter;
      Double4 begin, end;
      read(&query.ray, begin_bits);
      read(&query.ray, begin);  // origin x y z, direction x
      read(&query.ray.direction.y, end_bits);
      read(&query.ray.direction.y, end);  // direction y z, t_min, t_max
      read(&query.filter, filter);        // sure_from and sure_to, counts, context, ignored objects
      strange |= ((begin_bits ^ own_origin) & Long4{-1, -1, -1, 0}) | (end_bits & Long4{0, 0, -1, 0});
      other_filter |= filter ^ own_filter;
      ways[lane] = __builtin_shufflevector(narrowed(begin), narrowed(end), 3, 4, 5, 7);
      places[lane] = reinterpret_cast<const float*>(&ways[lane]);
    }
    const std::array<Float8, 4> turned = simd::turned(places);
    put_directions(turned);
    put(limit, asked, simd::minimum(turned[3], Float8(largest_t)) * Float8(1.0F + 8 * rounding) + Float8(0.0F));
    if (fills_register && (other_filter[0] | other_filter[1] | other_filter[3]) == 0) {
      put(sure_from, asked, Float8(surely_from(queries.filter(0))));
      put(sure_to, asked, Float8(surely_to(queries.filter(0))));
    } else {
      put_filters(queries.part(asked, present));
    }
    std::uint32_t others = those_apart() | 0x100U >> (simd_lanes - present);
    if ((strange[0] | strange[1] | strange[2]) != 0) others |= strangers_among(queries, present);
    return static_cast<std::size_t>(std::countr_zero(others));
  }
  template <bool full>
  [[gnu::always_inline]] std::size_t gather_eight(const FanInTurn& fan) {
    const std::size_t present = full ? simd_lanes : fan.size() - asked;
    std::array<Float4, simd_lanes> ways;  // direction x y z
    std::array<const float*, simd_lanes> places;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const Vec3& way = fan.direction(asked + (full || lane < present ? lane : present - 1));
      ways[lane] = narrowed(Double4{way.x, way.y, way.z, 0.0});
      places[lane] = reinterpret_cast<const float*>(&ways[lane]);
    }
    put_directions(simd::turned(places));
    put(limit, asked, Float8(largest_t * (1.0F + 8 * rounding)));
    put(sure_from, asked, Float8(surely_from(fan.filter(0))));
    put(sure_to, asked, Float8(surely_to(fan.filter(0))));
    return static_cast<std::size_t>(std::countr_zero(those_apart() | 0x100U >> (simd_lanes - present)));
  }

  [[gnu::always_inline]] void put_directions(const std::array<Float8, 4>& ways) {
    // A quotient by nothing is infinite: a ray beside a box meets both planes at the same infinity, one between them at
    // both. On a plane it would be no number, but planes are moved outwards before.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(direction[axis], asked, ways[axis]);
      put(reciprocal[axis], asked, Float8(1.0F) / ways[axis]);
    }
    put(size, asked,
        simd::maximum(simd::absolute(ways[0]), simd::maximum(simd::absolute(ways[1]), simd::absolute(ways[2]))));
  }

  /// Bit i: of the next eight, ray i has a direction far from that of the first ray, or one too long or too short.
  [[gnu::always_inline]] std::uint32_t those_apart() const {
    std::array<Float8, 3> first, own;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = Float8(direction[axis][0]);
      own[axis] = Float8::load(&direction[axis][asked]);
    }
    const auto product = [](const auto& one, const auto& other) __attribute__((always_inline)) {
      return one[0] * other[0] + one[1] * other[1] + one[2] * other[2];
    };
    const Float8 along = product(first, own), length = Float8::load(&size[asked]);
    const Float8 least = Float8(least_cosine_squared) * product(first, first) * product(own, own);
    const Mask8 is_close = (along > Float8(0.0F)) & (least <= along * along) & (length > Float8(shortest)) &
                           (length < Float8(longest));  // false for what is no number
    return is_close.bits() ^ 0xffU;
  }

  /// Bit i: of the next rays, ray i begins at another point, or later.
  [[gnu::noinline]] std::uint32_t strangers_among(const QueriesInTurn& queries, std::size_t present) const {
    const Ray<double>& first = queries.ray(0);
    std::uint32_t result = 0;
    for (std::size_t lane = 0; lane < present; ++lane) {
      const Ray<double>& ray = queries.ray(asked + lane);
      result |= (ray.origin != first.origin || ray.t_min != 0.0 ? 1U : 0U) << lane;
    }
    return result;
  }

  [[gnu::noinline]] void put_filters(const QueriesInTurn& queries) {
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const HitFilter& filter = queries.filter(std::min(lane, queries.size() - 1));
      sure_from[asked + lane] = surely_from(filter);
      sure_to[asked + lane] = surely_to(filter);
    }
  }
  /// A filter that ignores objects is asked whether it does.
  static float surely_from(const HitFilter& filter) {
    const bool ignores = (filter.ignored_objects[0] & filter.ignored_objects[1]) != HitFilter::no_object;
    return ignores ? largest_t : filter.counts != nullptr ? filter.sure_from : -largest_t;
  }
  static float surely_to(const HitFilter& filter) { return filter.counts != nullptr ? filter.sure_to : largest_t; }

  /// A ray in a place that is left, there for the cone alone: it ends before it begins.
  void repeat(std::size_t from, std::size_t to) {
    for (Numbers* const row : {&direction[0], &direction[1], &direction[2], &reciprocal[0], &reciprocal[1],
                               &reciprocal[2], &size, &sure_from, &sure_to}) {
      (*row)[to] = (*row)[from];
    }
    limit[to] = -1.0F;
  }
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
