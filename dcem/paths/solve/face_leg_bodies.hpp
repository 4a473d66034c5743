#pragma once
/// Bodies of face_leg.hpp.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/solve/face_leg.hpp"

namespace dcem {

namespace detail {

/// The part of a segment, as shares of its length, that lies in a triangle of a plane with this normal or within
/// `tolerance_m` of it; none: first ≥ second.
inline std::pair<double, double> share_in_triangle(const Vec3& from_m, const Vec3& to_m,
                                                   const std::array<Vec3, 3>& corners_m, const Vec3& normal,
                                                   double tolerance_m) {
  const double turn = glm::dot(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]), normal);
  std::pair<double, double> share{0.0, 1.0};
  for (std::size_t side = 0; side < 3; ++side) {
    const Vec3 along = glm::normalize(corners_m[(side + 1) % 3] - corners_m[side]);
    const Vec3 inwards = (turn < 0.0 ? -1.0 : 1.0) * glm::cross(normal, along);
    const double start_m = glm::dot(from_m - corners_m[side], inwards) + tolerance_m;
    const double end_m = glm::dot(to_m - corners_m[side], inwards) + tolerance_m;
    if (start_m < 0.0 && end_m < 0.0) return {1.0, 0.0};
    if (start_m < 0.0) share.first = std::max(share.first, start_m / (start_m - end_m));
    if (end_m < 0.0) share.second = std::min(share.second, start_m / (start_m - end_m));
  }
  return share;
}

}  // namespace detail

DCEM_INLINE bool lies_on_facet(const Scene& scene, FacetId id, const Vec3& from_m, const Vec3& to_m,
                               double tolerance_m) {
  const WorldFacet& facet = scene.facet(id);
  std::vector<std::pair<double, double>> shares;
  for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
    const auto corners_m = scene.corners_m(facet.first_triangle + index);
    const auto share = detail::share_in_triangle(from_m, to_m, {corners_m[0], corners_m[1], corners_m[2]},
                                                 facet.plane.normal, tolerance_m);
    if (share.first < share.second) shares.push_back(share);
  }
  std::sort(shares.begin(), shares.end());
  double reached = 0.0;
  for (const auto& [first, second] : shares) {
    if (first > reached) return false;
    reached = std::max(reached, second);
  }
  return reached >= 1.0;
}

}  // namespace dcem
