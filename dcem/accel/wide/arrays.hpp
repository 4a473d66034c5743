#pragma once
/// The memory of a wide tree, and changes of its single parts.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "dcem/accel/wide/build/collapse.hpp"
#include "dcem/accel/wide/build/quads.hpp"
#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/trace/quad_planes.hpp"
#include "dcem/accel/wide/update/leaf_numbers.hpp"
#include "dcem/core/huge_pages.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle.hpp"

namespace dcem {

/// Plain arrays; `WideTree` keeps their promises and `find_wide_defect` checks them.
///
/// Node 0 is the root. Nodes and blocks never move; what an edit gives up is used again. A unit is a group that owns a
/// subtree: one entry of the tree leads to it, and edits above take it as a whole.
struct WideArrays {
  /// Vertices that follow one another, and all are corners of one block; none where its corners lie scattered.
  struct VertexRun {
    std::uint32_t first = 0, count = 0;
  };
  static constexpr std::uint32_t no_unit = 0xffffffffU;

  HugePageVector<WideNode> nodes;
  std::vector<WidePlace> node_place;     ///< where a node hangs; none for the root and for unused nodes
  std::vector<std::uint32_t> node_unit;  ///< the unit whose root it is, or no_unit
  HugePageVector<PatchBlock> blocks;
  std::vector<WidePlace> block_place;
  std::vector<std::uint32_t> block_unit;  ///< the unit whose root it is, or no_unit
  std::vector<std::uint32_t> group_of_block;
  std::vector<VertexRun> run_of_block;
  std::vector<std::uint32_t> free_nodes;

  HugePageVector<WidePatch> patches;  ///< block b holds 8 b … 8 b + 7
  HugePageVector<PatchPlanes> planes;
  std::vector<std::uint32_t> patch_of_triangle;
  HugePageVector<Vec3> vertices_m;  ///< as edits took them over
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<char> is_there;        ///< per triangle
  std::vector<WideChild> unit_root;  ///< per group; none for groups without subtree of their own

  Vec3 origin_m{0.0};
  float extent_m = 0.0F;  ///< no finite bound is larger, from the origin; grows only
  WideCosts costs;
  double weighted_area_m2 = 0.0;  ///< Σ cost · half surface over all nodes and blocks but the root
  double largest_area_m2 = 0.0;   ///< that this has had since it was last summed

  void add_area(double area_m2) {
    weighted_area_m2 += area_m2;
    largest_area_m2 = std::max(largest_area_m2, weighted_area_m2);
  }
  /// Whether roundings of the sum when it was larger may show in it now.
  bool is_area_worn() const { return weighted_area_m2 < 1e-3 * largest_area_m2; }

  /// Empties everything and keeps the memory.
  void clear();
  /// The same, but gives memory back that was asked for in the other way.
  void clear_for(bool huge_pages);

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

  /// Asks for the memory of a block that will be written soon; then, when that is there, for what it names. Rays have
  /// pushed most of it out of the caches since the last frame, and writing one block is too much work for the processor
  /// to look as far ahead as the next.
  void fetch_block(std::uint32_t block) const;
  void fetch_around_block(std::uint32_t block, std::span<const Vec3> from_m) const;
  /// To be called once the patches of a block are there.
  void find_run(std::uint32_t block);
  /// Takes over where the corners of a block are.
  void copy_vertices(std::uint32_t block, std::span<const Vec3> from_m);
  TriangleCorners corners_m(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {vertices_m[a], vertices_m[b], vertices_m[c]};
  }
  /// Empty where the triangle is not there.
  Aabb<double> box_of(std::uint32_t triangle) const {
    Aabb<double> box;
    if (is_there[triangle] == 0) return box;
    for (const std::uint32_t vertex : triangles[triangle]) box.extend(vertices_m[vertex]);
    return box;
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
    const auto is_there_now = [&](std::uint32_t triangle) { return is_there[triangle] != 0; };
    if (std::ranges::all_of(patch.triangles(), is_there_now)) {
      for (const std::uint32_t vertex : patch.corner) box.extend(vertices_m[vertex]);
    } else {
      for (const std::uint32_t triangle : patch.triangles()) box.extend(box_of(triangle));
    }
    return box;
  }

 private:
  // Inline: a call of what only fetches does nothing that g++ sees, and is left out.
  template <typename Item>
  [[gnu::always_inline]] static void fetch(const Item* first, std::size_t count) {
    const auto* bytes = reinterpret_cast<const char*>(first);
    for (std::size_t line = 0; line < count * sizeof(Item); line += 64) __builtin_prefetch(bytes + line, 1);
  }
  double weight(WideChild child, const Aabb<float>& box) const {
    const double cost = child.is_none() ? 0.0 : child.is_block() ? costs.block : costs.node;
    return cost * static_cast<double>(box.half_area());
  }
  std::uint32_t present_lanes(std::span<const WidePatch> held, detail::BlockPatches& there) const;
  void write_planes(const detail::BlockWriter& writer, std::uint32_t lane, const WidePatch& patch,
                    PatchPlanes& result) const;
};

inline void WideArrays::clear() {
  const auto empty = [](auto&... lists) { (lists.clear(), ...); };
  empty(nodes, node_place, node_unit, blocks, block_place, block_unit, group_of_block, run_of_block, free_nodes,
        patches, planes, patch_of_triangle, vertices_m, triangles, is_there, unit_root);
  origin_m = Vec3(0.0);
  extent_m = 0.0F;
  weighted_area_m2 = largest_area_m2 = 0.0;
}

inline void WideArrays::clear_for(bool huge_pages) {
  clear();
  if (nodes.get_allocator().asks() == huge_pages) return;
  const auto exchange = [huge_pages](auto&... lists) {
    ((lists = std::remove_reference_t<decltype(lists)>(HugePageAllocator<int>(huge_pages))), ...);
  };
  exchange(nodes, blocks, patches, planes, vertices_m);
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
  run_of_block.emplace_back();
  patches.resize(patches.size() + simd_lanes);
  planes.resize(planes.size() + simd_lanes);
  return static_cast<std::uint32_t>(blocks.size() - 1);
}

inline void WideArrays::hang(WideChild child, WidePlace place, const Aabb<float>& box) {
  WideNode& node = nodes[place.node()];
  add_area(-weight(node.child[place.lane()], box_at(place)));
  node.child[place.lane()] = child;
  node.set_box(place.lane(), box);
  add_area(weight(child, box));
  if (child.is_none()) return;
  (child.is_block() ? block_place[child.index()] : node_place[child.index()]) = place;
}

inline void WideArrays::set_box(WidePlace place, const Aabb<float>& box) {
  const WideChild child = child_at(place);
  add_area(weight(child, box) - weight(child, box_at(place)));
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

}  // namespace dcem

#include "dcem/accel/wide/update/leaf_writer.hpp"
