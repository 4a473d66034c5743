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

  std::vector<WidePatch> patches;  ///< block b holds 8 b … 8 b + 7
  std::vector<PatchPlanes> planes;
  std::vector<std::uint32_t> patch_of_triangle;
  std::vector<Aabb<double>> boxes;         ///< of triangles
  std::vector<TriangleCorners> corners_m;  ///< of triangles
  std::vector<WideChild> unit_root;        ///< per group; none for groups without subtree of their own

  Vec3 origin_m{0.0};
  float extent_m = 0.0F;  ///< no finite bound is larger, from the origin; grows only
  WideCosts costs;
  double weighted_area_m2 = 0.0;  ///< Σ cost · half surface over all nodes and blocks but the root

  /// Empties everything and keeps the memory.
  void clear();

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
  /// Keeps `extent_m` a bound of what is written.
  void note_extent(const Aabb<float>& box) {
    if (box.empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
      extent_m = std::max({extent_m, std::abs(box.min[axis]), std::abs(box.max[axis])});
    }
  }

  /// Writes the numbers of a block from the triangles of its patches, and nothing else. Returns the box around it.
  Aabb<float> write_block(std::uint32_t block);

  /// The single-precision box around a double one, from the tree's origin.
  Aabb<float> rounded_out(const Aabb<double>& box) const;

  Aabb<double> box_of_patch(const WidePatch& patch) const {
    Aabb<double> box;
    for (const std::uint32_t triangle : patch.triangles()) box.extend(boxes[triangle]);
    return box;
  }

 private:
  double weight(WideChild child, const Aabb<float>& box) const {
    const double cost = child.is_none() ? 0.0 : child.is_block() ? costs.block : costs.node;
    return cost * static_cast<double>(box.half_area());
  }
  void load_lane(detail::BlockLanes& lanes, std::uint32_t lane, const WidePatch& patch, const Vec3& centre_m) const;
  static void store_shapes(const detail::BlockLanes& lanes, PatchBlock& block);
  PatchPlanes planes_of(const detail::BlockLanes& lanes, std::uint32_t lane, const WidePatch& patch) const;
  WidePatch present_part(const WidePatch& patch) const;
};

inline void WideArrays::clear() {
  const auto empty = [](auto&... lists) { (lists.clear(), ...); };
  empty(nodes, node_place, node_unit, blocks, block_place, block_unit, group_of_block, free_nodes, patches, planes,
        patch_of_triangle, boxes, corners_m, unit_root);
  origin_m = Vec3(0.0);
  extent_m = 0.0F;
  weighted_area_m2 = 0.0;
}

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
  // Two roundings, of the difference and to float: less than one unit of the last place together. What is moved by is
  // one to two of them. (std::nextafter is a call.)
  const auto room = [](float value) { return std::abs(value) * 0x1p-23F + std::numeric_limits<float>::min(); };
  Aabb<float> result;
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = static_cast<float>(box.min[axis] - origin_m[axis]);
    const auto high = static_cast<float>(box.max[axis] - origin_m[axis]);
    result.min[axis] = low - room(low);
    result.max[axis] = high + room(high);
  }
  return result;
}

inline Aabb<float> WideArrays::write_block(std::uint32_t index) {
  PatchBlock& block = blocks[index];
  const std::span<const WidePatch> held = std::span(patches).subspan(std::size_t{index} * simd_lanes, simd_lanes);
  Aabb<double> box;
  block.lanes = 0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if (held[lane].is_none()) continue;
    for (const std::uint32_t triangle : held[lane].triangles()) {
      box.extend(boxes[triangle]);
      block.lanes |= (boxes[triangle].empty() ? 0U : 1U) << lane;
    }
  }
  if (block.lanes == 0) return {};
  const Vec3 centre_m = box.center() - origin_m;
  // To float and back as explicit vectors: with plain numbers g++ 12 (-O2) vectorises the way there and back away, and
  // the corners would be counted from another centre than queries use.
  using Double4 = double __attribute__((vector_size(32)));
  const Float4 rounded = __builtin_convertvector((Double4{centre_m.x, centre_m.y, centre_m.z, 0.0}), Float4);
  const Double4 exact = __builtin_convertvector(rounded, Double4);
  std::memcpy(block.centre_m.data(), &rounded, sizeof block.centre_m);
  const Vec3 counted_from_m(exact[0], exact[1], exact[2]);
  detail::BlockLanes lanes;
  std::array<WidePatch, simd_lanes> there;
  for (std::uint32_t rest = block.lanes; rest != 0; rest &= rest - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
    there[lane] = present_part(held[lane]);
    load_lane(lanes, lane, there[lane], counted_from_m);
  }
  lanes.compute();
  store_shapes(lanes, block);
  for (std::uint32_t rest = block.lanes; rest != 0; rest &= rest - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
    planes[index * simd_lanes + lane] = planes_of(lanes, lane, there[lane]);
  }
  return rounded_out(box);
}

