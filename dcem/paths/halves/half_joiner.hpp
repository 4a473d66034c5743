#pragma once
/// Two halves joined: every sequence of at most two mirrors and edges that a path between two ends may take.
///
/// With R₁ the image of the receiver in its mirror and T₂ that of the transmitter in its own, both points of a path
/// over two mirrors lie on the straight line from R₁ to T₂: so T₂ is in the cone of R₁ through the receiver's mirror.
/// Over a mirror and an edge the point on the edge is in that cone, and follows from the image and the other end in
/// closed form. What is left is looked up in both maps, each point at the end that must see it. The solver decides.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/wedge_method.hpp"

namespace dcem {

class HalfJoiner {
 public:
  /// The most of each, and of both together.
  struct Orders {
    int reflections = 2, diffractions = 1, interactions = 2;
  };

  HalfJoiner(const Scene& scene, const FacetOutlines& outlines, const Orders& orders)
      : scene_(scene), outlines_(outlines), orders_(orders) {}

  /// Calls `visit(sequence)`, from the receiver outwards, once for each.
  template <typename Visit>
  void for_each_sequence(const PathHalf& receiver, const PathHalf& transmitter, Visit&& visit) {
    sequence_.clear();
    visit(std::as_const(sequence_));
    const bool mirrors = orders_.reflections >= 1 && orders_.interactions >= 1;
    const bool edges = orders_.diffractions >= 1 && orders_.interactions >= 1;
    for (std::size_t layer = 0; layer < receiver.layers().size(); ++layer) {  // a facet is in the same one for both
      const Side own{receiver, receiver.layers()[layer]}, other{transmitter, transmitter.layers()[layer]};
      if (mirrors) single_mirrors(own, other, visit);
      if (edges) single_edges(own, other, visit);
    }
    if (orders_.interactions < 2) return;
    for (const HalfLayer& own : receiver.layers()) {
      for (const HalfLayer& other : transmitter.layers()) {
        const Side near{receiver, own}, far{transmitter, other};
        if (orders_.reflections >= 2) mirror_pairs(near, far, visit);
        if (mirrors && edges) mirror_and_edge(near, far, false, visit);
        if (mirrors && edges) mirror_and_edge(far, near, true, visit);
      }
    }
  }

 private:
  /// One end, and what it may see of the scenery or of what moves.
  struct Side {
    const PathHalf& half;
    const HalfLayer& layer;
  };

  /// Points this far beside a facet are left to the solver. Far above rounding.
  static constexpr float beside_m = 2e-3F;

  /// Where a straight way crosses the plane of a facet, strictly between its ends, on or beside the facet.
  std::optional<Vec3> crossing(FacetId facet, const Vec3& from_m, const Vec3& to_m) const {
    const Plane& plane = scene_.facet(facet).plane;
    const double from = signed_distance_m(plane, from_m), to = signed_distance_m(plane, to_m);
    if ((from > 0.0) == (to > 0.0) || from == to) return std::nullopt;
    const Vec3 point_m = from_m + from / (from - to) * (to_m - from_m);
    if (!outlines_.is_over(facet, point_m, beside_m)) return std::nullopt;
    return point_m;
  }

  /// Where a path between two points meets an edge, or a little beside.
  std::optional<Vec3> edge_point(WedgeId id, const Vec3& from_m, const Vec3& to_m) const {
    const Wedge& edge = scene_.wedge(id).edge;
    const EdgeLine line{edge.start_m, edge_direction(edge), edge_length_m(edge)};
    const double place_m = detail::place_between(from_m, line, to_m);
    if (!(place_m >= -beside_m && place_m <= line.length_m + beside_m)) return std::nullopt;
    return line.at(place_m);
  }

  template <typename First, typename Last, typename Visit>
  void offer(const Side& receiver, First first, const Vec3& first_m, const Side& transmitter, Last last,
             const Vec3& last_m, bool single, Visit& visit) {
    if (receiver.half.hides(scene_, outlines_, first, first_m)) return;
    if (transmitter.half.hides(scene_, outlines_, last, last_m)) return;
    sequence_.assign(1, first);
    if (!single) sequence_.emplace_back(last);
    visit(std::as_const(sequence_));
  }

  template <typename Visit>
  void single_mirrors(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const FacetId facet = receiver.layer.mirrors[at];
      if (!std::ranges::binary_search(transmitter.layer.mirrors, facet)) continue;
      const auto point_m = crossing(facet, receiver.layer.images_m[at], transmitter.half.position_m());
      if (point_m) offer(receiver, facet, *point_m, transmitter, facet, *point_m, true, visit);
    }
  }

  template <typename Visit>
  void single_edges(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (const WedgeId edge : receiver.layer.edges) {
      if (!std::ranges::binary_search(transmitter.layer.edges, edge)) continue;
      const auto point_m = edge_point(edge, receiver.half.position_m(), transmitter.half.position_m());
      if (point_m) offer(receiver, edge, *point_m, transmitter, edge, *point_m, true, visit);
    }
  }

  template <typename Visit>
  void mirror_pairs(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const FacetId near = receiver.layer.mirrors[at];
      const Vec3& image_m = receiver.layer.images_m[at];
      transmitter.layer.for_each_image_in(receiver.layer.cones[at], image_m, beside_m, [&](std::uint32_t other) {
        const FacetId far = transmitter.layer.mirrors[other];
        if (near == far) return;
        const auto far_m = crossing(far, transmitter.layer.images_m[other], image_m);
        if (!far_m) return;
        const auto near_m = crossing(near, image_m, *far_m);
        if (near_m) offer(receiver, near, *near_m, transmitter, far, *far_m, false, visit);
      });
    }
  }

  /// The mirror is that of `over`, the edge that of `beside`; `turned`: `over` is the transmitter.
  template <typename Visit>
  void mirror_and_edge(const Side& over, const Side& beside, bool turned, Visit& visit) {
    for (std::size_t at = 0; at < over.layer.mirrors.size(); ++at) {
      const FacetId facet = over.layer.mirrors[at];
      const Vec3& image_m = over.layer.images_m[at];
      beside.layer.for_each_edge_in(over.layer.cones[at], image_m, [&](std::uint32_t other) {
        const WedgeId edge = beside.layer.edges[other];
        const WorldWedge& wedge = scene_.wedge(edge);
        if (wedge.facets[0] == facet || wedge.facets[1] == facet) return;  // that is in the wedge's own terms
        const auto edge_m = edge_point(edge, beside.half.position_m(), image_m);
        if (!edge_m) return;
        const auto mirror_m = crossing(facet, image_m, *edge_m);
        if (!mirror_m || !faces(wedge.edge, *mirror_m - *edge_m)) return;
        if (turned) {
          offer(beside, edge, *edge_m, over, facet, *mirror_m, false, visit);
        } else {
          offer(over, facet, *mirror_m, beside, edge, *edge_m, false, visit);
        }
      });
    }
  }

  /// Whether a direction away from an edge may lie in its exterior; at grazing the solver decides.
  static bool faces(const Wedge& wedge, const Vec3& away_m) {
    const double azimuth = azimuth_rad(wedge, away_m);
    return azimuth <= wedge.exterior_angle_rad + 1e-6 || azimuth >= 2.0 * pi - 1e-6;
  }

  const Scene& scene_;
  const FacetOutlines& outlines_;
  Orders orders_;
  Sequence sequence_;
};

}  // namespace dcem
