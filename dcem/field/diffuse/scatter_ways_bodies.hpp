#pragma once
/// Bodies of scatter_ways.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/field/diffuse/scatter_ways.hpp"
#include "dcem/paths/query/foliage_length.hpp"

namespace dcem {

DCEM_INLINE ScatterWays::ScatterWays(const Scene& scene, const LinkEnd& transmitter, const LinkEnd& receiver)
    : scene_(scene), transmitter_(transmitter), receiver_(receiver) {
  ways_.emplace_back().path.interactions.push_back({InteractionKind::scattering, {}, Vec3(0.0)});
}

DCEM_INLINE std::uint32_t ScatterWays::number_of(const PartList& parts, std::size_t part) {
  const auto [first, second] = parts.crossed(part);
  if (first == 0 && second == 0) return 1;
  Way way;
  add_sheets(parts.sheets(first), way);
  way.place = way.path.interactions.size();
  way.path.interactions.push_back({InteractionKind::scattering, {}, Vec3(0.0)});
  add_sheets(parts.sheets(second), way);
  ways_.push_back(std::move(way));
  return static_cast<std::uint32_t>(ways_.size());
}

DCEM_INLINE const Path& ScatterWays::over(std::uint32_t number, FacetId facet, const Vec3& point_m) {
  Way& way = ways_[number - 1];
  way.path.interactions[way.place].facet = facet;
  way.path.interactions[way.place].point_m = point_m;
  const Vec3 &from_m = transmitter_.position_m, &to_m = receiver_.position_m;
  way.path.length_m = glm::distance(from_m, point_m) + glm::distance(point_m, to_m);
  // Where sheets cross each other their order changes from point to point, and with it what they let pass.
  if (way.sheets.size() > 1) put_in_order(way.path);
  if (!scene_.foliage().empty()) {
    const IgnoredBodies ignored{transmitter_.ignored_body, receiver_.ignored_body};
    way.path.foliage.clear();
    add_foliage_along(scene_, from_m, point_m, ignored, way.path.foliage);
    add_foliage_along(scene_, point_m, to_m, ignored, way.path.foliage);
  }
  return way.path;
}

DCEM_INLINE Path ScatterWays::listed(const Path& way) const {
  Path path = way;
  put_in_order(path);
  return path;
}

DCEM_INLINE double ScatterWays::share(const Vec3& from_m, const Vec3& to_m, FacetId sheet) const {
  const Plane& plane = scene_.facet(sheet).plane;
  const double from = signed_distance_m(plane, from_m), to = signed_distance_m(plane, to_m);
  return from == to ? 0.0 : std::clamp(from / (from - to), 0.0, 1.0);
}

DCEM_INLINE void ScatterWays::add_sheets(std::span<const FacetId> sheets, Way& way) {
  for (const FacetId sheet : sheets) {
    way.sheets.push_back(sheet);
    way.path.interactions.push_back({InteractionKind::transmission, sheet, Vec3(0.0)});
  }
}

DCEM_INLINE void ScatterWays::put_in_order(Path& way) const {
  const auto scatters = [](const Interaction& at) { return at.kind == InteractionKind::scattering; };
  const auto place = std::ranges::find_if(way.interactions, scatters);
  put_in_order(transmitter_.position_m, place->point_m, std::span(way.interactions.begin(), place));
  put_in_order(place->point_m, receiver_.position_m, std::span(place + 1, way.interactions.end()));
}

DCEM_INLINE void ScatterWays::put_in_order(const Vec3& from_m, const Vec3& to_m,
                                           std::span<Interaction> crossings) const {
  for (Interaction& at : crossings) at.point_m = from_m + share(from_m, to_m, at.facet) * (to_m - from_m);
  std::ranges::sort(crossings, [&](const Interaction& one, const Interaction& other) {
    const double one_at = share(from_m, to_m, one.facet), other_at = share(from_m, to_m, other.facet);
    return one_at != other_at ? one_at < other_at : one.facet < other.facet;
  });
}

}  // namespace dcem