/// A pair of which one triangle is not there is the other.
inline WidePatch WideArrays::present_part(const WidePatch& patch) const {
  if (!patch.is_pair() || (!boxes[patch.triangle[0]].empty() && !boxes[patch.triangle[1]].empty())) return patch;
  const std::uint32_t left = boxes[patch.triangle[0]].empty() ? patch.triangle[1] : patch.triangle[0];
  return {{left, WidePatch::no_triangle}, {{{left, 0}, {left, 1}, {left, 2}, {}}}};
}

/// A triangle becomes a quadrilateral with its fourth corner in the middle of an edge: it has no edge without length.
inline void WideArrays::load_lane(detail::BlockLanes& lanes, std::uint32_t lane, const WidePatch& patch,
                                  const Vec3& centre_m) const {
  // The centre in the world would be rounded, far from zero by more than the patch is large.
  const auto corner = [&](std::size_t index) {
    const auto& [triangle, at] = patch.corner[index];
    return (corners_m[triangle][at] - origin_m) - centre_m;
  };
  const Vec3 a = corner(0), c = corner(2);
  lanes.corner_m[0].set(lane, a);
  lanes.corner_m[1].set(lane, corner(1));
  lanes.corner_m[2].set(lane, c);
  lanes.corner_m[3].set(lane, patch.is_pair() ? corner(3) : 0.5 * (a + c));
  lanes.is_pair.at[lane] = patch.is_pair() ? 1.0 : 0.0;
  for (std::size_t side = 0; side < patch.triangles().size(); ++side) {
    const TriangleCorners& own = corners_m[patch.triangle[side]];
    for (std::size_t index = 0; index < 3; ++index) lanes.own_corner_m[side][index].set(lane, own[index]);
  }
}

inline void WideArrays::store_shapes(const detail::BlockLanes& lanes, PatchBlock& block) {
  std::array<float, simd_lanes> size_m{};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    lanes.corner_m[corner].x.store(block.corner_m[corner][0]);
    lanes.corner_m[corner].y.store(block.corner_m[corner][1]);
    lanes.corner_m[corner].z.store(block.corner_m[corner][2]);
    for (const std::array<float, simd_lanes>& row : block.corner_m[corner]) {
      for (std::size_t lane = 0; lane < simd_lanes; ++lane) size_m[lane] = std::max(size_m[lane], std::abs(row[lane]));
    }
  }
  block.size_m = *std::max_element(size_m.begin(), size_m.end());
  lanes.diameter_m.store(block.reach_m);
  for (float& reach_m : block.reach_m) reach_m *= static_cast<float>(PatchBlock::edge_error_factor);
  lanes.normal[0].x.store(block.normal[0]);
  lanes.normal[0].y.store(block.normal[1]);
  lanes.normal[0].z.store(block.normal[2]);
  lanes.offset_m.store(block.offset_m);
  lanes.bend_m.store(block.bend_m);
}

inline PatchPlanes WideArrays::planes_of(const detail::BlockLanes& lanes, std::uint32_t lane,
                                         const WidePatch& patch) const {
  PatchPlanes result;
  result.triangle = patch.triangle;
  result.plane[0] = {lanes.normal[0].get(lane), corners_m[patch.triangle[0]][0]};
  if (!patch.is_pair()) return result;
  result.plane[1] = {lanes.normal[1].get(lane), corners_m[patch.triangle[1]][0]};
  const Vec3 &a = corners_m[patch.corner[0].triangle][patch.corner[0].at],
             &c = corners_m[patch.corner[2].triangle][patch.corner[2].at];
  const int axis = result.axis(), x = (axis + 1) % 3, y = (axis + 2) % 3;
  // b lies where u x + v y < w.
  const double turn = result.plane[0].normal[axis] < 0.0 ? -1.0 : 1.0;
  const Vec3 from = a - result.plane[0].point_m;
  result.u = -turn * (c[y] - a[y]);
  result.v = turn * (c[x] - a[x]);
  result.w = result.u * from[x] + result.v * from[y];
  return result;
}

}  // namespace dcem
