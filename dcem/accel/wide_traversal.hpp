#pragma once
/// The walks through a wide tree.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide_binner.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/accel/wide_ray.hpp"

namespace dcem::detail {

/// Levels of nodes and blocks of a wide tree. The tree over all and the tree of a unit have no more than the binary
/// trees they are made from, each wide node standing for one of their nodes at least; an edit makes nodes only above
/// `wide_edit_levels`, so that what it pushes down, a block or a unit, is pushed no further than a built tree reaches.
inline constexpr std::uint32_t wide_levels = 2 * WideBinner::levels + 1;
inline constexpr std::uint32_t wide_edit_levels = 40;
static_assert(wide_edit_levels < WideBinner::levels);
/// A walk leaves at most seven entries behind per level.
inline constexpr std::uint32_t wide_stack_size = 7 * wide_levels;

/// Calls `visit(lane)` for the set bits, lowest first, until one returns true. Returns whether one did.
template <typename Visit>
[[gnu::always_inline]] inline bool any_lane(std::uint32_t lanes, Visit&& visit) {
  for (; lanes != 0; lanes &= lanes - 1) {
    if (visit(static_cast<std::uint32_t>(std::countr_zero(lanes)))) return true;
  }
  return false;
}

/// What a walk reads.
struct WideView {
  std::span<const WideNode> nodes;
  std::span<const PatchBlock> blocks;
};

/// Near entries first. Calls `take(block_index, met, hits, limit)` for each block of which the ray may meet patches, up
/// to `limit` (padded), which `take` lowers: entries beyond it are left out.
template <typename Take>
[[gnu::always_inline]] inline void walk_wide_nearest(const WideView& tree, const WideRay& ray, float limit, Take&& take,
                                                     TraversalCounters& counters) {
  // No initial values: clearing the stack would cost more than the walk.
  struct Pending {
    std::uint32_t child;
    float entry;
  };
  std::array<Pending, wide_stack_size> stack;
  std::uint32_t height = 0;
  WideChild current = WideChild::node(0);
  while (true) {
    ++counters.nodes_visited;
    if (!current.is_block()) {
      const WideNode& node = tree.nodes[current.index()];
      Float8 entries;
      std::uint32_t met = ray.meets(node, limit, entries);
      if (met != 0) {
        alignas(32) std::array<float, simd_lanes> entry;
        entries.store(entry);
        std::uint32_t lane = static_cast<std::uint32_t>(std::countr_zero(met));
        Pending nearest{node.child[lane].code, entry[lane]};
        const std::uint32_t bottom = height;
        for (met &= met - 1; met != 0; met &= met - 1) {
          lane = static_cast<std::uint32_t>(std::countr_zero(met));
          Pending other{node.child[lane].code, entry[lane]};
          if (other.entry < nearest.entry) std::swap(other, nearest);
          // The nearest of those that wait lies on top.
          std::uint32_t place = height++;
          for (; place > bottom && stack[place - 1].entry < other.entry; --place) stack[place] = stack[place - 1];
          stack[place] = other;
        }
        current = {nearest.child};
        continue;
      }
    } else {
      const PatchBlock& block = tree.blocks[current.index()];
      WideRay::PatchHits hits;
      const std::uint32_t met = ray.meets(block, limit, hits);
      if (met != 0) take(current.index(), met, hits, limit);
    }
    do {
      if (height == 0) return;
      --height;
    } while (!(stack[height].entry <= limit));
    current = {stack[height].child};
  }
}

/// Entries with the largest box first. Calls `take(block_index, met, hits) -> bool` until one returns true. Returns
/// whether one did.
template <typename Take>
[[gnu::always_inline]] inline bool walk_wide_any(const WideView& tree, const WideRay& ray, float limit, Take&& take,
                                                 TraversalCounters& counters) {
  // One entry per node with the lanes that wait: pushing them one by one would be a loop that no processor foresees.
  struct Pending {
    std::uint32_t node, lanes;
  };
  std::array<Pending, wide_stack_size> stack;
  std::uint32_t height = 0;
  WideChild current = WideChild::node(0);
  while (true) {
    ++counters.nodes_visited;
    if (!current.is_block()) {
      const WideNode& node = tree.nodes[current.index()];
      Float8 entries;
      const std::uint32_t met = ray.meets(node, limit, entries);
      if (met != 0) {
        const std::uint32_t rest = met & (met - 1);
        stack[height] = {current.index(), rest};
        height += rest != 0 ? 1U : 0U;
        current = node.child[static_cast<std::uint32_t>(std::countr_zero(met))];
        continue;
      }
    } else {
      const PatchBlock& block = tree.blocks[current.index()];
      WideRay::PatchHits hits;
      const std::uint32_t met = ray.meets(block, limit, hits);
      if (met != 0 && take(current.index(), met, hits)) return true;
    }
    if (height == 0) return false;
    Pending& top = stack[height - 1];
    current = tree.nodes[top.node].child[static_cast<std::uint32_t>(std::countr_zero(top.lanes))];
    top.lanes &= top.lanes - 1;
    height -= top.lanes == 0 ? 1U : 0U;
  }
}

/// All entries of the tree whose box `keep(box)` holds for, in tree coordinates; `take(block_index)` for blocks.
template <typename Keep, typename Take>
void walk_wide_boxes(const WideView& tree, Keep&& keep, Take&& take, TraversalCounters& counters) {
  std::array<std::uint32_t, wide_stack_size + simd_lanes> stack;
  std::uint32_t height = 0;
  stack[height++] = WideChild::node(0).code;
  while (height > 0) {
    const WideChild current{stack[--height]};
    ++counters.nodes_visited;
    if (current.is_block()) {
      take(current.index());
      continue;
    }
    const WideNode& node = tree.nodes[current.index()];
    for (std::uint32_t lane = simd_lanes; lane-- > 0;) {
      if (node.child[lane].is_none()) continue;
      const Aabb<float> box = node.box(lane);
      if (!box.empty() && keep(box)) stack[height++] = node.child[lane].code;
    }
  }
}

/// Patches that may be the nearest, with the earliest t of each.
class WideCandidates {
 public:
  struct Candidate {
    std::uint32_t patch;
    float first;
    PatchKnowledge known;
  };

  /// False where there is no room.
  bool add(const Candidate& candidate, float limit) {
    if (count_ == held_.size()) drop_beyond(limit);
    if (count_ == held_.size()) return false;
    held_[count_++] = candidate;
    return true;
  }
  void drop_beyond(float limit) {
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < count_; ++index) {
      if (!(held_[index].first > limit)) held_[kept++] = held_[index];
    }
    count_ = kept;
  }
  std::span<Candidate> held() { return {held_.data(), count_}; }

 private:
  std::array<Candidate, 24> held_;  // as the stack: no initial values
  std::uint32_t count_ = 0;
};

}  // namespace dcem::detail
