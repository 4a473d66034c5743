#pragma once
/// The memory of a wide tree, and the writing of its single parts.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/patch_planes.hpp"
#include "dcem/accel/patches.hpp"
#include "dcem/accel/wide_block.hpp"
#include "dcem/accel/wide_collapse.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/core/error.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle.hpp"

namespace dcem {

namespace detail {

/// The next smaller number, as std::nextafter says for finite ones, without a call.
inline float next_below(float value) {
  const auto bits = std::bit_cast<std::int32_t>(value);
  if (bits == 0 || value == 0.0F) return -std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>(bits < 0 ? bits + 1 : bits - 1);
}

}  // namespace detail

/// Plain arrays; `WideTree` keeps their promises and `find_wide_defect` checks them.
///
/// Node 0 is the root. Nodes and blocks never move; what an edit gives up is used again. A unit is a group that owns a
/// subtree: one entry of the tree leads to it, and edits above take it as a whole.
struct WideArrays {
  static constexpr std::uint32_t no_unit = 0xffffffffU;

  std::vector<WideNode> nodes;
  std::vector<WidePlace> node_place;     ///< where a node hangs; none for the root and for unused nodes
  std::vector<std::uint32_t> node_unit;  ///< the unit whose root it is, or no_unit
  std::vector<PatchBlock> blocks;
  std::vector<WidePlace> block_place;
  std::vector<std::uint32_t> block_unit;  ///< the unit whose root it is, or no_unit
  std::vector<std::uint32_t> group_of_block;
  std::vector<std::uint32_t> free_nodes;

  std::vector<Patch> patches;  ///< block b holds 8 b … 8 b + 7
  std::vector<PatchPlanes> planes;
  std::vector<std::uint32_t> patch_of_triangle;
  std::vector<Aabb<double>> boxes;         ///< of triangles
  std::vector<TriangleCorners> corners_m;  ///< of triangles
  std::vector<WideChild> unit_root;        ///< per group; none for groups without subtree of their own

  Vec3 origin_m{0.0};
  float extent_m = 0.0F;  ///< no finite bound is larger, from the origin; grows only
  WideCosts costs;
  double weighted_area_m2 = 0.0;  ///< Σ cost · half surface over all nodes and blocks but the root

  WidePlace place_of(WideChild child) const {
    return child.is_block() ? block_place[child.index()] : node_place[child.index()];
  }
  std::uint32_t unit_of(WideChild child) const {
    return child.is_block() ? block_unit[child.index()] : node_unit[child.index()];
  }
  Aabb<float> box_at(WidePlace place) const { return nodes[place.node()].box(place.lane()); }
  WideChild child_at(WidePlace place) const { return nodes[place.node()].child[place.lane()]; }

  std::uint32_t take_node();
  std::uint32_t add_block(std::uint32_t group);

  /// Puts a child with its box into a lane.
  void hang(WideChild child, WidePlace place, const Aabb<float>& box);
  /// Changes the box of a lane; keeps the sum.
  void set_box(WidePlace place, const Aabb<float>& box);
  /// Makes the boxes above a node tight again, as far up as they change. Returns how many nodes were looked at.
  std::size_t tighten_above(std::uint32_t node);

  /// Takes over one triangle.
  void set_triangle(std::uint32_t triangle, const TriangleCorners& corners, const Aabb<double>& box) {
    corners_m[triangle] = corners;
    boxes[triangle] = box;
  }
  /// Writes the numbers of a block from the triangles of its patches. Returns the box around it.
  Aabb<float> write_block(std::uint32_t block);

  /// The single-precision box around a double one, from the tree's origin.
  Aabb<float> rounded_out(const Aabb<double>& box) const;

  Aabb<double> box_of_patch(const Patch& patch) const {
    Aabb<double> box;
    for (const std::uint32_t triangle : patch.triangles()) box.extend(boxes[triangle]);
    return box;
  }

