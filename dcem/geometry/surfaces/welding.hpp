#pragma once
/// Vertices that lie within a tolerance of each other become one vertex.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/surfaces/disjoint_sets.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

struct WeldedVertices {
  std::vector<Vec3> vertices_m;          ///< distinct vertices in lexicographic order
  std::vector<std::uint32_t> new_index;  ///< for each vertex handed in, its index in `vertices_m`
};

/// Joins vertices no further apart than `tolerance_m`, transitively: a chain of close vertices is one vertex. Of each
/// cluster the lexicographically smallest vertex stands for all, so nothing depends on the order of the input.
inline WeldedVertices weld(const std::vector<Vec3>& vertices_m, double tolerance_m);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Index of each vertex in the sorted list of distinct ones.
struct DistinctVertices {
  std::vector<Vec3> vertices_m;
  std::vector<std::uint32_t> index;
};

inline DistinctVertices distinct_vertices(const std::vector<Vec3>& vertices_m) {
  std::vector<std::uint32_t> order(vertices_m.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return lexicographic_less(vertices_m[a], vertices_m[b]); });
  DistinctVertices distinct;
  distinct.index.resize(vertices_m.size());
  for (const std::uint32_t vertex : order) {
    if (distinct.vertices_m.empty() || lexicographic_less(distinct.vertices_m.back(), vertices_m[vertex])) {
      distinct.vertices_m.push_back(vertices_m[vertex]);
    }
    distinct.index[vertex] = static_cast<std::uint32_t>(distinct.vertices_m.size() - 1);
  }
  return distinct;
}

/// Space cut into cubes whose edge is the tolerance: close vertices are in the same or in neighbouring cubes.
class WeldGrid {
 public:
  WeldGrid(const std::vector<Vec3>& vertices_m, double tolerance_m) : vertices_m_(vertices_m), cell_m_(tolerance_m) {
    cells_.reserve(vertices_m.size());
    for (std::uint32_t index = 0; index < vertices_m.size(); ++index) {
      cells_[key(cell_of(vertices_m[index]))].push_back(index);
    }
  }

  /// Joins `vertex` with every vertex of a lower index that is close to it.
  void join_neighbours(std::uint32_t vertex, DisjointSets& sets) const {
    const auto centre = cell_of(vertices_m_[vertex]);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto cell = cells_.find(key({centre[0] + dx, centre[1] + dy, centre[2] + dz}));
          if (cell != cells_.end()) join_close(vertex, cell->second, sets);
        }
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const Vec3& point_m) const {
    return {std::llround(std::floor(point_m.x / cell_m_)), std::llround(std::floor(point_m.y / cell_m_)),
            std::llround(std::floor(point_m.z / cell_m_))};
  }
  static std::uint64_t key(const Cell& cell) {  // two cells may share a key: distance decides, not the key
    return hash_values(static_cast<std::uint64_t>(cell[0]), cell[1], cell[2]);
  }
  void join_close(std::uint32_t vertex, const std::vector<std::uint32_t>& others, DisjointSets& sets) const {
    for (const std::uint32_t other : others) {
      if (other < vertex && glm::distance(vertices_m_[vertex], vertices_m_[other]) <= cell_m_) sets.join(vertex, other);
    }
  }

  const std::vector<Vec3>& vertices_m_;
  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace detail

inline WeldedVertices weld(const std::vector<Vec3>& vertices_m, double tolerance_m) {
  std::vector<Vec3> unsigned_zeros_m = vertices_m;
  for (Vec3& vertex : unsigned_zeros_m)
    vertex += Vec3(0.0);  // −0 is 0: they compare equal, so either might have stayed
  const detail::DistinctVertices distinct = detail::distinct_vertices(unsigned_zeros_m);
  DisjointSets sets(distinct.vertices_m.size());
  if (tolerance_m > 0.0) {
    const detail::WeldGrid grid(distinct.vertices_m, tolerance_m);
    for (std::uint32_t index = 0; index < distinct.vertices_m.size(); ++index) grid.join_neighbours(index, sets);
  }
  WeldedVertices welded;
  std::vector<std::uint32_t> new_of_distinct(distinct.vertices_m.size());
  for (std::uint32_t index = 0; index < distinct.vertices_m.size(); ++index) {
    if (sets.smallest(index) == index) {  // distinct vertices are sorted: the smallest index is the smallest vertex
      new_of_distinct[index] = static_cast<std::uint32_t>(welded.vertices_m.size());
      welded.vertices_m.push_back(distinct.vertices_m[index]);
    } else {
      new_of_distinct[index] = new_of_distinct[sets.smallest(index)];
    }
  }
  welded.new_index.resize(vertices_m.size());
  for (std::size_t vertex = 0; vertex < vertices_m.size(); ++vertex) {
    welded.new_index[vertex] = new_of_distinct[distinct.index[vertex]];
  }
  return welded;
}

}  // namespace dcem
