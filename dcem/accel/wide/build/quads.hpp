#pragma once
/// Pairs triangles into flat convex quadrilaterals: what a wide tree holds in its leaves.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/accel/wide/quad.hpp"
#include "dcem/core/radix_sort.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/triangle_view.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

namespace detail {

/// Two triangles on one edge: the ways from one end of it to the other end and to the corners beside it.
struct EdgePair {
  Vec3 along_m, first_m, second_m;
  Vec3 first_normal = glm::cross(along_m, first_m), second_normal = glm::cross(along_m, second_m);  ///< twice the areas
  double length_squared_m2 = glm::dot(along_m, along_m);
  double first_squared = glm::dot(first_normal, first_normal);
  double second_squared = glm::dot(second_normal, second_normal);

  bool is_first_larger() const { return first_squared >= second_squared; }

  /// Whether the corner of the smaller triangle lies within `flatness` edge lengths of the plane of the larger one.
  bool is_flat(double flatness) const {
    const double height = is_first_larger() ? glm::dot(first_normal, second_m) : glm::dot(second_normal, first_m);
    const double larger_squared = std::max(first_squared, second_squared);
    return larger_squared > 0.0 && height * height <= flatness * flatness * length_squared_m2 * larger_squared;
  }

  /// Whether the quadrilateral that they make, all but flat, turns the same way at every corner, and enough to survive
  /// rounding. The turns at opposite corners have the same sum.
  bool is_convex() const {
    const Vec3 normal = second_normal - first_normal;
    const double sum = glm::dot(normal, normal), least = 1e-3 * sum;
    const double at_first = -glm::dot(normal, first_normal), at_second = glm::dot(normal, second_normal);
    const double at_end = glm::dot(normal, glm::cross(along_m - first_m, second_m - along_m));
    // Two triangles on one side of the edge lie on each other: their normals cancel, but for rounding.
    const bool on_both_sides = glm::dot(first_normal, second_normal) < 0.0;
    return on_both_sides && at_first >= least && at_second >= least && at_end >= least && sum - at_end >= least;
  }
};

/// Pairs the triangles [first, last) greedily, the longest shared edge first.
class QuadBuilder {
 public:
  /// `flatness`: how far the fourth corner may lie from the plane of the others, relative to the shared edge; below 0
  /// there are no pairs.
  QuadBuilder(const TriangleView& mesh, double flatness) : mesh_(mesh), flatness_(flatness) {}

  void append(std::uint32_t first, std::uint32_t last, std::vector<Quad>& quads) {
    if (last == first) return;
    pairs_.clear();
    if (flatness_ >= 0.0) {
      collect_edges(first, last);
      collect_pairs();
    }
    order_pairs();
    taken_.assign(last - first, false);
    for (const KeyOrder::Entry& entry : longest_first_.entries) {
      const Pair& pair = pairs_[entry.index];
      if (taken_[pair.one - first] || taken_[pair.other - first]) continue;
      taken_[pair.one - first] = taken_[pair.other - first] = true;
      quads.push_back(quad_of(pair));
    }
    for (std::uint32_t triangle = first; triangle < last; ++triangle) {
      if (taken_[triangle - first]) continue;
      quads.push_back(Quad::alone(triangle, mesh_.triangles[triangle]));
    }
  }

 private:
  struct Edge {
    std::uint32_t low, high, triangle;
  };
  /// Of a list of edges with one lower vertex: the higher one, then the triangle.
  using EdgeKey = std::uint64_t;
  static EdgeKey key_of(const Edge& edge) { return std::uint64_t{edge.high} << 32 | edge.triangle; }
  static std::uint32_t high_of(EdgeKey key) { return static_cast<std::uint32_t>(key >> 32); }
  static std::uint32_t triangle_of(EdgeKey key) { return static_cast<std::uint32_t>(key); }

  static constexpr std::size_t few_pairs = 256;  ///< sorted sooner by comparing

  struct Pair {
    double length_squared_m2;  ///< of the shared edge
    std::uint32_t one, other;  ///< the larger triangle and the other
    std::uint16_t b, d;        ///< their corners that are not on the shared edge

    std::uint64_t numbers() const { return std::uint64_t{std::min(one, other)} << 32 | std::max(one, other); }
  };

