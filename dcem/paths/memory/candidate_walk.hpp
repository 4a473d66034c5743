#pragma once
/// Which of many ways over one edge, and perhaps over a mirror next to the device, a device at a point may take: the
/// inmost loop of receivers that move through places.
///
/// All in single precision around the middle of the place. What is walked through holds plain numbers and is the same
/// for every processor; the walks stand under the name of the instructions that they are compiled for
/// (core/instruction_set.hpp), and all say the same (candidate_kernels.hpp).
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/paths/halves/cone_walk.hpp"

namespace dcem {

/// Eight parts of edges, as the standing end, or its image, sees them; over a mirror next to the device both are
/// mirrored in it.
struct EightCandidates {
  EightParts parts;
  EightFloats error{};  ///< how far a point on the edge may be off, relative to how oblique the way is
};

/// A mirror next to the device, and which candidates are over it.
struct CandidateMirror {
  /// normal·x − offset, which is 0 on it and positive on one side.
  struct Plane {
    float x = 0.0F, y = 0.0F, z = 0.0F, offset = 0.0F;

    [[gnu::always_inline]] float at(float px, float py, float pz) const { return x * px + y * py + z * pz - offset; }
  };
  Plane plane;
  std::array<Plane, 4> sides;  ///< of its hull, positive inside; where there are more, the others are not asked
  std::size_t end = 0;         ///< those over it come before this one, and after those over the mirror before
};

/// Where a device is.
struct CandidatePoint {
  float x, y, z;
};

/// Points this far beside an edge or a mirror are left to the solver, metres.
inline constexpr float candidate_room_m = 2e-3F;

inline namespace DCEM_ISA {

/// Where the ways meet their edges, how far that may be off, and which of these points are on the parts.
struct EdgesMet {
  Float8 x, y, z, error;
  std::uint32_t lanes;
};

[[gnu::always_inline]] inline EdgesMet edges_met(const EightCandidates& eight, const CandidatePoint& point) {
  const EightParts& parts = eight.parts;
  const Float8 sx(parts.start[0]), sy(parts.start[1]), sz(parts.start[2]);
  const Float8 dx = Float8(point.x) - sx, dy = Float8(point.y) - sy, dz = Float8(point.z) - sz;
  const Float8 ex(parts.direction[0]), ey(parts.direction[1]), ez(parts.direction[2]);
  const Float8 own_place(parts.place), own_distance(parts.distance);
  const Float8 at = dx * ex + dy * ey + dz * ez;
  const Float8 x = dx - at * ex, y = dy - at * ey, z = dz - at * ez;
  const Float8 sum = own_distance + simd::square_root(x * x + y * y + z * z);
  const Float8 between = at - own_place, inverse = Float8(1.0F) / sum;
  const Float8 met = own_place + between * (own_distance * inverse);
  const Float8 off = Float8(eight.error) * (Float8(1.0F) + simd::absolute(between) * inverse);
  const Float8 room = off + candidate_room_m;
  // Asked for so that NaN, of both ends on the edge's line, passes.
  const std::uint32_t out = ((met + room < Float8(parts.from)) | (Float8(parts.to) + room < met)).bits();
  return {sx + met * ex, sy + met * ey, sz + met * ez, off, ~out & 0xffU};
}

/// Which of the ways to these points may cross a mirror on its hull. With p and q the distances of device and point
/// from the mirror, and s and t those inside a side, a way does where s |q| + t |p| ≥ 0.
[[gnu::always_inline]] inline std::uint32_t crossings_met(const CandidateMirror& mirror, const CandidatePoint& point,
                                                          const EdgesMet& met) {
  const auto at_met = [&](const CandidateMirror::Plane& of) {
    return met.x * of.x + met.y * of.y + met.z * of.z - of.offset;
  };
  const Float8 own(mirror.plane.at(point.x, point.y, point.z)), other = at_met(mirror.plane), error = met.error;
  std::uint32_t left = ~(((error < own) & (error < other)) | ((own < -error) & (other < -error))).bits() & 0xffU;
  const Float8 p = simd::absolute(own) + error, q = simd::absolute(other) + error;
  const Float8 room = (error + candidate_room_m) * (p + q);
  for (const CandidateMirror::Plane& side : mirror.sides) {
    if (left == 0) break;
    const Float8 s(side.at(point.x, point.y, point.z)), t = at_met(side);
    const Float8 inside = s * q + t * p + room + error * (simd::absolute(s) + simd::absolute(t)) * 2.0F;
    left &= ~(inside < Float8(0.0F)).bits();
  }
  return left;
}

/// Tells of ways over an edge alone that a device at a point may take.
inline void visit_over_edges(std::span<const EightCandidates> all, const CandidatePoint& point,
                             const EightsVisitor& visit) {
  for (std::size_t eight = 0; eight < all.size(); ++eight) {
    const std::uint32_t lanes = edges_met(all[eight], point).lanes;
    if (lanes != 0) visit(eight * simd_lanes, lanes);
  }
}

/// The same of ways over mirrors.
inline void visit_over_mirrors(std::span<const EightCandidates> all, std::span<const CandidateMirror> mirrors,
                               const CandidatePoint& point, const EightsVisitor& visit) {
  std::size_t next = 0;  // the first candidate that has not been asked yet
  for (const CandidateMirror& mirror : mirrors) {
    while (next < mirror.end) {
      const std::size_t first = next / simd_lanes * simd_lanes, end = std::min(mirror.end, first + simd_lanes);
      const EdgesMet met = edges_met(all[first / simd_lanes], point);
      std::uint32_t lanes = met.lanes & (0xffU << (next - first)) & (0xffU >> (first + simd_lanes - end));
      if (lanes != 0) lanes &= crossings_met(mirror, point, met);
      if (lanes != 0) visit(first, lanes);
      next = end;
    }
  }
}

}  // namespace DCEM_ISA

}  // namespace dcem
