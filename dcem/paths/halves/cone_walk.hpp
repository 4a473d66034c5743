#pragma once
/// Walks through clusters of boxes, and of what lies in them, that a cone may reach: the inmost loops of joining.
///
/// What is walked through holds plain numbers and is the same for every processor; the walks stand under the name of
/// the instructions that they are compiled for (core/instruction_set.hpp), and all say the same (cone_kernels.hpp).
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/simd.hpp"

namespace dcem {

/// The half space normal·x ≥ offset.
struct HalfSpace {
  float x, y, z, offset;
};

/// Eight numbers side by side.
using EightFloats = std::array<float, simd_lanes>;

/// Eight boxes as centres and half sizes.
struct EightBoxes {
  std::array<EightFloats, 3> centre{}, half{};
  std::uint32_t used = 0;  ///< bit i: lane i holds a box
};

/// Clusters of eight items, and groups of eight clusters, by their boxes; boxes are nested likewise.
struct BoxTree {
  std::span<const EightBoxes> groups, clusters;
};

/// Eight parts of edges, each on its edge's line, as one end sees them.
struct EightParts {
  std::array<EightFloats, 3> start{}, direction{};
  EightFloats from{}, to{};         ///< along the edge
  EightFloats place{}, distance{};  ///< of the end, along the edge and from its line
};

/// Eight images of an end, and what each of them sees through its mirror: as many half spaces as a mirror of four sides
/// has.
struct EightImages {
  static constexpr std::size_t plane_count = 5;
  std::array<EightFloats, 3> place{};
  std::array<std::array<EightFloats, 4>, plane_count> planes{};
};

/// A place that counts from where cones do, or whatever is within `moved_m` of it.
struct ConeTarget {
  float x, y, z;
  float slack_m;  ///< how far a place may be off, in single precision
  float moved_m;
};

/// Is told of eight items, which stand from `first` on: those whose bits are set may be reached.
struct EightsVisitor {
  void (*visit)(void* context, std::size_t first, std::uint32_t lanes);
  void* context;

