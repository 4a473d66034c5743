#pragma once
/// One node of a binary tree of boxes, and the walk below a node.
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/error.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem {

inline constexpr std::uint32_t no_node = 0xffffffffU;    ///< parent of the root; root of an empty object
inline constexpr std::uint32_t free_slot = 0xfffffffeU;  ///< parent of a node slot that is not in use

/// No leaf holds more primitives than this, whatever the boxes look like.
inline constexpr std::uint32_t maximum_leaf_size = 8;
/// Levels of one built tree: of the tree over one object, and of the tree over the objects.
inline constexpr std::uint32_t maximum_build_depth = 64;
/// A walk leaves at most one node behind per depth; a whole tree has two built trees on top of one another.
inline constexpr std::uint32_t traversal_stack_size = 2 * maximum_build_depth;

/// A box and what is below it: two children in neighbouring slots, or a range of the tree's primitive order.
template <std::floating_point Scalar>
struct BvhNode {
  Aabb<Scalar> box;
  std::uint32_t first = 0;  ///< inner node: slot of the first child; leaf: first position in the primitive order
  std::uint32_t count = 0;  ///< primitives of a leaf, 1 … maximum_leaf_size; 0 marks an inner node

  bool is_leaf() const { return count != 0; }
  std::uint32_t left() const { return first; }
  std::uint32_t right() const { return first + 1; }
};

/// Calls `visit(slot, depth)` for `root` (depth 1) and every node below it, parents before children.
template <std::floating_point Scalar, class Visit>
void for_each_node(std::span<const BvhNode<Scalar>> nodes, std::uint32_t root, Visit&& visit) {
  struct Pending {
    std::uint32_t slot;
    std::uint32_t depth;
  };
  std::array<Pending, traversal_stack_size> stack;
  std::size_t height = 0;
  Pending current{root, 1};
  while (true) {
    visit(current.slot, current.depth);
    const BvhNode<Scalar>& node = nodes[current.slot];
    if (!node.is_leaf()) {
      DCEM_ASSERT(height < stack.size());
      stack[height++] = {node.right(), current.depth + 1};
      current = {node.left(), current.depth + 1};
    } else if (height > 0) {
      current = stack[--height];
    } else {
      return;
    }
  }
}

}  // namespace dcem
