#pragma once
/// The binary tree while it is being improved: boxes at hand, children in any order.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/core/simd.hpp"

namespace dcem::detail {

/// A node with its box. Any order; unused ones are allowed.
struct BinaryNode {
  FloatBox box;
  float half_area_m2 = 0.0F;
  std::uint32_t left = 0, right = 0;   ///< both 0: a leaf
  std::uint32_t first = 0, count = 0;  ///< positions of a leaf's items
  std::uint32_t parent = 0;

  bool is_leaf() const { return left == right; }
};

inline FloatBox box_around(std::span<const WideItem> items) {
  FloatBox box;
  for (const WideItem& item : items) box.extend(item.low, item.high);
  return box;
}

/// The tree with the boxes of its nodes, at the same slots.
inline std::vector<BinaryNode> with_boxes(std::span<const WideSplit> splits, std::span<const WideItem> items) {
  std::vector<BinaryNode> nodes(splits.size());
  // Children stand behind their parents.
  for (std::size_t slot = splits.size(); slot-- > 0;) {
    const WideSplit& split = splits[slot];
    BinaryNode& node = nodes[slot];
    if (split.is_leaf()) {
      node.first = split.first;
      node.count = split.count;
      node.box = box_around(items.subspan(split.first, split.count));
    } else {
      node.left = split.left;
      node.right = split.right;
      node.box = nodes[split.left].box;
      node.box.extend(nodes[split.right].box);
      nodes[split.left].parent = nodes[split.right].parent = static_cast<std::uint32_t>(slot);
    }
    node.half_area_m2 = node.box.half_area();
  }
  return nodes;
}

/// Writes the tree below `root` as a collapse reads it: children behind their parents, the items below any node side
/// by side. `items` must not be what `placed` shows.
inline std::vector<WideSplit> in_order(std::span<const BinaryNode> nodes, std::uint32_t root,
                                       std::span<const WideItem> items, std::span<WideItem> placed) {
  struct Pending {
    std::uint32_t from, to;
  };
  std::vector<WideSplit> splits(1);
  std::vector<Pending> open{{root, 0}};
  std::uint32_t position = 0;
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const BinaryNode& node = nodes[from];
    splits[to] = {node.half_area_m2, 0, 0, position, node.count};
    if (node.is_leaf()) {
      std::copy_n(items.begin() + node.first, node.count, placed.begin() + position);
      position += node.count;
      continue;
    }
    const auto left = static_cast<std::uint32_t>(splits.size());
    splits[to].left = left;
    splits[to].right = left + 1;
    splits.resize(splits.size() + 2);
    // The left one is taken next, so that its items come before those of the right one.
    open.push_back({node.right, left + 1});
    open.push_back({node.left, left});
  }
  for (std::size_t slot = splits.size(); slot-- > 0;) {
    WideSplit& split = splits[slot];
    if (!split.is_leaf()) split.count = splits[split.left].count + splits[split.right].count;
  }
  return splits;
}

/// Joins a few nodes in pairs, the smallest box around two first. Returns the node around all; `parts` is used up.
inline std::uint32_t join(std::span<std::uint32_t> parts, std::vector<BinaryNode>& nodes) {
  for (std::size_t count = parts.size(); count > 1; --count) {
    BinaryNode joint;
    joint.half_area_m2 = std::numeric_limits<float>::infinity();
    std::size_t one = 0, other = 1;
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) {
        FloatBox box = nodes[parts[a]].box;
        box.extend(nodes[parts[b]].box);
        if (!(box.half_area() < joint.half_area_m2)) continue;
        joint.box = box;
        joint.half_area_m2 = box.half_area();
        one = a;
        other = b;
      }
    }
    joint.left = parts[one];
    joint.right = parts[other];
    nodes.push_back(joint);
    parts[one] = static_cast<std::uint32_t>(nodes.size() - 1);
    parts[other] = parts[count - 1];
  }
  return parts[0];
}

/// Levels of a tree, the root's included.
inline std::uint32_t depth_of_tree(std::span<const WideSplit> splits) {
  std::vector<std::uint32_t> depth(splits.size(), 1);
  for (std::size_t slot = 0; slot < splits.size(); ++slot) {
    if (!splits[slot].is_leaf()) depth[splits[slot].left] = depth[splits[slot].right] = depth[slot] + 1;
  }
  return splits.empty() ? 0 : *std::max_element(depth.begin(), depth.end());
}

}  // namespace dcem::detail
