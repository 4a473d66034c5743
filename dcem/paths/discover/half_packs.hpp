#pragma once
/// Halves of paths that end at edges, eight at a time: which of them the shortest way from another half may lead on to.
///
/// The reasons are those of paths/halves/edge_pairs.hpp; here each edge is met from an image of its own.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/lane_edge.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// An edge that an end reaches, the mirrors on the way from the end, and the end's image in them.
struct EdgeHalf {
  WedgeId id;
  Wedge edge;
  std::span<const SequenceElement> mirrors;
  Vec3 image_m;
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

inline namespace DCEM_ISA {

/// Where the way from a half meets the edges of a pack: points, how far they may be off, and the lanes that are left.
struct HalfPack {
  LanePoints first, last, along, image;
  LanePoints first_normal, last_normal;  ///< of the faces; zero where the gate does not ask
  Float8 length_m;
  std::uint32_t lanes;

  HalfPack(std::span<const EdgeHalf> halves, const Vec3& origin_m);

  /// The lanes of those halves that the way from another may lead on to.
  std::uint32_t meeting(const NearHalf& near) const;

 private:
  static constexpr float beside_m = 2e-3F;  ///< edges are taken to be longer by this at both ends
  static constexpr int halvings = 5;

  struct Found {
    LaneMeeting near;
    Float8 slope, slope_error;
  };
  LanePoints at(const Float8& place_m) const {
    return {first.x + place_m * along.x, first.y + place_m * along.y, first.z + place_m * along.z};
  }
  std::uint32_t hidden_by_own_faces(const NearHalf& near) const;
  Found look_from(const NearHalf& near, const LanePoints& point) const;
  std::uint32_t missing(const NearHalf& near) const;
};

}  // namespace DCEM_ISA

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

inline namespace DCEM_ISA {

inline HalfPack::HalfPack(std::span<const EdgeHalf> halves, const Vec3& origin_m)
    : first(Vec3(0.0)),
      last(Vec3(0.0)),
      along(Vec3(0.0)),
      image(Vec3(0.0)),
      first_normal(Vec3(0.0)),
      last_normal(Vec3(0.0)),
      length_m(0.0F),
      lanes((1U << halves.size()) - 1U) {
  std::array<Vec3, simd_lanes> from, to, way, source, one, other;
  std::array<float, simd_lanes> length{};
  for (std::size_t lane = 0; lane < halves.size(); ++lane) {
    const EdgeHalf& half = halves[lane];
    way[lane] = edge_direction(half.edge);
    from[lane] = half.edge.start_m - static_cast<double>(beside_m) * way[lane];
    to[lane] = half.edge.end_m + static_cast<double>(beside_m) * way[lane];
    source[lane] = half.image_m;
    const double asks = half.edge.exterior_angle_rad > pi ? 1.0 : 0.0;
    one[lane] = asks * half.edge.normal;
    other[lane] = asks * detail::last_face_normal(half.edge);
    length[lane] = static_cast<float>(edge_length_m(half.edge)) + 2.0F * beside_m;
  }
  const auto held = [&](const std::array<Vec3, simd_lanes>& all) {
    return std::span<const Vec3>(all).first(halves.size());
  };
  first = LanePoints(held(from), origin_m);
  last = LanePoints(held(to), origin_m);
  along = LanePoints(held(way), Vec3(0.0));
  image = LanePoints(held(source), origin_m);
  first_normal = LanePoints(held(one), Vec3(0.0));
  last_normal = LanePoints(held(other), Vec3(0.0));
  length_m = Float8(length);
}

/// The lanes whose wedge has the whole edge of the other half in its interior.
inline std::uint32_t HalfPack::hidden_by_own_faces(const NearHalf& near) const {
  const Float8 slack(-(near.error_m + 2e-3F));
  std::uint32_t hidden = lanes;
  for (const float place : {0.0F, static_cast<float>(near.length_m)}) {
    const auto coordinate = [&](std::size_t axis) {
      return Float8(near.lanes.start[axis] + place * near.lanes.direction[axis]);
    };
    const LanePoints away = LanePoints(coordinate(0), coordinate(1), coordinate(2)) - first;
    const auto over = [&](const LanePoints& normal) {
      return away.x * normal.x + away.y * normal.y + away.z * normal.z;
    };
    hidden &= ((over(first_normal) < slack) & (over(last_normal) < slack)).bits();
    if (hidden == 0) break;
  }
  return hidden;
}

inline HalfPack::Found HalfPack::look_from(const NearHalf& near, const LanePoints& point) const {
  const LanePoints away = near.lanes.from_start(point);
  Found found{{near.lanes, static_cast<float>(near.place_m), static_cast<float>(near.distance_m), away, near.error_m},
              Float8(0.0F),
              Float8(0.0F)};
  const LanePoints in = near.lanes.across(away, found.near.place_m), out = image - point;
  const auto per_length = [](const LanePoints& way) {
    return Float8(1.0F) / simd::square_root(way.x * way.x + way.y * way.y + way.z * way.z);
  };
  const auto along_edge = [&](const LanePoints& way) { return way.x * along.x + way.y * along.y + way.z * along.z; };
  const Float8 per_in = per_length(in), per_out = per_length(out), error(2.0F * near.error_m);
  found.slope = along_edge(in) * per_in - along_edge(out) * per_out;
  found.slope_error = Float8(2.0F) * ((found.near.beside_m + error) * per_in + error * per_out) + 2e-6F;
  return found;
}

/// The lanes in which the way meets the other half's edge beyond its ends, of a zero that a few halvings enclose.
inline std::uint32_t HalfPack::missing(const NearHalf& near) const {
  Float8 low(0.0F), high = length_m;
  for (int step = 0; step < halvings; ++step) {
    const Float8 middle = Float8(0.5F) * (low + high);
    const Found here = look_from(near, at(middle));
    high = simd::select(here.slope_error < here.slope, middle, high);
    low = simd::select(here.slope < -here.slope_error, middle, low);
  }
  const LaneMeeting here = look_from(near, at(Float8(0.5F) * (low + high))).near;
  const Float8 moved_m = Float8(0.5F) * (high - low);  // from where it was asked for
  const Float8 room =
      here.beside_m + beside_m +
      edge_point_reach_m(Float8(static_cast<float>(near.distance_m)), here.sum_m, here.between_m, moved_m);
  return ((here.place_m + room < Float8(0.0F)) | (Float8(static_cast<float>(near.length_m)) + room < here.place_m))
      .bits();
}

/// Lanes are asked for what they are not, so that NaN, of points in one, passes.
inline std::uint32_t HalfPack::meeting(const NearHalf& near) const {
  std::uint32_t left = lanes & ~(near.lanes.behind(near.lanes.from_start(first), near.error_m) &
                                 near.lanes.behind(near.lanes.from_start(last), near.error_m));
  if (left == 0) return 0;
  const Found start = look_from(near, first);
  left &= ~(start.slope_error < start.slope).bits();
  if (left == 0) return 0;
  const Found end = look_from(near, last);
  left &= ~(end.slope < -end.slope_error).bits();
  if (left == 0) return 0;
  left &= ~hidden_by_own_faces(near);
  return left == 0 ? 0 : left & ~missing(near);
}

}  // namespace DCEM_ISA

}  // namespace dcem
