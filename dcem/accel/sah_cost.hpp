#pragma once
/// What a tree costs to traverse, by the surface-area heuristic.
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/sah_settings.hpp"

namespace dcem {

/// Cost of one node for a ray that reaches it: C_t for an inner node, C_i n for a leaf of n primitives.
template <std::floating_point Scalar>
double node_cost(const BvhNode<Scalar>& node, const SahSettings& settings) {
  return node.is_leaf() ? settings.intersection_cost * static_cast<double>(node.count) : settings.traversal_cost;
}

/// Σ cost · surface over a node and everything below it, in square metres: half surfaces, as in Aabb::half_area.
template <std::floating_point Scalar>
double weighted_area(std::span<const BvhNode<Scalar>> nodes, std::uint32_t root, const SahSettings& settings) {
  double sum = 0.0;
  for_each_node<Scalar>(nodes, root, [&](std::uint32_t slot, std::uint32_t) {
    sum += node_cost(nodes[slot], settings) * static_cast<double>(nodes[slot].box.half_area());
  });
  return sum;
}

/// Expected cost of a long random ray that meets the root's box, no unit:
/// Σ cost · surface / surface of the root (Goldsmith, Salmon 1987; MacDonald, Booth 1990).
/// A root without surface is met by no such ray: 0.
inline double sah_from_area(double weighted_area_m2, double root_area_m2) {
  return root_area_m2 > 0.0 ? weighted_area_m2 / root_area_m2 : 0.0;
}

/// The same for the subtree below one node, relative to that node's own box.
template <std::floating_point Scalar>
double subtree_sah_cost(std::span<const BvhNode<Scalar>> nodes, std::uint32_t root, const SahSettings& settings) {
  return sah_from_area(weighted_area(nodes, root, settings), static_cast<double>(nodes[root].box.half_area()));
}

/// How far refits have degraded a tree down since it was built.
struct BvhQuality {
  double sah_now = 0.0;       ///< SAH cost, no unit
  double sah_at_build = 0.0;  ///< SAH cost after the last whole build, no unit

  /// 1 for a tree as good as new, larger when degraded; 1 for a tree without surface, infinite for one that had none
  /// when it was built.
  double ratio() const {
    if (sah_at_build > 0.0) return sah_now / sah_at_build;
    return sah_now > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
  }
};

}  // namespace dcem
