#pragma once
/// A triangle that stops a leg for sure: what stopped a leg a moment ago is asked first when the leg has moved a
/// little.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/memory/way_reach.hpp"
#include "dcem/paths/query/leg_filter.hpp"

namespace dcem {

/// A straight leg, how far each of its ends may have moved, and what it ignores: facets `own` at either end, and bodies
/// that are not there.
struct VagueLeg {
  Vec3 from_m, to_m;
  Drift from, to;
  std::span<const FacetId> own;
  IgnoredBodies ignored;
};

namespace detail {

/// Whether a point in the plane of a triangle is inside, by more than a margin.
inline bool is_well_inside(const std::array<Vec3, 3>& corners_m, const Vec3& normal, const Vec3& point_m,
                           double margin_m) {
  const Vec3 centre_m = (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0;
  for (std::size_t side = 0; side < 3; ++side) {
    const Vec3 &start = corners_m[side], across = glm::cross(normal, corners_m[(side + 1) % 3] - start);
    const double length = glm::length(across);
    if (!(length > 1e-6)) return false;  // of a sliver nothing is well inside
    const double turn = glm::dot(across, centre_m - start) < 0.0 ? -1.0 : 1.0;
    if (!(turn * glm::dot(across, point_m - start) > margin_m * length)) return false;
  }
  return true;
}

/// How far from where it crosses a plane a leg may meet what strays from the plane by at most `stray_m`; `apart_m`: how
/// far its ends are from the plane, together.
inline double grazing_reach_m(const VagueLeg& leg, double apart_m, double stray_m) {
  const double moved_m = leg.from.most_m() + leg.to.most_m();
  return stray_m * (glm::distance(leg.from_m, leg.to_m) + moved_m) / (apart_m - moved_m);
}

}  // namespace detail

/// Whether the facet of a triangle stops a leg wherever its ends are: it is opaque and none of those that the leg
/// ignores, and the leg crosses it well inside. Of a facet with holes or dents it is the triangle alone. What this says
/// yes to, `SceneTracer::follow_leg` finds blocked; the reverse does not hold.
inline bool surely_stops(const Scene& scene, const FacetOutlines& outlines, std::uint32_t triangle,
                         const VagueLeg& leg) {
  const FacetId id = scene.facet_of_triangle(triangle);
  const WorldFacet& facet = scene.facet(id);
  if (!facet.present || facet.transmits || leg.ignored[0] == facet.body || leg.ignored[1] == facet.body) return false;
  const FacetOutline& outline = outlines.of(id);
  const double clear_m = 2e-3 + 2.0 * outline.lift_m;
  const double from = signed_distance_m(facet.plane, leg.from_m), to = signed_distance_m(facet.plane, leg.to_m);
  if ((from > 0.0) == (to > 0.0)) return false;
  const double from_room_m = clear_m + leg.from.most_m(), to_room_m = clear_m + leg.to.most_m();
  if (!(std::abs(from) > from_room_m && std::abs(to) > to_room_m)) return false;
  const Vec3 point_m = leg.from_m + from / (from - to) * (leg.to_m - leg.from_m);
  const double reach_m = crossing_reach_m(facet.plane, leg.from_m, leg.from, leg.to_m, leg.to) +
                         detail::grazing_reach_m(leg, std::abs(from) + std::abs(to), outline.stray_m);
  const bool is_inside = outline.fills_hull ? outlines.is_over(id, point_m, -(clear_m + reach_m))
                                            : detail::is_well_inside(scene.corners_m(triangle), facet.plane.normal,
                                                                     point_m, clear_m + reach_m);
  if (!is_inside) return false;
  constexpr double along_cosine = 0.98;  // what lies along a mirror does not stop legs to it
  const double clear_of_own_m = std::max(0.05, 2.0 * scene.settings().weld_tolerance_m);
  return std::none_of(leg.own.begin(), leg.own.end(), [&](FacetId mirror) {
    if (mirror == id) return true;
    const Plane& plane = scene.facet(mirror).plane;
    return std::abs(glm::dot(facet.plane.normal, plane.normal)) >= along_cosine &&
           std::abs(signed_distance_m(plane, point_m)) <= clear_of_own_m + reach_m;
  });
}

}  // namespace dcem
