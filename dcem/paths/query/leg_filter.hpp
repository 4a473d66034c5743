#pragma once
/// What a straight leg of a path ignores: the surfaces at its ends, and bodies that are not there for its link.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "dcem/accel/hit_filter.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// What a leg ignores at one of its ends: the facets it starts or ends on, and what lies along the reflecting one
/// within the weld tolerance (coplanar duplicates, dirt). A wall that stands on that facet is not ignored, however
/// close.
struct LegEnd {
  std::span<const FacetId> facets;
  std::array<const Plane*, 2> planes{};  ///< of all `facets`, or null at a device
};

/// Bodies that do not exist for a link: those that its devices ride on.
using IgnoredBodies = std::array<std::optional<BodyId>, 2>;

/// Planes of which the cosine of the angle between them is greater lie along each other.
inline constexpr double lies_along_cosine = 0.995;

/// Whether a facet lies along a plane at one of its points: within the weld tolerance, and tilted by less than about 6
/// degrees: small patches of a dirty wall are tilted by their rounding.
inline bool lies_along(const Scene& scene, const WorldFacet& facet, const Plane& plane, const Vec3& point_m) {
  return std::abs(signed_distance_m(plane, point_m)) <= scene.settings().weld_tolerance_m &&
         std::abs(glm::dot(plane.normal, facet.plane.normal)) > lies_along_cosine;
}

/// How far triangles stray from the plane of their facet, at most: beyond, the facet would have been split.
inline double facet_reach_m(const Scene& scene) {
  return 1.01 * detail::stray_tolerances * scene.settings().planarity_tolerance_m;
}

/// The `HitFilter` of one leg. A hit farther from the planes at an end than anything that is ignored there is sure to
/// count: an index decides it without a question.
class LegFilter {
 public:
  /// A leg from one place (t = 0) to another (t = 1).
  LegFilter(const Scene& scene, const Ray<double>& leg, const LegEnd& start, const LegEnd& end,
            const IgnoredBodies& ignored)
      : scene_(&scene), leg_(leg), ends_{start, end}, ignored_(ignored) {
    const double reach_m = 1.01 * std::max(scene.settings().weld_tolerance_m, facet_reach_m(scene));
    sure_from_ = share_within(start, leg.origin, reach_m);
    sure_to_ = 1.0 - share_within(end, leg.origin + leg.direction, reach_m);
  }

  /// A ray that leaves a place, and does not meet what is at that very place.
  LegFilter(const Scene& scene, const Ray<double>& ray, const LegEnd& start, const IgnoredBodies& ignored)
      : LegFilter(scene, ray, start, {}, ignored) {
    leaves_start_ = true;
    sure_from_ = std::max(sure_from_, 0.0);
    sure_to_ = std::numeric_limits<double>::infinity();
  }

  /// Valid as long as this stays where it is.
  HitFilter hit_filter() const {
    const auto number = [](const std::optional<BodyId>& body) { return body ? body->value : HitFilter::no_object; };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const bool asks = sure_from_ > -infinity || sure_to_ < infinity;
    return {rounded_up(sure_from_),
            -rounded_up(-sure_to_),
            asks ? &ask : nullptr,
            this,
            {number(ignored_[0]), number(ignored_[1])}};
  }

 private:
  static bool ask(const void* context, const TriangleHit& hit) {
    return static_cast<const LegFilter*>(context)->counts(hit);
  }

  /// In single precision, and no smaller than the value, up to 1e38.
  static float rounded_up(double value) {
    const auto rounded = static_cast<float>(std::clamp(value, -1e38, 1e38));
    return rounded + std::abs(rounded) * 0x1p-22F + 1e-37F;
  }

  bool counts(const TriangleHit& hit) const {
    if (leaves_start_ && !(hit.t > 0.0)) return false;
    const FacetId facet = scene_->facet_of_triangle(hit.triangle);
    const Vec3 point_m = leg_.at(hit.t);
    return !skips(ends_[0], facet, point_m) && !skips(ends_[1], facet, point_m);
  }

  bool skips(const LegEnd& end, FacetId facet, const Vec3& point_m) const {
    if (std::find(end.facets.begin(), end.facets.end(), facet) != end.facets.end()) return true;
    return std::any_of(end.planes.begin(), end.planes.end(), [&](const Plane* plane) {
      return plane != nullptr && lies_along(*scene_, scene_->facet(facet), *plane, point_m);
    });
  }

  /// Calls `look(plane)` for the planes of what is ignored at an end.
  template <typename Look>
  void for_each_plane(const LegEnd& end, Look&& look) const {
    if (end.planes[0] == nullptr) {
      for (const FacetId facet : end.facets) look(scene_->facet(facet).plane);
    }
    for (const Plane* plane : end.planes) {
      if (plane != nullptr) look(*plane);
    }
  }

  /// Which share of the leg, from one of its ends on, is not farther than `reach_m` from all planes there; −∞ where
  /// there are none. Beyond it |distance + t · slope| > reach holds for each plane, as it does for one that is as far
  /// and as steep as any; infinite along a plane.
  double share_within(const LegEnd& end, const Vec3& from_m, double reach_m) const {
    double farthest_m = -std::numeric_limits<double>::infinity(), least_slope = std::numeric_limits<double>::infinity();
    for_each_plane(end, [&](const Plane& plane) {
      farthest_m = std::max(farthest_m, std::abs(signed_distance_m(plane, from_m)));
      least_slope = std::min(least_slope, std::abs(glm::dot(plane.normal, leg_.direction)));
    });
    return farthest_m < 0.0 ? farthest_m : (reach_m + farthest_m) / least_slope;
  }

  const Scene* scene_;
  Ray<double> leg_;
  std::array<LegEnd, 2> ends_;
  IgnoredBodies ignored_;
  double sure_from_, sure_to_;
  bool leaves_start_ = false;
};

}  // namespace dcem
