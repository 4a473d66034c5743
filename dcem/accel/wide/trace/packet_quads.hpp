#pragma once
/// The quads of a leaf as the point sees them from which the rays of a packet come.
///
/// An edge from p to q, seen from the point, spans a plane with the normal p × (q − p), and a ray passes on the side
/// that the sign of the product with its direction tells. A ray meets the plane of a quad at height / (normal ·
/// direction).
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/packet_cone.hpp"
#include "dcem/accel/wide/trace/packet_rays.hpp"
#include "dcem/accel/wide/trace/quad_hits.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// What eight rays have of a quad, one lane each.
struct RowHits {
  Float8 first, last;                 ///< where the quad is met, no earlier and no later
  Mask8 certain;                      ///< the quad is met, after the point
  std::array<std::uint32_t, 2> side;  ///< as QuadHits::side

  QuadCertainty certainty(std::uint32_t lane) const {
    const auto bit = [lane](std::uint32_t lanes) { return lanes >> lane & 1U; };
    return static_cast<QuadCertainty>(bit(certain.bits()) * (1 + bit(side[0]) + 2 * bit(side[1])));
  }
};

/// All quads of a leaf, side by side.
///
/// Error of an edge's product, as for WideRay::meets: the corners seen from the point are off by 4 u (distance + size)
/// and by what double precision leaves, an edge by 3 u size, and there are nine more roundings: together less than
/// |direction| (10 diameter + 2 size) · 16 u (distance + size).
class PacketQuads {
 public:
  [[gnu::always_inline]] PacketQuads(const QuadLeaf& leaf, const PacketRays& rays) {
    const Float4 centre_m = (load_four(leaf.centre_m.data()) - rays.origin_m) - rays.origin_low_m;
    const Float4 apart_m = absolute(centre_m);
    const float distance_m = std::max(apart_m[0], std::max(apart_m[1], apart_m[2]));
    const float far_error_m = (rays.farthest_m + rays.extent_m) * 0x1p-48F;
    const float error_m = 16 * rounding * distance_m + (16 * rounding * leaf.size_m + far_error_m);
    error_ = (leaf.reach_m + 2 * error_m) * (leaf.bend_m + error_m) + 2 * leaf.size_m * error_m;
    thickness_m_ = leaf.bend_m + 2 * error_m;
    std::array<Row3, 4> corner, seen;  // from the centre, and from the point
    for (std::size_t at = 0; at < 4; ++at) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corner[at][axis] = Float8(leaf.corner_m[at][axis]);
        seen[at][axis] = corner[at][axis] + Float8(float_at(centre_m, axis));
      }
    }
    const auto across = [&](std::size_t from, std::size_t to) __attribute__((always_inline)) {
      Row3 way;
      for (std::size_t axis = 0; axis < 3; ++axis) way[axis] = corner[to][axis] - corner[from][axis];
      const Row3& at = seen[from];
      return Row3{at[1] * way[2] - at[2] * way[1], at[2] * way[0] - at[0] * way[2], at[0] * way[1] - at[1] * way[0]};
    };
    edge_ = {across(0, 1), across(1, 2), across(2, 3), across(3, 0), across(2, 0)};
    normal_ = {Float8(leaf.normal[0]), Float8(leaf.normal[1]), Float8(leaf.normal[2])};
    height_m_ = normal_[0] * seen[0][0] + normal_[1] * seen[0][1] + normal_[2] * seen[0][2];
  }

  /// Quads that no ray of a cone meets: all four corner rays pass one edge on one side and another edge on the other,
  /// and so does what is between them. Twice the error: once for the corner rays, once for the rays.
  [[gnu::always_inline]] std::uint32_t beside(const PacketCone& cone) const {
    Float8 least_of_highest(1e30F), most_of_lowest(-1e30F);
    for (std::size_t side = 0; side < 4; ++side) {
      const auto along = [&](std::size_t corner) __attribute__((always_inline)) {
        return edge_[side][0] * cone.corner[0][corner] + edge_[side][1] * cone.corner[1][corner] +
               edge_[side][2] * cone.corner[2][corner];
      };
      const Float8 one = along(0), two = along(1), three = along(2), four = along(3);
      const Float8 high = simd::maximum(simd::maximum(one, two), simd::maximum(three, four));
      const Float8 low = simd::minimum(simd::minimum(one, two), simd::minimum(three, four));
      least_of_highest = simd::minimum(high, least_of_highest);
      most_of_lowest = simd::maximum(low, most_of_lowest);
    }
    const float error = 2 * error_ * cone.corner_size;
    return ((least_of_highest < Float8(-error)) & (most_of_lowest > Float8(error))).bits();
  }

 private:
  friend class PacketQuad;
  static constexpr float rounding = PacketRays::rounding;
  using Row3 = std::array<Float8, 3>;

  std::array<Row3, 5> edge_;  ///< normals for the edges a b, b c, c d, d a and the diagonal c a
  Row3 normal_;
  Float8 height_m_;
  float error_;  ///< of a product, for a direction whose longest axis is 1
  float thickness_m_;
};

