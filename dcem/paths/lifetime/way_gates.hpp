#pragma once
/// Whether the points of a way surely stay on what they are on, or off what they are off, while ends and bodies move.
#include <algorithm>
#include <cmath>

#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/lifetime/facet_rims.hpp"
#include "dcem/paths/lifetime/vague_way.hpp"

namespace dcem {

/// A line crosses a flat polygon, and its ends stay on two sides of the plane: then it goes on crossing it as long as
/// it does not touch the rim, because the point at which it crosses the plane moves without a jump. The same holds of a
/// line that misses it.
class WayGates {
 public:
  WayGates(const VagueScene& vague, const FacetOutlines& outlines, const FacetRims& rims, const EdgeRules& rules)
      : vague_(vague), outlines_(outlines), rims_(rims), rules_(rules) {}

  /// Whether no path is ever over two elements, wherever its ends are: both are of one body, or of the scenery, and the
  /// mirror holds the edge, or all of it is in the solid of the edge or in the plane of one of its faces.
  bool never_meet(const Sequence& sequence) const {
    if (sequence.size() != 2 || sequence[0].is_edge() == sequence[1].is_edge()) return false;
    const std::size_t edge_at = sequence[0].is_edge() ? 0 : 1;
    const FacetId mirror = sequence[1 - edge_at].mirror();
    const WorldWedge& wedge = scene().wedge(sequence[edge_at].edge());
    if (scene().facet(mirror).body != wedge.body) return false;
    if (wedge.facets[0] == mirror || wedge.facets[1] == mirror) return true;
    return holds_now(mirror, sequence[edge_at].edge()) ||
           is_in_solid(wedge.edge, scene().hull_m(scene().facet(mirror)));
  }

  /// Whether surely no path takes the way, for what its points must be on and where its neighbours must be.
  bool are_shut(const VagueWay& way) const {
    for (std::size_t gate = 0; gate < way.mirror_count; ++gate) {
      if (misses(way.mirrors[gate])) return true;
    }
    if (way.mirror_count == 2 && bounces_in_place(way)) return true;
    if (!way.edge) return false;
    const EdgeGate& gate = *way.edge;
    if (turn_of(gate, 0) == Turn::inside || turn_of(gate, 1) == Turn::inside) return true;
    const bool outside = turn_of(gate, 0) == Turn::outside && turn_of(gate, 1) == Turn::outside;
    return rules_.shadow_only && outside && shadow_of(gate) == Shadow::lit;
  }

  /// Whether the points of a way that a path takes surely stay where they must be.
  bool stay_open(const Sequence& sequence, const VagueWay& way) const {
    for (std::size_t gate = 0; gate < way.mirror_count; ++gate) {
      if (!stays_on(way.mirrors[gate])) return false;
    }
    if (way.mirror_count == 2 && !bounces_surely(way)) return false;
    if (!way.edge) return true;
    const EdgeGate& gate = *way.edge;
    if (sequence.size() == 2 && !never_holds_edge(way.mirrors[0].facet, gate.edge)) return false;
    if (!stays_on_edge(gate) || !stays_outside(gate, 0) || !stays_outside(gate, 1)) return false;
    return !rules_.shadow_only || shadow_of(gate) == Shadow::dark;
  }

  /// How far triangles of a facet leave its plane.
  double stray_m(FacetId facet) const { return outlines_.of(facet).stray_m; }

  /// Whether the line stays off the rim of a facet where it may cross its plane.
  bool stays_off_rim(FacetId id, const VagueLine& line, const Share& part) const {
    const WorldFacet& facet = scene().facet(id);
    const double more_m = vague_.reach_m(facet.body, scene().hull_m(facet)) + outlines_.of(id).stray_m;
    const auto is_apart = [&](const Segment& side) {
      return stays_apart(line, part, more_m, [&](const Segment& way) { return distance_between_m(way, side); });
    };
    if (outlines_.of(id).fills_hull) {
      const std::span<const Vec3> hull_m = scene().hull_m(facet);
      for (std::size_t corner = 0; corner < hull_m.size(); ++corner) {
        if (!is_apart({hull_m[corner], hull_m[corner + 1 == hull_m.size() ? 0 : corner + 1]})) return false;
      }
      return true;
    }
    return std::ranges::all_of(rims_.of(id),
                               [&](const RimSide& side) { return is_apart(FacetRims::segment(scene(), side)); });
  }

