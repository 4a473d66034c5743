#pragma once
/// Questions that paths ask of the scene: what does a ray hit, is a leg free and which sheets does it cross, which
/// facets are at a point. `Index` is a `SpatialIndex` over the scene's triangles, whose objects are the scene's bodies.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Where a ray meets a facet.
struct SurfaceHit {
  FacetId facet;
  double t = 0.0;  ///< in units of the ray's direction
};

/// A sheet that a leg crosses.
struct Crossing {
  FacetId facet;
  double t = 0.0;  ///< 0 at the start of the leg, 1 at its end
};

template <typename Index>
class SceneTracer {
 public:
  SceneTracer(const Scene& scene, const Index& index) : scene_(scene), index_(index) {}

  const Scene& scene() const { return scene_; }
  const Index& index() const { return index_; }

  /// The first facet along a ray with t > 0. Of hits at the same distance the facet with the smallest id is the first:
  /// triangles are numbered facet by facet.
  std::optional<SurfaceHit> closest_hit(const Ray<double>& ray, const LegEnd& start, const IgnoredBodies& ignored,
                                        TraversalCounters& counters) const;

  /// Follows a straight leg. False where an opaque facet blocks it or more than `crossing_limit` sheets are in the way;
  /// otherwise `crossings` holds the sheets in order (two coplanar sheets at one point count once: the material whose
  /// name comes first).
  bool follow_leg(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                  const IgnoredBodies& ignored, std::size_t crossing_limit, std::vector<Crossing>& crossings,
                  TraversalCounters& counters) const;

  /// Puts crossings of a leg in order. Of parallel sheets within the weld tolerance of each other, one after the other,
  /// the one whose material's name comes first stands for all.
  void merge_in_order(std::vector<Crossing>& crossings, const Vec3& leg_m) const;

  /// Calls `test(triangle) -> bool` for triangles that a straight leg meets and does not ignore, in no promised order,
  /// until one returns true. Returns whether one did.
  template <typename Test>
  bool any_triangle_between(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                            const IgnoredBodies& ignored, Test&& test, TraversalCounters& counters) const {
    const Ray<double> leg = segment_between(from_m, to_m);
    const LegFilter filter(scene_, leg, start, end, ignored);
    return index_.visit_hits(
        leg, filter.hit_filter(), [&](const TriangleHit& hit) { return test(hit.triangle); }, &counters);
  }

  /// Facets within `radius_m` of a point, ascending by id; `near` is overwritten.
  void facets_near(const Vec3& point_m, double radius_m, const IgnoredBodies& ignored, std::vector<FacetId>& near,
                   TraversalCounters& counters) const;
  std::vector<FacetId> facets_near(const Vec3& point_m, double radius_m, const IgnoredBodies& ignored,
                                   TraversalCounters& counters) const {
    std::vector<FacetId> near;
    facets_near(point_m, radius_m, ignored, near, counters);
    return near;
  }

  /// Whether a point on the facet's plane lies where the facet reflects: on it, and not on its rim, unless coplanar
  /// facets go on there. A path whose point is on the very rim of a mirror is no path: it is the boundary of the lit
  /// region.
  bool reflects_at(FacetId facet, const Vec3& point_m, const IgnoredBodies& ignored, TraversalCounters& counters) const;

  /// Whether a straight leg meets a facet, its rim included: the test by which `follow_leg` decides.
  bool meets(FacetId facet, const Vec3& from_m, const Vec3& to_m) const {
    const WatertightRay leg(segment_between(from_m, to_m));
    const WorldFacet& held = scene_.facet(facet);
    for (std::uint32_t index = 0; index < held.triangle_count; ++index) {
      const std::optional<double> t = leg.intersect(scene_.corners_m(held.first_triangle + index));
      if (t && *t >= 0.0 && *t <= 1.0) return true;
    }
    return false;
  }

