#pragma once
/// Halves of paths that end at edges, and what may lead on from them.
#include <algorithm>
#include <cmath>
#include <span>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/lane_edge.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// An edge that an end reaches, the mirrors on the way from the end, and the end's image in them.
struct EdgeHalf {
  WedgeId id;
  Wedge edge;
  std::span<const SequenceElement> mirrors;
  Vec3 image_m;
  std::span<const FacetId> in_view{};  ///< mirrors that the edge sees, ascending
};

/// A mirror between two edges: its plane, and the box around it.
struct MirrorWindow {
  Plane plane;
  Aabb<double> box;
};

/// A half as others are asked against it, in double and in single precision.
struct NearHalf {
  Wedge edge;
  Vec3 along, last_normal;
  double place_m, distance_m, length_m;  ///< of the image along and from the edge; of the edge
  LaneEdge lanes;
  float error_m;  ///< how far coordinates in single precision may be off

  NearHalf(const EdgeHalf& half, const Vec3& origin_m, double reach_m);

  /// Whether the edge may be seen from anywhere in a box, and the way from there over it may meet it.
  bool may_meet(const Aabb<double>& box) const;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// The normal of the second face, on the exterior side.
inline Vec3 last_face_normal(const Wedge& wedge) {
  const double angle_rad = wedge.exterior_angle_rad;
  return std::sin(angle_rad) * wedge.tangent - std::cos(angle_rad) * wedge.normal;
}

}  // namespace detail

inline NearHalf::NearHalf(const EdgeHalf& half, const Vec3& origin_m, double reach_m)
    : edge(half.edge),
      along(edge_direction(half.edge)),
      last_normal(detail::last_face_normal(half.edge)),
      place_m(glm::dot(half.image_m - half.edge.start_m, along)),
      distance_m(glm::distance(half.image_m, half.edge.start_m + place_m * along)),
      length_m(edge_length_m(half.edge)),
      lanes(lane_edge(half.edge, origin_m)),
      error_m(static_cast<float>(4e-7 * reach_m)) {}

inline bool NearHalf::may_meet(const Aabb<double>& box) const {
  const Vec3 half_m = 0.5 * (box.max - box.min), middle_m = 0.5 * (box.min + box.max) - edge.start_m;
  const auto spread = [&](const Vec3& direction) { return glm::dot(glm::abs(direction), half_m); };
  const auto is_behind = [&](const Vec3& normal) { return glm::dot(normal, middle_m) + spread(normal) < -1e-2; };
  if (lanes.both_faces && is_behind(edge.normal) && is_behind(last_normal)) return false;
  // A point at z along the edge and d from it leads on to the image over (z·d₁ + z₁·d)/(d + d₁).
  const double middle = glm::dot(middle_m, along), low = middle - spread(along), high = middle + spread(along);
  const double from_line = glm::length(middle_m - middle * along), radius = glm::length(half_m);
  const double nearest = std::max(0.0, from_line - radius), farthest = from_line + radius;
  const double slack = 1e-2 * (farthest + distance_m);
  const auto times = [&](double slope, double most) { return slope * (slope * most > 0.0 ? farthest : nearest); };
  return times(place_m, 1.0) + high * distance_m > -slack &&
         times(place_m - length_m, -1.0) + (low - length_m) * distance_m < slack;
}

}  // namespace dcem
