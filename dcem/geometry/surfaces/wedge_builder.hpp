#pragma once
/// From a surface mesh to its diffracting edges.
///
/// 1. Collect the sides where exactly two triangles of two facets meet, and those of one triangle only. 2. Group them
/// by their facets. 3. Join contiguous pieces that lie on one line. 4. Lay the line, find the faces' directions.
///
/// Where the line lies: vertices are rounded (cities to 0.1 mm), so none of several pieces runs exactly along a facet's
/// mean plane. A point of diffraction must lie on both mirrors, or fields jump where a reflection turns into a
/// diffraction.
/// * Two planes that cross at more than 10° (from flat or from folded shut): the edge is the planes' line of
///   intersection; its ends are the outermost vertices, moved onto it. All contiguous pieces on the same sides of both
///   facets are one edge, unless a vertex lies more than five planarity tolerances (5 mm, as far as a facet may stray
///   from its plane) off the line.
/// * Planes that cross at less, where rounding would carry the line away (1/sin 10° is 5.8): from welded vertex to
///   welded vertex. Free edges: the same, moved onto the facet's plane. Pieces are one edge as long as no vertex
///   lies more than two weld tolerances from the straight line between the edge's ends, which is what two vertices that
///   welding may have moved by one each can amount to.
///
/// `Wedge::stray_m` says how far the vertices are from the edge. Nothing depends on the order of triangles or their
/// winding. Cost: O(n log n) in the number of triangles, apart from rims of very many slight bends.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/geometry/surfaces/disjoint_sets.hpp"
#include "dcem/geometry/surfaces/edge_chains.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

/// All edges where exactly two triangles of two facets meet at more than 0.1° from flat, then all free edges; each kind
/// by its facets, then by start and end. None where more than two triangles meet. Edges of any exterior angle above
/// 180.1° are here; who searches picks. Needs the mesh's vertices, triangles and facets, with the vertices of each
/// triangle ascending; `settings` are those with which the mesh was built.
std::vector<Wedge> build_wedges(const SurfaceMesh& mesh, const SurfaceSettings& settings = {});

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Two facets that differ from flat by less than this are a seam, no edge.
inline constexpr double flat_limit_rad = degrees_to_radians(0.1);

/// Sine of the angle above which two planes have a line of intersection worth using.
inline const double crossing_sine = std::sin(degrees_to_radians(10.0));

/// How far vertices may lie from an edge: off the planes' line, in planarity tolerances; off the chord, in weld
/// tolerances.
inline constexpr double line_tolerances = 5.0, chord_tolerances = 2.0;

/// Steps 3 and 4, facet pair by facet pair.
class WedgeBuilder {
 public:
  WedgeBuilder(const SurfaceMesh& mesh, const SurfaceSettings& settings)
      : mesh_(mesh),
        side_tolerance_m_(settings.weld_tolerance_m),
        line_tolerance_m_(line_tolerances * settings.planarity_tolerance_m),
        chord_tolerance_m_(chord_tolerances * settings.weld_tolerance_m) {}

  std::vector<Wedge> build() {
    const EdgePieces pieces = edge_pieces(mesh_);
    wedges_.reserve(pieces.size());  // every wedge has a piece of its own
    for (auto first = pieces.begin(), last = first; first != pieces.end(); first = last) {
      while (last != pieces.end() && last->group() == first->group()) ++last;
      const std::size_t before = wedges_.size();
      add_group(std::span(first, last));
      std::sort(wedges_.begin() + static_cast<std::ptrdiff_t>(before), wedges_.end(), [](const auto& a, const auto& b) {
        return a.start_m != b.start_m ? lexicographic_less(a.start_m, b.start_m) : lexicographic_less(a.end_m, b.end_m);
      });
    }
    return std::move(wedges_);
  }

 private:
  const Plane& plane(std::uint32_t facet) const { return mesh_.facets[facet].plane; }
  const Vec3& vertex_m(std::uint32_t index) const { return mesh_.vertices_m[index]; }

  void add_group(std::span<const EdgePiece> pieces) {
    if (!pieces.front().is_free()) {
      const Vec3 crossing = glm::cross(plane(pieces.front().facets[0]).normal, plane(pieces.front().facets[1]).normal);
      const double sine = glm::length(crossing);
      if (sine >= crossing_sine) return add_on_planes(pieces, crossing / sine);
    }
    add_along_vertices(pieces);
  }

