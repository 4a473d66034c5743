#pragma once
/// Pairs triangles into flat convex quadrilaterals: what a wide tree holds in its leaves.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Triangles as a tree sees them: corners by number into common vertices, metres.
struct TriangleView {
  std::span<const Vec3> vertices_m;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  /// Per triangle the surface it belongs to: triangles of different surfaces are never paired. Empty: all are of one.
  std::span<const std::uint32_t> surface_of_triangle{};

  std::size_t size() const { return triangles.size(); }
  bool same_surface(std::uint32_t one, std::uint32_t other) const {
    return surface_of_triangle.empty() || surface_of_triangle[one] == surface_of_triangle[other];
  }
  TriangleCorners corners_m(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {vertices_m[a], vertices_m[b], vertices_m[c]};
  }
};

/// One triangle, or two that share the edge from corner c to corner a.
struct WidePatch {
  static constexpr std::uint32_t no_triangle = 0xffffffffU;

  std::array<std::uint32_t, 2> triangle{no_triangle, no_triangle};
  /// Vertices: a, b, c of the first triangle, d of the second. A triangle alone has a in place of d.
  std::array<std::uint32_t, 4> corner{};
  /// Which of a, b, c is the first corner of the first triangle, and which of a, c, d of the second: 0, 1 or 2.
  std::array<std::uint32_t, 2> begin{};

  static WidePatch alone(std::uint32_t triangle, const std::array<std::uint32_t, 3>& vertices) {
    return {{triangle, no_triangle}, {vertices[0], vertices[1], vertices[2], vertices[0]}, {}};
  }
  bool is_none() const { return triangle[0] == no_triangle; }
  bool is_pair() const { return triangle[1] != no_triangle; }
  std::span<const std::uint32_t> triangles() const { return {triangle.data(), is_pair() ? 2U : 1U}; }
  /// The first corner of a triangle.
  std::uint32_t first_vertex(std::size_t side) const {
    return side == 0 || begin[1] == 0 ? corner[begin[side]] : corner[begin[1] + 1];
  }
};

namespace detail {

inline double twice_area_m2(const Vec3& a, const Vec3& b, const Vec3& c) {
  return glm::length(glm::cross(b - a, c - a));
}

/// How far d lies from the plane of a, b, c; infinite where that has no plane.
inline double distance_from_plane_m(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  return length > 0.0 ? std::abs(glm::dot(normal, d - a)) / length : INFINITY;
}

/// Whether a b c d, all but flat, turns the same way at every corner, and enough to survive rounding.
inline bool is_convex(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 normal = glm::cross(b - a, c - a) + glm::cross(c - a, d - a);
  const double least = 1e-3 * glm::dot(normal, normal);
  const auto turn = [&](const Vec3& from, const Vec3& at, const Vec3& to) {
    return glm::dot(normal, glm::cross(at - from, to - at)) >= least;
  };
  // Two triangles that lie on each other have normals that cancel.
  return least > 0.0 && turn(a, b, c) && turn(b, c, d) && turn(c, d, a) && turn(d, a, b);
}

/// Pairs the triangles [first, last) greedily, the longest shared edge first.
class PatchBuilder {
 public:
  /// `flatness`: how far the fourth corner may lie from the plane of the others, relative to the shared edge.
  PatchBuilder(const TriangleView& mesh, double flatness) : mesh_(mesh), flatness_(flatness) {}

  void append(std::uint32_t first, std::uint32_t last, std::vector<WidePatch>& patches) {
    if (last == first) return;
    collect_edges(first, last);
    collect_pairs();
    taken_.assign(last - first, false);
    for (const Pair& pair : pairs_) {
      if (taken_[pair.one - first] || taken_[pair.other - first]) continue;
      taken_[pair.one - first] = taken_[pair.other - first] = true;
      patches.push_back(pair.patch);
    }
    for (std::uint32_t triangle = first; triangle < last; ++triangle) {
      if (taken_[triangle - first]) continue;
      patches.push_back(WidePatch::alone(triangle, mesh_.triangles[triangle]));
    }
  }

 private:
  struct Edge {
    std::uint32_t low, high, triangle;
  };
  struct Pair {
    double length_m;
    std::uint32_t one, other;
    WidePatch patch;
  };

