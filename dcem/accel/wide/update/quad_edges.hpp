#pragma once
/// Ways between the corners of quads, one quad in every lane of a register: how large the quads are, and whether they
/// are convex.
#include <array>

#include "dcem/accel/wide/update/double_lanes.hpp"

namespace dcem::detail {

/// What is smaller is no length.
inline constexpr double least_squared_length = 1e-280;

inline namespace DCEM_ISA {

/// Ways between the corners in the world, and the products that point along the normals.
struct QuadEdges {
  VectorPart ab, ac, ad, bc, cd, bd, at_b, at_d;

  [[gnu::always_inline]] void set(const std::array<VectorPart, 4>& corner) {
    const auto& [a, b, c, d] = corner;
    ab.set_difference(b, a);
    ac.set_difference(c, a);
    ad.set_difference(d, a);
    bc.set_difference(c, b);
    cd.set_difference(d, c);
    bd.set_difference(d, b);
    at_b.set_cross(ab, ac);
    at_d.set_cross(ac, ad);
  }

  /// The longest way between two corners, rounded up; above 0.
  [[gnu::always_inline]] void set_diameter(DoublePart& result) const {
    DoublePart longest = DoublePart{} + least_squared_length, squared;
    for (const VectorPart* way : std::array<const VectorPart*, 6>{&ab, &ac, &ad, &bc, &cd, &bd}) {
      way->dot(*way, squared);
      longest = squared > longest ? squared : longest;
    }
    set_reciprocal_root(result, longest, 2);
    result *= longest * 1.00001;
  }

  /// Above 0 where the quadrilateral is convex (see EdgePair) and there is a plane. The turns at opposite corners of a
  /// quadrilateral are the normals of the triangles there, and both pairs have the same sum.
  [[gnu::always_inline]] void set_soundness(const VectorPart& normal, DoublePart& result) const {
    VectorPart at_c;
    at_c.set_cross(bc, cd);
    VectorPart sum;
    sum.x = at_b.x + at_d.x;
    sum.y = at_b.y + at_d.y;
    sum.z = at_b.z + at_d.z;
    DoublePart least, turn_b, turn_c, turn_d, length;
    sum.dot(sum, least);
    sum.dot(at_b, turn_b);
    sum.dot(at_c, turn_c);
    sum.dot(at_d, turn_d);
    const DoublePart turn_a = least - turn_c;
    turn_b = turn_b < turn_c ? turn_b : turn_c;
    turn_d = turn_d < turn_a ? turn_d : turn_a;
    turn_b = turn_b < turn_d ? turn_b : turn_d;
    normal.dot(normal, length);
    result = turn_b >= 1e-3 * least ? least : DoublePart{};
    result = length > 0.0 ? result : DoublePart{};
  }
};

}  // namespace DCEM_ISA

}  // namespace dcem::detail
