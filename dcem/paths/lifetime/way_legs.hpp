#pragma once
/// Whether the legs of a way surely stay free, or one of them surely stays blocked, while ends and bodies move.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/inset.hpp"
#include "dcem/paths/lifetime/leg_crossings.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
template <typename Index>
class WayLegs {
 public:
  WayLegs(const VagueScene& vague, const SceneTracer<Index>& tracer, const WayGates& gates,
          const IgnoredBodies& ignored, int max_transmissions)
      : vague_(vague),
        tracer_(tracer),
        crossings_(vague, gates),
        ignored_(ignored),
        max_transmissions_(static_cast<std::size_t>(max_transmissions)) {}

  /// Whether nothing comes near any leg, but for sheets that it surely goes on crossing. The line of a leg is followed
  /// beyond a mirror as far as the point on the mirror may run along it; what is behind the mirror there does not
  /// count.
  bool stay_free(const VagueWay& way) const {
    for (std::size_t leg = 0; leg < way.leg_count; ++leg) {
      if (comes_near(way.legs[leg])) return false;
    }
    return !way.edge || !touches_third(*way.edge, way.legs[0].edges[1] ? way.legs[0].line.to : way.legs[1].line.to);
  }

  /// Whether something opaque surely stands in a leg, or too many sheets in all, or a third facet lies on the edge
  /// wherever the point on it is.
  bool stay_blocked(const VagueWay& way) const {
    std::size_t sheets = 0;
    for (std::size_t leg = 0; leg < way.leg_count; ++leg) {
      if (is_stopped(way.legs[leg], sheets) || sheets > max_transmissions_) return true;
    }
    return way.edge && lies_on_third(*way.edge);
  }

  /// How far an end may move before it may touch anything: then it would be mounted on it.
  double clearance_m(const Vec3& end_m, double most_m) const {
    double least_m = most_m;
    const double tolerance_m = scene().settings().weld_tolerance_m + lifetime_guard_m;
    tracer_.index().overlapping(
        inflated(Aabb<double>{end_m, end_m}, 2.0 * most_m + tolerance_m), [&](std::uint32_t triangle) {
          if (!counts(scene().facet(scene().facet_of_triangle(triangle)))) return;
          const double share = scene().facet(scene().facet_of_triangle(triangle)).body.value == 0 ? 1.0 : 0.5;
          least_m =
              std::min(least_m, share * (distance_to_triangle_m(scene().corners_m(triangle), end_m) - tolerance_m));
        });
    return std::max(0.0, least_m);
  }

 private:
  const Scene& scene() const { return vague_.scene(); }
  bool counts(const WorldFacet& facet) const { return facet.present && !tracer_.is_ignored(facet.body, ignored_); }

  bool comes_near(const VagueStretch& leg) const {
    const Segment widest = leg.line.segment(leg.widest());
    const double moved_m = leg.line.most_moved_m(leg.widest()) + 2.0 * lifetime_guard_m;
    const double room_m = moved_m + vague_.most_reach_m(widest, moved_m);
    bool is_near = !(room_m < 1e6);
    std::vector<FacetId> sheets;
    tracer_.index().visit([&](const Aabb<double>& box) { return !is_near && meets_box(widest, inflated(box, room_m)); },
                          [&](std::uint32_t triangle) {
                            if (is_near || !may_touch(leg, triangle)) return;
                            const FacetId id = scene().facet_of_triangle(triangle);
                            is_near = !passes(id);
                            if (!is_near && std::find(sheets.begin(), sheets.end(), id) == sheets.end())
                              sheets.push_back(id);
                          });
    return is_near || !crosses_all(leg, sheets);
  }
  /// Whether legs may cross a facet.
  bool passes(FacetId id) const { return scene().facet(id).transmits && max_transmissions_ > 0; }
  /// Whether sheets near a leg surely are and stay crossed, one after another.
  bool crosses_all(const VagueStretch& leg, std::span<const FacetId> sheets) const {
    std::vector<LegCrossing> crossed;
    return std::all_of(sheets.begin(), sheets.end(), [&](FacetId id) {
      return tracer_.meets(id, leg.line.from.at_m, leg.line.to.at_m) && crossings_.add_sheet(leg, id, crossed);
    });
  }

  bool may_touch(const VagueStretch& leg, std::uint32_t triangle) const {
    const FacetId id = scene().facet_of_triangle(triangle);
    const WorldFacet& facet = scene().facet(id);
    if (!counts(facet) || LegCrossings::is_own(scene(), leg, id)) return false;
    const std::array<Vec3, 3> corners_m = scene().corners_m(triangle);
    detail::InsetOutline part;
    part.assign(corners_m);
    for (const auto& mirror : leg.mirrors) {
      if (mirror && !keep_before(*mirror, facet.body, part)) return false;
    }
    const Vec3 across = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double size = glm::length(across);
    const Vec3 normal = size > 0.0 ? across / size : facet.plane.normal;
    return !stays_apart(leg.line, leg.widest(), vague_.reach_m(facet.body, corners_m),
                        [&](const Segment& way) { return distance_to_polygon_m(way, part.corners(), normal); });
  }
  /// Leaves what is, or may come, before a mirror, and what lies along it; false where that is nothing.
  bool keep_before(const LegMirror& mirror, BodyId body, detail::InsetOutline& part) const {
    const WorldFacet& facet = scene().facet(mirror.facet);
    double slack_m = scene().settings().weld_tolerance_m + lifetime_guard_m;
    if (facet.body != body) {
      double moved_m = 0.0;
      for (const Vec3& corner_m : part.corners()) {
        moved_m =
            std::max(moved_m, vague_.seen_moved_m(facet.body, {corner_m, vague_.reach_m(body, std::array{corner_m})}));
      }
      slack_m += moved_m;
    }
    const Vec3 inward = mirror.side * facet.plane.normal;
    return part.keep(inward, glm::dot(inward, facet.plane.point_m) - slack_m);
  }

