#pragma once
/// Layers of a wide tree: the tree over all, whose leaves are blocks and units, and the tree within each unit, whose
/// leaves are blocks. Edits stay within a layer.
#include <cstdint>

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/build/binner.hpp"

namespace dcem::detail {

/// Nodes of a built layer lie on no deeper level, its root being on level 1: below them there are leaves.
inline constexpr std::uint32_t wide_layer_levels = WideBinner::levels - 1;

/// Whether a child is a node of the same layer as the node in which it hangs.
inline bool is_layer_node(const WideArrays& arrays, WideChild child) {
  return !child.is_none() && !child.is_block() && arrays.node_unit[child.index()] == WideArrays::no_unit;
}

inline bool is_layer_root(const WideArrays& arrays, std::uint32_t node) {
  return node == 0 || arrays.node_unit[node] != WideArrays::no_unit;
}

/// Level of a node within its layer, 1 for its root.
inline std::uint32_t layer_level(const WideArrays& arrays, std::uint32_t node) {
  std::uint32_t level = 1;
  for (; !is_layer_root(arrays, node); node = arrays.node_place[node].node()) ++level;
  return level;
}

inline bool is_used_node(const WideArrays& arrays, std::uint32_t node) {
  return node < arrays.nodes.size() && (node == 0 || !arrays.node_place[node].is_none());
}

/// Eight boxes, one in each lane.
struct BoxLanes {
  Float8 low[3], high[3];

  explicit BoxLanes(const WideNode& node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = Float8(node.bounds_m[2 * axis]);
      high[axis] = Float8(node.bounds_m[2 * axis + 1]);
    }
  }
  /// Half the surface of each box, extended by another one; as Aabb::half_area, 0 for empty ones.
  std::array<float, simd_lanes> half_areas_with(const Aabb<float>& other) const {
    Float8 size[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<std::size_t>(axis);
      size[row] = simd::maximum(high[row], other.max[axis]) - simd::minimum(low[row], other.min[axis]);
      size[row] = simd::maximum(size[row], 0.0F);  // an empty box is −∞ wide
    }
    alignas(32) std::array<float, simd_lanes> areas;
    (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]).store(areas);
    return areas;
  }
  std::array<float, simd_lanes> half_areas() const { return half_areas_with({}); }
};

}  // namespace dcem::detail