  // --- pieces that belong together ---

  /// Unit vector in face `face` of the pieces, across `direction`, towards the facet; zero where the plane has none.
  Vec3 into_face(std::span<const EdgePiece> pieces, std::size_t face, const Vec3& direction) const {
    const Plane& facet = plane(pieces.front().facets[face]);
    const Vec3 across = glm::cross(facet.normal, direction);
    const double length = glm::length(across);
    if (length < 0.5) return Vec3(0.0);
    double reach_m = 0.0;
    for (const EdgePiece& piece : pieces) {
      const double corner_m = glm::dot(vertex_m(piece.opposite[face]) - vertex_m(piece.a), across);
      if (std::abs(corner_m) > std::abs(reach_m)) reach_m = corner_m;
    }
    if (std::abs(reach_m) <= side_tolerance_m_) {  // rounding may have tipped a sliver over: where is its facet?
      reach_m = glm::dot(facet.point_m - vertex_m(pieces.front().a), across);
    }
    return (reach_m < 0.0 ? -1.0 : 1.0) / length * across;
  }

  /// Calls `visit` for each set of pieces connected through vertices where they lie on the same side of their facets;
  /// `chains`: only through vertices of exactly two pieces. The sides refer to `direction_of_piece`.
  template <typename DirectionOfPiece, typename Visit>
  void for_each_connected(std::span<const EdgePiece> pieces, bool chains, DirectionOfPiece&& direction_of_piece,
                          Visit&& visit) const {
    if (pieces.size() == 1) return visit(pieces);
    std::vector<std::array<Vec3, 2>> into;
    for (const EdgePiece& piece : pieces) {
      const Vec3 along = direction_of_piece(piece);
      const Vec3 first = into_face({&piece, 1}, 0, along);
      into.push_back({first, piece.is_free() ? first : into_face({&piece, 1}, 1, along)});
    }
    DisjointSets sets(pieces.size());
    for_each_vertex(piece_ends(pieces), [&](auto first, auto last) {
      if (chains && last - first != 2) return;
      for (auto one = first; one != last; ++one) {
        for (auto other = first; other != one; ++other) {
          const auto &a = into[one->second], &b = into[other->second];
          if (glm::dot(a[0], b[0]) > 0.0 && glm::dot(a[1], b[1]) > 0.0) sets.join(one->second, other->second);
        }
      }
    });
    std::vector<EdgePieces> members(pieces.size());
    for (std::uint32_t index = 0; index < pieces.size(); ++index) {
      members[sets.smallest(index)].push_back(pieces[index]);
    }
    for (const EdgePieces& set : members) {
      if (!set.empty()) visit(std::span(set));
    }
  }

  // --- edges on the line where two planes cross ---

  void add_on_planes(std::span<const EdgePiece> pieces, const Vec3& direction) {
    const auto along = [&](const EdgePiece&) { return direction; };
    for_each_connected(pieces, false, along, [&](std::span<const EdgePiece> set) {
      if (!add_on_line(set, direction)) add_along_vertices(set);
    });
  }

  /// False where a vertex is too far off the line, or the pieces make no length along it.
  bool add_on_line(std::span<const EdgePiece> pieces, const Vec3& direction) {
    std::uint32_t lowest = pieces.front().a, highest = lowest;
    double stray_m = 0.0;
    const Vec3 origin_m = vertex_m(lowest);
    const auto place_m = [&](std::uint32_t vertex) { return glm::dot(direction, vertex_m(vertex) - origin_m); };
    for (const EdgePiece& piece : pieces) {
      for (const std::uint32_t vertex : {piece.a, piece.b}) {
        if (place_m(vertex) < place_m(lowest)) lowest = vertex;
        if (place_m(vertex) > place_m(highest)) highest = vertex;
        stray_m = std::max(stray_m, glm::length(step_to_planes_m(piece, vertex)));
      }
    }
    if (stray_m > line_tolerance_m_ || place_m(highest) - place_m(lowest) <= side_tolerance_m_) return false;
    add_wedge(pieces, direction, vertex_m(lowest) + step_to_planes_m(pieces.front(), lowest),
              vertex_m(highest) + step_to_planes_m(pieces.front(), highest), stray_m);
    return true;
  }

