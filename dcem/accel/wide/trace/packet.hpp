#pragma once
/// Rays from one point into a narrow cone, through a wide tree together.
///
/// Nodes are tested against the cone as a whole, eight boxes at a time (packet_cone.hpp). Whether a ray meets a box
/// that the cone meets, and which, is asked for eight rays at a time (packet_rays.hpp): of a cone that is wide far out,
/// most is beside its rays, and most of them end before. At a leaf, for each of them the edges of the quads are
/// products with normals that are worked out once: an edge from p to q, seen from the point, spans a plane with the
/// normal p × (q − p), and a ray passes on the side that the sign of the product with its direction tells.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/packet_cone.hpp"
#include "dcem/accel/wide/trace/packet_rays.hpp"
#include "dcem/accel/wide/trace/walk.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Closest hits of a few rays with a common origin, t_min = 0 and directions within some 30 degrees of each other.
class RayPacket {
 public:
  static constexpr std::size_t capacity = PacketRays::capacity;

  /// One place for each answer; at most `capacity`.
  RayPacket(const WideArrays& tree, std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
            TraversalCounters& counters)
      : tree_(tree), queries_(queries), hits_(hits), counters_(counters) {}

  /// False where single precision does not do, or the cone is too wide: then the rays must go one by one.
  bool prepare() { return rays_.prepare(tree_, queries_) && cone_.surround(rays_); }

  [[gnu::flatten]] void trace() {
    walk();
    for (std::size_t ray = 0; ray < queries_.size(); ++ray) {
      hits_[ray] = found_[ray].decide(tree_, queries_[ray].ray, rays_.limit[ray], counters_);
    }
  }

 private:
  static constexpr float rounding = PacketRays::rounding;

  [[gnu::always_inline]] void walk() {
    struct Waiting {
      LaneKeys keys;
      std::uint32_t node;
    };
    std::array<Waiting, wide_depth_limit> waiting;  // by depth
    std::uint32_t height = 0;
    float reach_m = rays_.farthest_limit_m();
    WideChild current = WideChild::node(0);
    std::uint32_t parent = 0, parent_lane = 0;
    while (true) {
      ++counters_.nodes_visited;
      bool descends = false;
      const bool is_root = current == WideChild::node(0);
      const std::uint32_t active = is_root ? 1U : rays_.that_meet(tree_.nodes[parent], parent_lane);
      if (active != 0 && current.is_leaf()) {
        if (test_leaf(current.index(), active)) reach_m = rays_.farthest_limit_m();
      } else if (active != 0) {
        Float8 ahead_m;
        const Mask8 missed = cone_.misses(tree_.nodes[current.index()], reach_m, ahead_m);
        const std::uint32_t met = missed.bits() ^ 0xffU;
        if (met != 0) {
          LaneKeys entered(ahead_m, missed);
          const std::uint32_t nearest = entered.least();
          entered.remove(nearest);
          waiting[height] = {entered, current.index()};
          height += (met & (met - 1)) != 0 ? 1U : 0U;
          parent = current.index();
          parent_lane = LaneKeys::lane(nearest);
          current = tree_.nodes[parent].child[parent_lane];
          descends = true;
        }
      }
      if (descends) continue;
      std::uint32_t nearest = 0;
      while (true) {
        if (height == 0) return;
        nearest = waiting[height - 1].keys.least();
        if (LaneKeys::may_be_within(nearest, reach_m)) break;
        --height;
      }
      waiting[height - 1].keys.remove(nearest);
      parent = waiting[height - 1].node;
      parent_lane = LaneKeys::lane(nearest);
      current = tree_.nodes[parent].child[parent_lane];
    }
  }

