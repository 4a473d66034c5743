#pragma once
/// Levels of a wide tree: the tree over all, whose leaves are leaves and objects, and the tree within each object,
/// whose leaves are leaves. Edits stay within a level.
#include <cstdint>

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/node.hpp"

namespace dcem::detail {

/// Nodes of a built level lie on no deeper depth, its root being on depth 1: below them there are leaves.
inline constexpr std::uint32_t wide_level_depth_limit = wide_build_depth_limit - 1;

/// Whether a child is a node of the same level as the node in which it hangs.
inline bool is_level_node(const WideArrays& arrays, WideChild child) {
  return !child.is_none() && !child.is_leaf() && arrays.object_rooted_at_node[child.index()] == WideArrays::no_object;
}

inline bool is_level_root(const WideArrays& arrays, std::uint32_t node) {
  return node == 0 || arrays.object_rooted_at_node[node] != WideArrays::no_object;
}

/// Level of a node within its level, 1 for its root.
inline std::uint32_t depth_in_level(const WideArrays& arrays, std::uint32_t node) {
  std::uint32_t depth = 1;
  for (; !is_level_root(arrays, node); node = arrays.lane_of_node[node].node()) ++depth;
  return depth;
}

inline bool is_used_node(const WideArrays& arrays, std::uint32_t node) {
  return node < arrays.nodes.size() && (node == 0 || !arrays.lane_of_node[node].is_none());
}

inline namespace DCEM_ISA {

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

}  // namespace DCEM_ISA

}  // namespace dcem::detail