  /// From a vertex to the nearest point of both planes.
  Vec3 step_to_planes_m(const EdgePiece& piece, std::uint32_t vertex) const {
    const Plane &first = plane(piece.facets[0]), &second = plane(piece.facets[1]);
    const double cosine = glm::dot(first.normal, second.normal);
    const Vec3 crossing = glm::cross(first.normal, second.normal);
    const double sine_squared = glm::dot(crossing, crossing);
    const double from_first_m = signed_distance_m(first, vertex_m(vertex));
    const double from_second_m = signed_distance_m(second, vertex_m(vertex));
    return ((cosine * from_second_m - from_first_m) / sine_squared) * first.normal +
           ((cosine * from_first_m - from_second_m) / sine_squared) * second.normal;
  }

  // --- edges from vertex to vertex ---

  void add_along_vertices(std::span<const EdgePiece> pieces) {
    const auto along = [&](const EdgePiece& piece) { return glm::normalize(vertex_m(piece.b) - vertex_m(piece.a)); };
    for_each_connected(pieces, true, along, [&](std::span<const EdgePiece> set) {
      const EdgeChain chain = edge_chain(set, mesh_.vertices_m);
      const std::vector<std::size_t> corners = chain_corners(chain, mesh_.vertices_m, chord_tolerance_m_);
      for (std::size_t index = 0; index + 1 < corners.size(); ++index) {
        add_chord(chain, corners[index], corners[index + 1]);
      }
    });
  }

  void add_chord(const EdgeChain& chain, std::size_t first, std::size_t last) {
    const EdgePiece& piece = chain.pieces[first];
    std::array<Vec3, 2> ends_m{vertex_m(chain.vertices[first]), vertex_m(chain.vertices[last])};
    if (piece.is_free()) {
      const Plane& facet = plane(piece.facets[0]);
      for (Vec3& end_m : ends_m) end_m -= signed_distance_m(facet, end_m) * facet.normal;
    }
    double stray_m = 0.0;
    for (std::size_t place = first; place <= last; ++place) {
      stray_m = std::max(stray_m, distance_to_segment_m(vertex_m(chain.vertices[place]), ends_m[0], ends_m[1]));
    }
    const std::span<const EdgePiece> part = std::span(chain.pieces).subspan(first, last - first);
    const Vec3 chord_m = ends_m[1] - ends_m[0];
    if (chord_m != Vec3(0.0)) add_wedge(part, glm::normalize(chord_m), ends_m[0], ends_m[1], stray_m);
  }

  // --- the frame of an edge ---

  void add_wedge(std::span<const EdgePiece> pieces, const Vec3& direction, const Vec3& start_m, const Vec3& end_m,
                 double stray_m) {
    const EdgePiece& piece = pieces.front();
    const Vec3 tangent = into_face(pieces, 0, direction);
    const Vec3 other = piece.is_free() ? tangent : into_face(pieces, 1, direction);
    if (tangent == Vec3(0.0) || other == Vec3(0.0)) return;  // a speck that stands upright on its facet's plane
    Wedge wedge{start_m, end_m, piece.facets, 2.0 * pi, tangent, glm::cross(direction, tangent), stray_m};
    const double turn = piece.is_free() ? -glm::dot(wedge.normal, plane(piece.facets[0]).normal)
                                        : glm::dot(wedge.normal, other);  // face n lies on the interior side of face 0
    if (turn > 0.0) {
      wedge.normal = -wedge.normal;
      std::swap(wedge.start_m, wedge.end_m);
    }
    if (!piece.is_free()) {
      wedge.exterior_angle_rad -= std::atan2(std::abs(glm::dot(wedge.normal, other)), glm::dot(tangent, other));
      if (wedge.exterior_angle_rad - pi <= flat_limit_rad) return;
    }
    wedges_.push_back(wedge);
  }

  const SurfaceMesh& mesh_;
  double side_tolerance_m_, line_tolerance_m_, chord_tolerance_m_;
  std::vector<Wedge> wedges_;
};

}  // namespace detail

inline std::vector<Wedge> build_wedges(const SurfaceMesh& mesh, const SurfaceSettings& settings) {
  return detail::WedgeBuilder(mesh, settings).build();
}

}  // namespace dcem
