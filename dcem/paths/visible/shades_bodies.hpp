#pragma once
/// Bodies of shades.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/visible/shades.hpp"

namespace dcem {

DCEM_INLINE Shades::Shades(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                           std::span<const FacetId> seen)
    : from_m_(end.position_m) {
  for (const FacetId id : seen) {
    const WorldFacet& facet = scene.facet(id);
    const double off_m = std::abs(signed_distance_m(facet.plane, from_m_));
    if (!facet.present || off_m <= in_plane_guard_m) continue;  // seen edge on it hides nothing
    if (std::ranges::binary_search(end.mounted_on, id)) continue;
    const bool lies_beneath = std::ranges::any_of(end.mounted_on, [&](FacetId mount) {
      return lies_along(scene, facet, scene.facet(mount).plane, from_m_) && off_m <= scene.settings().weld_tolerance_m;
    });
    if (lies_beneath) continue;
    // With more triangles a corner lies on a side of the hull, but for rounding, and a neighbour may begin there.
    if (outlines.of(id).fills_hull && facet.triangle_count + 2 == facet.hull_point_count) {
      add(facet, id, outlines.of(id).stray_m, scene.hull_m(facet));
      continue;
    }
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      add(facet, id, outlines.of(id).stray_m, scene.corners_m(facet.first_triangle + index));
    }
  }
  make_blocks();
}

DCEM_INLINE void Shades::add(const WorldFacet& facet, FacetId id, double stray_m, std::span<const Vec3> corners_m) {
  const std::size_t first = sides_.size();
  add_sides(from_m_, corners_m, sides_);
  if (sides_.size() < first + 3) return sides_.resize(first);
  const double off_m = signed_distance_m(facet.plane, from_m_);
  const Vec3 normal = off_m > 0.0 ? -facet.plane.normal : facet.plane.normal;
  shades_.push_back({id, facet.body, static_cast<std::uint32_t>(corners_m_.size()),
                     static_cast<std::uint32_t>(corners_m.size()), normal,
                     glm::dot(normal, facet.plane.point_m) - stray_m, facet.transmits});
  corners_m_.insert(corners_m_.end(), corners_m.begin(), corners_m.end());
  first_side_.push_back(static_cast<std::uint32_t>(sides_.size()));
  cones_.push_back(DirectionCone::around(from_m_, corners_m));
  nearest_m_.push_back(nearest_m(from_m_, corners_m, std::abs(off_m)));
  of_shades_.add(cones_.back(), nearest_m_.back());
}

/// No more than the distance of any point of the polygon: that of its plane, and of a sphere around it.
DCEM_INLINE double Shades::nearest_m(const Vec3& from_m, std::span<const Vec3> corners_m, double plane_distance_m) {
  Vec3 middle_m(0.0);
  for (const Vec3& corner_m : corners_m) middle_m += corner_m / static_cast<double>(corners_m.size());
  double radius_m = 0.0;
  for (const Vec3& corner_m : corners_m) radius_m = std::max(radius_m, glm::distance(corner_m, middle_m));
  return std::max(0.999 * plane_distance_m, glm::distance(from_m, middle_m) - radius_m);
}

DCEM_INLINE void Shades::make_blocks() {
  for (std::size_t first = 0; first < shades_.size(); first += block_size) {
    const std::size_t end = std::min(first + block_size, shades_.size());
    Vec3 sum(0.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t index = first; index < end; ++index) {
      sum += cones_[index].axis;
      nearest = std::min(nearest, nearest_m_[index]);
    }
    DirectionCone block{glm::length(sum) > 1e-6 ? glm::normalize(sum) : Vec3(0, 0, 1), 1.0, 0.0, false};
    double widest_rad = 0.0;
    for (std::size_t index = first; index < end; ++index) {
      const double off_rad = std::acos(std::clamp(glm::dot(block.axis, cones_[index].axis), -1.0, 1.0));
      widest_rad = std::max(widest_rad, off_rad + std::acos(std::clamp(cones_[index].cosine, -1.0, 1.0)));
      block.is_all = block.is_all || cones_[index].is_all;
    }
    block.cosine = std::cos(widest_rad);
    block.sine = std::sin(widest_rad);
    block.is_all = block.is_all || !(widest_rad < 0.5 * pi) || !(block.cosine > DirectionCone::least_cosine);
    of_blocks_.add(block, nearest);
  }
}

DCEM_INLINE void Shades::Cones::add(const DirectionCone& cone, double nearest) {
  x.push_back(static_cast<float>(cone.axis.x));
  y.push_back(static_cast<float>(cone.axis.y));
  z.push_back(static_cast<float>(cone.axis.z));
  cosine.push_back(cone.is_all ? -1e9F : static_cast<float>(cone.cosine));
  sine.push_back(cone.is_all ? 0.0F : static_cast<float>(cone.sine));
  nearest_m.push_back(static_cast<float>(nearest));
}

/// Two cones meet where their axes are no farther apart than both angles: cos ≥ cos(α + β), but for rounding.
template <typename Visit>
void Shades::Cones::for_each_met(const DirectionCone& cone, double farthest_m, std::size_t first, std::size_t end,
                                 Visit&& visit) const {
  constexpr float slack = 1e-5F;
  const auto ax = static_cast<float>(cone.axis.x), ay = static_cast<float>(cone.axis.y),
             az = static_cast<float>(cone.axis.z), c = static_cast<float>(cone.cosine),
             s = static_cast<float>(cone.sine), far_m = static_cast<float>(1.00001 * farthest_m);
  for (std::size_t index = first; index < end; ++index) {
    const float dot = ax * x[index] + ay * y[index] + az * z[index];
    const bool meets = cone.is_all || dot >= c * cosine[index] - s * sine[index] - slack;
    if (meets && nearest_m[index] <= far_m) visit(index);
  }
}

DCEM_INLINE void Shades::find(const DirectionCone& cone, double farthest_m, std::vector<std::uint32_t>& found) const {
  found.clear();
  of_blocks_.for_each_met(cone, farthest_m, 0, of_blocks_.x.size(), [&](std::size_t block) {
    const std::size_t first = block * block_size, end = std::min(first + block_size, shades_.size());
    of_shades_.for_each_met(cone, farthest_m, first, end,
                            [&](std::size_t index) { found.push_back(static_cast<std::uint32_t>(index)); });
  });
  std::ranges::sort(found, [&](std::uint32_t one, std::uint32_t other) {
    const float a = of_shades_.cosine[one], b = of_shades_.cosine[other];
    return a != b ? a < b : one < other;
  });
}

}  // namespace dcem
