#pragma once
/// Walks through clusters of boxes, and of what lies in them, that a cone may reach: the inmost loops of joining.
///
/// What is walked through is the same for every processor (cone_items.hpp); the walks stand under the name of the
/// instructions that they are compiled for (core/instruction_set.hpp), and all say the same (cone_kernels.hpp).
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/fetch.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/cone_items.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// So many half spaces are asked about without looking whether anything is left: most mirrors have four sides.
inline constexpr std::size_t planes_at_once = 5;

/// A cone as boxes are asked about it: of each half space the coordinates of the corner that is farthest inside. Of
/// many half spaces those after the first sixteen are left out.
class ConeCorners {
 public:
  explicit ConeCorners(std::span<const HalfSpace> cone) : count_(std::min(cone.size(), side_.size())) {
    for (std::size_t at = 0; at < count_; ++at) {
      const HalfSpace& plane = cone[at];
      side_[at] = {plane, {plane.x < 0.0F ? 0U : 3U, plane.y < 0.0F ? 1U : 4U, plane.z < 0.0F ? 2U : 5U}};
    }
  }

  /// The boxes of which some point may be in the cone.
  [[gnu::always_inline]] std::uint32_t meets(const EightBoxes& boxes) const {
    Mask8 met = Float8(0.0F) <= Float8(0.0F);
    for (std::size_t at = 0; at < count_; ++at) {
      if (at == planes_at_once && met.bits() == 0) return 0;
      const auto& [plane, corner] = side_[at];
      const Float8 x(boxes.corner[corner[0]]), y(boxes.corner[corner[1]]), z(boxes.corner[corner[2]]);
      met = met & (Float8(plane.offset) <= x * plane.x + y * plane.y + z * plane.z);
    }
    return boxes.used & met.bits();
  }

 private:
  struct Side {
    HalfSpace plane;
    std::array<std::uint32_t, 3> corner;
  };
  std::array<Side, 16> side_;
  std::size_t count_;
};

/// What is neither `beside` already nor outside of a cone: `depth(plane)` is how far inside it may be.
template <typename Depth>
[[gnu::always_inline]] inline std::uint32_t left_in(std::span<const HalfSpace> cone, const Mask8& beside,
                                                    Depth&& depth) {
  Mask8 out = beside;
  for (std::size_t at = 0; at < cone.size(); ++at) {
    if (at == planes_at_once && out.bits() == 0xffU) return 0;
    out = out | (depth(cone[at]) < Float8(cone[at].offset));
  }
  return ~out.bits() & 0xffU;
}

/// Calls `visit(number)` for those of eight, the first of which is number 8 · `of`, whose bits are set.
template <typename Visit>
[[gnu::always_inline]] inline void for_each_lane(std::size_t of, std::uint32_t lanes, Visit&& visit) {
  for (; lanes != 0; lanes &= lanes - 1) visit(of * simd_lanes + static_cast<std::size_t>(std::countr_zero(lanes)));
}