  /// All edges, in a list per lower vertex.
  void collect_edges(std::uint32_t first, std::uint32_t last) {
    // Lists for the vertices of these triangles alone: a scene has thousands of objects.
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
    for_each_edge([&](const Edge& edge) { edges_[next_edge_[edge.low - lowest]++] = key_of(edge); });
    lowest_ = lowest;
  }

  void collect_pairs() {
    for (std::size_t vertex = 0; vertex + 1 < first_edge_.size(); ++vertex) {
      const std::size_t first = first_edge_[vertex], last = first_edge_[vertex + 1];
      std::ranges::sort(std::span(edges_).subspan(first, last - first));
      const std::uint32_t low = lowest_ + static_cast<std::uint32_t>(vertex);
      for (std::size_t index = first; index + 1 < last; ++index) {
        for (std::size_t next = index + 1; next < last && next < index + 4; ++next) {
          const std::uint32_t high = high_of(edges_[index]);
          if (high_of(edges_[next]) != high) break;
          try_pair({low, high, triangle_of(edges_[index])}, {low, high, triangle_of(edges_[next])});
        }
      }
    }
  }

  /// Most lengths differ in single precision, of which the bits have the order of the numbers; where they do not, pairs
  /// are compared.
  void order_pairs() {
    std::vector<KeyOrder::Entry>& order = longest_first_.entries;
    order.clear();
    for (std::uint32_t index = 0; index < pairs_.size(); ++index) {
      order.push_back({~std::bit_cast<std::uint32_t>(static_cast<float>(pairs_[index].length_squared_m2)), index});
    }
    const auto is_before = [&](const KeyOrder::Entry& entry, const KeyOrder::Entry& other_entry) {
      const Pair &one = pairs_[entry.index], &other = pairs_[other_entry.index];
      return one.length_squared_m2 != other.length_squared_m2 ? one.length_squared_m2 > other.length_squared_m2
                                                              : one.numbers() < other.numbers();
    };
    if (order.size() < few_pairs) {
      std::ranges::sort(order, is_before);
      return;
    }
    longest_first_.sort();
    for (auto first = order.begin(), last = first; first != order.end(); first = last) {
      while (last != order.end() && last->key == first->key) ++last;
      if (last - first > 1) std::sort(first, last, is_before);
    }
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
    const std::uint32_t one = edge.triangle, other = same.triangle;
    const std::uint32_t b = opposite(edge), d = opposite(same);
    if (one == other || b == 3 || d == 3) return;
    const Vec3& low_m = mesh_.vertices_m[edge.low];
    const EdgePair ways{mesh_.vertices_m[edge.high] - low_m, at(one, b) - low_m, at(other, d) - low_m};
    if (!ways.is_flat(flatness_) || !ways.is_convex()) return;
    const auto corner = [](std::uint32_t at) { return static_cast<std::uint16_t>(at); };
    // The larger triangle gives the plane.
    pairs_.push_back(ways.is_first_larger() ? Pair{ways.length_squared_m2, one, other, corner(b), corner(d)}
                                            : Pair{ways.length_squared_m2, other, one, corner(d), corner(b)});
  }

  Quad quad_of(const Pair& pair) const {
    const auto &vertices = mesh_.triangles[pair.one], &others = mesh_.triangles[pair.other];
    const std::uint32_t b = pair.b, c = (b + 1) % 3, a = (b + 2) % 3;
    const std::uint32_t begin = (3 - a) % 3, other_begin = pair.d == 0 ? 2U : others[0] == vertices[a] ? 0U : 1U;
    return {{pair.one, pair.other}, {vertices[a], vertices[b], vertices[c], others[pair.d]}, {begin, other_begin}};
  }

  const TriangleView& mesh_;
  double flatness_;
  std::uint32_t lowest_ = 0;  ///< vertex of the triangles
  std::vector<EdgeKey> edges_;
  std::vector<std::uint32_t> first_edge_, next_edge_;  ///< per vertex, from the lowest one on
  std::vector<Pair> pairs_;
  KeyOrder longest_first_;
  std::vector<bool> taken_;
};

}  // namespace detail

}  // namespace dcem
