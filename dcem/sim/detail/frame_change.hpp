#pragma once
/// What differs between two frames, as far as links are concerned that were known in the first.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/paths/memory/swept_boxes.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::detail {

class FrameChange {
 public:
  /// `has_boxes`: whether `boxes` is asked for.
  FrameChange(const Scene& scene, bool has_boxes) : has_boxes_(has_boxes), margin_m_(margin_m(scene)) {
    for (const Body& body : scene.bodies()) {
      Aabb<double>& box = local_boxes_.emplace_back();
      for (const Vec3& vertex_m : body.mesh.vertices_m) box.extend(vertex_m);
    }
    moved_.assign(local_boxes_.size(), 0);
  }

  /// Notes what `next` changes in the frame at hand.
  void note(const Frame& now, const Frame& next) {
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

  /// Whether any body is in another state, be it its velocity alone.
  bool any() const { return any_; }
  /// Whether any body has moved, come or gone …
  bool any_moved() const { return any_moved_; }
  /// … and which.
  std::span<const char> moved() const { return moved_; }
  /// How many there are now, the scenery not among them.
  std::size_t bodies_there() const { return bodies_there_; }
  /// Where bodies in another state were and are.
  const SweptBoxes& boxes() const { return boxes_; }

 private:
  /// More than anything reaches that touches a way within tolerances: a third facet beside an edge, which itself strays
  /// from its mesh by at most five weld tolerances, and what lies along a mirror.
  static double margin_m(const Scene& scene) {
    return std::max(0.05, 2.0 * (6.0 * scene.settings().weld_tolerance_m + facet_reach_m(scene)));
  }

  bool has_boxes_;
  double margin_m_;
  std::vector<Aabb<double>> local_boxes_;  ///< by body, in its own axes
  std::vector<char> moved_;
  SweptBoxes boxes_;
  bool any_ = false, any_moved_ = false;
  std::size_t bodies_there_ = 0;
};

}  // namespace dcem::detail
