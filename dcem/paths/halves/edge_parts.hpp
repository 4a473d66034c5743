#pragma once
/// Parts of edges seen from one end, eight at a time.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

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

/// Takes off the ends of a part on which no path is diffracted for sure.
inline void cut_to_contact(EdgePart& part, const EdgeContact& contact) {
  part.from = std::max(part.from, contact.touched_to_m);
  part.to = std::min(part.to, contact.touched_from_m);
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

/// An apex, or what is within `moved_m` of it, as the walks ask for it.
inline ConeTarget edge_target(const Vec3& apex, float moved_m) {
  return {static_cast<float>(apex.x), static_cast<float>(apex.y), static_cast<float>(apex.z),
          5e-3F + 2e-6F * static_cast<float>(glm::length(apex)), moved_m};
}

/// Before it is given a part a lane meets nothing.
inline EightParts no_parts() {
  EightParts parts;
  parts.to.fill(-1e30F);
  return parts;
}

/// Of the line from `start`, counted from where cones are.
inline void set_part(EightParts& parts, std::size_t lane, const EdgePart& part, const Vec3& start,
                     const Vec3& direction) {
  for (int axis = 0; axis < 3; ++axis) {
    parts.start[static_cast<std::size_t>(axis)][lane] = static_cast<float>(start[axis]);
    parts.direction[static_cast<std::size_t>(axis)][lane] = static_cast<float>(direction[axis]);
  }
  parts.from[lane] = part.from;
  parts.to[lane] = part.to;
  parts.place[lane] = part.place;
  parts.distance[lane] = part.distance;
}

/// From now on the parts are those that another end sees.
inline void see_from(EightParts& parts, const Vec3& end) {
  const Float8 dx = Float8(static_cast<float>(end.x)) - Float8(parts.start[0]),
               dy = Float8(static_cast<float>(end.y)) - Float8(parts.start[1]),
               dz = Float8(static_cast<float>(end.z)) - Float8(parts.start[2]);
  const Float8 ex(parts.direction[0]), ey(parts.direction[1]), ez(parts.direction[2]);
  const Float8 place = dx * ex + dy * ey + dz * ez;
  const Float8 x = dx - place * ex, y = dy - place * ey, z = dz - place * ez;
  place.store(parts.place);
  simd::square_root(x * x + y * y + z * z).store(parts.distance);
}

}  // namespace dcem
