#pragma once
/// Bodies of foliage_length.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/query/foliage_length.hpp"

namespace dcem {

namespace detail {

/// Crossings closer than this, of the leg's length, are one crossing that rounding has doubled.
inline constexpr double shortest_piece = 1e-12;

/// Whether a point lies inside a closed shell: a ray from it meets the shell an odd number of times. The ray stands in
/// no relation to any wall, so that it meets no edge, at which the triangles of either side would count.
inline bool is_inside(const Scene& scene, const FoliageShell& shell, const Vec3& point_m) {
  const WatertightRay ray({point_m, Vec3(0.271'828'182'8, 0.141'421'356'2, 1.0)});
  bool inside = false;
  for (const std::uint32_t triangle : shell.triangles) {
    const std::optional<double> t = ray.intersect(scene.corners_m(triangle));
    if (t && *t > 0.0) inside = !inside;
  }
  return inside;
}

/// The part of a leg inside one closed shell, 0…1 of its length: the pieces between crossings whose middle is inside.
/// A leg may meet edges and corners, so the number of crossings says nothing. `crossed_at` is scratch memory.
inline double share_inside(const Scene& scene, const FoliageShell& shell, const Ray<double>& leg,
                           std::vector<double>& crossed_at) {
  crossed_at.assign({0.0, 1.0});
  const WatertightRay prepared(leg);
  for (const std::uint32_t triangle : shell.triangles) {
    const std::optional<double> t = prepared.intersect(scene.corners_m(triangle));
    if (t && *t > 0.0 && *t < 1.0) crossed_at.push_back(*t);
  }
  std::sort(crossed_at.begin(), crossed_at.end());
  double share = 0.0;
  for (std::size_t index = 1; index < crossed_at.size(); ++index) {
    const double from = crossed_at[index - 1], to = crossed_at[index];
    const bool is_piece = to - from > shortest_piece;
    if (is_piece && is_inside(scene, shell, leg.at(0.5 * (from + to)))) share += to - from;
  }
  return share;
}

}  // namespace detail

DCEM_INLINE void add_foliage_along(const Scene& scene, const Vec3& from_m, const Vec3& to_m,
                                   const IgnoredBodies& ignored, std::vector<FoliageLength>& foliage) {
  std::vector<double> crossed_at;
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
