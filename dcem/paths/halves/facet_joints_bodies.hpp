#pragma once
/// Bodies of facet_joints.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/facet_joints.hpp"

namespace dcem {

DCEM_INLINE bool FacetJoints::is_straight(const Scene& scene, const WorldFacet& facet, const Side& side) {
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    for (const Vec3& corner_m : scene.corners_m(facet.first_triangle + triangle)) {
      if (corner_m.x == side.x_m && corner_m.y == side.y_m) continue;
      if (std::hypot(corner_m.x - side.x_m, corner_m.y - side.y_m) < close_m) return false;
    }
  }
  return true;
}

DCEM_INLINE Vec3 FacetJoints::nearest_corner_m(const Scene& scene, const WorldFacet& facet, const Vec3& point_m) {
  Vec3 nearest_m = scene.corners_m(facet.first_triangle)[0];
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    for (const Vec3& corner_m : scene.corners_m(facet.first_triangle + triangle)) {
      if (glm::distance(corner_m, point_m) < glm::distance(nearest_m, point_m)) nearest_m = corner_m;
    }
  }
  return nearest_m;
}

DCEM_INLINE void FacetJoints::add_sides(const Scene& scene, std::uint32_t facet, std::vector<Side>& sides) {
  const WorldFacet& held = scene.facets()[facet];
  const std::span<const Vec3> hull_m = scene.hull_m(held);
  for (std::uint32_t at = 0; at < hull_m.size(); ++at) {
    const Vec3 &hull_from = hull_m[at], &hull_to = hull_m[(at + 1) % hull_m.size()];
    if (std::hypot(hull_from.x - hull_to.x, hull_from.y - hull_to.y) > 2.0 * close_m) continue;
    const Vec3 from = nearest_corner_m(scene, held, hull_from), to = nearest_corner_m(scene, held, hull_to);
    if (from.x != to.x || from.y != to.y || std::abs(from.z - to.z) < least_length_m) continue;
    const Side side{from.x, from.y, std::min(from.z, to.z), std::max(from.z, to.z), facet, at};
    if (is_straight(scene, held, side)) sides.push_back(side);
  }
}

DCEM_INLINE void FacetJoints::find(const Scene& scene, std::uint32_t facets,
                                   const std::function<bool(FacetId)>& takes) {
  std::vector<Side> sides;
  for (std::uint32_t facet = 0; facet < facets; ++facet) {
    if (takes(FacetId(facet))) add_sides(scene, facet, sides);
  }
  const auto line = [](const Side& side) { return std::array{side.x_m, side.y_m}; };
  std::ranges::stable_sort(sides, {}, line);
  struct Found {
    std::uint32_t facet;
    FacetJoint joint;
  };
  std::vector<Found> found;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    for (last = first + 1; last < sides.size() && sides[last].is_on_line_of(sides[first]);) ++last;
    for (std::size_t one = first; one < last && last - first <= most_on_line; ++one) {
      for (std::size_t other = first; other < last; ++other) {
        const Side &own = sides[one], &beside = sides[other];
        if (own.facet >= beside.facet) continue;
        if (std::min(own.high_m, beside.high_m) - std::max(own.low_m, beside.low_m) < least_length_m) continue;
        found.push_back({own.facet, {FacetId(beside.facet), own.side, beside.side}});
      }
    }
  }
  std::ranges::stable_sort(found, {}, &Found::facet);
  first_.assign(facets + std::size_t{1}, 0);
  for (const Found& one : found) {
    ++first_[one.facet + std::size_t{1}];
    joints_.push_back(one.joint);
  }
  for (std::size_t facet = 1; facet < first_.size(); ++facet) first_[facet] += first_[facet - 1];
}

}  // namespace dcem