 private:
  enum class Turn { unknown, inside, outside };
  enum class Shadow { unknown, lit, dark };
  const Scene& scene() const { return vague_.scene(); }

  bool misses(const MirrorGate& gate) const {
    const WorldFacet& facet = scene().facet(gate.facet);
    const double more_m = vague_.reach_m(facet.body, scene().hull_m(facet)) + outlines_.of(gate.facet).stray_m;
    const auto is_apart = [&](std::span<const Vec3> corners_m) {
      return stays_apart(gate.line, gate.part, more_m,
                         [&](const Segment& way) { return distance_to_polygon_m(way, corners_m, facet.plane.normal); });
    };
    if (is_apart(scene().hull_m(facet))) return true;
    if (outlines_.of(gate.facet).fills_hull) return false;
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      if (!is_apart(scene().corners_m(facet.first_triangle + index))) return false;
    }
    return true;
  }
  bool stays_on(const MirrorGate& gate) const {
    return gate.sides_are_sure && stays_off_rim(gate.facet, gate.line, gate.part);
  }

  /// The first mirror must come first along the line, and the two must not be patches of one wall (`lies_along`).
  bool bounces_surely(const VagueWay& way) const {
    const MirrorGate &first = way.mirrors[0], &second = way.mirrors[1];
    if (!(first.part.high < second.part.low)) return false;
    const WorldFacet &one = scene().facet(first.facet), &two = scene().facet(second.facet);
    if (std::abs(glm::dot(one.plane.normal, two.plane.normal)) < 0.98 && turns_little(one.body, two.body)) return true;
    return least_off_m(vague_, one, second.line, second.part) > 2.0 * scene().settings().weld_tolerance_m;
  }
  bool bounces_in_place(const VagueWay& way) const { return way.mirrors[0].part.low > way.mirrors[1].part.high; }
  /// 0.98 instead of the 0.995 of `lies_along` leaves 0.1 radians.
  bool turns_little(BodyId one, BodyId other) const {
    return one == other || vague_.turn(one) + vague_.turn(other) < 0.09;
  }

  /// The solid of an edge is convex; in the exterior a point must be 1e-9 m off both faces (`clear_of_faces`).
  static bool is_in_solid(const Wedge& edge, std::span<const Vec3> points_m) {
    const Vec2 along(std::cos(edge.exterior_angle_rad), std::sin(edge.exterior_angle_rad));
    const Vec3 other = along.y * edge.tangent - along.x * edge.normal;  // of face n, on the exterior side
    return std::all_of(points_m.begin(), points_m.end(), [&](const Vec3& point_m) {
      const Vec3 away_m = point_m - edge.start_m;
      return glm::dot(away_m, edge.normal) <= 0.5 * in_plane_guard_m &&
             glm::dot(away_m, other) <= 0.5 * in_plane_guard_m;
    });
  }
  /// `holds_edge` of the solver. Of one body, or of the scenery, it never changes.
  bool never_holds_edge(FacetId mirror, WedgeId id) const {
    const WorldFacet& facet = scene().facet(mirror);
    const WorldWedge& wedge = scene().wedge(id);
    if (facet.body == wedge.body) return !holds_now(mirror, id);
    const double tolerance_m = scene().settings().weld_tolerance_m + wedge.edge.stray_m + lifetime_guard_m;
    return std::max(off_m(facet, wedge, wedge.edge.start_m), off_m(facet, wedge, wedge.edge.end_m)) > tolerance_m;
  }
  double off_m(const WorldFacet& facet, const WorldWedge& wedge, const Vec3& point_m) const {
    const VaguePoint point{point_m, vague_.reach_m(wedge.body, std::array{point_m})};
    return std::abs(signed_distance_m(facet.plane, point_m)) - vague_.seen_moved_m(facet.body, point);
  }
  bool holds_now(FacetId mirror, WedgeId edge) const {
    return holds_edge(scene().facet(mirror).plane, scene().wedge(edge).edge, scene().settings().weld_tolerance_m);
  }

