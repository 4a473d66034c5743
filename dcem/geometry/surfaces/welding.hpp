#pragma once
/// Vertices that lie within a tolerance of each other become one vertex.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
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
  struct Entry {
    Vec3 vertex_m;
    std::uint32_t place;
  };
  std::vector<Entry> order(vertices_m.size());
  for (std::uint32_t place = 0; place < order.size(); ++place) order[place] = {vertices_m[place], place};
  std::sort(order.begin(), order.end(),
            [](const Entry& a, const Entry& b) { return lexicographic_less(a.vertex_m, b.vertex_m); });
  DistinctVertices distinct;
  distinct.index.resize(vertices_m.size());
  distinct.vertices_m.reserve(vertices_m.size());
  for (const Entry& entry : order) {
    if (distinct.vertices_m.empty() || lexicographic_less(distinct.vertices_m.back(), entry.vertex_m)) {
      distinct.vertices_m.push_back(entry.vertex_m);
    }
    distinct.index[entry.place] = static_cast<std::uint32_t>(distinct.vertices_m.size() - 1);
  }
  return distinct;
}

/// Space cut into cubes, eight tolerances wide: what is close to a vertex mostly lies in its own cube, and beyond a
/// side only where that is within the tolerance. Cubes are chains in one table, so that millions of vertices cost no
/// allocation each.
class WeldGrid {
 public:
  /// Precondition: fewer than 2^32 − 1 vertices.
  WeldGrid(const std::vector<Vec3>& vertices_m, double tolerance_m)
      : vertices_m_(vertices_m),
        tolerance_m_(tolerance_m),
        cell_m_(8.0 * tolerance_m),
        first_(std::bit_ceil(vertices_m.size() + 1), nobody),
        next_(vertices_m.size(), nobody) {}

  /// Joins `vertex` with all that are close to it and came before, and takes it in.
  void take(std::uint32_t vertex, DisjointSets& sets) {
    const Vec3 low_m = vertices_m_[vertex] - Vec3(tolerance_m_), high_m = vertices_m_[vertex] + Vec3(tolerance_m_);
    const Cell low = cell_of(low_m), high = cell_of(high_m);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) join_close(vertex, first_[slot({x, y, z})], sets);
      }
    }
    std::uint32_t& first = first_[slot(cell_of(vertices_m_[vertex]))];
    next_[vertex] = std::exchange(first, vertex);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};

  /// Moved by a part of a cube: coordinates in files are round, and would lie on its sides.
  Cell cell_of(const Vec3& point_m) const {
    const auto along = [&](double x_m) { return std::llround(std::floor(x_m / cell_m_ + 0.381966)); };
    return {along(point_m.x), along(point_m.y), along(point_m.z)};
  }
  std::size_t slot(const Cell& cell) const {  // two cells may share a slot: distance decides, not the slot
    return hash_values(static_cast<std::uint64_t>(cell[0]), cell[1], cell[2]) & (first_.size() - 1);
  }
  void join_close(std::uint32_t vertex, std::uint32_t other, DisjointSets& sets) const {
    for (; other != nobody; other = next_[other]) {
      if (glm::distance(vertices_m_[vertex], vertices_m_[other]) <= tolerance_m_) sets.join(vertex, other);
    }
  }

  const std::vector<Vec3>& vertices_m_;
  double tolerance_m_;
  double cell_m_;
  std::vector<std::uint32_t> first_;  ///< in each slot
  std::vector<std::uint32_t> next_;   ///< behind each vertex in its slot
};

}  // namespace detail

inline WeldedVertices weld(const std::vector<Vec3>& vertices_m, double tolerance_m) {
  std::vector<Vec3> unsigned_zeros_m = vertices_m;
  for (Vec3& vertex : unsigned_zeros_m)
    vertex += Vec3(0.0);  // −0 is 0: they compare equal, so either might have stayed
  const detail::DistinctVertices distinct = detail::distinct_vertices(unsigned_zeros_m);
  DisjointSets sets(distinct.vertices_m.size());
  if (tolerance_m > 0.0) {
    detail::WeldGrid grid(distinct.vertices_m, tolerance_m);
    for (std::uint32_t index = 0; index < distinct.vertices_m.size(); ++index) grid.take(index, sets);
  }
  WeldedVertices welded;
  std::vector<std::uint32_t> new_of_distinct(distinct.vertices_m.size());
  welded.vertices_m.reserve(distinct.vertices_m.size());
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
