#pragma once
/// Parts of edges seen from one end, in clusters: those that diffract between the end and a place in a cone.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

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

class EdgeClusters {
 public:
  /// `wedge_of(part)` for a part of `parts`; cones count from `origin_m`.
  template <typename WedgeOf>
  void build(std::span<const EdgePart> parts, const Vec3& origin_m, WedgeOf&& wedge_of) {
    clusters_.build(parts.size(), [&](std::uint32_t part) {
      const Wedge& wedge = wedge_of(parts[part]);
      const Vec3 start = wedge.start_m - origin_m, direction = edge_direction(wedge);
      Aabb<double> box;
      box.extend(start + static_cast<double>(parts[part].from) * direction);
      box.extend(start + static_cast<double>(parts[part].to) * direction);
      return box;
    });
    const std::span<const std::uint32_t> items = clusters_.items();
    lanes_.assign(items.size() / simd_lanes, {});
    for (std::size_t at = 0; at < items.size(); ++at) {
      PartLanes& lanes = lanes_[at / simd_lanes];
      const std::size_t lane = at % simd_lanes;
      lanes.to[lane] = -1e30F;
      if (items[at] == ConeClusters::nothing) continue;
      const EdgePart& part = parts[items[at]];
      const Wedge& wedge = wedge_of(part);
      const Vec3 direction = edge_direction(wedge), start = wedge.start_m - origin_m;
      for (int axis = 0; axis < 3; ++axis) {
        lanes.start[static_cast<std::size_t>(axis)][lane] = static_cast<float>(start[axis]);
        lanes.direction[static_cast<std::size_t>(axis)][lane] = static_cast<float>(direction[axis]);
      }
      lanes.from[lane] = part.from;
      lanes.to[lane] = part.to;
      lanes.place[lane] = part.place;
      lanes.distance[lane] = part.distance;
    }
  }

  /// Boxes that hold all parts.
  std::span<const ConeClusters::Box> boxes() const { return clusters_.boxes(); }

  /// Calls `visit(part)` for parts on which the point that diffracts between the end and an apex may lie in a cone, for
  /// the apex at `apex` or anywhere within `moved_m` of it; where `end_moves` it is the end that may be within
  /// `moved_m` of where it is.
  template <bool end_moves = false, typename Visit>
  void for_each_in(std::span<const HalfSpace> cone, const Vec3& apex, float moved_m, Visit&& visit) const {
    const Float8 ax(static_cast<float>(apex.x)), ay(static_cast<float>(apex.y)), az(static_cast<float>(apex.z));
    const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(apex));  // of a place, in single precision
    clusters_.for_each_in(cone, [&](std::size_t first) {
      const PartLanes& lanes = lanes_[first / simd_lanes];
      const Float8 sx(lanes.start[0]), sy(lanes.start[1]), sz(lanes.start[2]);
      const Float8 ex(lanes.direction[0]), ey(lanes.direction[1]), ez(lanes.direction[2]);
      const Float8 own_place(lanes.place), own_distance(lanes.distance), from(lanes.from), to(lanes.to);
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
      if (left == 0) return;
      Float8 room = far;
      if (moved_m > 0.0F) {
        point = simd::minimum(simd::maximum(point, from), to);
        room = far + reach;
      }
      const Float8 px = sx + point * ex, py = sy + point * ey, pz = sz + point * ez;
      for (const HalfSpace& plane : cone) {
        left &= ~(px * plane.x + py * plane.y + pz * plane.z + room < Float8(plane.offset)).bits();
        if (left == 0) return;
      }
      for (; left != 0; left &= left - 1) {
        const std::uint32_t item = clusters_.items()[first + static_cast<std::size_t>(std::countr_zero(left))];
        if (item != ConeClusters::nothing) visit(item);
      }
    });
  }

 private:
  using Lanes = std::array<float, simd_lanes>;
  /// Eight parts, each on its edge's line.
  struct PartLanes {
    std::array<Lanes, 3> start{}, direction{};
    Lanes from{}, to{}, place{}, distance{};
  };

  ConeClusters clusters_;
  std::vector<PartLanes> lanes_;
};

}  // namespace dcem
