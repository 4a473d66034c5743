#pragma once
/// The walks of one ray through a wide tree.
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/ray.hpp"
#include "dcem/core/lane_keys.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Hides from the compiler that a pointer is the same as before: what is read through it is then read where it is
/// needed, instead of being kept on the stack from the beginning of a walk.
template <typename Item>
[[gnu::always_inline]] inline const Item* read_anew(const Item* item) {
  asm("" : "+r"(item));
  return item;
}

/// Asks for the memory of a child. Inline: g++ leaves out calls that do nothing else.
[[gnu::always_inline]] inline void fetch(const WideArrays& tree, WideChild child) {
  static_assert(sizeof(WideNode) == 256 && sizeof(QuadLeaf) == 512);
  const std::uint32_t is_leaf = child.is_leaf() ? 1U : 0U;
  const char* const bases[2] = {reinterpret_cast<const char*>(tree.nodes.data()),
                                reinterpret_cast<const char*>(tree.leaves.data())};
  const char* const at = bases[is_leaf] + (std::uint64_t{child.index()} << (8U + is_leaf));
  for (std::size_t line = 0; line < sizeof(QuadLeaf); line += 64) __builtin_prefetch(at + line);
}

/// A lane as the answer to questions instead of as a number. Where the processor foresees the answers it goes on with
/// the lane's child before it has tested the boxes of the node, which otherwise every step waits for; an answer that it
/// does not foresee costs it what it has begun. So where rays resemble those before them.
[[gnu::always_inline]] inline std::uint32_t foreseen(std::uint32_t lane) {
  std::uint32_t told = 0;
  while (told != lane) {
    ++told;
    asm("" : "+r"(told));  // or the compiler takes the number
  }
  return told;
}
/// The first of the lanes met, asked one after another.
[[gnu::always_inline]] inline std::uint32_t foreseen_first(std::uint32_t met) {
  std::uint32_t told = 0;
  while ((met >> told & 1U) == 0) {
    ++told;
    asm("" : "+r"(told));
  }
  return told;
}
/// The same, asked only whether it is the first of all.
[[gnu::always_inline]] inline std::uint32_t foreseen_if_lane_0(std::uint32_t met) {
  std::uint32_t told = 0;
  if ((met & 1U) == 0) {
    told = static_cast<std::uint32_t>(std::countr_zero(met));
    asm("" : "+r"(told));
  }
  return told;
}

/// Near children first. Calls `take(leaf_index, met, hits, limit)` for each leaf of which the ray may meet quads, up to
/// `limit` (padded), which `take` lowers: children beyond it are left out. `fetches`: the second nearest child of a
/// node is asked for ahead, which pays in trees beyond the caches. `alike`: its neighbour comes from the same point.
template <bool fetches, bool alike, typename Take>
[[gnu::always_inline]] inline void walk_closest(const WideArrays& tree, const WideRay& ray, float limit, Take&& take,
                                                TraversalCounters& counters) {
  // The children that wait, by depth of the nodes they are from. They are copied, because by the time they are asked
  // for the node has left the nearest cache. No initial values: clearing them would cost more than the walk.
  std::array<LaneKeys, wide_depth_limit> keys;
  static_assert(sizeof(WideChild) == sizeof(std::uint32_t));
  std::array<std::array<std::uint32_t, simd_lanes>, wide_depth_limit> children;  // codes
  std::uint32_t height = 0;
  const WideNode* const nodes = tree.nodes.data();
  const QuadLeaf* const leaves = tree.leaves.data();
  std::uint64_t visited = 0;
  WideChild current = WideChild::node(0);
  while (true) {
    bool is_lost = false;
    if (!current.is_leaf()) {
      const WideRay::BoxTest boxes(*read_anew(&ray), limit);
      do {
        ++visited;
        const WideNode& node = nodes[current.index()];
        Float8 entry;
        const Mask8 missed = boxes.misses(node, entry);
        const std::uint32_t met = missed.bits() ^ 0xffU;
        is_lost = met == 0;
        if (is_lost) break;
        LaneKeys entered(entry, missed);
        const std::uint32_t nearest = entered.least();
        entered.remove(nearest);
        keys[height] = entered;
        std::memcpy(children[height].data(), node.child.data(), sizeof node.child);
        height += (met & (met - 1)) != 0 ? 1U : 0U;
        current = node.child[alike ? foreseen(LaneKeys::lane(nearest)) : LaneKeys::lane(nearest)];
        if constexpr (fetches) {
          if ((met & (met - 1)) != 0) fetch(tree, node.child[LaneKeys::lane(entered.least())]);
        }
      } while (!current.is_leaf());
    }
    if (!is_lost) {
      ++visited;
      QuadHits hits;
      const std::uint32_t met = read_anew(&ray)->template meets<alike>(leaves[current.index()], limit, hits);
      if (met != 0) take(current.index(), met, hits, limit);
    }
    std::uint32_t nearest = 0;
    while (true) {
      if (height == 0) {
        counters.nodes_visited += visited;
        return;
      }
      nearest = keys[height - 1].least();
      if (LaneKeys::may_be_within(nearest, limit)) break;
      --height;
    }
    keys[height - 1].remove(nearest);
    current = {children[height - 1][LaneKeys::lane(nearest)]};
  }
}

