#pragma once
/// How far motion has degraded a subtree down since it was built: two measures, both kept along the paths of each
/// refit.
///
/// A tree has two levels: the tree over the objects, and each object's own tree. Sums stay within a level, because an
/// edit of one level cannot mend the other, and because a large object that stands still would hide what the level
/// above it suffers.
///
/// * SAH: Σ cost · surface below a node, now against then (Goldsmith, Salmon 1987; MacDonald, Booth 1990). The node's
/// own
///   surface is no divisor: a subtree whose parts drift apart grows around them, and rays of the scene meet it more
///   often.
/// * RT-DEFORM: per inner node the surface over that of its children, now against then; of these the mean relative
///   growth (Lauterbach, Yoon, Tuft, Manocha, "RT-DEFORM", IEEE Symposium on Interactive Ray Tracing 2006).
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/accel/sah_cost.hpp"

namespace dcem {

/// Of one node and what is below it.
struct SubtreeDegradation {
  double weighted_area_m2 = 0.0;        ///< Σ cost · half surface over the whole subtree, both levels
  double level_area_m2 = 0.0;           ///< the same within the node's own level
  double level_area_at_build_m2 = 0.0;  ///< the same when the node was built
  double area_ratio_at_build = 1.0;     ///< of an inner node: its surface over its children's when it was built
  double ratio_growth_sum = 0.0;        ///< Σ over inner nodes of the level of (ratio now / ratio at build − 1)
  std::uint32_t inner_nodes = 0;        ///< of the level, the node itself included
  bool is_object_root = false;          ///< the level of the objects ends at its parent

  friend bool operator==(const SubtreeDegradation&, const SubtreeDegradation&) = default;

  /// 1 as built, larger when degraded, no unit. Infinite where nothing had a surface and now something has.
  double sah_growth() const {
    if (level_area_at_build_m2 > 0.0) return level_area_m2 / level_area_at_build_m2;
    return level_area_m2 > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
  }

  /// 0 as built, larger when degraded, no unit.
  double deformation() const { return inner_nodes > 0 ? ratio_growth_sum / inner_nodes : 0.0; }
};

namespace detail {

/// Surface of an inner node over the sum of its children's; 1 where they have none. Bounded, so that points next to
/// boxes of 1e15 m overflow no sum.
template <std::floating_point Scalar>
double area_ratio(std::span<const BvhNode<Scalar>> nodes, const BvhNode<Scalar>& inner) {
  const double children_m2 = static_cast<double>(nodes[inner.left()].box.half_area()) +
                             static_cast<double>(nodes[inner.right()].box.half_area());
  return children_m2 > 0.0 ? std::min(static_cast<double>(inner.box.half_area()) / children_m2, 1e60) : 1.0;
}

}  // namespace detail

/// Brings the sums of one node up to date, from its box and from its children's sums. What was noted at build stays.
template <std::floating_point Scalar>
void refresh_degradation(std::span<SubtreeDegradation> degradation, std::span<const BvhNode<Scalar>> nodes,
                         std::uint32_t slot, const SahSettings& settings) {
  const BvhNode<Scalar>& node = nodes[slot];
  SubtreeDegradation& own = degradation[slot];
  own.weighted_area_m2 = own.level_area_m2 = node_cost(node, settings) * static_cast<double>(node.box.half_area());
  own.ratio_growth_sum = 0.0;
  own.inner_nodes = 0;
  if (node.is_leaf()) return;
  own.inner_nodes = 1;
  own.ratio_growth_sum = detail::area_ratio(nodes, node) / own.area_ratio_at_build - 1.0;
  for (const std::uint32_t child : {node.left(), node.right()}) {
    const SubtreeDegradation& below = degradation[child];
    own.weighted_area_m2 += below.weighted_area_m2;
    if (below.is_object_root) continue;
    own.level_area_m2 += below.level_area_m2;
    own.ratio_growth_sum += below.ratio_growth_sum;
    own.inner_nodes += below.inner_nodes;
  }
}

/// The same for a node that has just been built: now is then.
template <std::floating_point Scalar>
void begin_degradation(std::span<SubtreeDegradation> degradation, std::span<const BvhNode<Scalar>> nodes,
                       std::uint32_t slot, const SahSettings& settings) {
  const BvhNode<Scalar>& node = nodes[slot];
  const double ratio = node.is_leaf() ? 1.0 : detail::area_ratio(nodes, node);
  // A parent without surface around children without surface: any growth is then measured from 1.
  degradation[slot].area_ratio_at_build = ratio > 0.0 ? ratio : 1.0;
  refresh_degradation(degradation, nodes, slot, settings);
  degradation[slot].level_area_at_build_m2 = degradation[slot].level_area_m2;
}

}  // namespace dcem
