#pragma once
/// How a `WideBvh` finds triangles by their boxes; included by wide_bvh.hpp.
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
  visit_where([&](const Aabb<float>& box) { return keep(in_world(box)); }, keep, visit, counters);
}

template <typename Visit>
void WideBvh::overlapping(const Aabb<double>& box, Visit&& visit, TraversalCounters* counters) const {
  const Aabb<double> region = canonical_box(box);
  // Both rounded outwards: what overlaps in double overlaps in single precision.
  visit_where([rounded = arrays_.rounded_out(region)](const Aabb<float>& held) { return rounded.overlaps(held); },
              [&](const Aabb<double>& held) { return region.overlaps(held); }, visit, counters);
}

/// `keep_rounded` must hold for the rounded box around every box for which `keep` holds.
template <typename KeepRounded, typename Keep, typename Visit>
void WideBvh::visit_where(KeepRounded&& keep_rounded, Keep&& keep, Visit&& visit, TraversalCounters* counters) const {
  TraversalCounters spent;
  const auto take = [&](std::uint32_t leaf) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      if ((arrays_.leaves[leaf].lanes >> lane & 1U) == 0) continue;
      for (const std::uint32_t triangle : arrays_.quads[leaf * simd_lanes + lane].triangles()) {
        if (arrays_.is_there[triangle] == 0 || !keep(arrays_.box_of(triangle))) continue;
        ++spent.primitives_tested;
        visit(triangle);
      }
    }
  };
  detail::walk_boxes(arrays_, keep_rounded, take, spent);
  if (counters != nullptr) *counters += spent;
}

}  // namespace dcem
