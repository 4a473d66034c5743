#pragma once
/// Façades that stand on the lowest level of a scenery: what is seen under their feet is nothing.
///
/// A way from a point above that level that passes under such a foot falls, and stays below the level: it meets nothing
/// of the scenery any more. So the façade hides as if it went on downwards. Without that, the pixels that its foot runs
/// through are filled by nothing, and at street level, where feet of façades far away lie in one row of pixels,
/// elements of half a city show through them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/paths/halves/inset.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

class FacetFeet {
 public:
  /// From so far above the lowest level on feet are asked about.
  static constexpr double least_height_m = 0.1;

  /// Looks at the first facets of a scene, those of its scenery.
  void find(const Scene& scene, std::uint32_t facets);

  /// The lowest corner of the scenery; +∞ where there is none.
  double lowest_m() const { return lowest_m_; }
  /// Whether a facet stands on that level, upright, with sides that go straight up.
  bool stands(FacetId facet) const { return facet.value < foot_.size() && foot_[facet.value] != none; }
  /// The hull of a facet that stands, its foot so far lower. Corners keep their numbers.
  std::span<const Vec3> deepened(FacetId facet, std::span<const Vec3> hull_m, double depth_m,
                                 detail::InsetOutline& deep) const;

 private:
  static constexpr unsigned char none = 255;
  static constexpr std::size_t most_corners = 32;
  /// What is no higher than this belongs to the foot: then it must be on the lowest level, to the last bit.
  static constexpr double foot_m = 1e-3;
  static constexpr double rounding_m = 1e-9;  ///< of corners of hulls

  /// The number of the corner with which the foot begins.
  unsigned char foot_of(const Scene& scene, const WorldFacet& facet) const;
  template <typename Visit>
  static void for_each_corner(const Scene& scene, const WorldFacet& facet, Visit&& visit);
  bool is_on_lowest_level(const Scene& scene, const WorldFacet& facet) const;

  std::vector<unsigned char> foot_;  ///< by facet
  double lowest_m_ = std::numeric_limits<double>::infinity();
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Visit>
void FacetFeet::for_each_corner(const Scene& scene, const WorldFacet& facet, Visit&& visit) {
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    for (const Vec3& corner_m : scene.corners_m(facet.first_triangle + triangle)) visit(corner_m);
  }
}

inline void FacetFeet::find(const Scene& scene, std::uint32_t facets) {
  const auto scenery = scene.facets().first(facets);
  for (const WorldFacet& facet : scenery) {
    for_each_corner(scene, facet, [&](const Vec3& corner_m) { lowest_m_ = std::min(lowest_m_, corner_m.z); });
  }
  for (const WorldFacet& facet : scenery) foot_.push_back(foot_of(scene, facet));
}

/// Whether all corners of its triangles that are as low as its foot are on the lowest level.
inline bool FacetFeet::is_on_lowest_level(const Scene& scene, const WorldFacet& facet) const {
  bool is_on = true;
  for_each_corner(scene, facet, [&](const Vec3& corner_m) {
    is_on = is_on && (corner_m.z >= lowest_m_ + foot_m || corner_m.z == lowest_m_);
  });
  return is_on;
}

/// Of an upright hull with two corners at the foot, from which its sides go straight up: where there are more, one of
/// them lies beside another and not below.
inline unsigned char FacetFeet::foot_of(const Scene& scene, const WorldFacet& facet) const {
  const std::span<const Vec3> hull_m = scene.hull_m(facet);
  if (std::abs(facet.plane.normal.z) > rounding_m || hull_m.size() < 4 || hull_m.size() > most_corners) return none;
  const auto is_low = [&](const Vec3& corner_m) { return corner_m.z < lowest_m_ + foot_m; };
  const auto corner_m = [&](std::size_t number) { return hull_m[number % hull_m.size()]; };
  const auto is_below = [&](std::size_t low, std::size_t high) {
    const Vec3 way_m = corner_m(high) - corner_m(low);
    return std::hypot(way_m.x, way_m.y) <= rounding_m && std::abs(corner_m(low).z - lowest_m_) <= rounding_m;
  };
  for (std::size_t first = 0; first < hull_m.size(); ++first) {
    if (!is_low(corner_m(first)) || !is_low(corner_m(first + 1))) continue;
    const bool is_straight = is_below(first, first + hull_m.size() - 1) && is_below(first + 1, first + 2);
    return is_straight && is_on_lowest_level(scene, facet) ? static_cast<unsigned char>(first) : none;
  }
  return none;
}

inline std::span<const Vec3> FacetFeet::deepened(FacetId facet, std::span<const Vec3> hull_m, double depth_m,
                                                 detail::InsetOutline& deep) const {
  if (!deep.assign(hull_m)) return hull_m;
  const std::size_t first = foot_[facet.value];
  deep.corners_m[first].z -= depth_m;
  deep.corners_m[(first + 1) % hull_m.size()].z -= depth_m;
  return deep.corners();
}

}  // namespace dcem
