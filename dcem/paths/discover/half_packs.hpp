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
#include "dcem/paths/discover/edge_half.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/lane_edge.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// Where the way from a half meets the edges of a pack: points, how far they may be off, and the lanes that are left.
struct HalfPack {
  LanePoints first, last, along, image;
  LanePoints first_normal, last_normal;  ///< of the faces; zero where the gate does not ask
  Float8 length_m;
  std::uint32_t lanes;

  HalfPack(std::span<const EdgeHalf> halves, const Vec3& origin_m);

  /// The lanes of those halves that the way from another may lead on to; with a mirror between the two, whose image the
  /// other is in, through that.
  std::uint32_t meeting(const NearHalf& near, const MirrorWindow* window, const Vec3& origin_m) const;

 private:
  static constexpr float beside_m = 2e-3F;  ///< edges are taken to be longer by this at both ends
  static constexpr int halvings = 5;

  LanePoints at(const Float8& place_m) const {
    return {first.x + place_m * along.x, first.y + place_m * along.y, first.z + place_m * along.z};
  }
  std::uint32_t hidden_by_own_faces(const NearHalf& near) const;
  LaneSlope look_from(const NearHalf& near, const LanePoints& point) const {
    return {
        near.lanes, static_cast<float>(near.place_m), static_cast<float>(near.distance_m), near.error_m, point, along,
        image};
  }
  std::uint32_t missing(const NearHalf& near, const MirrorWindow* window, const Vec3& origin_m) const;
  static std::uint32_t beside(const MirrorWindow& window, const Vec3& origin_m, const LanePoints& from,
                              const LanePoints& to, const Float8& error_m);
};

}  // namespace DCEM_ISA

// ---------------------------------------------------------------------------------------------------------------------

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

/// The lanes in which a way, both of whose ends may be off, crosses a mirror's plane beside the box around it, or not
/// at all.
inline std::uint32_t HalfPack::beside(const MirrorWindow& window, const Vec3& origin_m, const LanePoints& from,
                                      const LanePoints& to, const Float8& error_m) {
  const Vec3& normal = window.plane.normal;
  const auto offset = static_cast<float>(glm::dot(normal, window.plane.point_m - origin_m));
  const auto over = [&](const LanePoints& points) {
    return dot(points, static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)) -
           offset;
  };
  const Float8 first = over(from), second = over(to), inverse = Float8(1.0F) / (first - second);
  std::uint32_t lanes = (((error_m < first) & (error_m < second)) | ((first < -error_m) & (second < -error_m))).bits();
  const LanePoints way = to - from;
  const Float8 length = simd::absolute(way.x) + simd::absolute(way.y) + simd::absolute(way.z);
  const Float8 room = error_m * (Float8(2.0F) + length * simd::absolute(inverse)), share = first * inverse;
  const auto outside = [&](const Float8& start, const Float8& along_way, int axis) {
    const Float8 point = start + share * along_way;
    return ((point + room < Float8(static_cast<float>(window.box.min[axis] - origin_m[axis]))) |
            (Float8(static_cast<float>(window.box.max[axis] - origin_m[axis])) + room < point))
        .bits();
  };
  return lanes | outside(from.x, way.x, 0) | outside(from.y, way.y, 1) | outside(from.z, way.z, 2);
}

/// The lanes in which the way meets the other half's edge beyond its ends, or misses the mirror: of a zero that a few
/// halvings enclose.
inline std::uint32_t HalfPack::missing(const NearHalf& near, const MirrorWindow* window, const Vec3& origin_m) const {
  Float8 low(0.0F), high = length_m;
  for (int step = 0; step < halvings; ++step) {
    const Float8 middle = Float8(0.5F) * (low + high);
    const LaneSlope here = look_from(near, at(middle));
    high = simd::select(here.slope_error < here.slope, middle, high);
    low = simd::select(here.slope < -here.slope_error, middle, low);
  }
  const LanePoints point = at(Float8(0.5F) * (low + high));
  const LaneMeeting here = look_from(near, point).near;
  const Float8 moved_m = Float8(0.5F) * (high - low);  // from where it was asked for
  const Float8 room =
      here.beside_m + beside_m +
      edge_point_reach_m(Float8(static_cast<float>(near.distance_m)), here.sum_m, here.between_m, moved_m);
  const Mask8 beyond =
      (here.place_m + room < Float8(0.0F)) | (Float8(static_cast<float>(near.length_m)) + room < here.place_m);
  if (window == nullptr) return beyond.bits();
  const LaneEdge& edge = near.lanes;
  const LanePoints from{Float8(edge.start[0]) + here.place_m * edge.direction[0],
                        Float8(edge.start[1]) + here.place_m * edge.direction[1],
                        Float8(edge.start[2]) + here.place_m * edge.direction[2]};
  return beyond.bits() | beside(*window, origin_m, from, point, room + moved_m + near.error_m);
}

/// Lanes are asked for what they are not, so that NaN, of points in one, passes.
inline std::uint32_t HalfPack::meeting(const NearHalf& near, const MirrorWindow* window, const Vec3& origin_m) const {
  std::uint32_t left = lanes & ~(near.lanes.behind(near.lanes.from_start(first), near.error_m) &
                                 near.lanes.behind(near.lanes.from_start(last), near.error_m));
  if (left == 0) return 0;
  const LaneSlope start = look_from(near, first);
  left &= ~(start.slope_error < start.slope).bits();
  if (left == 0) return 0;
  const LaneSlope end = look_from(near, last);
  left &= ~(end.slope < -end.slope_error).bits();
  if (left == 0) return 0;
  left &= ~hidden_by_own_faces(near);
  return left == 0 ? 0 : left & ~missing(near, window, origin_m);
}

}  // namespace DCEM_ISA

}  // namespace dcem