  /// Of the two points a leg ends at on an edge it is the one on the edge that third facets must stay away from.
  bool touches_third(const EdgeGate& gate, const VaguePoint& point) const {
    const WorldWedge& wedge = scene().wedge(gate.edge);
    const Segment part = part_of(gate);
    const double tolerance_m = scene().settings().weld_tolerance_m + wedge.edge.stray_m + lifetime_guard_m;
    const double own_m = vague_.reach_m(wedge.body, std::array{part.from_m, part.to_m});
    const double near_m = point.moved_m + own_m + tolerance_m, reach_m = near_m + vague_.most_reach_m(part, near_m);
    bool is_near = !(reach_m < 1e6);
    if (is_near) return true;
    tracer_.index().overlapping(inflated(Aabb<double>{point.at_m, point.at_m}, reach_m), [&](std::uint32_t triangle) {
      const FacetId id = scene().facet_of_triangle(triangle);
      if (is_near || id == wedge.facets[0] || id == wedge.facets[1] || !counts(scene().facet(id))) return;
      const BodyId body = scene().facet(id).body;
      const std::array<Vec3, 3> corners_m = scene().corners_m(triangle);
      const bool together = body == wedge.body;  // they do not move against each other
      const double moved_m = together ? 0.0 : own_m + vague_.reach_m(body, corners_m);
      is_near = !(distance_to_polygon_m(part, corners_m, normal_of(triangle)) > tolerance_m + moved_m);
    });
    return is_near;
  }
  /// Within reach of one triangle at both ends of where the point may be, and so in between. They must move together.
  bool lies_on_third(const EdgeGate& gate) const {
    const WorldWedge& wedge = scene().wedge(gate.edge);
    const Segment part = part_of(gate);
    const double reach_m = 0.999 * (scene().settings().weld_tolerance_m + wedge.edge.stray_m) - lifetime_guard_m;
    bool found = false;
    tracer_.index().overlapping(inflated(Aabb<double>{part.from_m, part.from_m}, reach_m), [&](std::uint32_t triangle) {
      const FacetId id = scene().facet_of_triangle(triangle);
      if (found || id == wedge.facets[0] || id == wedge.facets[1] || !counts(scene().facet(id))) return;
      if (scene().facet(id).body != wedge.body) return;
      const std::array<Vec3, 3> corners_m = scene().corners_m(triangle);
      found = distance_to_triangle_m(corners_m, part.from_m) <= reach_m &&
              distance_to_triangle_m(corners_m, part.to_m) <= reach_m;
    });
    return found;
  }
  Segment part_of(const EdgeGate& gate) const {
    const Wedge& edge = scene().wedge(gate.edge).edge;
    const Vec3 along = edge_direction(edge);
    return {edge.start_m + gate.place_m.low * along, edge.start_m + gate.place_m.high * along};
  }
  Vec3 normal_of(std::uint32_t triangle) const {
    const std::array<Vec3, 3> corners_m = scene().corners_m(triangle);
    const Vec3 across = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double size = glm::length(across);
    return size > 0.0 ? across / size : scene().facet(scene().facet_of_triangle(triangle)).plane.normal;
  }

  /// Counts sheets that are surely crossed where nothing opaque surely stands in the leg.
  bool is_stopped(const VagueStretch& leg, std::size_t& sheets) const {
    if (!(leg.start.high + 1e-9 < leg.end.low)) return false;
    const Segment sure = leg.line.segment({leg.start.high, leg.end.low});
    if (!(glm::distance(sure.from_m, sure.to_m) > lifetime_guard_m)) return false;
    std::vector<LegCrossing> crossed;
    const auto stops = [&](std::uint32_t triangle) {
      const FacetId id = scene().facet_of_triangle(triangle);
      if (!passes(id)) return crossings_.crosses(leg, id).has_value();
      crossings_.add_sheet(leg, id, crossed);
      return false;
    };
    TraversalCounters counters;
    if (tracer_.any_triangle_between(sure.from_m, sure.to_m, {}, {}, ignored_, stops, counters)) return true;
    sheets += crossed.size();
    return false;
  }

  const VagueScene& vague_;
  const SceneTracer<Index>& tracer_;
  LegCrossings crossings_;
  IgnoredBodies ignored_;
  std::size_t max_transmissions_;
};

}  // namespace dcem
