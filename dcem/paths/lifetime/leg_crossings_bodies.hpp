#pragma once
/// Bodies of leg_crossings.hpp.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/lifetime/leg_crossings.hpp"

namespace dcem {

DCEM_INLINE bool LegCrossings::is_own(const Scene& scene, const VagueStretch& leg, FacetId id) {
  for (std::size_t end = 0; end < 2; ++end) {
    if (leg.mirrors[end] && leg.mirrors[end]->facet == id) return true;
    if (!leg.edges[end]) continue;
    const auto& faces = scene.wedge(*leg.edges[end]).facets;
    if (faces[0] == id || faces[1] == id) return true;
  }
  return false;
}

DCEM_INLINE std::optional<Share> LegCrossings::crosses(const VagueStretch& leg, FacetId id) const {
  if (is_own(scene(), leg, id)) return std::nullopt;
  const Share part = crossing_part(leg.line, id);
  if (!(part.low > leg.start.high && part.high < leg.end.low)) return std::nullopt;
  if (!gates_.stays_off_rim(id, leg.line, part) || may_be_ignored(leg, scene().facet(id), part)) return std::nullopt;
  return part;
}

DCEM_INLINE bool LegCrossings::add_sheet(const VagueStretch& leg, FacetId id, std::vector<LegCrossing>& crossed) const {
  const auto is_it = [&](const LegCrossing& other) { return other.facet == id; };
  if (std::ranges::any_of(crossed, is_it)) return true;
  const std::optional<Share> part = crosses(leg, id);
  if (!part) return false;
  const auto apart = [&](const LegCrossing& other) { return are_apart(leg.line, {id, *part}, other); };
  if (!std::ranges::all_of(crossed, apart)) return false;
  crossed.push_back({id, *part});
  return true;
}

DCEM_INLINE Share LegCrossings::crossing_part(const VagueLine& line, FacetId id) const {
  const WorldFacet& facet = scene().facet(id);
  const double a_m = signed_distance_m(facet.plane, line.from.at_m);
  const double b_m = signed_distance_m(facet.plane, line.to.at_m);
  const double stray_m = gates_.stray_m(id) + lifetime_guard_m;
  const double a_moved_m = vague_.seen_moved_m(facet.body, line.from) + stray_m;
  const double b_moved_m = vague_.seen_moved_m(facet.body, line.to) + stray_m;
  Share part{0.0, 1.0};
  const bool are_off = std::abs(a_m) > a_moved_m && std::abs(b_m) > b_moved_m;
  if (are_off && (a_m > 0.0) != (b_m > 0.0)) {
    part = crossing_share(std::abs(a_m), a_moved_m, std::abs(b_m), b_moved_m);
  }
  const std::span<const Vec3> hull_m = scene().hull_m(facet);
  cut_to_points(line, hull_m, vague_.reach_m(facet.body, hull_m) + stray_m, part);
  return part;
}

DCEM_INLINE bool LegCrossings::may_be_parallel(const WorldFacet& one, const WorldFacet& other) const {
  const bool is_tilted = std::abs(glm::dot(one.plane.normal, other.plane.normal)) < 0.98;
  return !(is_tilted && (one.body == other.body || vague_.turn(one.body) + vague_.turn(other.body) < 0.09));
}

DCEM_INLINE bool LegCrossings::may_be_ignored(const VagueStretch& leg, const WorldFacet& facet,
                                              const Share& part) const {
  const auto lies_along_own = [&](FacetId id) {
    const WorldFacet& own = scene().facet(id);
    if (!may_be_parallel(own, facet)) return false;
    return !(least_off_m(vague_, own, leg.line, part) > 2.0 * scene().settings().weld_tolerance_m);
  };
  for (std::size_t end = 0; end < 2; ++end) {
    if (leg.mirrors[end] && lies_along_own(leg.mirrors[end]->facet)) return true;
    if (!leg.edges[end]) continue;
    const auto& faces = scene().wedge(*leg.edges[end]).facets;
    if (lies_along_own(faces[0]) || lies_along_own(faces[1])) return true;
  }
  return false;
}

DCEM_INLINE bool LegCrossings::are_apart(const VagueLine& line, const LegCrossing& one,
                                         const LegCrossing& other) const {
  const double between = std::max(one.part.low - other.part.high, other.part.low - one.part.high);
  if (!(between > 0.0)) return false;
  const WorldFacet &first = scene().facet(one.facet), &second = scene().facet(other.facet);
  if (!may_be_parallel(first, second)) return true;
  return std::min(across_m(line, first), across_m(line, second)) * between > 2.0 * scene().settings().weld_tolerance_m;
}

DCEM_INLINE double LegCrossings::across_m(const VagueLine& line, const WorldFacet& facet) const {
  return std::abs(signed_distance_m(facet.plane, line.from.at_m) - signed_distance_m(facet.plane, line.to.at_m)) -
         vague_.seen_moved_m(facet.body, line.from) - vague_.seen_moved_m(facet.body, line.to);
}

}  // namespace dcem