/// One of them, for eight rays at a time.
class PacketQuad {
 public:
  [[gnu::always_inline]] PacketQuad(const PacketQuads& quads, std::uint32_t lane)
      : error_(quads.error_), thickness_m_(quads.thickness_m_) {
    // From where the row lies in memory, which the processor spreads as it reads it.
    const auto spread = [lane](const Float8& row) __attribute__((always_inline)) {
      return Float8(reinterpret_cast<const SharedFloat*>(&row)[lane]);
    };
    for (std::size_t at = 0; at < edge_.size(); ++at) {
      for (std::size_t axis = 0; axis < 3; ++axis) edge_[at][axis] = spread(quads.edge_[at][axis]);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) normal_[axis] = spread(quads.normal_[axis]);
    height_m_ = spread(quads.height_m_);
  }

  /// Bit i: ray `first_ray` + i may meet the quad within its limit.
  [[gnu::always_inline]] std::uint32_t meets(const PacketRays& rays, std::size_t first_ray, RowHits& hits) const {
    const Float8 x = Float8::load(&rays.direction[0][first_ray]), y = Float8::load(&rays.direction[1][first_ray]),
                 z = Float8::load(&rays.direction[2][first_ray]), size = Float8::load(&rays.size[first_ray]);
    const auto along = [&](const std::array<Float8, 3>& by) __attribute__((always_inline)) {
      return by[0] * x + by[1] * y + by[2] * z;
    };
    const Float8 ab = along(edge_[0]), bc = along(edge_[1]), cd = along(edge_[2]), da = along(edge_[3]);
    const Float8 low = simd::minimum(simd::minimum(ab, bc), simd::minimum(cd, da));
    const Float8 high = simd::maximum(simd::maximum(ab, bc), simd::maximum(cd, da));
    const Float8 error = error_ * size, minus_error = -error_ * size;
    const Float8 steepness = 1.0F / along(normal_);
    const Float8 t = height_m_ * steepness, margin = simd::absolute(thickness_m_ * steepness);
    hits.first = t - margin;
    hits.last = t + margin;
    // Refusals are asked for, not passes: NaN, from numbers near the limits, refuses nothing.
    const Mask8 missed = ((low < minus_error) & (high > error)) | (hits.first > Float8::load(&rays.limit[first_ray])) |
                         (hits.last < Float8(0.0F));
    hits.certain = ((low > error) | (high < minus_error)) & (hits.first > Float8(0.0F));
    // The diagonal turns with the edges of the first triangle, and against those of the second.
    const Float8 ca = along(edge_[4]);
    const std::uint32_t left = (ca > error).bits(), right = (ca < minus_error).bits(), turn = (low > error).bits();
    hits.side = {(left & turn) | (right & ~turn), (right & turn) | (left & ~turn)};
    return missed.bits() ^ 0xffU;
  }

 private:
  using SharedFloat = float __attribute__((may_alias));

  std::array<std::array<Float8, 3>, 5> edge_;
  std::array<Float8, 3> normal_;
  Float8 height_m_;
  float error_, thickness_m_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