  bool is_ignored(BodyId body, const IgnoredBodies& ignored) const { return ignored[0] == body || ignored[1] == body; }

  /// Whether `one` stands for `other` where both lie on top of each other: by material name, then id.
  bool precedes(FacetId one, FacetId other) const {
    const std::string& name_one = scene_.material(scene_.facet(one).material).name;
    const std::string& name_other = scene_.material(scene_.facet(other).material).name;
    return name_one != name_other ? name_one < name_other : one < other;
  }

  /// Whether the planes of two facets are parallel to within the angle that makes triangles coplanar.
  bool parallel(FacetId one, FacetId other) const {
    return std::abs(glm::dot(scene_.facet(one).plane.normal, scene_.facet(other).plane.normal)) >
           detail::coplanar_cosine;
  }

 private:
  /// Facets of more triangles than this are searched through the tree.
  static constexpr std::uint32_t direct_test_limit = 16;

  /// Where a leg meets the plane of a facet: the same number whichever of the facet's triangles was hit.
  double plane_parameter(const WorldFacet& facet, const Ray<double>& leg, double t_triangle) const {
    const double from = signed_distance_m(facet.plane, leg.origin);
    const double slope = glm::dot(facet.plane.normal, leg.direction);
    const double t = slope == 0.0 ? t_triangle : -from / slope;
    return std::clamp(t, 0.0, 1.0);
  }

  /// Whether two crossings of a leg are of parallel sheets within the weld tolerance of each other, across the sheets.
  bool one_sheet(const Crossing& one, const Crossing& next, const Vec3& leg_m) const {
    const double apart_m = (next.t - one.t) * std::abs(glm::dot(leg_m, scene_.facet(one.facet).plane.normal));
    return apart_m <= scene_.settings().weld_tolerance_m && parallel(one.facet, next.facet);
  }

  /// The angle that coplanar facets cover around a point, radians: 2π inside, more where they overlap.
  double covered_rad(FacetId facet, const Vec3& point_m, const IgnoredBodies& ignored,
                     TraversalCounters& counters) const;

  /// Triangles whose facet's plane may hold the point: triangles stray from it by no more than the limit at which the
  /// facet would have been split.
  template <typename Visit>
  void for_each_triangle_at(const Vec3& point_m, TraversalCounters& counters, Visit&& visit) const {
    index_.overlapping(inflated(Aabb<double>{point_m, point_m}, facet_reach_m(scene_)), visit, &counters);
  }

