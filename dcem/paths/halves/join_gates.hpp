#pragma once
/// What a path over known mirrors and edges must pass: whether its points lie on them, and whether its ends see them.
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/core/fetch.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/wedge_method.hpp"

namespace dcem {

class JoinGates {
 public:
  JoinGates(const Scene& scene, const FacetOutlines& outlines) : scene_(scene), outlines_(outlines) {}

  const Scene& scene() const { return scene_; }

  /// Elements that are soon asked about: in a large city each lies somewhere else in memory, and that takes longer than
  /// the questions. First the element …
  [[gnu::always_inline]] void fetch(FacetId facet) const {
    dcem::fetch(scene_.facet(facet));
    dcem::fetch(outlines_.of(facet).lift_m);
  }
  [[gnu::always_inline]] void fetch(WedgeId edge) const { dcem::fetch(scene_.wedge(edge)); }
  /// … and, when that has come, what belongs to it.
  [[gnu::always_inline]] void fetch_more(FacetId facet) const { dcem::fetch(outlines_.sides(facet)); }
  [[gnu::always_inline]] void fetch_more(WedgeId edge) const {
    for (const FacetId face : scene_.wedge(edge).facets) fetch(face);
  }

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

  /// Whether the end of a half surely cannot see a point on an element.
  bool hides(const PathHalf& half, SequenceElement element, const Vec3& point_m) const {
    return element.is_edge() ? half.hides(scene_, outlines_, element.edge(), point_m)
                             : half.hides(scene_, outlines_, element.mirror(), point_m);
  }

  /// Points this far beside a facet are left to the solver. Far above rounding.
  static constexpr double beside_m = 2e-3;

 private:
  const Scene& scene_;
  const FacetOutlines& outlines_;
};

}  // namespace dcem
