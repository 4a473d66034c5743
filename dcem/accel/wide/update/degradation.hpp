#pragma once
/// How far motion has degraded the parts of a wide tree down since they were built: two measures per inner node,
/// brought up to date along the paths that edits have touched, and nowhere else.
///
/// * SAH: Σ cost · surface of what is below a node, now against then. The node's own surface is no divisor: a part
///   whose leaves drift apart grows around them, and rays of the scene meet it more often.
/// * RT-DEFORM: the surface of a node over that of its children, now against then; of the nodes of a part the mean
///   relative growth (Lauterbach, Yoon, Tuft, Manocha, "RT-DEFORM: interactive ray tracing of dynamic scenes using
///   BVHs", IEEE Symposium on Interactive Ray Tracing 2006).
///
/// Both stay within a level (wide/levels.hpp): edits of one cannot mend the other. An object counts in the level above
/// as one entry. What is not tracked costs nothing.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/levels.hpp"

namespace dcem {

/// What a wide tree notes while it is edited.
struct TrackedMeasures {
  bool sah = false;          ///< Σ cost · surface below each node
  bool deformation = false;  ///< RT-DEFORM's ratios
  bool touched = false;      ///< which nodes edits touch; goes with the others by itself

  bool measures() const { return sah || deformation; }
  bool any() const { return measures() || touched; }
  friend bool operator==(const TrackedMeasures&, const TrackedMeasures&) = default;
};

/// Of one inner node and what is below it in its level. Zero where it is not tracked.
struct Degradation {
  double area_m2 = 0.0;              ///< Σ cost · half surface of all that is below
  double area_at_build_m2 = -1.0;    ///< the same when the node was built; negative: not yet noted
  double area_ratio_at_build = 1.0;  ///< its surface over that of its children, when it was built
  double ratio_growth_sum = 0.0;     ///< Σ over inner nodes of (ratio now / ratio at build − 1)
  std::uint32_t inner_nodes = 0;     ///< itself included

  bool is_new() const { return area_at_build_m2 < 0.0; }
  /// 1 as built, larger when degraded, no unit. Infinite where nothing had a surface and now something has.
  double sah_growth() const {
    if (area_at_build_m2 > 0.0) return area_m2 / area_at_build_m2;
    return area_m2 > 0.0 && !is_new() ? std::numeric_limits<double>::infinity() : 1.0;
  }
  /// 0 as built, larger when degraded, no unit.
  double deformation() const { return inner_nodes > 0 ? ratio_growth_sum / inner_nodes : 0.0; }
};

namespace detail {

/// Keeps the measures of one tree. Edits say which nodes they touch; nothing is computed before `refresh`.
class DegradationLog {
 public:
  const TrackedMeasures& tracked() const { return tracked_; }
  const Degradation& degradation(std::uint32_t node) const { return degradation_[node]; }
  std::span<const Degradation> all() const { return degradation_; }
  /// The nodes that the last refresh has looked at, children before parents.
  std::span<const std::uint32_t> refreshed() const { return refreshed_; }

  /// From now on; what is tracked anew counts as built now.
  void watch(const TrackedMeasures& tracked, const WideArrays& arrays);

  /// Everything has been built anew.
  void renew(const WideArrays& arrays);

  /// The children of a node have changed, or its box.
  void touch(std::uint32_t node) {
    if (!tracked_.any()) return;
    if (node >= is_touched_.size()) is_touched_.resize(node + 1, 0);
    if (is_touched_[node] != 0) return;
    is_touched_[node] = 1;
    touched_.push_back(node);
  }
  /// A node is another one now, or counts as built now.
  void forget(std::uint32_t node) {
    if (node < degradation_.size()) degradation_[node] = {};
  }

  /// Marks all nodes that were touched, and those above them.
  void mark_paths(const WideArrays& arrays);
  bool is_marked(std::uint32_t node) const { return is_marked_[node] != 0; }
  void unmark();
  void forget_touches() {
    for (const std::uint32_t node : touched_) is_touched_[node] = 0;
    touched_.clear();
  }

  /// Brings the measures up to date.
  void refresh(const WideArrays& arrays);

  /// After a part has been built anew: that part, and what lies above it in its level.
  void renew_below(const WideArrays& arrays, std::uint32_t node);

 private:
  void refresh_from(const WideArrays& arrays, std::uint32_t node);
  void renew_level(const WideArrays& arrays, std::uint32_t node);

  /// From the children of the node and from the measures of its children. What was noted at build stays.
  void refresh_node(const WideArrays& arrays, std::uint32_t node);

  /// Surface of a node over that of its children; 1 where that has none. Bounded, so that points beside boxes of
  /// 1e15 m overflow no sum.
  static double area_ratio(const WideArrays& arrays, std::uint32_t node, double children_m2);

  TrackedMeasures tracked_;
  std::vector<Degradation> degradation_;  ///< per node
  std::vector<std::uint32_t> touched_, marked_, refreshed_;
  std::vector<char> is_touched_, is_marked_;  ///< per node
};

}  // namespace detail

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/accel/wide/update/degradation_bodies.hpp"
#endif
