#pragma once
/// Many rays through a wide tree, several of them on their way at any time.
///
/// A walk of one ray waits: for the memory of a node, and for one answer before it can ask the next question. Here each
/// ray makes one step, asks for the memory of its next one, and gives way to the others. Rays at nodes and rays at
/// leaves stand in two queues, so that the code for a step, which depends on the ray in a way that no processor
/// foresees, is the same for a run of rays. Each ray takes the steps that it takes alone.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/walk.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Closest hits of many rays.
class ClosestStream {
 public:
  /// A stream of fewer is not worth beginning.
  static constexpr std::size_t least = 16;

  ClosestStream(const WideArrays& tree, std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
                TraversalCounters& counters)
      : tree_(tree), queries_(queries), hits_(hits), counters_(counters) {}

  [[gnu::flatten]] void run() {
    for (std::uint32_t slot = 0; slot < slot_count; ++slot) begin_next(slot);
    while (nodes_next_.count + leaves_next_.count > 0) {
      const Queue at_nodes = std::exchange(nodes_next_, {}), at_leaves = std::exchange(leaves_next_, {});
      for (std::uint32_t index = 0; index < at_nodes.count; ++index) step_at_node(at_nodes.slot[index]);
      for (std::uint32_t index = 0; index < at_leaves.count; ++index) step_at_leaf(at_leaves.slot[index]);
    }
  }

 private:
  /// More hide no more waiting, and push each other out of the nearest cache.
  static constexpr std::uint32_t slot_count = 8;

  /// A ray on its way. No initial values.
  struct Slot {
    alignas(WideRay) std::array<std::byte, sizeof(WideRay)> ray;
    std::uint32_t query;
    std::uint32_t height;
    WideChild current;
    float limit;
    std::array<LaneKeys, wide_depth_limit> keys;        ///< of the children that wait, by depth
    std::array<std::uint32_t, wide_depth_limit> nodes;  ///< whose children they are
    alignas(ClosestCandidates) std::array<std::byte, sizeof(ClosestCandidates)> candidates;

    WideRay& wide() { return *std::launder(reinterpret_cast<WideRay*>(ray.data())); }
    ClosestCandidates& found() { return *std::launder(reinterpret_cast<ClosestCandidates*>(candidates.data())); }
  };
  struct Queue {
    std::array<std::uint32_t, slot_count + 1> slot;  // one more: written before it is known whether it counts
    std::uint32_t count = 0;
  };

  /// Lets the next ray begin in a slot; rays that need no walk are answered at once.
  [[gnu::always_inline]] void begin_next(std::uint32_t index) {
    Slot& slot = slots_[index];
    for (; next_ < queries_.size(); ++next_) {
      const RayQuery& query = queries_[next_];
      new (slot.ray.data()) WideRay(query.ray, tree_.origin_m, tree_.extent_m);
      if (slot.wide().usable()) break;
      hits_[next_] = closest_hit_of_all(tree_, query.ray, query.filter, counters_);
    }
    if (next_ == queries_.size()) return;
    slot.query = static_cast<std::uint32_t>(next_++);
    slot.height = 0;
    slot.limit = slot.wide().t_max();
    new (slot.candidates.data()) ClosestCandidates();
    send(index, WideChild::node(0));
  }

  /// Sends a ray to a child, whose memory is asked for.
  [[gnu::always_inline]] void send(std::uint32_t index, WideChild child) {
    slots_[index].current = child;
    const std::uint32_t is_leaf = child.is_leaf() ? 1U : 0U;
    nodes_next_.slot[nodes_next_.count] = index;
    leaves_next_.slot[leaves_next_.count] = index;
    nodes_next_.count += 1U - is_leaf;
    leaves_next_.count += is_leaf;
    fetch(tree_, child);
  }

  [[gnu::always_inline]] void step_at_node(std::uint32_t index) {
    ++counters_.nodes_visited;
    Slot& slot = slots_[index];
    const WideNode& node = tree_.nodes[slot.current.index()];
    Float8 entry;
    const Mask8 missed = WideRay::BoxTest(slot.wide(), slot.limit).misses(node, entry);
    const std::uint32_t met = missed.bits() ^ 0xffU;
    if (met == 0) return take_next(index);
    LaneKeys entered(entry, missed);
    const std::uint32_t nearest = entered.least();
    entered.remove(nearest);
    slot.keys[slot.height] = entered;
    slot.nodes[slot.height] = slot.current.index();
    slot.height += (met & (met - 1)) != 0 ? 1U : 0U;
    send(index, node.child[LaneKeys::lane(nearest)]);
  }

  [[gnu::always_inline]] void step_at_leaf(std::uint32_t index) {
    ++counters_.nodes_visited;
    Slot& slot = slots_[index];
    const std::uint32_t leaf = slot.current.index();
    QuadHits hits;
    const std::uint32_t met = slot.wide().meets(tree_.leaves[leaf], slot.limit, hits);
    if (met != 0) {
      const RayQuery& query = queries_[slot.query];
      slot.found().take(tree_, query.ray, query.filter, leaf, met, hits, slot.limit, counters_);
    }
    take_next(index);
  }

  /// Sends a ray to the nearest of the children that wait; where none does it has arrived.
  [[gnu::always_inline]] void take_next(std::uint32_t index) {
    Slot& slot = slots_[index];
    for (; slot.height > 0; --slot.height) {
      LaneKeys& waiting = slot.keys[slot.height - 1];
      const std::uint32_t nearest = waiting.least();
      if (!LaneKeys::may_be_within(nearest, slot.limit)) continue;
      waiting.remove(nearest);
      return send(index, tree_.nodes[slot.nodes[slot.height - 1]].child[LaneKeys::lane(nearest)]);
    }
    answer(slot.found().decide(tree_, queries_[slot.query].ray, slot.limit, counters_), hits_[slot.query]);
    begin_next(index);
  }

  const WideArrays& tree_;
  std::span<const RayQuery> queries_;
  std::span<std::optional<TriangleHit>> hits_;
  TraversalCounters& counters_;
  std::size_t next_ = 0;
  Queue nodes_next_, leaves_next_;
  std::array<Slot, slot_count> slots_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
