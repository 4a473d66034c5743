#pragma once
/// The memory of a binary tree: node slots, primitive order and the links between them.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "dcem/accel/binary/node.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem {

/// Plain arrays; `Bvh` keeps their promises and `find_defect` checks them.
///
/// Slot 0 is the root, slot 1 is never used, so that every pair of children starts at an even slot. Slots are never
/// moved: an edit frees pairs and takes pairs, everything else keeps its number.
template <std::floating_point Scalar>
struct BvhArrays {
  std::vector<BvhNode<Scalar>> nodes;
  std::vector<std::uint32_t> parent;        ///< per slot: the parent's slot, no_node for the root, or free_slot
  std::vector<std::uint32_t> order;         ///< per position: the primitive; leaves own ranges of positions
  std::vector<Aabb<Scalar>> ordered_boxes;  ///< per position: the primitive's box
  std::vector<std::uint32_t> leaf_of;       ///< per primitive: the slot of its leaf
  std::vector<std::uint32_t> free_pairs;    ///< first slots of unused pairs, the lowest at the back

  bool empty() const { return order.empty(); }

  /// A tree of `primitive_count` primitives in their own order, with a root slot and nothing below.
  void reset(std::size_t primitive_count);

  /// The first of two neighbouring slots.
  std::uint32_t take_pair();

  /// Frees every slot below `root`, which itself stays and must be built anew.
  void free_below(std::uint32_t root);

  /// Frees pairs of slots by their first slots; nothing that stays may lead there.
  void release(std::span<const std::uint32_t> pairs);

  /// Copies a tree in the layout of SahBuilder::build into `slot` and newly taken pairs, and calls
  /// `finish_leaf(slot)` for each leaf.
  template <class FinishLeaf>
  void build_all(std::uint32_t slot, std::span<const BvhNode<Scalar>> sprout, FinishLeaf&& finish_leaf);
};

template <std::floating_point Scalar>
void BvhArrays<Scalar>::reset(std::size_t primitive_count) {
  nodes.clear();
  parent.clear();
  free_pairs.clear();
  order.resize(primitive_count);
  std::iota(order.begin(), order.end(), 0U);
  ordered_boxes.assign(primitive_count, {});
  leaf_of.assign(primitive_count, no_node);
  if (primitive_count == 0) return;
  nodes.resize(2);
  parent = {no_node, free_slot};
}

template <std::floating_point Scalar>
std::uint32_t BvhArrays<Scalar>::take_pair() {
  if (!free_pairs.empty()) {
    const std::uint32_t pair = free_pairs.back();
    free_pairs.pop_back();
    return pair;
  }
  const std::size_t pair = nodes.size();
  nodes.resize(pair + 2);
  parent.resize(pair + 2, free_slot);
  return static_cast<std::uint32_t>(pair);
}

template <std::floating_point Scalar>
void BvhArrays<Scalar>::free_below(std::uint32_t root) {
  std::vector<std::uint32_t> pairs;
  for_each_node<Scalar>(nodes, root, [&](std::uint32_t slot, std::uint32_t) {
    if (!nodes[slot].is_leaf()) pairs.push_back(nodes[slot].left());
  });
  release(pairs);
}

template <std::floating_point Scalar>
void BvhArrays<Scalar>::release(std::span<const std::uint32_t> pairs) {
  for (const std::uint32_t pair : pairs) {
    for (const std::uint32_t slot : {pair, pair + 1}) {
      nodes[slot] = {};
      parent[slot] = free_slot;
    }
  }
  free_pairs.insert(free_pairs.end(), pairs.begin(), pairs.end());
  std::ranges::sort(free_pairs, std::greater{});
}

template <std::floating_point Scalar>
template <class FinishLeaf>
void BvhArrays<Scalar>::build_all(std::uint32_t slot, std::span<const BvhNode<Scalar>> sprout,
                                  FinishLeaf&& finish_leaf) {
  std::vector<std::uint32_t> slots(sprout.size(), slot);
  for (std::size_t local = 1; local < sprout.size(); local += 2) {
    slots[local] = take_pair();
    slots[local + 1] = slots[local] + 1;
  }
  for (std::size_t local = 0; local < sprout.size(); ++local) {
    BvhNode<Scalar>& node = nodes[slots[local]] = sprout[local];
    if (node.is_leaf()) continue;
    node.first = slots[node.first];
    parent[node.left()] = parent[node.right()] = slots[local];
  }
  // Last, because finishing a leaf may build_all another tree there, which moves the node array.
  for (std::size_t local = 0; local < sprout.size(); ++local) {
    if (sprout[local].is_leaf()) finish_leaf(slots[local]);
  }
}

}  // namespace dcem
