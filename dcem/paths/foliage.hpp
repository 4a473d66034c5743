#pragma once
/// How far a leg runs inside foliage.
#include <algorithm>
#include <vector>

#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/scene_tracer.hpp"

namespace dcem {

namespace detail {

/// The part of a leg inside one closed shell, 0…1 of its length. `crossed_at` is scratch memory.
inline double share_inside(const Scene& scene, const FoliageShell& shell, const Ray<double>& leg,
                           std::vector<std::pair<FacetId, double>>& crossed_at) {
  crossed_at.clear();
  // Beyond the end of the leg as well: the number of all crossings says whether the leg begins inside.
  const WatertightRay prepared(leg);
  for (const std::uint32_t triangle : shell.triangles) {
    const std::optional<double> t = prepared.intersect(scene.corners_m(triangle));
    if (t && *t > 0.0) crossed_at.emplace_back(scene.facet_of_triangle(triangle), *t);
  }
  // A facet is plane: it is crossed once, even where its triangles meet.
  std::sort(crossed_at.begin(), crossed_at.end());
  const auto same_facet = [](const auto& a, const auto& b) { return a.first == b.first; };
  crossed_at.erase(std::unique(crossed_at.begin(), crossed_at.end(), same_facet), crossed_at.end());
  std::sort(crossed_at.begin(), crossed_at.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  bool inside = crossed_at.size() % 2 == 1;
  double share = 0.0, from = 0.0;
  for (const auto& [facet, t] : crossed_at) {
    const double to = std::min(t, 1.0);
    if (inside) share += to - from;
    inside = !inside;
    from = to;
  }
  return share;
}

}  // namespace detail

/// Adds what a straight leg runs through to `foliage`, one entry per material in the order in which they come.
inline void add_foliage_along(const Scene& scene, const Vec3& from_m, const Vec3& to_m, const IgnoredBodies& ignored,
                              std::vector<FoliageLength>& foliage) {
  std::vector<std::pair<FacetId, double>> crossed_at;
  const Ray<double> leg = segment_between(from_m, to_m);
  Aabb<double> leg_box;
  leg_box.extend(from_m);
  leg_box.extend(to_m);
  for (const FoliageShell& shell : scene.foliage()) {
    if (ignored[0] == shell.body || ignored[1] == shell.body || !shell.box.overlaps(leg_box)) continue;
    const double length_m = detail::share_inside(scene, shell, leg, crossed_at) * glm::distance(from_m, to_m);
    if (!(length_m > 0.0)) continue;
    const auto same = std::find_if(foliage.begin(), foliage.end(),
                                   [&](const FoliageLength& other) { return other.material == shell.material; });
    if (same != foliage.end()) {
      same->length_m += length_m;
    } else {
      foliage.push_back({shell.material, length_m});
    }
  }
}

}  // namespace dcem