  const Scene& scene_;
  const Index& index_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Index>
std::optional<SurfaceHit> SceneTracer<Index>::closest_hit(const Ray<double>& ray, const LegEnd& start,
                                                          const IgnoredBodies& ignored,
                                                          TraversalCounters& counters) const {
  const LegFilter filter(scene_, ray, start, ignored);
  const std::optional<TriangleHit> hit = index_.closest_hit(ray, filter.hit_filter(), &counters);
  if (!hit) return std::nullopt;
  return SurfaceHit{scene_.facet_of_triangle(hit->triangle), hit->t};
}

template <typename Index>
bool SceneTracer<Index>::follow_leg(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                                    const IgnoredBodies& ignored, std::size_t crossing_limit,
                                    std::vector<Crossing>& crossings, TraversalCounters& counters) const {
  crossings.clear();
  const Ray<double> leg = segment_between(from_m, to_m);
  const LegFilter filter(scene_, leg, start, end, ignored);
  if (crossing_limit == 0 || !scene_.has_sheets()) return !index_.occluded(leg, filter.hit_filter(), &counters);
  const auto blocks = [&](const TriangleHit& hit) {
    const FacetId id = scene_.facet_of_triangle(hit.triangle);
    const WorldFacet& facet = scene_.facet(id);
    if (!facet.transmits) return true;
    crossings.push_back({id, plane_parameter(facet, leg, hit.t)});
    return false;
  };
  if (index_.visit_hits(leg, filter.hit_filter(), blocks, &counters)) return false;
  if (crossings.size() > 1) merge_in_order(crossings, to_m - from_m);
  return crossings.size() <= crossing_limit;
}

template <typename Index>
void SceneTracer<Index>::merge_in_order(std::vector<Crossing>& crossings, const Vec3& leg_m) const {
  std::sort(crossings.begin(), crossings.end(),
            [&](const Crossing& a, const Crossing& b) { return a.t != b.t ? a.t < b.t : precedes(a.facet, b.facet); });
  // Sheets are chained to the latest one of their stack, so a leg and its reverse merge the same.
  struct Stack {
    Crossing first_by_name, latest;
  };
  std::vector<Stack> stacks;
  for (const Crossing& crossing : crossings) {
    const auto stack = std::find_if(stacks.begin(), stacks.end(), [&](const Stack& other) {
      return other.latest.facet == crossing.facet || one_sheet(other.latest, crossing, leg_m);
    });
    if (stack == stacks.end()) {
      stacks.push_back({crossing, crossing});
    } else {
      stack->latest = crossing;
      if (precedes(crossing.facet, stack->first_by_name.facet)) stack->first_by_name = crossing;
    }
  }
  crossings.clear();
  for (const Stack& stack : stacks) crossings.push_back(stack.first_by_name);
}

template <typename Index>
void SceneTracer<Index>::facets_near(const Vec3& point_m, double radius_m, const IgnoredBodies& ignored,
                                     std::vector<FacetId>& near, TraversalCounters& counters) const {
  near.clear();
  index_.overlapping(
      inflated(Aabb<double>{point_m, point_m}, radius_m),
      [&](std::uint32_t triangle) {
        const FacetId facet = scene_.facet_of_triangle(triangle);
        if (is_ignored(scene_.facet(facet).body, ignored)) return;
        if (distance_to_triangle_m(scene_.corners_m(triangle), point_m) <= radius_m) near.push_back(facet);
      },
      &counters);
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
}

template <typename Index>
bool SceneTracer<Index>::reflects_at(FacetId id, const Vec3& point_m, const IgnoredBodies& ignored,
                                     TraversalCounters& counters) const {
  const WorldFacet& facet = scene_.facet(id);
  bool touches = false, inside = false;
  const auto test = [&](std::uint32_t triangle) {
    const TriangleContact touch = contact(scene_.corners_m(triangle), facet.plane.normal, point_m, in_plane_guard_m);
    touches = touches || touch.covered_rad > 0.0;
    inside = inside || touch.covered_rad == 2.0 * pi;
  };
  if (facet.triangle_count <= direct_test_limit) {
    for (std::uint32_t index = 0; index < facet.triangle_count && !inside; ++index) test(facet.first_triangle + index);
  } else {
    for_each_triangle_at(point_m, counters, [&](std::uint32_t triangle) {
      if (scene_.facet_of_triangle(triangle) == id) test(triangle);
    });
  }
  return inside || (touches && covered_rad(id, point_m, ignored, counters) > 2.0 * pi - 1e-3);
}

template <typename Index>
double SceneTracer<Index>::covered_rad(FacetId id, const Vec3& point_m, const IgnoredBodies& ignored,
                                       TraversalCounters& counters) const {
  double sum_rad = 0.0;
  for_each_triangle_at(point_m, counters, [&](std::uint32_t triangle) {
    const FacetId other = scene_.facet_of_triangle(triangle);
    if (!parallel(id, other) || is_ignored(scene_.facet(other).body, ignored)) return;
    if (distance_to_triangle_m(scene_.corners_m(triangle), point_m) > scene_.settings().weld_tolerance_m) return;
    sum_rad +=
        contact(scene_.corners_m(triangle), scene_.facet(id).plane.normal, point_m, in_plane_guard_m).covered_rad;
  });
  return sum_rad;
}

}  // namespace dcem
