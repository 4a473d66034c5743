#pragma once
/// The memory of a wide tree, and the writing of its single parts.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/patches.hpp"
#include "dcem/accel/wide_collapse.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/core/error.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle.hpp"

namespace dcem {

/// The plane of a triangle in double, from the triangle's own corners in their own order: the same whatever patch the
/// triangle is in, but for the sign of the normal. The normal is zero where there is no plane.
struct PatchPlane {
  Vec3 normal{0.0};   ///< of unit length
  Vec3 point_m{0.0};  ///< first corner of the triangle; far from zero an offset would be rounded too much

  /// The line of a ray meets it at height / slope.
  double height(const Ray<double>& ray) const { return glm::dot(normal, point_m - ray.origin); }
  double slope(const Ray<double>& ray) const { return glm::dot(normal, ray.direction); }
};

/// What a hit on a patch needs: the planes of its two triangles, and which of them is met. A pair is flat within a
/// limit only, and bends when its vertices move; t must be that of the triangle.
struct alignas(64) PatchPlanes {
  std::array<PatchPlane, 2> plane;
  /// The diagonal as a line u x + v y = w, seen along the axis on which the first normal is longest; x and y follow
  /// that axis in turn and count from the first plane's point. Triangle 1 lies where u x + v y > w.
  double u = 0.0, v = 0.0, w = 0.0;
  std::array<std::uint32_t, 2> triangle{Patch::no_triangle, Patch::no_triangle};

  bool is_pair() const { return triangle[1] != Patch::no_triangle; }
  std::span<const std::uint32_t> triangles() const { return {triangle.data(), is_pair() ? 2U : 1U}; }
  double t_of(std::size_t side, const Ray<double>& ray) const {
    return plane[side].height(ray) / plane[side].slope(ray);
  }

  /// Which axis is left out of the diagonal.
  int axis() const {
    const Vec3 size = glm::abs(plane[0].normal);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  }

  /// Where the line of a ray that meets the patch does so, and in which of the triangles.
  struct Meeting {
    double t;
    std::uint32_t side;
    /// Whether that is so. A ray along the patch, by less than some 0.06 degrees, may meet a fold in both triangles or
    /// one plane far outside: then each triangle is asked by itself.
    bool is_sure;
  };
  Meeting meet(const Ray<double>& ray) const {
    const double height = plane[0].height(ray), slope = plane[0].slope(ray);
    if (!is_pair()) return {height / slope, 0, true};
    const double other_slope = plane[1].slope(ray);
    const bool is_sure = slope * other_slope > 1e-6 * glm::dot(ray.direction, ray.direction);
    // Whether the point at t = height / slope is beyond the diagonal, multiplied by the slope.
    const int x = (axis() + 1) % 3, y = (axis() + 2) % 3;
    const Vec3 from = ray.origin - plane[0].point_m;
    const double beyond = u * (ray.direction[x] * height + from[x] * slope) +
                          v * (ray.direction[y] * height + from[y] * slope) - w * slope;
    const std::uint32_t side = (beyond > 0.0) == (slope > 0.0) && beyond != 0.0 ? 1U : 0U;
    return {side == 0 ? height / slope : plane[1].height(ray) / other_slope, side, is_sure};
  }
};

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
  /// `centre_m`: that of the block, from the tree's origin.
  void write_lane(PatchBlock& block, std::uint32_t lane, const Patch& held, const Vec3& centre_m,
                  PatchPlanes& planes_of_patch) const;
  PatchPlanes planes_of(const std::array<Vec3, 4>& world_m, const Patch& patch) const;
  Patch present_part(const Patch& patch) const;
  std::array<Vec3, 4> quadrilateral(const Patch& patch) const;
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

/// A triangle becomes a quadrilateral with its fourth corner in the middle of an edge: it has no edge without length.
inline std::array<Vec3, 4> WideArrays::quadrilateral(const Patch& patch) const {
  const auto corner = [&](std::size_t index) {
    const auto& [triangle, at] = patch.corner[index];
    return corners_m[triangle][at];
  };
  const Vec3 a = corner(0), b = corner(1), c = corner(2);
  return {a, b, c, patch.is_pair() ? corner(3) : 0.5 * (a + c)};
}

inline Aabb<float> WideArrays::write_block(std::uint32_t index) {
  PatchBlock& block = blocks[index];
  const std::span<const Patch> held = std::span(patches).subspan(std::size_t{index} * simd_lanes, simd_lanes);
  Aabb<double> box;
  block.lanes = 0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if (held[lane].is_none()) continue;
    const Aabb<double> own = box_of_patch(held[lane]);
    if (own.empty()) continue;
    block.lanes |= 1U << lane;
    box.extend(own);
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
  block.size_m = 0.0F;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if ((block.lanes >> lane & 1U) == 0) continue;
    write_lane(block, lane, held[lane], counted_from_m, planes[index * simd_lanes + lane]);
  }
  return rounded_out(box);
}