/// Rays that ask for any hit. Of those that leave a device and have no end the processor foresees how they go into the
/// root and what they miss, as they resemble the ones before; of segments, what they miss, which is most; of those that
/// leave a surface and have no end, nothing.
enum class RayKind : std::uint8_t { segment, from_device, from_surface };

/// Children with the largest box first: farther down it is met as a rule. Calls `take(leaf_index, met, hits) -> bool`
/// until one returns true. Returns whether one did.
template <RayKind kind, typename Take>
[[gnu::always_inline]] inline bool walk_any(const WideArrays& tree, const WideRay& ray, Take&& take,
                                            TraversalCounters& counters) {
  struct Waiting {
    std::uint32_t node, lanes;
  };
  std::array<Waiting, wide_depth_limit> waiting;  // by depth
  std::uint32_t height = 0;
  const WideNode* const nodes = tree.nodes.data();
  const QuadLeaf* const leaves = tree.leaves.data();
  const float limit = ray.t_max();
  std::uint64_t visited = 0;
  WideChild current = WideChild::node(0);
  while (true) {
    bool is_lost = false;
    if (!current.is_leaf()) {
      const WideRay::BoxTest boxes(*read_anew(&ray), limit);
      do {
        ++visited;
        const WideNode& node = nodes[current.index()];
        Float8 entry;
        const std::uint32_t met = boxes.misses(node, entry).bits() ^ 0xffU;
        is_lost = met == 0;
        if (is_lost) break;
        const std::uint32_t rest = met & (met - 1);
        waiting[height] = {current.index(), rest};
        const bool is_near_root = height == 0;
        height += rest != 0 ? 1U : 0U;
        current =
            node.child[kind == RayKind::from_device && is_near_root ? foreseen_first(met) : foreseen_if_lane_0(met)];
      } while (!current.is_leaf());
    }
    if (!is_lost) {
      ++visited;
      QuadHits hits;
      const std::uint32_t met =
          read_anew(&ray)->template meets<kind != RayKind::from_surface>(leaves[current.index()], limit, hits);
      if (met != 0 && take(current.index(), met, hits)) {
        counters.nodes_visited += visited;
        return true;
      }
    }
    if (height == 0) {
      counters.nodes_visited += visited;
      return false;
    }
    Waiting& top = waiting[height - 1];
    current = nodes[top.node].child[static_cast<std::uint32_t>(std::countr_zero(top.lanes))];
    top.lanes &= top.lanes - 1;
    height -= top.lanes == 0 ? 1U : 0U;
  }
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
