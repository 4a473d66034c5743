#pragma once
/// Rays from one point into a narrow cone, through a wide tree together.
///
/// Nodes are tested against the cone as a whole, four planes through the point, eight boxes at a time. At a leaf the
/// rays that meet its box are found eight at a time; for each of them the edges of the quads are products with normals
/// that are worked out once: an edge from p to q, seen from the point, spans a plane with the normal p × (q − p), and a
/// ray passes on the side that the sign of the product with its direction tells.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/walk.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Closest hits of a few rays with a common origin, t_min = 0 and directions within some 30 degrees of each other.
class RayPacket {
 public:
  static constexpr std::size_t capacity = 32;

  /// One place for each answer; at most `capacity`.
  RayPacket(const WideArrays& tree, std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
            TraversalCounters& counters)
      : tree_(tree), queries_(queries), hits_(hits), counters_(counters) {}

  /// False where single precision does not do, or the cone is too wide: then the rays must go one by one.
  bool prepare() { return prepare_rays() && prepare_cone(); }

  [[gnu::flatten]] void trace() {
    walk();
    for (std::size_t ray = 0; ray < queries_.size(); ++ray) {
      hits_[ray] = found_[ray].decide(tree_, queries_[ray].ray, limit_[ray], counters_);
    }
  }

 private:
  static constexpr float rounding = 0x1p-24F;
  using Numbers = std::array<float, capacity>;

  /// One plane of the cone, through its apex; what is on its side is in the cone. Or the plane across its middle.
  struct ConePlane {
    float x, y, z;
    float offset_m;                    ///< of the apex, less what rounding may move a box by
    std::array<std::uint32_t, 3> row;  ///< byte offsets in WideNode::bounds_m of the corner of a box that decides
  };

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

  /// Directions as rows of numbers; the last ray fills the rest of the last eight.
  [[gnu::always_inline]] bool prepare_rays() {
    const Vec3& at = queries_.front().ray.origin;
    const Double4 origin =
        Double4{at.x, at.y, at.z, 0.0} - Double4{tree_.origin_m.x, tree_.origin_m.y, tree_.origin_m.z, 0.0};
    origin_m_ = narrowed(origin);
    origin_low_m_ = remainder(origin, origin_m_);
    const Float4 distance = absolute(origin_m_);
    extent_m_ = tree_.extent_m;
    farthest_m_ = std::max(distance[0], std::max(distance[1], distance[2]));
    rays_ = (queries_.size() + simd_lanes - 1) / simd_lanes * simd_lanes;
    bool is_usable = farthest_m_ <= std::min(1e12F, 1e5F * extent_m_);
    for (std::size_t ray = 0; ray < rays_; ++ray) {
      const Ray<double>& own = queries_[std::min(ray, queries_.size() - 1)].ray;
      const auto x = static_cast<float>(own.direction.x), y = static_cast<float>(own.direction.y),
                 z = static_cast<float>(own.direction.z);
      direction_[0][ray] = x;
      direction_[1][ray] = y;
      direction_[2][ray] = z;
      // A quotient by nothing is infinite, on both sides alike, or no number, which neither minimum nor maximum keeps.
      for (std::size_t axis = 0; axis < 3; ++axis) reciprocal_[axis][ray] = 1.0F / direction_[axis][ray];
      size_[ray] = std::max(std::abs(x), std::max(std::abs(y), std::abs(z)));
      is_usable = is_usable && size_[ray] > 1e-12F && size_[ray] < 1e12F && own.t_max >= 0.0;
      limit_[ray] = WideRay::padded(own.t_max);
    }
    return is_usable;
  }

