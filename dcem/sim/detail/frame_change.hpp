#pragma once
/// What differs between two frames, as far as links are concerned that were known in the first.
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
  FrameChange(const Scene& scene, bool has_boxes);

  /// Notes what `next` changes in the frame at hand.
  void note(const Frame& now, const Frame& next);

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
  static double margin_m(const Scene& scene);

  bool has_boxes_;
  double margin_m_;
  std::vector<Aabb<double>> local_boxes_;  ///< by body, in its own axes
  std::vector<char> moved_;
  SweptBoxes boxes_;
  bool any_ = false, any_moved_ = false;
  std::size_t bodies_there_ = 0;
};

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/frame_change_bodies.hpp"
#endif