 private:
  double weight(WideChild child, const Aabb<float>& box) const {
    const double cost = child.is_none() ? 0.0 : child.is_block() ? costs.block : costs.node;
    return cost * static_cast<double>(box.half_area());
  }
};

inline std::uint32_t WideArrays::take_node() {
  if (!free_nodes.empty()) {
    const std::uint32_t node = free_nodes.back();
    free_nodes.pop_back();
    return node;
  }
  nodes.emplace_back();
  node_place.emplace_back();
  node_unit.push_back(no_unit);
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

inline std::uint32_t WideArrays::add_block(std::uint32_t group) {
  blocks.emplace_back();
  block_place.emplace_back();
  block_unit.push_back(no_unit);
  group_of_block.push_back(group);
  patches.resize(patches.size() + simd_lanes);
  planes.resize(planes.size() + simd_lanes);
  return static_cast<std::uint32_t>(blocks.size() - 1);
}

inline void WideArrays::hang(WideChild child, WidePlace place, const Aabb<float>& box) {
  WideNode& node = nodes[place.node()];
  weighted_area_m2 -= weight(node.child[place.lane()], box_at(place));
  node.child[place.lane()] = child;
  node.set_box(place.lane(), box);
  weighted_area_m2 += weight(child, box);
  if (child.is_none()) return;
  (child.is_block() ? block_place[child.index()] : node_place[child.index()]) = place;
}

inline void WideArrays::set_box(WidePlace place, const Aabb<float>& box) {
  const WideChild child = child_at(place);
  weighted_area_m2 += weight(child, box) - weight(child, box_at(place));
  nodes[place.node()].set_box(place.lane(), box);
}

inline std::size_t WideArrays::tighten_above(std::uint32_t node) {
  std::size_t visited = 0;
  for (WidePlace place = node_place[node]; !place.is_none(); place = node_place[place.node()]) {
    ++visited;
    const Aabb<float> box = nodes[child_at(place).index()].box();
    if (box == box_at(place)) break;
    set_box(place, box);
  }
  return visited;
}

inline Aabb<float> WideArrays::rounded_out(const Aabb<double>& box) const {
  if (box.empty()) return {};
  Aabb<float> result;
  for (int axis = 0; axis < 3; ++axis) {
    // Two roundings, of the difference and to float; one step outwards is more than both.
    result.min[axis] = detail::next_below(static_cast<float>(box.min[axis] - origin_m[axis]));
    result.max[axis] = -detail::next_below(-static_cast<float>(box.max[axis] - origin_m[axis]));
  }
  return result;
}

inline Aabb<float> WideArrays::write_block(std::uint32_t index) {
  PatchBlock& block = blocks[index];
  const std::span<const Patch> held = std::span(patches).subspan(std::size_t{index} * simd_lanes, simd_lanes);
  // All boxes at once: an empty one grows nothing.
  Aabb<double> box;
  std::uint32_t there = 0;
  for (std::uint32_t lane = 0; lane < simd_lanes && !held[lane].is_none(); ++lane) {
    for (const std::uint32_t triangle : held[lane].triangles()) {
      const Aabb<double>& own = boxes[triangle];
      box.extend(own);
      there |= (own.min.x <= own.max.x ? 1U : 0U) << lane;
    }
  }
  block.lanes = there;
  if (there == 0) return {};
  const Vec3 centre_m = box.center() - origin_m;
  // To float and back as explicit vectors: with plain numbers g++ 12 (-O2) vectorises the way there and back away, and
  // corners would be counted from another centre than queries use.
  const Float4 rounded_centre = __builtin_convertvector((Double4{centre_m.x, centre_m.y, centre_m.z, 0.0}), Float4);
  const Double4 exact_centre = __builtin_convertvector(rounded_centre, Double4);
  std::memcpy(block.centre_m.data(), &rounded_centre, sizeof block.centre_m);
  detail::BlockWriter writer(corners_m, origin_m + Vec3(exact_centre[0], exact_centre[1], exact_centre[2]));
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if ((block.lanes >> lane & 1U) != 0) writer.add(lane, held[lane]);
  }
  writer.write(block, held, std::span(planes).subspan(std::size_t{index} * simd_lanes, simd_lanes));
  const Aabb<float> rounded = rounded_out(box);
  for (int axis = 0; axis < 3; ++axis) {
    extent_m = std::max({extent_m, std::abs(rounded.min[axis]), std::abs(rounded.max[axis])});
  }
  return rounded;
}

}  // namespace dcem