  /// The cone as the pyramid over a rectangle across its middle.
  [[gnu::always_inline]] bool prepare_cone() {
    Float4 sum{};
    for (std::size_t ray = 0; ray < rays_; ++ray) {
      sum += Float4{direction_[0][ray], direction_[1][ray], direction_[2][ray], 0.0F} * (1.0F / size_[ray]);
    }
    if (!(dot(sum, sum) > 0.0F)) return false;
    const Float4 ahead = unit(sum), away = absolute(ahead);
    const bool x_least = away[0] <= away[1] && away[0] <= away[2], y_least = !x_least && away[1] <= away[2];
    const Float4 right = unit(
        cross(Float4{x_least ? 1.0F : 0.0F, y_least ? 1.0F : 0.0F, x_least || y_least ? 0.0F : 1.0F, 0.0F}, ahead));
    const Float4 up = cross(ahead, right);
    float least_cosine = 1.0F;
    std::array<float, 2> low{1e30F, 1e30F}, high{-1e30F, -1e30F};
    for (std::size_t ray = 0; ray < rays_; ++ray) {
      const Float4 own{direction_[0][ray], direction_[1][ray], direction_[2][ray], 0.0F};
      ahead_[ray] = dot(own, ahead);
      least_cosine = std::min(least_cosine, ahead_[ray] / size_[ray]);
      const std::array<float, 2> beside{dot(own, right) / ahead_[ray], dot(own, up) / ahead_[ray]};
      for (std::size_t side = 0; side < 2; ++side) {
        low[side] = std::min(low[side], beside[side]);
        high[side] = std::max(high[side], beside[side]);
      }
    }
    if (!(least_cosine > 0.5F)) return false;
    constexpr float room = 1e-5F;  // a hundred roundings of a tangent below 2
    set_plane(0, right - (low[0] - room) * ahead, 1.0F);
    set_plane(1, (high[0] + room) * ahead - right, 1.0F);
    set_plane(2, up - (low[1] - room) * ahead, 1.0F);
    set_plane(3, (high[1] + room) * ahead - up, 1.0F);
    set_plane(4, ahead, -1.0F);
    return true;
  }

