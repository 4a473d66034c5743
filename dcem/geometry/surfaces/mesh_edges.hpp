#pragma once
/// Edges of a mesh, sorted by place, and what follows from them: which shells enclose something.
///
/// A sorted list treats edges of one, two and many triangles alike; city meshes have them all.
#include <algorithm>
#include <compare>
#include <cstdint>
#include <limits>
#include <vector>

#include "dcem/geometry/surfaces/disjoint_sets.hpp"
#include "dcem/geometry/surfaces/mesh_cleaning.hpp"
#include "dcem/geometry/surfaces/side_order.hpp"

namespace dcem {

/// One side of one triangle; a < b.
struct MeshEdge {
  std::uint32_t a = 0, b = 0, triangle = 0;
  bool same_place(const MeshEdge& other) const { return a == other.a && b == other.b; }
  friend auto operator<=>(const MeshEdge&, const MeshEdge&) = default;
};

class MeshEdges {
 public:
  explicit MeshEdges(const CleanMesh& mesh) {
    edges_ = detail::sorted_sides<MeshEdge>(mesh.vertices_m.size(), [&](auto&& visit) {
      for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
        const auto& [a, b, c] = mesh.triangles[index].vertices;
        visit(MeshEdge{a, b, index});
        visit(MeshEdge{a, c, index});
        visit(MeshEdge{b, c, index});
      }
    });
  }

  /// Calls `visit(first, last)` for the triangles' sides at each place: one for an open edge, two where two triangles
  /// meet.
  template <typename Visit>
  void for_each_place(Visit&& visit) const {
    for (auto first = edges_.begin(); first != edges_.end();) {
      auto last = first;
      while (last != edges_.end() && last->same_place(*first)) ++last;
      visit(first, last);
      first = last;
    }
  }

 private:
  std::vector<MeshEdge> edges_;
};

/// Connected sets of triangles that enclose something. A shell encloses where all its edges join two triangles. It
/// still encloses what is above its foot where its only open edges are there: houses are often drawn without a floor.
struct EnclosingShells {
  std::vector<std::uint32_t> shell_of_triangle;  ///< counted from 1; 0: none
  std::vector<double> foot_m;                    ///< lowest z of each shell; entry 0 is shell 1
  std::vector<bool> stands;                      ///< whether it is open at the foot
  std::size_t closed = 0;                        ///< shells without open edges
  std::size_t standing = 0;                      ///< shells that are open at the foot
};

EnclosingShells enclosing_shells(const CleanMesh& mesh, const MeshEdges& edges, double tolerance_m);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// What the edges and corners of a connected set of triangles tell.
struct ShellFacts {
  double foot_m = std::numeric_limits<double>::infinity();
  double top_m = -std::numeric_limits<double>::infinity();
  bool leaks = false;   ///< a crowded edge, or an open one above the foot
  bool stands = false;  ///< open at the foot
};

/// Facts of each connected set, at the index of its smallest triangle.
inline std::vector<ShellFacts> shell_facts(const CleanMesh& mesh, const MeshEdges& edges, DisjointSets& shells,
                                           double tolerance_m) {
  std::vector<ShellFacts> facts(mesh.triangles.size());
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    ShellFacts& shell = facts[shells.smallest(index)];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      shell.foot_m = std::min(shell.foot_m, mesh.corner_m(index, corner).z);
      shell.top_m = std::max(shell.top_m, mesh.corner_m(index, corner).z);
    }
  }
  edges.for_each_place([&](auto first, auto last) {
    ShellFacts& shell = facts[shells.smallest(first->triangle)];
    const double edge_top_m = std::max(mesh.vertices_m[first->a].z, mesh.vertices_m[first->b].z);
    const bool open = last - first == 1, at_foot = edge_top_m <= shell.foot_m + tolerance_m;
    shell.leaks = shell.leaks || last - first > 2 || (open && !at_foot);
    shell.stands = shell.stands || (open && at_foot);
  });
  return facts;
}

}  // namespace detail

inline EnclosingShells enclosing_shells(const CleanMesh& mesh, const MeshEdges& edges, double tolerance_m) {
  DisjointSets shells(mesh.triangles.size());
  edges.for_each_place([&](auto first, auto last) {
    for (auto edge = first; edge != last; ++edge) shells.join(first->triangle, edge->triangle);
  });
  const std::vector<detail::ShellFacts> facts = detail::shell_facts(mesh, edges, shells, tolerance_m);
  EnclosingShells result;
  result.shell_of_triangle.resize(mesh.triangles.size(), 0);
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const std::uint32_t first = shells.smallest(index);
    const detail::ShellFacts& shell = facts[first];
    if (shell.leaks || !(shell.top_m > shell.foot_m + tolerance_m)) continue;  // a flat sheet encloses nothing
    if (first == index) {
      result.foot_m.push_back(shell.foot_m);
      result.stands.push_back(shell.stands);
      ++(shell.stands ? result.standing : result.closed);
    }
    result.shell_of_triangle[index] =
        first == index ? static_cast<std::uint32_t>(result.foot_m.size()) : result.shell_of_triangle[first];
  }
  return result;
}

}  // namespace dcem
