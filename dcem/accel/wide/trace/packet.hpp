#pragma once
/// Rays from one point into a cone, through a wide tree together.
///
/// Nodes are tested against the cone as a whole, eight boxes at a time (packet_cone.hpp). Whether a ray meets a box
/// that the cone meets, and which, is asked for eight rays at a time (packet_rays.hpp): of a cone that is wide far out,
/// most is beside its rays, and most of them end before. At a leaf the quads that the cone meets are asked for one
/// after another, each for eight rays at a time (packet_quads.hpp).
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/packet_cone.hpp"
#include "dcem/accel/wide/trace/packet_hits.hpp"
#include "dcem/accel/wide/trace/packet_quads.hpp"
#include "dcem/accel/wide/trace/packet_rays.hpp"
#include "dcem/core/lane_keys.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Closest hits of rays with a common origin, t_min = 0 and directions within some 40 degrees of the first one. One
/// packet serves for many, one after another. `Source`: see packet_source.hpp.
template <typename Source>
class RayPacket {
 public:
  static constexpr std::size_t least = 4;  ///< fewer are faster one by one

  RayPacket(const WideArrays& tree, const Source& source, TraversalCounters& counters)
      : tree_(tree), counters_(counters), source_(source), next_(source), found_(tree, source, counters) {}

  /// Takes the first of many rays that can go together, with one place for each answer. Returns how many these are;
  /// fewer than `least` must go one by one.
  std::size_t gather(const Source& source, std::span<std::optional<TriangleHit>> hits) {
    if (source.size() < least || !source.begins_together()) return 1;
    const std::size_t count = rays_.gather(tree_, source);
    if (count < least || !cone_.surround(rays_)) return std::min(count, least - 1);
    hits_ = {hits.data(), count};
    source_ = source.part(0, count);
    next_ = source.part(count, count);
    fetched_ = 0;
    return count;
  }

  [[gnu::flatten]] void trace() {
    found_.begin(source_);
    walk();
    for (std::uint32_t ray = 0; ray < source_.size(); ++ray) {
      fetch_some(2);  // what a walk of few steps has left
      answer(found_.decide(ray, rays_.limit[ray]), hits_[ray]);
    }
  }

 private:
  /// The children of a node that wait.
  struct Waiting {
    LaneKeys keys;
    std::uint32_t node;
  };

  [[gnu::always_inline]] void walk() {
    std::array<Waiting, wide_depth_limit> waiting;  // by depth
    std::uint32_t height = 0, parent = 0, lane = 0;
    float reach_m = rays_.farthest_limit_m();
    WideChild current = WideChild::node(0);
    while (true) {
      ++counters_.nodes_visited;
      fetch_some(8);
      const bool is_root = current == WideChild::node(0);
      const RayMask active = is_root ? 1U : rays_.that_meet(tree_.nodes[parent], lane);
      if (active != 0 && current.is_leaf()) {
        if (test_leaf(current.index(), active)) reach_m = rays_.farthest_limit_m();
      } else if (active != 0) {
        parent = current.index();
        const std::uint32_t met = enter(parent, reach_m, waiting[height], lane);
        if (met != 0) {
          height += (met & (met - 1)) != 0 ? 1U : 0U;
          current = tree_.nodes[parent].child[lane];
          continue;
        }
      }
      while (true) {
        if (height == 0) return;
        const std::uint32_t nearest = waiting[height - 1].keys.least();
        if (LaneKeys::may_be_within(nearest, reach_m)) {
          waiting[height - 1].keys.remove(nearest);
          lane = LaneKeys::lane(nearest);
          break;
        }
        --height;
      }
      parent = waiting[height - 1].node;
      current = tree_.nodes[parent].child[lane];
    }
  }

  /// Bit i: the cone meets child i of a node. `nearest` is the first of them, the others wait.
  [[gnu::always_inline]] std::uint32_t enter(std::uint32_t node, float reach_m, Waiting& others,
                                             std::uint32_t& nearest) const {
    Float8 ahead_m;
    const Mask8 missed = cone_.misses(tree_.nodes[node], reach_m, ahead_m);
    LaneKeys keys(ahead_m, missed);
    const std::uint32_t key = keys.least();
    keys.remove(key);
    nearest = LaneKeys::lane(key);
    others = {keys, node};
    return missed.bits() ^ 0xffU;
  }

  /// Returns whether a limit has changed.
  [[gnu::always_inline]] bool test_leaf(std::uint32_t index, RayMask active) {
    const QuadLeaf& leaf = tree_.leaves[index];
    const PacketQuads quads(leaf, rays_);
    bool is_changed = false;
    for (std::uint32_t lanes = leaf.lanes & ~quads.beside(cone_); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      const PacketQuad quad(quads, lane);
      for (std::size_t first_ray = 0; first_ray < rays_.count; first_ray += simd_lanes) {
        const std::uint32_t here = static_cast<std::uint32_t>(active >> first_ray) & 0xffU;
        if (here == 0) continue;
        RowHits hits;
        const std::uint32_t met = here & quad.meets(rays_, first_ray, hits);
        if (met == 0) continue;
        is_changed = found_.take(index * simd_lanes + lane, met, hits, first_ray, rays_) || is_changed;
      }
    }
    return is_changed;
  }

  /// Asks for the memory of some of the next rays: a few lines at a time, or all else would wait for them.
  [[gnu::always_inline]] void fetch_some(std::size_t lines) {
    constexpr std::size_t line = 64;
    const std::span<const std::byte> bytes = next_.bytes();
    const std::size_t end = std::min(fetched_ + lines * line, bytes.size());
    for (; fetched_ < end; fetched_ += line) __builtin_prefetch(bytes.data() + fetched_);
  }

  const WideArrays& tree_;
  TraversalCounters& counters_;
  Source source_, next_;  ///< the rays, and those that follow them
  std::span<std::optional<TriangleHit>> hits_;
  std::size_t fetched_ = 0;  ///< bytes of those that follow
  PacketRays rays_;
  PacketCone cone_;
  PacketHits<Source> found_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