  /// `side` 1: a box is outside when its farthest corner along the normal is behind the apex. −1: the nearest corner
  /// says how far ahead a box begins. Error: three products and two sums of numbers up to |normal| (|o| + extent).
  [[gnu::always_inline]] void set_plane(std::size_t index, const Float4& normal, float side) {
    ConePlane& plane = planes_[index];
    plane.x = normal[0];
    plane.y = normal[1];
    plane.z = normal[2];
    const float room_m = 16 * rounding * dot(absolute(normal), absolute(origin_m_) + extent_m_);
    plane.offset_m = dot(normal, origin_m_) - side * room_m;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      plane.row[axis] = 64 * axis + (normal[axis] * side > 0.0F ? 32U : 0U);
    }
  }

  [[gnu::always_inline]] void walk() {
    struct Waiting {
      LaneKeys keys;
      std::uint32_t node;
    };
    std::array<Waiting, wide_depth_limit> waiting;  // by depth
    std::uint32_t height = 0;
    float reach_m = farthest_limit_m();
    WideChild current = WideChild::node(0);
    std::uint32_t parent = 0, parent_lane = 0;
    while (true) {
      ++counters_.nodes_visited;
      bool descends = false;
      if (!current.is_leaf()) {
        Float8 ahead_m;
        const Mask8 missed = misses(tree_.nodes[current.index()], reach_m, ahead_m);
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
      } else if (const std::uint32_t active = rays_that_meet(tree_.nodes[parent], parent_lane); active != 0) {
        if (test_leaf(current.index(), active)) reach_m = farthest_limit_m();
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

  /// The way ahead beyond which no ray asks for anything.
  [[gnu::always_inline]] float farthest_limit_m() const {
    Float8 farthest(0.0F);
    for (std::size_t ray = 0; ray < rays_; ray += simd_lanes) {
      farthest = simd::maximum(farthest, Float8::load(&limit_[ray]) * Float8::load(&ahead_[ray]));
    }
    float result = 0.0F;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) result = std::max(result, farthest[lane]);
    return result * 1.0001F;
  }

  /// Bit i: ray i may meet a box within its limit. Errors as in WideRay::BoxTest.
  [[gnu::always_inline]] std::uint32_t rays_that_meet(const WideNode& node, std::uint32_t lane) const {
    std::array<Float8, 3> low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float at_m = float_at(origin_m_, axis), room_m = 8 * rounding * (std::abs(at_m) + extent_m_) + 1e-20F;
      low[axis] = (node.bounds_m[2 * axis][lane] - at_m) - room_m;
      high[axis] = (node.bounds_m[2 * axis + 1][lane] - at_m) + room_m;
    }
    std::uint32_t met = 0;
    for (std::size_t ray = 0; ray < rays_; ray += simd_lanes) {
      Float8 entry(0.0F), exit = Float8::load(&limit_[ray]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Float8 reciprocal = Float8::load(&reciprocal_[axis][ray]);
        const Float8 one = low[axis] * reciprocal, other = high[axis] * reciprocal;
        entry = simd::maximum(simd::minimum(one, other), entry);
        exit = simd::minimum(simd::maximum(one, other), exit);
      }
      met |= (entry <= exit).bits() << ray;
    }
    return met & static_cast<std::uint32_t>((std::uint64_t{1} << queries_.size()) - 1);
  }

  /// Whether a limit has changed.
  ///
  /// Error of an edge's product, as for WideRay::meets: the corners seen from the apex are off by 4 u (distance + size)
  /// and by what double precision leaves, an edge by 3 u size, and there are nine more roundings: together less than
  /// |direction| (10 diameter + 2 size) · 16 u (distance + size).
  [[gnu::always_inline]] bool test_leaf(std::uint32_t index, std::uint32_t active) {
    const QuadLeaf& leaf = tree_.leaves[index];
    const Float4 centre_m = (load_four(leaf.centre_m.data()) - origin_m_) - origin_low_m_;
    const Float4 apart_m = absolute(centre_m);
    const float distance_m = std::max(apart_m[0], std::max(apart_m[1], apart_m[2]));
    const float far_error_m = (farthest_m_ + extent_m_) * 0x1p-48F;
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
      const Float8 x(direction_[0][ray]), y(direction_[1][ray]), z(direction_[2][ray]);
      const auto along = [&](const std::array<Float8, 3>& by) __attribute__((always_inline)) {
        return by[0] * x + by[1] * y + by[2] * z;
      };
      const Float8 ab = along(edges[0]), bc = along(edges[1]), cd = along(edges[2]), da = along(edges[3]);
      const Float8 low = simd::minimum(simd::minimum(ab, bc), simd::minimum(cd, da));
      const Float8 high = simd::maximum(simd::maximum(ab, bc), simd::maximum(cd, da));
      const Float8 error(room * size_[ray]), minus_error(-room * size_[ray]);
      const std::uint32_t candidates = leaf.lanes & ~((low < minus_error) & (high > error)).bits();
      if (candidates == 0) continue;
      const Float8 steepness = Float8(1.0F) / along(normal);
      const Float8 t = height * steepness, margin = simd::absolute(Float8(thickness_m) * steepness);
      QuadHits hits;
      hits.first = t - margin;
      hits.last = t + margin;
      const std::uint32_t met = candidates & ~((hits.first > Float8(limit_[ray])) | (hits.last < Float8(0.0F))).bits();
      if (met == 0) continue;
      hits.certain = met & (((low > error) | (high < minus_error)) & (hits.first > Float8(0.0F))).bits();
      const Float8 ca = along(edges[4]);
      const std::uint32_t left = (ca > error).bits(), right = (ca < minus_error).bits(), turn = (low > error).bits();
      hits.side = {(left & turn) | (right & ~turn), (right & turn) | (left & ~turn)};
      const float before = limit_[ray];
      found_[ray].take(tree_, queries_[ray].ray, queries_[ray].filter, index, met, hits, limit_[ray], counters_);
      is_changed = is_changed || limit_[ray] != before;
    }
    return is_changed;
  }

  const WideArrays& tree_;
  std::span<const RayQuery> queries_;
  std::span<std::optional<TriangleHit>> hits_;
  TraversalCounters& counters_;
  std::size_t rays_ = 0;  ///< a multiple of eight
  Float4 origin_m_, origin_low_m_;
  float extent_m_ = 0.0F, farthest_m_ = 0.0F;
  std::array<ConePlane, 5> planes_;
  alignas(32) std::array<Numbers, 3> direction_, reciprocal_;
  alignas(32) Numbers size_, ahead_, limit_;
  std::array<ClosestCandidates, capacity> found_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
