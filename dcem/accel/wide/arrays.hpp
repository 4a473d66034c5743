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

#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/quad.hpp"
#include "dcem/accel/wide/settings.hpp"
#include "dcem/accel/wide/update/leaf_numbers.hpp"
#include "dcem/core/huge_pages.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle.hpp"

namespace dcem {

/// Plain arrays; `WideBvh` keeps their promises and `find_wide_defect` checks them.
///
/// Node 0 is the root. Nodes and leaves never move; what an edit gives up is used again. An object is an object that
/// owns a subtree: one entry of the tree leads to it, and edits above take it as a whole.
struct WideArrays {
  /// Vertices that follow one another, and all are corners of one leaf; none where its corners lie scattered.
  struct VertexRun {
    std::uint32_t first = 0, count = 0;
  };
  static constexpr std::uint32_t no_object = 0xffffffffU;

  HugePageVector<WideNode> nodes;
  std::vector<NodeLane> lane_of_node;                ///< where a node hangs; none for the root and for unused nodes
  std::vector<std::uint32_t> object_rooted_at_node;  ///< the object whose root it is, or no_object
  HugePageVector<QuadLeaf> leaves;
  std::vector<NodeLane> lane_of_leaf;
  std::vector<std::uint32_t> object_rooted_at_leaf;  ///< the object whose root it is, or no_object
  std::vector<VertexRun> run_of_leaf;
  std::vector<std::uint32_t> free_nodes;

  HugePageVector<Quad> quads;  ///< leaf b holds 8 b … 8 b + 7
  HugePageVector<QuadPlanes> planes;
  std::vector<std::uint32_t> quad_of_triangle;
  HugePageVector<Vec3> vertices_m;  ///< as edits took them over
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<char> is_there;          ///< per triangle
  std::vector<WideChild> object_root;  ///< per object; none for objects without subtree of their own

  Vec3 origin_m{0.0};
  float extent_m = 0.0F;  ///< no finite bound is larger, from the origin; grows only
  WideCosts costs;
  bool fetch_ahead = true;        ///< WideBuildSettings::fetch_ahead
  double weighted_area_m2 = 0.0;  ///< Σ cost · half surface over all nodes and leaves but the root
  double largest_area_m2 = 0.0;   ///< that this has had since it was last summed

  void add_area(double area_m2) {
    weighted_area_m2 += area_m2;
    largest_area_m2 = std::max(largest_area_m2, weighted_area_m2);
  }
  /// Whether roundings of the sum when it was larger may show in it now.
  bool is_area_imprecise() const { return weighted_area_m2 < 1e-3 * largest_area_m2; }

  /// Empties everything and keeps the memory.
  void clear();
  /// The same, but gives memory back that was asked for in the other way.
  void clear_for(bool huge_pages);

  NodeLane place_of(WideChild child) const {
    return child.is_leaf() ? lane_of_leaf[child.index()] : lane_of_node[child.index()];
  }
  std::uint32_t object_rooted_at(WideChild child) const {
    return child.is_leaf() ? object_rooted_at_leaf[child.index()] : object_rooted_at_node[child.index()];
  }
  Aabb<float> box_at(NodeLane place) const { return nodes[place.node()].box(place.lane()); }
  WideChild child_at(NodeLane place) const { return nodes[place.node()].child[place.lane()]; }

  /// Room for so many nodes and leaves in all.
  void reserve(std::size_t node_count, std::size_t leaf_count);
  std::uint32_t take_node();
  std::uint32_t add_leaf(std::uint32_t object);

  /// Puts a child with its box into a lane.
  void attach(WideChild child, NodeLane place, const Aabb<float>& box);
  /// Changes the box of a lane; keeps the sum.
  void set_box(NodeLane place, const Aabb<float>& box);
  /// Makes the boxes above a node tight again, as far up as they change. Returns how many nodes were looked at.
  std::size_t tighten_above(std::uint32_t node);

