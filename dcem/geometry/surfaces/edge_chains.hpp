#pragma once
/// The sides of facets, and how contiguous ones are put together to straight edges.
#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/geometry/surfaces/side_order.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

/// A side that one facet shares with another, or with none.
struct EdgePiece {
  std::array<std::uint32_t, 2> facets{};    ///< ascending; the second is `no_facet` where free
  std::uint32_t a = 0, b = 0;               ///< vertices, a < b
  std::array<std::uint32_t, 2> opposite{};  ///< third corner of the triangle in each facet

  bool is_free() const { return facets[1] == no_facet; }
  /// The same for pieces of the same facets; free ones come last. There are fewer than 2^31 facets.
  std::uint64_t group() const {
    return (static_cast<std::uint64_t>(is_free()) << 63) | (static_cast<std::uint64_t>(facets[0]) << 32) | facets[1];
  }
};

using EdgePieces = std::vector<EdgePiece>;

/// The sides where exactly two triangles of two facets meet, and those of one triangle only (free); sorted by kind and
/// facets, then by vertices. Needs the vertices of each triangle ascending.
EdgePieces edge_pieces(const SurfaceMesh& mesh);

/// A polyline: piece k runs from vertex k to vertex k + 1. A closed one ends at the vertex where it starts.
struct EdgeChain {
  std::vector<std::uint32_t> vertices;
  EdgePieces pieces;
};

/// Puts pieces of which no vertex has more than two one after the other, from the end with the smaller index. A closed
/// chain starts where it is furthest from its smallest vertex: at a corner.
EdgeChain edge_chain(std::span<const EdgePiece> pieces, const std::vector<Vec3>& vertices_m);

/// Places in `chain.vertices` where the chain bends, its two ends included: between two of them no vertex strays more
/// than `tolerance_m` from their chord. Splits at the sure corners, then at the worst vertex until all is straight
/// (Douglas and Peucker 1973), then takes back the splits that turned out to be none, as in the middle of a side
/// parallel to the first chord.
std::vector<std::size_t> chain_corners(const EdgeChain& chain, const std::vector<Vec3>& vertices_m, double tolerance_m);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// One side of one triangle.
struct TriangleSide {
  std::uint32_t a = 0, b = 0, facet = 0, opposite = 0;
  bool same_place(const TriangleSide& other) const { return a == other.a && b == other.b; }
  friend auto operator<=>(const TriangleSide&, const TriangleSide&) = default;
};

inline std::vector<TriangleSide> triangle_sides(const SurfaceMesh& mesh) {
  return sorted_sides<TriangleSide>(mesh.vertices_m.size(), [&](auto&& visit) {
    for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
      const auto& [a, b, c] = mesh.triangles[index];
      const std::uint32_t facet = mesh.facet_of_triangle[index];
      visit(TriangleSide{a, b, facet, c});
      visit(TriangleSide{a, c, facet, b});
      visit(TriangleSide{b, c, facet, a});
    }
  });
}

/// A vertex of a piece, and the piece's place in its list.
using PieceEnd = std::pair<std::uint32_t, std::uint32_t>;

