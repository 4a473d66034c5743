#pragma once
/// How the leaves of a `WideArrays` are written from their triangles: for those who build and edit trees.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "dcem/accel/wide/arrays.hpp"

namespace dcem {

[[gnu::always_inline]] inline void WideArrays::fetch_leaf(std::uint32_t leaf) const {
  fetch(&leaves[leaf], 1);
  fetch(&quads[std::size_t{leaf} * simd_lanes], simd_lanes);
}

[[gnu::always_inline]] inline void WideArrays::fetch_node_of(std::uint32_t leaf) const {
  fetch(&nodes[lane_of_leaf[leaf].node()], 1);
}

[[gnu::always_inline]] inline void WideArrays::fetch_around_leaf(std::uint32_t leaf,
                                                                 std::span<const Vec3> from_m) const {
  fetch_node_of(leaf);
  fetch(&planes[std::size_t{leaf} * simd_lanes], std::bit_width(leaves[leaf].lanes));
  if (const auto [first, count] = run_of_leaf[leaf]; count != 0) {
    fetch(&from_m[first], count);
    fetch(&vertices_m[first], count);
    return;
  }
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const Quad& quad = quads[leaf * simd_lanes + lane];
    if (quad.is_none()) continue;
    for (const std::uint32_t vertex : quad.corner) {
      __builtin_prefetch(&from_m[vertex]);
      __builtin_prefetch(&vertices_m[vertex], 1);
    }
  }
}

inline void WideArrays::find_run(std::uint32_t leaf) {
  const std::span<const Quad> held = std::span(quads).subspan(std::size_t{leaf} * simd_lanes, simd_lanes);
  const auto for_each_corner = [&](auto&& visit) {
    for (const Quad& quad : held) {
      if (quad.is_none()) continue;
      for (const std::uint32_t vertex : quad.corner) visit(vertex);
    }
  };
  std::uint32_t lowest = held.front().corner[0], seen = 0;
  for_each_corner([&](std::uint32_t vertex) { lowest = std::min(lowest, vertex); });
  bool is_near = true;
  for_each_corner([&](std::uint32_t vertex) {
    is_near = is_near && vertex - lowest < 32;
    seen |= 1U << (vertex - lowest) % 32;
  });
  const auto count = static_cast<std::uint32_t>(std::popcount(seen));
  const bool follows = is_near && count == static_cast<std::uint32_t>(std::countr_one(seen));
  run_of_leaf[leaf] = follows ? VertexRun{lowest, count} : VertexRun{};
}

template <typename Take>
void WideArrays::for_each_corner(std::uint32_t leaf, Take&& take) const {
  if (const auto [first, count] = run_of_leaf[leaf]; count != 0) {
    for (std::uint32_t vertex = first; vertex < first + count; ++vertex) take(vertex);
    return;
  }
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const Quad& quad = quads[leaf * simd_lanes + lane];
    if (!quad.is_none()) std::ranges::for_each(quad.corner, take);
  }
}

inline void WideArrays::copy_vertices(std::uint32_t leaf, std::span<const Vec3> from_m) {
  if (const auto [first, count] = run_of_leaf[leaf]; count != 0) {
    std::copy_n(from_m.begin() + first, count, vertices_m.begin() + first);
    return;
  }
  for_each_corner(leaf, [&](std::uint32_t vertex) { vertices_m[vertex] = from_m[vertex]; });
}

/// A corner that two leaves have in common is written by two threads: the same numbers, each in one piece.
inline void WideArrays::copy_vertices_together(std::uint32_t leaf, std::span<const Vec3> from_m) {
  for_each_corner(leaf, [&](std::uint32_t vertex) {
    for (int axis = 0; axis < 3; ++axis) {
      std::atomic_ref(vertices_m[vertex][axis]).store(from_m[vertex][axis], std::memory_order_relaxed);
    }
  });
}

inline Aabb<float> WideArrays::write_leaf(std::uint32_t index) {
  QuadLeaf& leaf = leaves[index];
  detail::LeafQuads there;
  leaf.lanes = present_lanes(std::span(quads).subspan(std::size_t{index} * simd_lanes, simd_lanes), there);
  if (leaf.lanes == 0) return {};
  detail::LeafNumbers writer(there.in_lane, vertices_m);
  const Aabb<double> box = writer.bounds_m();
  const Vec3 centre_m = box.center() - origin_m;
  // To float and back as explicit vectors: with plain numbers g++ 12 (-O2) vectorises the way there and back away, and
  // the corners would be counted from another centre than queries use.
  using Double4 = double __attribute__((vector_size(32)));
  const Float4 rounded = __builtin_convertvector((Double4{centre_m.x, centre_m.y, centre_m.z, 0.0}), Float4);
  const Double4 exact = __builtin_convertvector(rounded, Double4);
  std::memcpy(leaf.centre_m.data(), &rounded, sizeof leaf.centre_m);
  const Vec3 counted_from_m(exact[0], exact[1], exact[2]);
  // Rounding keeps the order: no corner is farther than the box.
  const Vec3 reach_m =
      glm::max(glm::abs((box.min - origin_m) - counted_from_m), glm::abs((box.max - origin_m) - counted_from_m));
  leaf.size_m = static_cast<float>(std::max({reach_m.x, reach_m.y, reach_m.z}));
  writer.write(origin_m, counted_from_m, leaf);
  for (std::uint32_t rest = leaf.lanes; rest != 0; rest &= rest - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
    write_planes(writer, lane, *there.in_lane[lane], planes[index * simd_lanes + lane]);
  }
  return rounded_out(box);
}

/// The quads of which something is there; lanes without get another quad of the leaf. A pair of which one triangle
/// is not there is the other. Returns the lanes with one.
inline std::uint32_t WideArrays::present_lanes(std::span<const Quad> held, detail::LeafQuads& there) const {
  std::uint32_t lanes = 0;
  const Quad* any = nullptr;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const Quad& quad = held[lane];
    const bool first = !quad.is_none() && is_there[quad.triangle[0]] != 0;
    const bool second = quad.is_pair() && is_there[quad.triangle[1]] != 0;
    there.in_lane[lane] = &quad;
    if (!first && !second) continue;
    lanes |= 1U << lane;
    if (quad.is_pair() && first != second) {
      const std::uint32_t left = quad.triangle[first ? 0 : 1];
      there.in_lane[lane] = &(there.halves[lane] = Quad::alone(left, triangles[left]));
    }
    any = there.in_lane[lane];
  }
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if ((lanes >> lane & 1U) == 0) there.in_lane[lane] = any;
  }
  return lanes;
}

inline void WideArrays::write_planes(const detail::LeafNumbers& writer, std::uint32_t lane, const Quad& quad,
                                     QuadPlanes& result) const {
  const float least =
      quad.is_pair() ? TrianglePlane::least_slope_squared_of(writer.difference_squared(lane)) : TrianglePlane::alone;
  // Number by number: a plane made elsewhere and copied would wait for its parts.
  const auto write = [&](std::size_t side) {
    TrianglePlane& plane = result.side[side];
    writer.write_normal(side, lane, plane.normal);
    const Vec3& point_m = vertices_m[quad.first_vertex(side)];
    plane.point_m.x = point_m.x;
    plane.point_m.y = point_m.y;
    plane.point_m.z = point_m.z;
    plane.triangle = quad.triangle[side];
    plane.least_slope_squared = least;
  };
  write(0);
  if (quad.is_pair()) {
    write(1);
  } else {
    result.side[1].triangle = Quad::no_triangle;
  }
}

}  // namespace dcem