  /// Asks for the memory of a leaf that will be written soon; then, when that is there, for what it names. Rays have
  /// pushed most of it out of the caches since the last frame, and writing one leaf is too much work for the processor
  /// to look as far ahead as the next.
  void fetch_leaf(std::uint32_t leaf) const;
  void fetch_node_of(std::uint32_t leaf) const;
  void fetch_around_leaf(std::uint32_t leaf, std::span<const Vec3> from_m) const;
  /// To be called once the quads of a leaf are there.
  void find_run(std::uint32_t leaf);
  /// Calls `take` with each vertex that the quads of a leaf have, with some of them more than once.
  template <typename Take>
  void for_each_corner(std::uint32_t leaf, Take&& take) const;
  /// Takes over where the corners of a leaf are.
  void copy_vertices(std::uint32_t leaf, std::span<const Vec3> from_m);
  /// The same, while other threads do it for other leaves.
  void copy_vertices_together(std::uint32_t leaf, std::span<const Vec3> from_m);
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

  /// Writes the numbers of a leaf from the triangles of its quads, and nothing else. Returns the box around it.
  Aabb<float> write_leaf(std::uint32_t leaf);

  /// The single-precision box around a double one, from the tree's origin.
  Aabb<float> rounded_out(const Aabb<double>& box) const;

  Aabb<double> box_of_quad(const Quad& quad) const {
    Aabb<double> box;
    const auto is_there_now = [&](std::uint32_t triangle) { return is_there[triangle] != 0; };
    if (std::ranges::all_of(quad.triangles(), is_there_now)) {
      for (const std::uint32_t vertex : quad.corner) box.extend(vertices_m[vertex]);
    } else {
      for (const std::uint32_t triangle : quad.triangles()) box.extend(box_of(triangle));
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
    const double cost = child.is_none() ? 0.0 : child.is_leaf() ? costs.leaf : costs.node;
    return cost * static_cast<double>(box.half_area());
  }
  std::uint32_t present_lanes(std::span<const Quad> held, detail::LeafQuads& there) const;
  void write_planes(const detail::LeafNumbers& writer, std::uint32_t lane, const Quad& quad, QuadPlanes& result) const;
};

inline void WideArrays::clear() {
  const auto empty = [](auto&... lists) { (lists.clear(), ...); };
  empty(nodes, lane_of_node, object_rooted_at_node, leaves, lane_of_leaf, object_rooted_at_leaf, run_of_leaf,
        free_nodes, quads, planes, quad_of_triangle, vertices_m, triangles, is_there, object_root);
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
  exchange(nodes, leaves, quads, planes, vertices_m);
}

inline void WideArrays::reserve(std::size_t node_count, std::size_t leaf_count) {
  const auto make_room = [](std::size_t count, auto&... lists) { (lists.reserve(count), ...); };
  make_room(node_count, nodes, lane_of_node, object_rooted_at_node);
  make_room(leaf_count, leaves, lane_of_leaf, object_rooted_at_leaf, run_of_leaf);
  make_room(leaf_count * simd_lanes, quads, planes);
}

inline std::uint32_t WideArrays::take_node() {
  if (!free_nodes.empty()) {
    const std::uint32_t node = free_nodes.back();
    free_nodes.pop_back();
    return node;
  }
  nodes.emplace_back();
  lane_of_node.emplace_back();
  object_rooted_at_node.push_back(no_object);
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

inline std::uint32_t WideArrays::add_leaf(std::uint32_t object) {
  leaves.emplace_back();
  leaves.back().object = object;
  lane_of_leaf.emplace_back();
  object_rooted_at_leaf.push_back(no_object);
  run_of_leaf.emplace_back();
  quads.resize(quads.size() + simd_lanes);
  planes.resize(planes.size() + simd_lanes);
  return static_cast<std::uint32_t>(leaves.size() - 1);
}

inline void WideArrays::attach(WideChild child, NodeLane place, const Aabb<float>& box) {
  WideNode& node = nodes[place.node()];
  add_area(-weight(node.child[place.lane()], box_at(place)));
  node.child[place.lane()] = child;
  node.set_box(place.lane(), box);
  add_area(weight(child, box));
  if (child.is_none()) return;
  (child.is_leaf() ? lane_of_leaf[child.index()] : lane_of_node[child.index()]) = place;
}

inline void WideArrays::set_box(NodeLane place, const Aabb<float>& box) {
  const WideChild child = child_at(place);
  add_area(weight(child, box) - weight(child, box_at(place)));
  nodes[place.node()].set_box(place.lane(), box);
}

inline std::size_t WideArrays::tighten_above(std::uint32_t node) {
  std::size_t visited = 0;
  for (NodeLane place = lane_of_node[node]; !place.is_none(); place = lane_of_node[place.node()]) {
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
