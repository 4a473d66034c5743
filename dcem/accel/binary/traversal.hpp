#pragma once
/// The walks behind the queries of `Bvh`.
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "dcem/accel/binary/arrays.hpp"
#include "dcem/accel/binary/slab_test.hpp"
#include "dcem/accel/counters.hpp"
#include "dcem/core/error.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem::detail {

/// Near child first; a subtree is left out when the ray enters it beyond the closest hit so far. Subtrees that
/// touch the closest hit are visited, so that the callback sees every candidate of a tie.
template <std::floating_point Scalar, class Leaf>
TraversalCounters walk_closest(const BvhArrays<Scalar>& arrays, const Ray<Scalar>& ray, Leaf& leaf) {
  struct Pending {
    std::uint32_t slot;
    Scalar entry_t;
  };
  TraversalCounters counters;
  if (arrays.empty()) return counters;
  const SlabTest<Scalar> slab(ray);
  Scalar t_max = slab.t_max();
  ++counters.nodes_visited;
  if (!slab.meets(arrays.nodes[0].box, t_max)) return counters;
  std::array<Pending, traversal_stack_size> stack;
  std::size_t height = 0;
  std::uint32_t slot = 0;
  while (true) {
    const BvhNode<Scalar>& node = arrays.nodes[slot];
    if (!node.is_leaf()) {
      counters.nodes_visited += 2;
      const SlabEntry<Scalar> left = slab.enter(arrays.nodes[node.left()].box, t_max);
      const SlabEntry<Scalar> right = slab.enter(arrays.nodes[node.right()].box, t_max);
      if (left.met && right.met) {
        const std::uint32_t nearer = right.t < left.t ? 1U : 0U;
        slot = node.left() + nearer;
        stack[height++] = {node.right() - nearer, std::max(left.t, right.t)};
        continue;
      }
      if (left.met || right.met) {
        slot = node.left() + (left.met ? 0U : 1U);
        continue;
      }
    } else {
      for (std::size_t position = node.first; position < node.first + node.count; ++position) {
        if (!slab.meets(arrays.ordered_boxes[position], t_max)) continue;
        ++counters.primitives_tested;
        leaf(arrays.order[position], t_max);
      }
    }
    do {
      if (height == 0) return counters;
      slot = stack[--height].slot;
    } while (!(stack[height].entry_t <= SlabTest<Scalar>::padded(t_max)));
  }
}

/// Left child first, which the builder made the larger one. `meets(box)` must hold for a box whenever it holds for a
/// box inside; `visit(primitive) -> bool` stops the walk with true. Returns whether it was stopped.
template <std::floating_point Scalar, class Meets, class Visit>
bool walk_any(const BvhArrays<Scalar>& arrays, Meets& meets, Visit& visit, TraversalCounters& counters) {
  if (arrays.empty()) return false;
  std::array<std::uint32_t, traversal_stack_size> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const BvhNode<Scalar>& node = arrays.nodes[stack[--height]];
    ++counters.nodes_visited;
    if (!meets(node.box)) continue;
    if (!node.is_leaf()) {
      stack[height++] = node.right();
      stack[height++] = node.left();
      continue;
    }
    for (std::size_t position = node.first; position < node.first + node.count; ++position) {
      if (!meets(arrays.ordered_boxes[position])) continue;
      ++counters.primitives_tested;
      if (visit(arrays.order[position])) return true;
    }
  }
  return false;
}

}  // namespace dcem::detail
