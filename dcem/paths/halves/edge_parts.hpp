#pragma once
/// Parts of edges seen from one end, eight at a time: those that diffract between the end and a place in a cone.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/halves/cone.hpp"

namespace dcem {

/// A part of an edge: where it begins and ends along the edge, where along it the end that sees it is, and how far from
/// its line.
struct EdgePart {
  std::uint32_t edge = 0;  ///< of the caller's
  float from = 0.0F, to = 0.0F;
  float place = 0.0F, distance = 0.0F;
};

/// The whole of an edge as an end sees it.
inline EdgePart whole_edge(std::uint32_t number, const Wedge& edge, const Vec3& end_m) {
  const Vec3 direction = edge_direction(edge);
  const double place_m = glm::dot(end_m - edge.start_m, direction);
  return {number, 0.0F, static_cast<float>(edge_length_m(edge)), static_cast<float>(place_m),
          static_cast<float>(glm::distance(end_m, edge.start_m + place_m * direction))};
}

/// Cuts a part of an edge down to what is in a cone, which counts from `origin_m` and has room for rounding; where
/// nothing is left the part ends before it begins.
inline void cut_to_cone(EdgePart& part, const Wedge& edge, const Vec3& origin_m, std::span<const HalfSpace> cone) {
  const Vec3 start = edge.start_m - origin_m, direction = edge_direction(edge);
  for (const HalfSpace& plane : cone) {
    const Vec3 normal(plane.x, plane.y, plane.z);
    const double inside = glm::dot(normal, start) - plane.offset, slope = glm::dot(normal, direction);
    if (slope > 1e-9) {
      part.from = std::max(part.from, static_cast<float>(-inside / slope));
    } else if (slope < -1e-9) {
      part.to = std::min(part.to, static_cast<float>(-inside / slope));
    } else if (inside < 0.0) {
      part.to = -1e30F;
    }
  }
}

/// How far the point that diffracts may move along an edge while the other end moves by `moved_m`: with the places z₁,
/// z₂ and distances d₁, d₂ of both ends it is at z₁ + (z₂ − z₁) d₁/(d₁ + d₂), of which the derivative by z₂ and d₂ has
/// the size d₁/(d₁ + d₂) √(1 + ((z₂ − z₁)/(d₁ + d₂))²).
inline Float8 edge_point_reach_m(const Float8& own_distance, const Float8& sum, const Float8& between,
                                 const Float8& moved_m) {
  const Float8 least = simd::maximum(sum - moved_m, Float8(1e-3F));
  const Float8 slope = (simd::absolute(between) + moved_m) / least;
  return moved_m * own_distance / least * simd::square_root(Float8(1.0F) + slope * slope);
}

/// How far the point may be off because the end that sees the edge is far away.
inline Float8 edge_point_error_m(const Float8& own_place, const Float8& own_distance) {
  return Float8(1e-6F) * (simd::absolute(own_place) + own_distance);
}

/// Eight parts of edges, each on its edge's line, as the end that sees them does.
class PartLanes {
 public:
  /// Before it is given a part a lane meets nothing.
  PartLanes() { to_.fill(-1e30F); }

  /// The numbers count from `origin_m`.
  void set(std::size_t lane, const EdgePart& part, const Wedge& wedge, const Vec3& origin_m) {
    const Vec3 direction = edge_direction(wedge), start = wedge.start_m - origin_m;
    for (int axis = 0; axis < 3; ++axis) {
      start_[static_cast<std::size_t>(axis)][lane] = static_cast<float>(start[axis]);
      direction_[static_cast<std::size_t>(axis)][lane] = static_cast<float>(direction[axis]);
    }
    from_[lane] = part.from;
    to_[lane] = part.to;
    place_[lane] = part.place;
    distance_[lane] = part.distance;
  }

  /// From now on the parts are those that another end sees.
  void see_from(const Vec3& end) {
    const Float8 dx = Float8(static_cast<float>(end.x)) - Float8(start_[0]),
                 dy = Float8(static_cast<float>(end.y)) - Float8(start_[1]),
                 dz = Float8(static_cast<float>(end.z)) - Float8(start_[2]);
    const Float8 ex(direction_[0]), ey(direction_[1]), ez(direction_[2]);
    const Float8 place = dx * ex + dy * ey + dz * ez;
    const Float8 x = dx - place * ex, y = dy - place * ey, z = dz - place * ez;
    place.store(place_);
    simd::square_root(x * x + y * y + z * z).store(distance_);
  }

  /// Parts on which the point that diffracts between the end and an apex may lie in a cone, for the apex at `apex` or
  /// anywhere within `moved_m` of it; where `end_moves` it is the end that may be within `moved_m` of where it is.
  template <bool end_moves = false>
  std::uint32_t meeting(std::span<const HalfSpace> cone, const Vec3& apex, float moved_m) const {
    const Float8 ax(static_cast<float>(apex.x)), ay(static_cast<float>(apex.y)), az(static_cast<float>(apex.z));
    const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(apex));  // of a place, in single precision
    const Float8 sx(start_[0]), sy(start_[1]), sz(start_[2]);
    const Float8 ex(direction_[0]), ey(direction_[1]), ez(direction_[2]);
    const Float8 own_place(place_), own_distance(distance_), from(from_), to(to_);
    const Float8 dx = ax - sx, dy = ay - sy, dz = az - sz;
    const Float8 place = dx * ex + dy * ey + dz * ez;
    const Float8 x = dx - place * ex, y = dy - place * ey, z = dz - place * ez;
    const Float8 distance = simd::square_root(x * x + y * y + z * z), sum = own_distance + distance;
    const Float8 between = place - own_place;
    Float8 point = own_place + between * (own_distance / sum);
    // Asked for so that NaN, of an end and an apex on the edge's line, is inside.
    const Float8 far = edge_point_error_m(own_place, own_distance);
    Float8 reach = far + slack_m;
    if (moved_m > 0.0F) {
      reach = reach + edge_point_reach_m(end_moves ? distance : own_distance, sum, between, moved_m);
    }
    std::uint32_t left = ~((point + reach < from) | (to + reach < point)).bits() & 0xffU;
    if (left == 0) return 0;
    Float8 room = far;
    if (moved_m > 0.0F) {
      point = simd::minimum(simd::maximum(point, from), to);
      room = far + reach;
    }
    const Float8 px = sx + point * ex, py = sy + point * ey, pz = sz + point * ez;
    for (const HalfSpace& plane : cone) {
      left &= ~(px * plane.x + py * plane.y + pz * plane.z + room < Float8(plane.offset)).bits();
      if (left == 0) break;
    }
    return left;
  }

 private:
  using Lanes = std::array<float, simd_lanes>;
  std::array<Lanes, 3> start_{}, direction_{};
  Lanes from_{}, to_{}, place_{}, distance_{};
};

}  // namespace dcem
