#pragma once
/// Bodies of frame_change.hpp.
#include <algorithm>
#include <cstddef>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/frame_change.hpp"

namespace dcem::detail {

DCEM_INLINE FrameChange::FrameChange(const Scene& scene, bool has_boxes)
    : has_boxes_(has_boxes), margin_m_(margin_m(scene)) {
  for (const Body& body : scene.bodies()) {
    Aabb<double>& box = local_boxes_.emplace_back();
    for (const Vec3& vertex_m : body.mesh.vertices_m) box.extend(vertex_m);
  }
  moved_.assign(local_boxes_.size(), 0);
}

DCEM_INLINE void FrameChange::note(const Frame& now, const Frame& next) {
  boxes_.clear();
  any_ = any_moved_ = false;
  bodies_there_ = 0;
  for (std::size_t body = 1; body < local_boxes_.size(); ++body) {  // the scenery stands
    const BodyState &before = now.bodies[body], &after = next.bodies[body];
    const bool is_there = before.present || after.present;
    bodies_there_ += after.present ? 1 : 0;
    moved_[body] = is_there && (before.present != after.present || before.occupant != after.occupant ||
                                before.placement.pose != after.placement.pose);
    any_moved_ = any_moved_ || moved_[body] != 0;
    if (!is_there || before == after) continue;
    any_ = true;
    if (!has_boxes_ || local_boxes_[body].empty()) continue;
    for (const BodyState* state : {&before, &after}) {
      if (state->present) boxes_.add(local_boxes_[body], state->placement.pose, margin_m_);
    }
  }
}

DCEM_INLINE double FrameChange::margin_m(const Scene& scene) {
  return std::max(0.05, 2.0 * (6.0 * scene.settings().weld_tolerance_m + facet_reach_m(scene)));
}

}  // namespace dcem::detail
