#pragma once
/// Many rays through a wide tree, several of them on their way at any time.
///
/// A walk of one ray waits: for the memory of a node, and for one answer before it can ask the next question. Here each
/// ray makes one step, asks for the memory of its next one, and gives way to the others. Rays at nodes, rays at leaves
/// and rays that have arrived stand in queues of their own, so that the code for a step, which depends on the ray in a
/// way that no processor foresees, is the same for a run of rays. Each ray takes the steps that it takes alone.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/waiting_children.hpp"
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
    while (next_round_->any()) {
      const Round& now = *next_round_;
      next_round_ = next_round_ == &rounds_[0] ? &rounds_[1] : &rounds_[0];
      next_round_->clear();
      for (std::uint32_t index = 0; index < now.at_nodes.count; ++index) step_at_node(now.at_nodes.slot[index]);
      for (std::uint32_t index = 0; index < now.at_leaves.count; ++index) step_at_leaf(now.at_leaves.slot[index]);
      for (std::uint32_t index = 0; index < now.arrived.count; ++index) finish(now.arrived.slot[index]);
    }
  }

 private:
  /// More hide no more waiting, and push each other out of the nearest cache.
  static constexpr std::uint32_t slot_count = 12;

  /// A ray on its way. No initial values.
  struct Slot {
    alignas(WideRay) std::array<std::byte, sizeof(WideRay)> ray;
    std::uint32_t query;
    WideChild current;
    float limit;
    WaitingChildren waiting;
    alignas(ClosestCandidates) std::array<std::byte, sizeof(ClosestCandidates)> candidates;

    WideRay& wide() { return *std::launder(reinterpret_cast<WideRay*>(ray.data())); }
    ClosestCandidates& found() { return *std::launder(reinterpret_cast<ClosestCandidates*>(candidates.data())); }
  };
  struct Queue {
    std::array<std::uint32_t, slot_count + 1> slot;  // one more: written before it is known whether it counts
    std::uint32_t count = 0;
  };
  /// Who makes which step.
  struct Round {
    Queue at_nodes, at_leaves, arrived;

    bool any() const { return at_nodes.count + at_leaves.count + arrived.count > 0; }
    void clear() { at_nodes.count = at_leaves.count = arrived.count = 0; }
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
    slot.waiting.clear();
    slot.limit = slot.wide().t_max();
    new (slot.candidates.data()) ClosestCandidates();
    send(index, WideChild::node(0));
  }

  /// Sends a ray to a child, whose memory is asked for.
  [[gnu::always_inline]] void send(std::uint32_t index, WideChild child) {
    slots_[index].current = child;
    const std::uint32_t is_leaf = child.is_leaf() ? 1U : 0U;
    Queue &nodes = next_round_->at_nodes, &leaves = next_round_->at_leaves;
    nodes.slot[nodes.count] = index;
    leaves.slot[leaves.count] = index;
    nodes.count += 1U - is_leaf;
    leaves.count += is_leaf;
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
    slot.waiting.push(slot.current.index(), entered, (met & (met - 1)) != 0);
    send(index, node.child[LaneKeys::lane(nearest)]);
  }

  [[gnu::always_inline]] void step_at_leaf(std::uint32_t index) {
    ++counters_.nodes_visited;
    Slot& slot = slots_[index];
    const std::uint32_t leaf = slot.current.index();
    QuadHits hits;
    const std::uint32_t met = slot.wide().meets<false>(tree_.leaves[leaf], slot.limit, hits);
    if (met != 0) {
      const RayQuery& query = queries_[slot.query];
      slot.found().take(tree_, query.ray, query.filter, leaf, met, hits, slot.limit, counters_);
    }
    take_next(index);
  }

  /// Sends a ray to the nearest of the children that wait. Where none does it has arrived: it is finished in the next
  /// round, when the memory of what it has met has come.
  [[gnu::always_inline]] void take_next(std::uint32_t index) {
    Slot& slot = slots_[index];
    WaitingChildren::Place place;
    if (slot.waiting.take(slot.limit, place)) return send(index, tree_.nodes[place.node].child[place.lane]);
    Queue& arrived = next_round_->arrived;
    arrived.slot[arrived.count++] = index;
  }

  [[gnu::always_inline]] void finish(std::uint32_t index) {
    Slot& slot = slots_[index];
    answer(slot.found().decide(tree_, queries_[slot.query].ray, slot.limit, counters_), hits_[slot.query]);
    begin_next(index);
  }

  const WideArrays& tree_;
  std::span<const RayQuery> queries_;
  std::span<std::optional<TriangleHit>> hits_;
  TraversalCounters& counters_;
  std::size_t next_ = 0;
  std::array<Round, 2> rounds_;
  Round* next_round_ = rounds_.data();
  std::array<Slot, slot_count> slots_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
