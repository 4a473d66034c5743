#pragma once
/// The cone around the rays of a packet: which boxes of a node are beside it, eight at a time, and how far ahead the
/// others begin.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/packet_rays.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Four planes through the point that the rays have in common, and one across the middle.
class PacketCone {
 public:
  /// The cone as the pyramid over a rectangle across its middle.
  [[gnu::always_inline]] bool surround(PacketRays& rays) {
    std::array<Float8, 3> sums{Float8(0.0F), Float8(0.0F), Float8(0.0F)};
    for (std::size_t ray = 0; ray < rays.count; ray += simd_lanes) {
      const Float8 by = Float8(1.0F) / Float8::load(&rays.size[ray]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sums[axis] = sums[axis] + Float8::load(&rays.direction[axis][ray]) * by;
      }
    }
    const Float4 sum{total(sums[0]), total(sums[1]), total(sums[2]), 0.0F};
    if (!(dot(sum, sum) > 0.0F)) return false;
    const Float4 ahead = unit(sum), away = absolute(ahead);
    const bool x_least = away[0] <= away[1] && away[0] <= away[2], y_least = !x_least && away[1] <= away[2];
    const Float4 right = unit(
        cross(Float4{x_least ? 1.0F : 0.0F, y_least ? 1.0F : 0.0F, x_least || y_least ? 0.0F : 1.0F, 0.0F}, ahead));
    const Float4 up = cross(ahead, right);
    Float8 cosine(1.0F);
    std::array<Float8, 2> lowest{Float8(1e30F), Float8(1e30F)}, highest{Float8(-1e30F), Float8(-1e30F)};
    for (std::size_t ray = 0; ray < rays.count; ray += simd_lanes) {
      const auto along = [&](const Float4& by) __attribute__((always_inline)) {
        return Float8::load(&rays.direction[0][ray]) * by[0] + Float8::load(&rays.direction[1][ray]) * by[1] +
               Float8::load(&rays.direction[2][ray]) * by[2];
      };
      const Float8 own = along(ahead);
      PacketRays::put(rays.ahead, ray, own);
      cosine = simd::minimum(own / Float8::load(&rays.size[ray]), cosine);
      const std::array<Float8, 2> beside{along(right) / own, along(up) / own};
      for (std::size_t side = 0; side < 2; ++side) {
        lowest[side] = simd::minimum(beside[side], lowest[side]);
        highest[side] = simd::maximum(beside[side], highest[side]);
      }
    }
    const float least_cosine = least(cosine);
    const std::array<float, 2> low{least(lowest[0]), least(lowest[1])}, high{-least(-highest[0]), -least(-highest[1])};
    if (!(least_cosine > 0.5F)) return false;
    constexpr float room = 1e-5F;  // a hundred roundings of a tangent below 2
    set_plane(rays, 0, right - (low[0] - room) * ahead, 1.0F);
    set_plane(rays, 1, (high[0] + room) * ahead - right, 1.0F);
    set_plane(rays, 2, up - (low[1] - room) * ahead, 1.0F);
    set_plane(rays, 3, (high[1] + room) * ahead - up, 1.0F);
    set_plane(rays, 4, ahead, -1.0F);
    corner_size = 0.0F;
    for (std::size_t at = 0; at < 4; ++at) {
      const float beside = at % 2 == 0 ? low[0] - 2 * room : high[0] + 2 * room;
      const float above = at < 2 ? low[1] - 2 * room : high[1] + 2 * room;
      const Float4 way = ahead + beside * right + above * up, size = absolute(way);
      for (std::size_t axis = 0; axis < 3; ++axis) corner[axis][at] = way[axis];
      corner_size = std::max(corner_size, std::max(size[0], std::max(size[1], size[2])));
    }
    return true;
  }

  /// Which boxes no ray meets within its limit. `ahead_m`: no point of the others is nearer along the middle of the
  /// cone.
  [[gnu::always_inline]] Mask8 misses(const WideNode& node, float reach_m, Float8& ahead_m) const {
    const auto* const bounds = reinterpret_cast<const char*>(node.bounds_m.data());
    const auto along = [&](const ConePlane& plane) __attribute__((always_inline)) {
      return Float8::load(bounds + plane.row[0]) * plane.x + Float8::load(bounds + plane.row[1]) * plane.y +
             Float8::load(bounds + plane.row[2]) * plane.z;
    };
    ahead_m = simd::maximum(along(planes_[4]) - Float8(planes_[4].offset_m), Float8(0.0F));
    Mask8 missed = ahead_m > Float8(reach_m);
    for (std::size_t side = 0; side < 4; ++side) {
      missed = missed | (along(planes_[side]) < Float8(planes_[side].offset_m));
    }
    // An empty box, from +∞ to −∞, is on the right side of what it is asked about.
    return missed | (Float8::load(bounds) > Float8::load(bounds + 32));
  }

  std::array<std::array<float, 4>, 3> corner;  ///< directions along the edges of the pyramid, axis by axis
  float corner_size;                           ///< no coordinate of these is larger

 private:
  static constexpr float rounding = PacketRays::rounding;

  /// One plane of the cone, through its apex; what is on its side is in the cone. Or the plane across its middle.
  struct ConePlane {
    float x, y, z;
    float offset_m;                    ///< of the apex, less what rounding may move a box by
    std::array<std::uint32_t, 3> row;  ///< byte offsets in WideNode::bounds_m of the corner of a box that decides
  };

  static float total(const Float8& of) {
    const Float4 four = of.first_four() + of.last_four();
    return (four[0] + four[1]) + (four[2] + four[3]);
  }
  static float least(const Float8& of) {
    const Float4 low = of.first_four(), high = of.last_four(), four = low < high ? low : high;
    return std::min(std::min(four[0], four[1]), std::min(four[2], four[3]));
  }
  static float dot(const Float4& one, const Float4& other) {
    const Float4 products = one * other;
    return products[0] + products[1] + products[2];
  }
  static Float4 cross(const Float4& one, const Float4& other) {
    const auto turned = [](const Float4& by) { return __builtin_shufflevector(by, by, 1, 2, 0, 3); };
    const Float4 product = one * turned(other) - turned(one) * other;
    return turned(product);
  }
  static Float4 unit(const Float4& way) { return way * (1.0F / std::sqrt(dot(way, way))); }

  /// `side` 1: a box is outside when its farthest corner along the normal is behind the apex. −1: the nearest corner
  /// says how far ahead a box begins. Error: three products and two sums of numbers up to |normal| (|o| + extent).
  [[gnu::always_inline]] void set_plane(const PacketRays& rays, std::size_t index, const Float4& normal, float side) {
    ConePlane& plane = planes_[index];
    plane.x = normal[0];
    plane.y = normal[1];
    plane.z = normal[2];
    const float room_m = 16 * rounding * dot(absolute(normal), absolute(rays.origin_m) + rays.extent_m);
    plane.offset_m = dot(normal, rays.origin_m) - side * room_m;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      plane.row[axis] = 64 * axis + (normal[axis] * side > 0.0F ? 32U : 0U);
    }
  }

  std::array<ConePlane, 5> planes_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
