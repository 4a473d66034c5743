#pragma once
/// Bodies of place.hpp.
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/common_cone.hpp"
#include "dcem/paths/halves/place.hpp"

namespace dcem {

DCEM_INLINE double PlaceBox::way_out_m(const Vec3& point_m, const Vec3& towards) const {
  if (!holds(point_m)) return 0.0;
  const Vec3 away_m = point_m - middle_m;
  double way_m = std::numeric_limits<double>::infinity();
  const std::array<Vec3, 3> axes{ahead, aside(), Vec3(0.0, 0.0, 1.0)};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& along = axes[static_cast<std::size_t>(axis)];
    const double speed = glm::dot(towards, along), at_m = glm::dot(away_m, along);
    if (speed != 0.0) way_m = std::min(way_m, ((speed > 0.0 ? half_m[axis] : -half_m[axis]) - at_m) / speed);
  }
  return way_m;
}

DCEM_INLINE void PlaceBox::corners_beside(const Plane& plane, double side, std::vector<Vec3>& result_m) const {
  const std::array<Vec3, 8> all_m = corners_m();
  std::array<double, 8> above_m;
  result_m.clear();
  for (std::size_t corner = 0; corner < all_m.size(); ++corner) {
    above_m[corner] = side * signed_distance_m(plane, all_m[corner]);
    if (above_m[corner] > in_plane_guard_m) result_m.push_back(all_m[corner]);
  }
  if (result_m.empty() || result_m.size() == all_m.size()) return;
  for (std::size_t corner = 0; corner < all_m.size(); ++corner) {
    for (const std::size_t next : {corner | 1U, corner | 2U, corner | 4U}) {
      if (next == corner || (above_m[corner] > in_plane_guard_m) == (above_m[next] > in_plane_guard_m)) continue;
      const double share = above_m[corner] / (above_m[corner] - above_m[next]);
      const Vec3 cut_m = all_m[corner] + share * (all_m[next] - all_m[corner]);
      result_m.push_back(cut_m + side * in_plane_guard_m * plane.normal);
    }
  }
}

DCEM_INLINE std::array<Vec3, 8> PlaceBox::corners_m() const {
  std::array<Vec3, 8> corners;
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    const double along = (corner & 1U) != 0 ? half_m.x : -half_m.x, across = (corner & 2U) != 0 ? half_m.y : -half_m.y;
    const double up = (corner & 4U) != 0 ? half_m.z : -half_m.z;
    corners[corner] = middle_m + along * ahead + across * aside() + Vec3(0.0, 0.0, up);
  }
  return corners;
}

DCEM_INLINE void Place::go_on(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings) {
  const int step = work().count() - steps_left_;
  --steps_left_;
  if (step < Sight::scenery_steps) return sight_.find_scenery_step(step, scene, outlines, settings, scenery_);
  if (step < steps_without_beams) return take_mirrors(scene, outlines, step - Sight::scenery_steps);
  look_through_mirrors(scene, outlines, settings, step - steps_without_beams);
}

/// One of `beam_steps` parts of them. The first two are one part and the facets that its first mirror lights, which is
/// the ground; in it are half as many as in the others.
DCEM_INLINE void Place::look_through_mirrors(const Scene& scene, const FacetOutlines& outlines,
                                             const HalfSettings& settings, int step) {
  constexpr std::size_t halves = 2 * beam_steps - 3;
  const auto before = [&](int part) {
    return part <= 1 ? 0 : mirrors_.size() * (2 * static_cast<std::size_t>(part) - 3) / halves;
  };
  std::vector<Vec3> images_m;
  const auto shared = [&](std::size_t at) {
    find_images(scene.facet(mirrors_[at].facet).plane, mirrors_[at], images_m);
    return SharedMirror{mirrors_[at].facet, mirrors_[at].cone, images_m};
  };
  if (step == 0 && !mirrors_.empty()) beams_->find_lit_facets(scene, outlines, settings, shared(0), 0, false);
  for (std::size_t at = before(step); at < before(step + 1); ++at) {
    const auto place = static_cast<std::uint32_t>(at);
    if (at > 0) beams_->find_lit_facets(scene, outlines, settings, shared(at), place, false);
    beams_->find_lit_edges(scene, outlines, outlines.middle_m(), settings, shared(at), place);
  }
  if (steps_left_ > 0) return;
  beams_->lay_out(scene);
  beams_->fit();
}

DCEM_INLINE void Place::find_images(const Plane& plane, const PlaceMirror& mirror, std::vector<Vec3>& result_m) const {
  box_.corners_beside(plane, mirror.side, result_m);
  for (Vec3& point_m : result_m) point_m = mirrored(plane, point_m);
}

/// One of `mirror_steps` parts of them.
DCEM_INLINE void Place::take_mirrors(const Scene& scene, const FacetOutlines& outlines, int step) {
  if (step == 0) sight_.settle();
  const auto before = [&](int part) { return scenery_.mirrors.size() * static_cast<std::size_t>(part) / mirror_steps; };
  std::vector<Vec3> corners_m;
  std::vector<HalfSpace> cone;
  for (std::size_t at = before(step); at < before(step + 1); ++at) {
    const FacetId facet = scenery_.mirrors[at];
    const Plane& plane = scene.facet(facet).plane;
    for (const double side : {1.0, -1.0}) {
      box_.corners_beside(plane, side, corners_m);
      if (corners_m.empty()) continue;
      common_cone(outlines.sides(facet), plane, side * plane.normal, corners_m, outlines.middle_m(), cone);
      planes_.insert(planes_.end(), cone.begin(), cone.end());
      cone_ends_.push_back(planes_.size());
      mirrors_.push_back({facet, static_cast<std::uint32_t>(at), side, mirrored(plane, box_.middle_m), {}});
    }
  }
  if (step < mirror_steps - 1) return;
  for (std::size_t at = 0; at < cone_ends_.size(); ++at) {
    const std::size_t first = at == 0 ? 0 : cone_ends_[at - 1];
    mirrors_[at].cone = std::span(planes_).subspan(first, cone_ends_[at] - first);
  }
  cone_ends_ = {};
}

}  // namespace dcem
