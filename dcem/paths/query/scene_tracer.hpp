#pragma once
/// Questions that paths ask of the scene: what does a ray hit, is a leg free and which sheets does it cross, which
/// facets are at a point. `Tree` is `WideBvh`, `Bvh<double>` or their oracle `BruteForce<double>`, over the scene's
/// triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/geometry/triangle.hpp"
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

/// What a leg ignores at one of its ends: the facets it starts or ends on, and what lies along the reflecting one
/// within the weld tolerance (coplanar duplicates, dirt). A wall that stands on that facet is not ignored, however
/// close.
struct LegEnd {
  std::span<const FacetId> facets;
  std::array<const Plane*, 2> planes{};  ///< of the reflecting facet or of a wedge's two faces; null at a device
};

/// Bodies that do not exist for a link: those that its devices ride on.
using IgnoredBodies = std::array<std::optional<BodyId>, 2>;

template <typename Tree>
class SceneTracer {
 public:
  SceneTracer(const Scene& scene, const Tree& tree) : scene_(scene), tree_(tree) {}

  const Scene& scene() const { return scene_; }

  /// The first facet along a ray with t > 0. Of hits at the same distance the facet with the smallest id is the first.
  std::optional<SurfaceHit> closest_hit(const Ray<double>& ray, const LegEnd& start, const IgnoredBodies& ignored,
                                        TraversalCounters& counters) const;

  /// Follows a straight leg. False where an opaque facet blocks it or more than `crossing_limit` sheets are in the way;
  /// otherwise `crossings` holds the sheets in order (two coplanar sheets at one point count once: the material whose
  /// name comes first).
  bool follow_leg(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                  const IgnoredBodies& ignored, std::size_t crossing_limit, std::vector<Crossing>& crossings,
                  TraversalCounters& counters) const;

  /// Calls `test(triangle) -> bool` for triangles that a straight leg meets and does not ignore, in no promised order,
  /// until one returns true. Returns whether one did.
  template <typename Test>
  bool any_triangle_between(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                            const IgnoredBodies& ignored, Test&& test, TraversalCounters& counters) const {
    const Ray<double> leg = segment_between(from_m, to_m);
    const WatertightRay prepared(leg);
    const auto meets = [&](std::uint32_t triangle) {
      const std::optional<double> t = prepared.intersect(scene_.corners_m(triangle));
      if (!t || *t < 0.0 || *t > 1.0) return false;
      const FacetId facet = scene_.facet_of_triangle(triangle);
      const Vec3 point_m = leg.at(*t);
      if (is_ignored(scene_.facet(facet).body, ignored)) return false;
      return !skips(start, facet, point_m) && !skips(end, facet, point_m) && test(triangle);
    };
    return tree_.any(leg, meets, &counters);
  }

  /// Facets within `radius_m` of a point, ascending by id.
  std::vector<FacetId> facets_near(const Vec3& point_m, double radius_m, const IgnoredBodies& ignored,
                                   TraversalCounters& counters) const;

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

  /// Whether a facet lies along a plane at one of its points: within the weld tolerance, and hardly tilted.
  bool lies_along(const WorldFacet& facet, const Plane& plane, const Vec3& point_m) const {
    return std::abs(signed_distance_m(plane, point_m)) <= scene_.settings().weld_tolerance_m &&
           std::abs(glm::dot(plane.normal, facet.plane.normal)) > along_cosine;
  }

 private:
  /// Facets of more triangles than this are searched through the tree.
  static constexpr std::uint32_t direct_test_limit = 16;
  /// Facets within about 6 degrees of a plane lie along it: small patches of a dirty wall are tilted by their rounding.
  static constexpr double along_cosine = 0.995;

  bool skips(const LegEnd& end, FacetId facet, const Vec3& point_m) const {
    if (std::find(end.facets.begin(), end.facets.end(), facet) != end.facets.end()) return true;
    return std::any_of(end.planes.begin(), end.planes.end(), [&](const Plane* plane) {
      return plane != nullptr && lies_along(scene_.facet(facet), *plane, point_m);
    });
  }

