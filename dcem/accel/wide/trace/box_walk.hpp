#pragma once
/// The walk through a wide tree that asks of boxes alone.
#include <array>
#include <cstdint>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/node.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem::detail {

/// Goes to all children whose box `keep(box)` holds for, in the tree's coordinates; `take(leaf_index)` for leaves.
template <typename Keep, typename Take>
void walk_boxes(const WideArrays& tree, Keep&& keep, Take&& take, TraversalCounters& counters) {
  if (tree.nodes.empty()) return;
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

}  // namespace dcem::detail