/// A pair of which one triangle is not there is the other.
inline Patch WideArrays::present_part(const Patch& patch) const {
  if (!patch.is_pair() || (!boxes[patch.triangle[0]].empty() && !boxes[patch.triangle[1]].empty())) return patch;
  const std::uint32_t left = boxes[patch.triangle[0]].empty() ? patch.triangle[1] : patch.triangle[0];
  return {{left, Patch::no_triangle}, {{{left, 0}, {left, 1}, {left, 2}, {}}}};
}

inline void WideArrays::write_lane(PatchBlock& block, std::uint32_t lane, const Patch& held, const Vec3& centre_m,
                                   PatchPlanes& planes_of_patch) const {
  const Patch patch = present_part(held);
  const std::array<Vec3, 4> world_m = quadrilateral(patch);
  planes_of_patch = planes_of(world_m, patch);
  std::array<Vec3, 4> corner_m;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    // The centre in the world would be rounded, far from zero by more than the patch is large.
    corner_m[corner] = (world_m[corner] - origin_m) - centre_m;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<float>(corner_m[corner][axis]);
      block.corner_m[corner][static_cast<std::size_t>(axis)][lane] = at;
      block.size_m = std::max(block.size_m, std::abs(at));
    }
  }
  const auto& [a, b, c, d] = corner_m;
  const auto squared = [](const Vec3& from, const Vec3& to) { return glm::dot(to - from, to - from); };
  const double diameter_m =
      std::sqrt(std::max({squared(a, b), squared(b, c), squared(c, d), squared(d, a), squared(a, c), squared(b, d)}));
  block.reach_m[lane] = static_cast<float>(PatchBlock::edge_error_factor * diameter_m);
  const Vec3& normal = planes_of_patch.plane[0].normal;
  for (int axis = 0; axis < 3; ++axis) {
    block.normal[static_cast<std::size_t>(axis)][lane] = static_cast<float>(normal[axis]);
  }
  block.offset_m[lane] = static_cast<float>(glm::dot(normal, a));
  block.bend_m[lane] = 0.0F;
  if (!patch.is_pair()) return;
  // Without a plane, or where the vertices have moved until the pair is not convex, nothing is certain, but every ray
  // near it is asked.
  const bool is_sound = normal != Vec3(0.0) && detail::is_convex(a, b, c, d);
  block.bend_m[lane] = static_cast<float>(is_sound ? std::abs(glm::dot(normal, d - a)) * 1.0001 : diameter_m);
}

inline PatchPlanes WideArrays::planes_of(const std::array<Vec3, 4>& world_m, const Patch& patch) const {
  PatchPlanes result;
  result.triangle = patch.triangle;
  for (const std::uint32_t triangle : patch.triangles()) {
    const auto& [a, b, c] = corners_m[triangle];
    const Vec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    result.plane[triangle == patch.triangle[0] ? 0 : 1] = {length > 0.0 ? across / length : Vec3(0.0), a};
  }
  if (!patch.is_pair()) return result;
  // Both normals to one side: a b c d turns the same way in both triangles.
  const auto& [a, b, c, d] = world_m;
  if (glm::dot(result.plane[1].normal, glm::cross(c - a, d - a)) < 0.0) result.plane[1].normal *= -1.0;
  if (glm::dot(result.plane[0].normal, glm::cross(b - a, c - a)) < 0.0) result.plane[0].normal *= -1.0;
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
