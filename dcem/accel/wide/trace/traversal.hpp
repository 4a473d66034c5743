#pragma once
/// The walks through a wide tree.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/lane_keys.hpp"
#include "dcem/accel/wide/trace/ray.hpp"

namespace dcem::detail {

/// Depths of nodes and leaves of a wide tree. The tree over all and the tree of an object have no more than the binary
/// trees they are made from, each wide node standing for one of their nodes at least; an edit makes nodes only above
/// `wide_edit_depth_limit`, so that what it pushes down, a leaf or an object, is pushed no further than a built tree
/// reaches.
inline constexpr std::uint32_t wide_depth_limit = 2 * WideBinner::depths + 1;
inline constexpr std::uint32_t wide_edit_depth_limit = 40;
static_assert(wide_edit_depth_limit < WideBinner::depths);

/// Entries of a node that wait in a walk. They are copied, because by the time they are asked for the node has left the
/// closest_hit cache. No initial values: clearing a stack of them would cost more than the walk.
struct alignas(32) WaitingEntries {
  std::array<std::uint32_t, simd_lanes> child;
  std::uint32_t lanes;

  [[gnu::always_inline]] void set(const WideNode& node, std::uint32_t waiting) {
    std::memcpy(child.data(), node.child.data(), sizeof child);
    lanes = waiting;
  }
  /// Takes a lane out. Returns whether others are left.
  [[gnu::always_inline]] bool remove(std::uint32_t lane) {
    lanes ^= 1U << lane;
    return lanes != 0;
  }
};
static_assert(sizeof(WideChild) == sizeof(std::uint32_t));

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
  std::span<const QuadLeaf> leaves;
  bool may_fetch = true;  ///< WideSettings::fetch_ahead

  /// Whether what a ray needs next is far away as a rule: then it pays to ask for it ahead. Below, asking costs as much
  /// as it gains.
  bool fetches_ahead() const { return may_fetch && leaves.size_bytes() > 8'000'000; }

  // Inline: g++ leaves out calls that do nothing else.
  [[gnu::always_inline]] void fetch(WideChild child) const {
    const auto* at = child.is_leaf() ? reinterpret_cast<const char*>(&leaves[child.index()])
                                     : reinterpret_cast<const char*>(&nodes[child.index()]);
    const std::size_t bytes = child.is_leaf() ? sizeof(QuadLeaf) : sizeof(WideNode);
    for (std::size_t line = 0; line < bytes; line += 64) __builtin_prefetch(at + line);
  }
};

/// Near entries first. Calls `take(leaf_index, met, hits, limit)` for each leaf of which the ray may meet quads, up
/// to `limit` (padded), which `take` lowers: entries beyond it are left out.
template <typename Take>
[[gnu::always_inline]] inline void walk_wide_closest(const WideView& tree, const WideRay& ray, float limit, Take&& take,
                                                     TraversalCounters& counters) {
  // The entries that wait, by depth of the nodes they are from.
  std::array<LaneKeys, wide_depth_limit> keys;
  std::array<WaitingEntries, wide_depth_limit> waiting;
  std::uint32_t height = 0;
  const bool fetches = tree.fetches_ahead();
  WideChild current = WideChild::node(0);
  while (true) {
    ++counters.nodes_visited;
    if (!current.is_leaf()) {
      const WideNode& node = tree.nodes[current.index()];
      Float8 entries;
      const Mask8 mask = ray.meets(node, limit, entries);
      const std::uint32_t met = mask.bits();
      if (met != 0) {
        LaneKeys entered(entries, mask);
        const std::int32_t closest_hit = entered.least();
        entered.remove(closest_hit);
        keys[height] = entered;
        waiting[height].set(node, met ^ (1U << LaneKeys::lane(closest_hit)));
        height += (met & (met - 1)) != 0 ? 1U : 0U;
        current = node.child[LaneKeys::lane(closest_hit)];
        if (fetches && (met & (met - 1)) != 0) tree.fetch(node.child[LaneKeys::lane(entered.least())]);
        continue;
      }
    } else {
      const QuadLeaf& leaf = tree.leaves[current.index()];
      WideRay::QuadHits hits;
      const std::uint32_t met = ray.meets(leaf, limit, hits);
      if (met != 0) take(current.index(), met, hits, limit);
    }
    std::int32_t closest_hit = 0;
    do {
      if (height == 0) return;
      --height;
      closest_hit = keys[height].least();
    } while (!LaneKeys::may_be_within(closest_hit, limit));
    keys[height].remove(closest_hit);
    current = {waiting[height].child[LaneKeys::lane(closest_hit)]};
    height += waiting[height].remove(LaneKeys::lane(closest_hit)) ? 1U : 0U;
  }
}

/// Entries with the largest box first. Calls `take(leaf_index, met, hits) -> bool` until one returns true. Returns
/// whether one did.
template <typename Take>
[[gnu::always_inline]] inline bool walk_wide_any(const WideView& tree, const WideRay& ray, float limit, Take&& take,
                                                 TraversalCounters& counters) {
  std::array<WaitingEntries, wide_depth_limit> waiting;  // by depth of the nodes they are from
  std::uint32_t height = 0;
  WideChild current = WideChild::node(0);
  while (true) {
    ++counters.nodes_visited;
    if (!current.is_leaf()) {
      const WideNode& node = tree.nodes[current.index()];
      Float8 entries;
      const std::uint32_t met = ray.meets(node, limit, entries).bits();
      if (met != 0) {
        const std::uint32_t rest = met & (met - 1);
        waiting[height].set(node, rest);
        height += rest != 0 ? 1U : 0U;
        current = node.child[static_cast<std::uint32_t>(std::countr_zero(met))];
        continue;
      }
    } else {
      const QuadLeaf& leaf = tree.leaves[current.index()];
      WideRay::QuadHits hits;
      const std::uint32_t met = ray.meets(leaf, limit, hits);
      if (met != 0 && take(current.index(), met, hits)) return true;
    }
    if (height == 0) return false;
    WaitingEntries& top = waiting[height - 1];
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(top.lanes));
    current = {top.child[lane]};
    height -= top.remove(lane) ? 0U : 1U;
  }
}

/// All entries of the tree whose box `keep(box)` holds for, in tree coordinates; `take(leaf_index)` for leaves.
template <typename Keep, typename Take>
void walk_wide_boxes(const WideView& tree, Keep&& keep, Take&& take, TraversalCounters& counters) {
  std::array<std::uint32_t, (simd_lanes - 1) * wide_depth_limit + simd_lanes> stack;
  std::uint32_t height = 0;
  stack[height++] = WideChild::node(0).code;
  while (height > 0) {
    const WideChild current{stack[--height]};
    ++counters.nodes_visited;
    if (current.is_leaf()) {
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

/// Quads that may be the closest_hit, with the earliest t of each.
class WideCandidates {
 public:
  struct Candidate {
    std::uint32_t quad;
    float first;
    QuadKnowledge known;
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