  bool stays_on_edge(const EdgeGate& gate) const {
    const VaguePoint &one = gate.unfolded.from, &two = gate.unfolded.to;
    if (!(-one.at_m.y > one.moved_m && two.at_m.y > two.moved_m)) return false;
    const double length_m = edge_length_m(scene().wedge(gate.edge).edge);
    const double place_m = gate.unfolded.at(-one.at_m.y / (two.at_m.y - one.at_m.y)).x;
    if (!(place_m > 0.0 && place_m < length_m)) return false;
    return std::ranges::all_of(std::array{0.0, length_m}, [&](double end) {
      const Vec3 end_m(end, 0.0, 0.0);
      return stays_apart(gate.unfolded, gate.part, 0.0,
                         [&](const Segment& part) { return distance_to_segment_m(end_m, part.from_m, part.to_m); });
    });
  }

  /// Where a neighbour is across the edge, as the edge sees it: x along face 0, y along its normal.
  Vec2 across(const EdgeGate& gate, std::size_t neighbour) const {
    const Wedge& edge = scene().wedge(gate.edge).edge;
    const Vec3 away_m = gate.neighbours[neighbour].at_m - edge.start_m;
    return {glm::dot(away_m, edge.tangent), glm::dot(away_m, edge.normal)};
  }
  /// How far a neighbour is from both faces, which go on for ever, and on which side of them.
  Turn turn_of(const EdgeGate& gate, std::size_t neighbour, double* margin_m = nullptr) const {
    const Wedge& edge = scene().wedge(gate.edge).edge;
    const Vec2 point = across(gate, neighbour);
    const auto to_face = [&](double angle_rad) {
      const Vec2 face(std::cos(angle_rad), std::sin(angle_rad));
      const double along = glm::dot(point, face);
      return along > 0.0 ? std::abs(point.x * face.y - point.y * face.x) : glm::length(point);
    };
    const double away_m = std::min(to_face(0.0), to_face(edge.exterior_angle_rad)) - lifetime_guard_m -
                          vague_.seen_moved_m(scene().wedge(gate.edge).body, gate.neighbours[neighbour]);
    if (margin_m != nullptr) *margin_m = away_m;
    if (!(away_m > 0.0)) return Turn::unknown;
    return in_exterior(edge, gate.neighbours[neighbour].at_m - edge.start_m) ? Turn::outside : Turn::inside;
  }
  /// The leg itself may end nearer to the edge than the neighbour, on a mirror: there the solver asks for 1e-9 m.
  bool stays_outside(const EdgeGate& gate, std::size_t neighbour) const {
    double margin_m = 0.0;
    if (turn_of(gate, neighbour, &margin_m) != Turn::outside) return false;
    return gate.shares_left[neighbour] * (margin_m + lifetime_guard_m) > 10.0 * in_plane_guard_m;
  }
  /// Whether the straight way between both neighbours, seen along the edge, surely passes the edge on its solid side.
  Shadow shadow_of(const EdgeGate& gate) const {
    const Wedge& edge = scene().wedge(gate.edge).edge;
    const BodyId body = scene().wedge(gate.edge).body;
    const Vec2 one = across(gate, 0), two = across(gate, 1);
    const double away_m = distance_to_segment_m(Vec3(0.0), Vec3(one, 0.0), Vec3(two, 0.0));
    const double moved_m =
        std::max(vague_.seen_moved_m(body, gate.neighbours[0]), vague_.seen_moved_m(body, gate.neighbours[1]));
    if (!(away_m > moved_m + lifetime_guard_m)) return Shadow::unknown;
    const double turn_rad = std::abs(azimuth_rad(edge, gate.neighbours[0].at_m - edge.start_m) -
                                     azimuth_rad(edge, gate.neighbours[1].at_m - edge.start_m));
    return turn_rad > pi ? Shadow::dark : Shadow::lit;
  }

  const VagueScene& vague_;
  const FacetOutlines& outlines_;
  const FacetRims& rims_;
  EdgeRules rules_;
};

}  // namespace dcem