  /// Where a leg meets the plane of a facet: the same number whichever of the facet's triangles was hit.
  double plane_parameter(const WorldFacet& facet, const Ray<double>& leg, double t_triangle) const {
    const double from = signed_distance_m(facet.plane, leg.origin);
    const double slope = glm::dot(facet.plane.normal, leg.direction);
    const double t = slope == 0.0 ? t_triangle : -from / slope;
    return std::clamp(t, 0.0, 1.0);
  }

  void sort_and_merge(std::vector<Crossing>& crossings, const Vec3& leg_m) const;

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
    const double reach_m = 1.01 * detail::stray_tolerances * scene_.settings().planarity_tolerance_m;
    tree_.overlapping(inflated(Aabb<double>{point_m, point_m}, reach_m), visit, &counters);
  }

  const Scene& scene_;
  const Tree& tree_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Tree>
std::optional<SurfaceHit> SceneTracer<Tree>::closest_hit(const Ray<double>& ray, const LegEnd& start,
                                                         const IgnoredBodies& ignored,
                                                         TraversalCounters& counters) const {
  const WatertightRay prepared(ray);
  std::optional<SurfaceHit> best;
  tree_.closest(
      ray,
      [&](std::uint32_t triangle, double& t_max) {
        const std::optional<double> t = prepared.intersect(scene_.corners_m(triangle));
        if (!t || !(*t > ray.t_min) || *t > t_max) return;
        const FacetId facet = scene_.facet_of_triangle(triangle);
        if (best && *t == best->t && best->facet < facet) return;
        if (is_ignored(scene_.facet(facet).body, ignored) || skips(start, facet, ray.at(*t))) return;
        best = SurfaceHit{facet, *t};
        t_max = *t;
      },
      &counters);
  return best;
}

template <typename Tree>
bool SceneTracer<Tree>::follow_leg(const Vec3& from_m, const Vec3& to_m, const LegEnd& start, const LegEnd& end,
                                   const IgnoredBodies& ignored, std::size_t crossing_limit,
                                   std::vector<Crossing>& crossings, TraversalCounters& counters) const {
  crossings.clear();
  const Ray<double> leg = segment_between(from_m, to_m);
  const WatertightRay prepared(leg);
  const auto blocks = [&](std::uint32_t triangle) {
    const std::optional<double> t = prepared.intersect(scene_.corners_m(triangle));
    if (!t || *t < 0.0 || *t > 1.0) return false;
    const FacetId id = scene_.facet_of_triangle(triangle);
    const WorldFacet& facet = scene_.facet(id);
    const Vec3 point_m = leg.at(*t);
    if (is_ignored(facet.body, ignored) || skips(start, id, point_m) || skips(end, id, point_m)) return false;
    if (!facet.transmits || crossing_limit == 0) return true;
    crossings.push_back({id, plane_parameter(facet, leg, *t)});
    return false;
  };
  if (tree_.any(leg, blocks, &counters)) return false;
  if (crossings.size() > 1) sort_and_merge(crossings, to_m - from_m);
  return crossings.size() <= crossing_limit;
}

template <typename Tree>
void SceneTracer<Tree>::sort_and_merge(std::vector<Crossing>& crossings, const Vec3& leg_m) const {
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

template <typename Tree>
std::vector<FacetId> SceneTracer<Tree>::facets_near(const Vec3& point_m, double radius_m, const IgnoredBodies& ignored,
                                                    TraversalCounters& counters) const {
  std::vector<FacetId> near;
  tree_.overlapping(
      inflated(Aabb<double>{point_m, point_m}, radius_m),
      [&](std::uint32_t triangle) {
        const FacetId facet = scene_.facet_of_triangle(triangle);
        if (is_ignored(scene_.facet(facet).body, ignored)) return;
        if (distance_to_triangle_m(scene_.corners_m(triangle), point_m) <= radius_m) near.push_back(facet);
      },
      &counters);
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

template <typename Tree>
bool SceneTracer<Tree>::reflects_at(FacetId id, const Vec3& point_m, const IgnoredBodies& ignored,
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

template <typename Tree>
double SceneTracer<Tree>::covered_rad(FacetId id, const Vec3& point_m, const IgnoredBodies& ignored,
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
