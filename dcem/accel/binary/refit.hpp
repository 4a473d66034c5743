#pragma once
/// Bottom-up repair of boxes along the paths from changed leaves to the root.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/accel/binary/node.hpp"

namespace dcem {

/// What a refit did.
struct RefitReport {
  std::size_t visited_nodes = 0;  ///< nodes above moved primitives: their sums were brought up to date
  std::size_t touched_nodes = 0;  ///< of these, nodes whose box was computed anew
  std::size_t changed_nodes = 0;  ///< of these, nodes whose box became another

  friend bool operator==(const RefitReport&, const RefitReport&) = default;
};

/// Visits every node above a set of leaves once, children before parents, whatever order the slots are in.
///
/// Marking a leaf walks up and counts, per inner node, the marked children that are still to come; the walk ends where
/// another leaf has passed. Sweeping climbs from each leaf and goes on at a parent only when its last marked child is
/// done. A box is recomputed only when a child's box became another: that is the early out.
class DirtyPaths {
 public:
  /// Room for a tree with this many slots. Marking and sweeping allocate nothing.
  void reserve(std::size_t slots) {
    if (states_.size() >= slots) return;
    states_.resize(slots);
    leaves_.reserve(slots);
  }

  /// Notes that a primitive in `leaf` has another box. `parents` is BvhArrays::parent.
  void mark(std::uint32_t leaf, std::span<const std::uint32_t> parents) {
    if (states_[leaf].changed) return;
    states_[leaf].changed = true;
    leaves_.push_back(leaf);
    for (std::uint32_t node = parents[leaf]; node != no_node; node = parents[node]) {
      if (++states_[node].pending == 2) return;
    }
  }

  /// Calls `visit(slot, stale) -> bool` from the marked leaves upward, children before parents, and forgets the marks.
  /// `stale`: what is below has changed, the box must be computed anew; returned: it became another.
  template <class Visit>
  RefitReport sweep(std::span<const std::uint32_t> parents, Visit&& visit) {
    RefitReport report;
    for (const std::uint32_t leaf : leaves_) climb(leaf, parents, visit, report);
    leaves_.clear();
    return report;
  }

 private:
  struct State {
    std::uint8_t pending = 0;
    bool changed = false;
  };

  template <class Visit>
  void climb(std::uint32_t leaf, std::span<const std::uint32_t> parents, Visit& visit, RefitReport& report) {
    for (std::uint32_t node = leaf; node != no_node;) {
      const bool stale = states_[node].changed;
      states_[node].changed = false;
      const bool changed = visit(node, stale);
      ++report.visited_nodes;
      if (stale) ++report.touched_nodes;
      if (changed) ++report.changed_nodes;
      node = parents[node];
      if (node == no_node) return;
      states_[node].changed = states_[node].changed || changed;
      if (--states_[node].pending > 0) return;
    }
  }

  std::vector<State> states_;
  std::vector<std::uint32_t> leaves_;
};

}  // namespace dcem