  [[gnu::always_inline]] void operator()(std::size_t first, std::uint32_t lanes) const { visit(context, first, lanes); }
};

inline namespace DCEM_ISA {

/// The boxes of which some point may be in a cone.
[[gnu::always_inline]] inline std::uint32_t boxes_met(const EightBoxes& boxes, std::span<const HalfSpace> cone) {
  const Float8 x(boxes.centre[0]), y(boxes.centre[1]), z(boxes.centre[2]);
  const Float8 dx(boxes.half[0]), dy(boxes.half[1]), dz(boxes.half[2]);
  std::uint32_t met = boxes.used;
  for (const HalfSpace& plane : cone) {
    const Float8 reach = x * plane.x + y * plane.y + z * plane.z + dx * std::abs(plane.x) + dy * std::abs(plane.y) +
                         dz * std::abs(plane.z);
    met &= (Float8(plane.offset) <= reach).bits();
    if (met == 0) break;
  }
  return met;
}

/// Calls `visit(cluster)` for each cluster that a cone may reach.
template <typename Visit>
[[gnu::always_inline]] inline void walk_clusters(const BoxTree& tree, std::span<const HalfSpace> cone, Visit&& visit) {
  for (std::size_t upper = 0; upper < tree.groups.size(); ++upper) {
    for (std::uint32_t met = boxes_met(tree.groups[upper], cone); met != 0; met &= met - 1) {
      const std::size_t group = upper * simd_lanes + static_cast<std::size_t>(std::countr_zero(met));
      for (std::uint32_t inside = boxes_met(tree.clusters[group], cone); inside != 0; inside &= inside - 1) {
        visit(group * simd_lanes + static_cast<std::size_t>(std::countr_zero(inside)));
      }
    }
  }
}

/// How far the point that diffracts may move along an edge while the other end moves by `moved_m`: with the places z₁,
/// z₂ and distances d₁, d₂ of both ends it is at z₁ + (z₂ − z₁) d₁/(d₁ + d₂), of which the derivative by z₂ and d₂ has
/// the size d₁/(d₁ + d₂) √(1 + ((z₂ − z₁)/(d₁ + d₂))²).
[[gnu::always_inline]] inline Float8 edge_point_reach_m(const Float8& own_distance, const Float8& sum,
                                                        const Float8& between, const Float8& moved_m) {
  const Float8 least = simd::maximum(sum - moved_m, Float8(1e-3F));
  const Float8 slope = (simd::absolute(between) + moved_m) / least;
  return moved_m * own_distance / least * simd::square_root(Float8(1.0F) + slope * slope);
}

/// How far the point may be off because the end that sees the edge is far away.
[[gnu::always_inline]] inline Float8 edge_point_error_m(const Float8& own_place, const Float8& own_distance) {
  return Float8(1e-6F) * (simd::absolute(own_place) + own_distance);
}

/// Parts on which the point that diffracts between the end and a target may lie in a cone; where `end_moves` it is the
/// end that may be within `moved_m` of where it is.
template <bool end_moves>
[[gnu::always_inline]] inline std::uint32_t parts_met(const EightParts& parts, std::span<const HalfSpace> cone,
                                                      const ConeTarget& target) {
  const Float8 sx(parts.start[0]), sy(parts.start[1]), sz(parts.start[2]);
  const Float8 ex(parts.direction[0]), ey(parts.direction[1]), ez(parts.direction[2]);
  const Float8 own_place(parts.place), own_distance(parts.distance), from(parts.from), to(parts.to);
  const Float8 dx = Float8(target.x) - sx, dy = Float8(target.y) - sy, dz = Float8(target.z) - sz;
  const Float8 place = dx * ex + dy * ey + dz * ez;
  const Float8 x = dx - place * ex, y = dy - place * ey, z = dz - place * ez;
  const Float8 distance = simd::square_root(x * x + y * y + z * z), sum = own_distance + distance;
  const Float8 between = place - own_place;
  Float8 point = own_place + between * (own_distance / sum);
  // Asked for so that NaN, of an end and a target on the edge's line, is inside.
  const Float8 far = edge_point_error_m(own_place, own_distance);
  Float8 reach = far + target.slack_m;
  if (target.moved_m > 0.0F) {
    reach = reach + edge_point_reach_m(end_moves ? distance : own_distance, sum, between, target.moved_m);
  }
  std::uint32_t left = ~((point + reach < from) | (to + reach < point)).bits() & 0xffU;
  if (left == 0) return 0;
  Float8 room = far;
  if (target.moved_m > 0.0F) {
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

/// Images that may lie in a cone, and may see a target through their mirrors.
[[gnu::always_inline]] inline std::uint32_t images_met(const EightImages& images, std::span<const HalfSpace> cone,
                                                       const ConeTarget& target) {
  const Float8 x(images.place[0]), y(images.place[1]), z(images.place[2]);
  const Float8 error_m = Float8(1e-6F) * (simd::absolute(x) + simd::absolute(y) + simd::absolute(z));
  std::uint32_t left = 0xffU;
  for (const HalfSpace& plane : cone) {
    left &= ~(x * plane.x + y * plane.y + z * plane.z + error_m < Float8(plane.offset)).bits();
    if (left == 0) return 0;
  }
  const float room_m = target.moved_m + target.slack_m;
  for (const auto& plane : images.planes) {
    const Float8 inside =
        Float8(plane[0]) * target.x + Float8(plane[1]) * target.y + Float8(plane[2]) * target.z + room_m;
    left &= ~(inside < Float8(plane[3])).bits();
    if (left == 0) return 0;
  }
  return left;
}

/// Tells of the items that may be in a cone; `boxes`: of the items, in eights.
inline void visit_boxes(const BoxTree& tree, std::span<const EightBoxes> boxes, std::span<const HalfSpace> cone,
                        const EightsVisitor& visit) {
  walk_clusters(tree, cone, [&](std::size_t cluster) {
    const std::uint32_t lanes = boxes_met(boxes[cluster], cone);
    if (lanes != 0) visit(cluster * simd_lanes, lanes);
  });
}

/// The same of parts of edges, as `parts_met` has it …
template <bool end_moves>
inline void visit_parts(const BoxTree& tree, std::span<const EightParts> parts, std::span<const HalfSpace> cone,
                        const ConeTarget& target, const EightsVisitor& visit) {
  walk_clusters(tree, cone, [&](std::size_t cluster) {
    const std::uint32_t lanes = parts_met<end_moves>(parts[cluster], cone, target);
    if (lanes != 0) visit(cluster * simd_lanes, lanes);
  });
}

/// … and of images, as `images_met` has it.
inline void visit_images(const BoxTree& tree, std::span<const EightImages> images, std::span<const HalfSpace> cone,
                         const ConeTarget& target, const EightsVisitor& visit) {
  walk_clusters(tree, cone, [&](std::size_t cluster) {
    const std::uint32_t lanes = images_met(images[cluster], cone, target);
    if (lanes != 0) visit(cluster * simd_lanes, lanes);
  });
}

}  // namespace DCEM_ISA

}  // namespace dcem