  /// All edges, by their vertices: a counting sort over the lower one, then short lists.
  void collect_edges(std::uint32_t first, std::uint32_t last) {
    // Lists for the vertices of these triangles alone: a scene has thousands of groups.
    std::uint32_t lowest = mesh_.triangles[first][0], highest = lowest;
    for (std::uint32_t triangle = first; triangle < last; ++triangle) {
      const auto [low, high] = std::ranges::minmax(mesh_.triangles[triangle]);
      lowest = std::min(lowest, low);
      highest = std::max(highest, high);
    }
    first_edge_.assign(std::size_t{highest - lowest} + 2, 0);
    const auto for_each_edge = [&](auto&& visit) {
      for (std::uint32_t triangle = first; triangle < last; ++triangle) {
        const auto& corners = mesh_.triangles[triangle];
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::uint32_t from = corners[corner], to = corners[(corner + 1) % 3];
          visit(Edge{std::min(from, to), std::max(from, to), triangle});
        }
      }
    };
    for_each_edge([&](const Edge& edge) { ++first_edge_[edge.low - lowest + 1]; });
    for (std::size_t vertex = 1; vertex < first_edge_.size(); ++vertex) first_edge_[vertex] += first_edge_[vertex - 1];
    edges_.resize(3 * std::size_t{last - first});
    next_edge_.assign(first_edge_.begin(), first_edge_.end() - 1);
    for_each_edge([&](const Edge& edge) { edges_[next_edge_[edge.low - lowest]++] = edge; });
    for (std::size_t vertex = 0; vertex + 1 < first_edge_.size(); ++vertex) {
      std::sort(edges_.begin() + first_edge_[vertex], edges_.begin() + first_edge_[vertex + 1],
                [](const Edge& one, const Edge& other) {
                  return one.high != other.high ? one.high < other.high : one.triangle < other.triangle;
                });
    }
  }

  void collect_pairs() {
    pairs_.clear();
    for (std::size_t index = 0; index + 1 < edges_.size(); ++index) {
      for (std::size_t next = index + 1; next < edges_.size() && next < index + 4; ++next) {
        if (edges_[next].low != edges_[index].low || edges_[next].high != edges_[index].high) break;
        try_pair(edges_[index], edges_[next]);
      }
    }
    std::sort(pairs_.begin(), pairs_.end(), [](const Pair& one, const Pair& other) {
      if (one.length_m != other.length_m) return one.length_m > other.length_m;
      return std::tie(one.one, one.other) < std::tie(other.one, other.other);
    });
  }

  /// Which corner of a triangle is not on an edge; 3 where the triangle names a vertex twice.
  std::uint32_t opposite(const Edge& edge) const {
    const auto& corners = mesh_.triangles[edge.triangle];
    std::uint32_t at = 0;
    while (at < 3 && (corners[at] == edge.low || corners[at] == edge.high)) ++at;
    return at;
  }
  const Vec3& at(std::uint32_t triangle, std::uint32_t corner) const {
    return mesh_.vertices_m[mesh_.triangles[triangle][corner]];
  }

  void try_pair(const Edge& edge, const Edge& same) {
    std::uint32_t one = edge.triangle, other = same.triangle;
    std::uint32_t b = opposite(edge), d = opposite(same);
    if (one == other || b == 3 || d == 3 || !mesh_.same_surface(one, other)) return;
    const Vec3 &low = mesh_.vertices_m[edge.low], &high = mesh_.vertices_m[edge.high];
    // The larger triangle gives the plane.
    if (twice_area_m2(low, at(one, b), high) < twice_area_m2(low, at(other, d), high)) {
      std::swap(one, other);
      std::swap(b, d);
    }
    const std::uint32_t c = (b + 1) % 3, a = (b + 2) % 3;
    const Vec3 &at_a = at(one, a), &at_b = at(one, b), &at_c = at(one, c), &at_d = at(other, d);
    const double length_m = glm::distance(low, high);
    if (!(distance_from_plane_m(at_a, at_b, at_c, at_d) <= flatness_ * length_m)) return;
    if (!is_convex(at_a, at_b, at_c, at_d)) return;
    const auto &vertices = mesh_.triangles[one], &others = mesh_.triangles[other];
    const std::uint32_t begin = (3 - a) % 3, other_begin = d == 0 ? 2U : others[0] == vertices[a] ? 0U : 1U;
    pairs_.push_back({length_m,
                      std::min(one, other),
                      std::max(one, other),
                      {{one, other}, {vertices[a], vertices[b], vertices[c], others[d]}, {begin, other_begin}}});
  }

  const TriangleView& mesh_;
  double flatness_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_edge_, next_edge_;  ///< per vertex, from the lowest one on
  std::vector<Pair> pairs_;
  std::vector<bool> taken_;
};

}  // namespace detail

}  // namespace dcem
