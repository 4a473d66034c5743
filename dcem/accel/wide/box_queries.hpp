#pragma once
/// How a `WideBvh` finds triangles by their boxes; included by wide_bvh.hpp.
#include <algorithm>
#include <bit>
#include <cstdint>

#include "dcem/accel/wide/trace/box_lanes.hpp"
#include "dcem/accel/wide/trace/box_walk.hpp"
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

inline Aabb<double> WideBvh::in_world(const Aabb<float>& box) const {
  if (box.empty()) return {};
  Aabb<double> result;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(box.min[axis]), high = static_cast<double>(box.max[axis]);
    const double origin = arrays_.origin_m[axis];
    // The sum is rounded once, by less than this.
    result.min[axis] = origin + low - (std::abs(origin) + std::abs(low)) * 0x1p-51;
    result.max[axis] = origin + high + (std::abs(origin) + std::abs(high)) * 0x1p-51;
  }
  return result;
}

template <typename Keep, typename Visit>
void WideBvh::visit(Keep&& keep, Visit&& visit, TraversalCounters* counters) const {
  const auto children = [&](const WideNode& node) {
    std::uint32_t lanes = 0;
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const Aabb<float> box = node.box(lane);
      if (!node.child[lane].is_none() && !box.empty() && keep(in_world(box))) lanes |= 1U << lane;
    }
    return lanes;
  };
  visit_where(
      children, [](const QuadLeaf& leaf) { return leaf.lanes; }, keep, visit, counters);
}

template <typename Visit>
void WideBvh::overlapping(const Aabb<double>& box, Visit&& visit, TraversalCounters* counters) const {
  const Aabb<double> region = canonical_box(box);
  // Rounded outwards as the tree's boxes are: what overlaps in double overlaps in single precision.
  const Aabb<float> rounded = detail::with_ends(arrays_.rounded_out(region));
  const Aabb<double> from_origin{region.min - arrays_.origin_m, region.max - arrays_.origin_m};
  const auto children = [&](const WideNode& node) { return detail::children_overlapping(node, rounded); };
  const auto quads = [&, lost_m = lost_m()](const QuadLeaf& leaf) {
    return detail::quads_overlapping(leaf, from_origin, lost_m);
  };
  visit_where(
      children, quads, [&](const Aabb<double>& held) { return region.overlaps(held); }, visit, counters);
}

inline double WideBvh::lost_m() const {
  const Vec3 origin_m = glm::abs(arrays_.origin_m);
  return (std::max({origin_m.x, origin_m.y, origin_m.z}) + static_cast<double>(arrays_.extent_m)) * 0x1p-49;
}

/// `children` and `quads`: at least those lanes of a node and of a leaf in which there is a box that `keep` holds for.
template <typename Children, typename Quads, typename Keep, typename Visit>
void WideBvh::visit_where(Children&& children, Quads&& quads, Keep&& keep, Visit&& visit,
                          TraversalCounters* counters) const {
  TraversalCounters spent;
  const auto take = [&](std::uint32_t leaf) {
    for (std::uint32_t left = quads(arrays_.leaves[leaf]); left != 0; left &= left - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(left));
      for (const std::uint32_t triangle : arrays_.quads[leaf * simd_lanes + lane].triangles()) {
        if (arrays_.is_there[triangle] == 0 || !keep(arrays_.box_of(triangle))) continue;
        ++spent.primitives_tested;
        visit(triangle);
      }
    }
  };
  detail::walk_boxes(arrays_, children, take, spent);
  if (counters != nullptr) *counters += spent;
}

}  // namespace dcem