  /// Whether a limit has changed.
  ///
  /// Error of an edge's product, as for WideRay::meets: the corners seen from the apex are off by 4 u (distance + size)
  /// and by what double precision leaves, an edge by 3 u size, and there are nine more roundings: together less than
  /// |direction| (10 diameter + 2 size) · 16 u (distance + size).
  [[gnu::always_inline]] bool test_leaf(std::uint32_t index, std::uint32_t active) {
    const QuadLeaf& leaf = tree_.leaves[index];
    const Float4 centre_m = (load_four(leaf.centre_m.data()) - rays_.origin_m) - rays_.origin_low_m;
    const Float4 apart_m = absolute(centre_m);
    const float distance_m = std::max(apart_m[0], std::max(apart_m[1], apart_m[2]));
    const float far_error_m = (rays_.farthest_m + rays_.extent_m) * 0x1p-48F;
    const float error_m = 16 * rounding * distance_m + (16 * rounding * leaf.size_m + far_error_m);
    const float room = (leaf.reach_m + 2 * error_m) * (leaf.bend_m + error_m) + 2 * leaf.size_m * error_m;
    std::array<std::array<Float8, 3>, 4> corner, seen;  // from the centre, and from the apex
    for (std::size_t at = 0; at < 4; ++at) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corner[at][axis] = Float8(leaf.corner_m[at][axis]);
        seen[at][axis] = corner[at][axis] + Float8(float_at(centre_m, axis));
      }
    }
    const auto across = [&](std::size_t from, std::size_t to) __attribute__((always_inline)) {
      std::array<Float8, 3> way;
      for (std::size_t axis = 0; axis < 3; ++axis) way[axis] = corner[to][axis] - corner[from][axis];
      const std::array<Float8, 3>& at = seen[from];
      return std::array<Float8, 3>{at[1] * way[2] - at[2] * way[1], at[2] * way[0] - at[0] * way[2],
                                   at[0] * way[1] - at[1] * way[0]};
    };
    const std::array<std::array<Float8, 3>, 5> edges{across(0, 1), across(1, 2), across(2, 3), across(3, 0),
                                                     across(2, 0)};
    const std::array<Float8, 3> normal{Float8(leaf.normal[0]), Float8(leaf.normal[1]), Float8(leaf.normal[2])};
    const Float8 height = normal[0] * seen[0][0] + normal[1] * seen[0][1] + normal[2] * seen[0][2];
    const float thickness_m = leaf.bend_m + 2 * error_m;
    bool is_changed = false;
    for (; active != 0; active &= active - 1) {
      const auto ray = static_cast<std::uint32_t>(std::countr_zero(active));
      const Float8 x(rays_.direction[0][ray]), y(rays_.direction[1][ray]), z(rays_.direction[2][ray]);
      const auto along = [&](const std::array<Float8, 3>& by) __attribute__((always_inline)) {
        return by[0] * x + by[1] * y + by[2] * z;
      };
      const Float8 ab = along(edges[0]), bc = along(edges[1]), cd = along(edges[2]), da = along(edges[3]);
      const Float8 low = simd::minimum(simd::minimum(ab, bc), simd::minimum(cd, da));
      const Float8 high = simd::maximum(simd::maximum(ab, bc), simd::maximum(cd, da));
      const Float8 error(room * rays_.size[ray]), minus_error(-room * rays_.size[ray]);
      const std::uint32_t candidates = leaf.lanes & ~((low < minus_error) & (high > error)).bits();
      if (candidates == 0) continue;
      const Float8 steepness = Float8(1.0F) / along(normal);
      const Float8 t = height * steepness, margin = simd::absolute(Float8(thickness_m) * steepness);
      QuadHits hits;
      hits.first = t - margin;
      hits.last = t + margin;
      const std::uint32_t met =
          candidates & ~((hits.first > Float8(rays_.limit[ray])) | (hits.last < Float8(0.0F))).bits();
      if (met == 0) continue;
      hits.certain = met & (((low > error) | (high < minus_error)) & (hits.first > Float8(0.0F))).bits();
      const Float8 ca = along(edges[4]);
      const std::uint32_t left = (ca > error).bits(), right = (ca < minus_error).bits(), turn = (low > error).bits();
      hits.side = {(left & turn) | (right & ~turn), (right & turn) | (left & ~turn)};
      const float before = rays_.limit[ray];
      found_[ray].take(tree_, queries_[ray].ray, queries_[ray].filter, index, met, hits, rays_.limit[ray], counters_);
      is_changed = is_changed || rays_.limit[ray] != before;
    }
    return is_changed;
  }

  const WideArrays& tree_;
  std::span<const RayQuery> queries_;
  std::span<std::optional<TriangleHit>> hits_;
  TraversalCounters& counters_;
  PacketRays rays_;
  PacketCone cone_;
  std::array<ClosestCandidates, capacity> found_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
