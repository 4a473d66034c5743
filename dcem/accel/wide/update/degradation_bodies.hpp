#pragma once
/// Bodies of degradation.hpp.
#include <algorithm>
#include <array>

#include "dcem/accel/wide/update/degradation.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem::detail {

DCEM_INLINE void DegradationLog::watch(const TrackedMeasures& tracked, const WideArrays& arrays) {
  if (tracked == tracked_) return;
  tracked_ = tracked;
  renew(arrays);
}

DCEM_INLINE void DegradationLog::renew(const WideArrays& arrays) {
  touched_.clear();
  is_touched_.assign(tracked_.any() ? arrays.nodes.size() : 0, 0);
  degradation_.clear();
  refresh(arrays);
}

DCEM_INLINE void DegradationLog::mark_paths(const WideArrays& arrays) {
  is_marked_.resize(arrays.nodes.size(), 0);
  for (std::uint32_t node : touched_) {
    if (!is_used_node(arrays, node)) continue;  // an edit has set it free
    while (is_marked_[node] == 0) {
      is_marked_[node] = 1;
      marked_.push_back(node);
      if (node != 0) node = arrays.lane_of_node[node].node();
    }
  }
}

DCEM_INLINE void DegradationLog::unmark() {
  for (const std::uint32_t node : marked_) is_marked_[node] = 0;
  marked_.clear();
}

DCEM_INLINE void DegradationLog::refresh(const WideArrays& arrays) {
  refreshed_.clear();
  if (tracked_.measures() && !arrays.nodes.empty()) {
    degradation_.resize(arrays.nodes.size());
    mark_paths(arrays);
    if (degradation_[0].is_new() || is_marked(0)) refresh_from(arrays, 0);
    unmark();
  }
  forget_touches();
}

DCEM_INLINE void DegradationLog::renew_below(const WideArrays& arrays, std::uint32_t node) {
  if (!tracked_.measures()) return;
  degradation_.resize(arrays.nodes.size());
  renew_level(arrays, node);
  while (!is_level_root(arrays, node)) {
    node = arrays.lane_of_node[node].node();
    refresh_node(arrays, node);
  }
}

DCEM_INLINE void DegradationLog::refresh_from(const WideArrays& arrays, std::uint32_t node) {
  for (const WideChild child : arrays.nodes[node].child) {
    if (child.is_none() || child.is_leaf()) continue;
    if (is_marked(child.index()) || degradation_[child.index()].is_new()) refresh_from(arrays, child.index());
  }
  refresh_node(arrays, node);
  refreshed_.push_back(node);
}

DCEM_INLINE void DegradationLog::renew_level(const WideArrays& arrays, std::uint32_t node) {
  degradation_[node] = {};
  for (const WideChild child : arrays.nodes[node].child) {
    if (is_level_node(arrays, child)) renew_level(arrays, child.index());
  }
  refresh_node(arrays, node);
}

DCEM_INLINE void DegradationLog::refresh_node(const WideArrays& arrays, std::uint32_t node) {
  const WideNode& held = arrays.nodes[node];
  const std::array<float, simd_lanes> areas_m2 = BoxLanes(held).half_areas();
  const bool is_new = degradation_[node].is_new();
  Degradation sum;
  sum.area_ratio_at_build = degradation_[node].area_ratio_at_build;
  sum.inner_nodes = 1;
  double children_m2 = 0.0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const WideChild child = held.child[lane];
    if (child.is_none()) continue;
    const auto area_m2 = static_cast<double>(areas_m2[lane]);
    children_m2 += area_m2;
    sum.area_m2 += (child.is_leaf() ? arrays.costs.leaf : arrays.costs.node) * area_m2;
    if (!is_level_node(arrays, child)) continue;
    const Degradation& below = degradation_[child.index()];
    sum.area_m2 += below.area_m2;
    sum.ratio_growth_sum += below.ratio_growth_sum;
    sum.inner_nodes += below.inner_nodes;
  }
  sum.area_at_build_m2 = is_new ? sum.area_m2 : degradation_[node].area_at_build_m2;
  if (tracked_.deformation) {
    const double ratio = area_ratio(arrays, node, children_m2);
    if (is_new) sum.area_ratio_at_build = ratio > 0.0 ? ratio : 1.0;
    sum.ratio_growth_sum += ratio / sum.area_ratio_at_build - 1.0;
  }
  degradation_[node] = sum;
}

DCEM_INLINE double DegradationLog::area_ratio(const WideArrays& arrays, std::uint32_t node, double children_m2) {
  if (!(children_m2 > 0.0)) return 1.0;
  const Aabb<float> box = node == 0 ? arrays.nodes[0].box() : arrays.box_at(arrays.lane_of_node[node]);
  return std::min(static_cast<double>(box.half_area()) / children_m2, 1e60);
}

}  // namespace dcem::detail
