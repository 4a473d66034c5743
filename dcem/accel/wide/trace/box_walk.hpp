#pragma once
/// The walk through a wide tree that asks of boxes alone.
#include <array>
#include <bit>
#include <cstdint>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/node.hpp"

namespace dcem::detail {

/// Goes to the children that `lanes(node)` has a bit for, all of which there are; `take(leaf_index)` for leaves.
template <typename Lanes, typename Take>
void walk_boxes(const WideArrays& tree, Lanes&& lanes, Take&& take, TraversalCounters& counters) {
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
    for (std::uint32_t left = lanes(node); left != 0;) {
      const auto last = static_cast<std::uint32_t>(std::bit_width(left) - 1);
      stack[height++] = node.child[last].code;
      left ^= 1U << last;
    }
  }
}

}  // namespace dcem::detail