inline std::vector<PieceEnd> piece_ends(std::span<const EdgePiece> pieces) {
  std::vector<PieceEnd> ends;
  ends.reserve(2 * pieces.size());
  for (std::uint32_t index = 0; index < pieces.size(); ++index) {
    ends.insert(ends.end(), {{pieces[index].a, index}, {pieces[index].b, index}});
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// Calls `visit(first, last)` for the ends at each vertex.
template <typename Visit>
void for_each_vertex(const std::vector<PieceEnd>& ends, Visit&& visit) {
  for (auto first = ends.begin(), last = first; first != ends.end(); first = last) {
    while (last != ends.end() && last->first == first->first) ++last;
    visit(first, last);
  }
}

/// Of equally far vertices the smallest.
inline std::uint32_t furthest_vertex(const std::vector<PieceEnd>& ends, std::uint32_t from,
                                     const std::vector<Vec3>& vertices_m) {
  std::uint32_t furthest = from;
  double furthest_m = 0.0;
  for (const PieceEnd& end : ends) {
    const double distance_m = glm::distance(vertices_m[from], vertices_m[end.first]);
    if (distance_m > furthest_m) {
      furthest = end.first;
      furthest_m = distance_m;
    }
  }
  return furthest;
}

inline std::uint32_t chain_start(const std::vector<PieceEnd>& ends, const std::vector<Vec3>& vertices_m) {
  for (auto end = ends.begin(); end != ends.end(); ++end) {
    const bool before = end != ends.begin() && (end - 1)->first == end->first;
    const bool after = end + 1 != ends.end() && (end + 1)->first == end->first;
    if (!before && !after) return end->first;
  }
  return furthest_vertex(ends, ends.front().first, vertices_m);
}

/// Places that no straight edge can pass, and the two ends: between pieces of ten tolerances or more that turn by more
/// than 30 degrees a vertex is 2.6 tolerances off its neighbours' chord at least, and two could be taken up. They keep
/// the cost of a rim with very many corners down.
inline std::vector<std::size_t> sure_corners(const EdgeChain& chain, const std::vector<Vec3>& vertices_m,
                                             double tolerance_m) {
  constexpr double turn_cosine = 0.866;
  std::vector<std::size_t> corners{0};
  for (std::size_t place = 1; place < chain.pieces.size(); ++place) {
    const Vec3& here_m = vertices_m[chain.vertices[place]];
    const Vec3 before_m = here_m - vertices_m[chain.vertices[place - 1]];
    const Vec3 after_m = vertices_m[chain.vertices[place + 1]] - here_m;
    const double first_m = glm::length(before_m), second_m = glm::length(after_m);
    if (std::min(first_m, second_m) >= 10.0 * tolerance_m &&
        glm::dot(before_m, after_m) < turn_cosine * first_m * second_m) {
      corners.push_back(place);
    }
  }
  corners.push_back(chain.pieces.size());
  return corners;
}

/// The vertex between two places of a chain that strays most from their chord, where it strays too far.
inline std::optional<std::size_t> bend_between(const EdgeChain& chain, const std::vector<Vec3>& vertices_m,
                                               std::size_t first, std::size_t last, double tolerance_m) {
  const auto at = [&](std::size_t place) { return vertices_m[chain.vertices[place]]; };
  std::optional<std::size_t> bend;
  for (std::size_t place = first + 1; place < last; ++place) {
    const double stray_m = distance_to_segment_m(at(place), at(first), at(last));
    if (stray_m > tolerance_m) {
      tolerance_m = stray_m;
      bend = place;
    }
  }
  return bend;
}

}  // namespace detail

inline EdgePieces edge_pieces(const SurfaceMesh& mesh) {
  const std::vector<detail::TriangleSide> sides = detail::triangle_sides(mesh);
  EdgePieces pieces;
  pieces.reserve(sides.size());
  for (auto first = sides.begin(), last = first; first != sides.end(); first = last) {
    while (last != sides.end() && last->same_place(*first)) ++last;
    const detail::TriangleSide& second = *(last - 1);
    if (last - first == 1) {
      pieces.push_back({{first->facet, no_facet}, first->a, first->b, {first->opposite, first->opposite}});
    } else if (last - first == 2 && first->facet != second.facet) {
      pieces.push_back({{first->facet, second.facet}, first->a, first->b, {first->opposite, second.opposite}});
    }
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.group() < b.group(); });
  return pieces;
}

inline EdgeChain edge_chain(std::span<const EdgePiece> pieces, const std::vector<Vec3>& vertices_m) {
  if (pieces.size() == 1) return {{pieces[0].a, pieces[0].b}, {pieces[0]}};
  const std::vector<detail::PieceEnd> ends = detail::piece_ends(pieces);
  EdgeChain chain{{detail::chain_start(ends, vertices_m)}, {}};
  std::vector<char> used(pieces.size(), 0);
  while (chain.pieces.size() < pieces.size()) {
    const std::uint32_t here = chain.vertices.back();
    auto next = std::lower_bound(ends.begin(), ends.end(), detail::PieceEnd{here, 0U});
    while (next != ends.end() && next->first == here && used[next->second]) ++next;
    DCEM_ASSERT(next != ends.end() && next->first == here);
    used[next->second] = 1;
    const EdgePiece& piece = pieces[next->second];
    chain.vertices.push_back(piece.a == here ? piece.b : piece.a);
    chain.pieces.push_back(piece);
  }
  return chain;
}

inline std::vector<std::size_t> chain_corners(const EdgeChain& chain, const std::vector<Vec3>& vertices_m,
                                              double tolerance_m) {
  std::vector<std::size_t> corners = detail::sure_corners(chain, vertices_m, tolerance_m);
  const auto bend_after = [&](std::size_t index, std::size_t count) {
    return detail::bend_between(chain, vertices_m, corners[index], corners[index + count], tolerance_m);
  };
  for (std::size_t index = 0; index + 1 < corners.size();) {
    if (const auto bend = bend_after(index, 1)) {
      corners.insert(corners.begin() + static_cast<std::ptrdiff_t>(index) + 1, *bend);
    } else {
      ++index;
    }
  }
  for (std::size_t index = 0; index + 2 < corners.size();) {
    const bool closes = chain.vertices[corners[index]] == chain.vertices[corners[index + 2]];
    if (closes || bend_after(index, 2)) {
      ++index;
    } else {
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(index) + 1);
    }
  }
  return corners;
}

}  // namespace dcem