/// Tells of the eights of which `met(eight)` has lanes, among those whose clusters a cone may reach.
///
/// Which have is as good as chance, and a wrong guess costs more than a question: so all of a block are asked, one
/// after the other without a branch, and then told of.
template <typename Met>
[[gnu::always_inline]] inline void tell_of_clusters(const BoxTree& tree, const ConeCorners& cone, Met&& met,
                                                    const EightsVisitor& visit) {
  std::array<std::uint32_t, std::size_t{simd_lanes} * simd_lanes> reached, lanes;
  const auto ask_block = [&](std::size_t block) {
    std::size_t count = 0, found = 0;
    for_each_lane(block, cone.meets(tree.groups[block]), [&](std::size_t group) {
      for_each_lane(group, cone.meets(tree.clusters[group]),
                    [&](std::size_t eight) { reached[count++] = static_cast<std::uint32_t>(eight); });
    });
    for (std::size_t at = 0; at < count; ++at) {
      const std::uint32_t eight = reached[at], bits = met(eight);
      reached[found] = eight;
      lanes[found] = bits;
      found += bits != 0 ? 1 : 0;
    }
    for (std::size_t at = 0; at < found; ++at) visit(std::size_t{reached[at]} * simd_lanes, lanes[at]);
  };
  for (std::size_t blocks = 0; blocks < tree.blocks.size(); ++blocks) {
    for_each_lane(blocks, cone.meets(tree.blocks[blocks]), ask_block);
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

/// Eight parts of edges as they are asked about.
struct PartLanes {
  Float8 start_x, start_y, start_z, from, direction_x, direction_y, direction_z, to, place, distance;

  [[gnu::always_inline]] explicit PartLanes(const EightParts& parts)
      : start_x(parts.start[0]),
        start_y(parts.start[1]),
        start_z(parts.start[2]),
        from(parts.from),
        direction_x(parts.direction[0]),
        direction_y(parts.direction[1]),
        direction_z(parts.direction[2]),
        to(parts.to),
        place(parts.place),
        distance(parts.distance) {}
  /// Those with eight numbers among all.
  [[gnu::always_inline]] PartLanes(std::span<const PartRecord> all, const std::uint32_t* numbers) {
    const auto four = [&](auto member) {
      std::array<const float*, simd_lanes> places;
      for (std::size_t lane = 0; lane < simd_lanes; ++lane) places[lane] = (all[numbers[lane]].*member).data();
      return simd::turned(places);
    };
    const auto starts = four(&PartRecord::start_from), directions = four(&PartRecord::direction_to),
               ends = four(&PartRecord::place_distance);
    start_x = starts[0], start_y = starts[1], start_z = starts[2], from = starts[3];
    direction_x = directions[0], direction_y = directions[1], direction_z = directions[2], to = directions[3];
    place = ends[0], distance = ends[1];
  }
};

/// Parts on which the point that diffracts between the end and a target may lie in a cone; where `end_moves` it is the
/// end that may be within `moved_m` of where it is.
template <bool end_moves>
[[gnu::always_inline]] inline std::uint32_t parts_met(const PartLanes& parts, std::span<const HalfSpace> cone,
                                                      const ConeTarget& target) {
  const Float8 &sx = parts.start_x, &sy = parts.start_y, &sz = parts.start_z;
  const Float8 &ex = parts.direction_x, &ey = parts.direction_y, &ez = parts.direction_z;
  const Float8 &own_place = parts.place, &own_distance = parts.distance, &from = parts.from, &to = parts.to;
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
  const Mask8 beside = (point + reach < from) | (to + reach < point);
  Float8 room = far;
  if (target.moved_m > 0.0F) {
    point = simd::minimum(simd::maximum(point, from), to);
    room = far + reach;
  }
  const Float8 px = sx + point * ex, py = sy + point * ey, pz = sz + point * ez;
  return left_in(cone, beside,
                 [&](const HalfSpace& plane) { return px * plane.x + py * plane.y + pz * plane.z + room; });
}

template <bool end_moves>
[[gnu::always_inline]] inline std::uint32_t parts_met(const EightParts& parts, std::span<const HalfSpace> cone,
                                                      const ConeTarget& target) {
  return parts_met<end_moves>(PartLanes(parts), cone, target);
}

/// Which of eight points may lie in a cone.
[[gnu::always_inline]] inline std::uint32_t points_met(const Float8& x, const Float8& y, const Float8& z,
                                                       std::span<const HalfSpace> cone) {
  const Float8 error_m = Float8(1e-6F) * (simd::absolute(x) + simd::absolute(y) + simd::absolute(z));
  return left_in(cone, Float8(0.0F) < Float8(0.0F),
                 [&](const HalfSpace& plane) { return x * plane.x + y * plane.y + z * plane.z + error_m; });
}

/// Images that may lie in a cone, and may see a target through their mirrors.
[[gnu::always_inline]] inline std::uint32_t images_met(const EightImages& images, std::span<const HalfSpace> cone,
                                                       const ConeTarget& target) {
  const std::uint32_t inside =
      points_met(Float8(images.place[0]), Float8(images.place[1]), Float8(images.place[2]), cone);
  if (inside == 0) return 0;  // most: their planes need not come from memory
  const float room_m = target.moved_m + target.slack_m;
  Mask8 out = Float8(0.0F) < Float8(0.0F);
  for (const auto& plane : images.planes) {
    const Float8 depth =
        Float8(plane[0]) * target.x + Float8(plane[1]) * target.y + Float8(plane[2]) * target.z + room_m;
    out = out | (depth < Float8(plane[3]));
  }
  return inside & ~out.bits();
}

/// Tells of the points of a row that may lie in a cone.
inline void visit_points(const PointRow& row, std::span<const HalfSpace> cone, const EightsVisitor& visit) {
  const auto [x, y, z] = row.place;
  for (std::size_t first = 0; first < row.count; first += simd_lanes) {
    std::uint32_t lanes = points_met(Float8::load(x + first), Float8::load(y + first), Float8::load(z + first), cone);
    if (row.count - first < simd_lanes) lanes &= (1U << (row.count - first)) - 1U;
    if (lanes != 0) visit(first, lanes);
  }
}

/// Tells of the items that may be in a cone; `boxes`: of the items, in eights.
inline void visit_boxes(const BoxTree& tree, std::span<const EightBoxes> boxes, std::span<const HalfSpace> cone,
                        const EightsVisitor& visit) {
  const ConeCorners corners(cone);
  tell_of_clusters(
      tree, corners, [&](std::size_t eight) { return corners.meets(boxes[eight]); }, visit);
}

/// The same of parts of edges, as `parts_met` has it …
template <bool end_moves>
inline void visit_parts(const BoxTree& tree, std::span<const EightParts> parts, std::span<const HalfSpace> cone,
                        const ConeTarget& target, const EightsVisitor& visit) {
  const auto met = [&](std::size_t eight) { return parts_met<end_moves>(parts[eight], cone, target); };
  tell_of_clusters(tree, ConeCorners(cone), met, visit);
}

/// … of those of all parts that have these numbers, a multiple of eight …
inline void visit_listed_parts(std::span<const PartRecord> all, std::span<const std::uint32_t> numbers,
                               std::span<const HalfSpace> cone, const ConeTarget& target, const EightsVisitor& visit) {
  constexpr std::size_t ahead = 2 * simd_lanes;
  for (std::size_t first = 0; first < numbers.size(); first += simd_lanes) {
    if (first + ahead < numbers.size()) {
      for (std::size_t lane = 0; lane < simd_lanes; ++lane) fetch(all[numbers[first + ahead + lane]]);
    }
    const std::uint32_t lanes = parts_met<false>(PartLanes(all, &numbers[first]), cone, target);
    if (lanes != 0) visit(first, lanes);
  }
}

/// … and of images, as `images_met` has it.
inline void visit_images(const BoxTree& tree, std::span<const EightImages> images, std::span<const HalfSpace> cone,
                         const ConeTarget& target, const EightsVisitor& visit) {
  const auto met = [&](std::size_t eight) { return images_met(images[eight], cone, target); };
  tell_of_clusters(tree, ConeCorners(cone), met, visit);
}

}  // namespace DCEM_ISA

}  // namespace dcem
