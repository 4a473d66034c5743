#pragma once
/// Computes the numbers of a block of patches, several lanes at once.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/accel/patch_planes.hpp"
#include "dcem/accel/patches.hpp"
#include "dcem/accel/simd.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem::detail {

/// Double-precision lanes in one register.
using DoublePart = double __attribute__((vector_size(sizeof(FloatPart))));
using LongPart = std::int64_t __attribute__((vector_size(sizeof(FloatPart))));
inline constexpr std::size_t double_part_lanes = sizeof(DoublePart) / sizeof(double);

/// A number in each lane, in memory: single lanes of a register are slow to write and to read.
struct alignas(64) Lanes {
  std::array<double, simd_lanes> at{};

  void store(std::array<float, simd_lanes>& to) const {
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) to[lane] = static_cast<float>(at[lane]);
  }
};

/// A vector in each lane, in memory.
struct Lanes3 {
  Lanes x, y, z;

  void set(std::size_t lane, const Vec3& value) {
    x.at[lane] = value.x;
    y.at[lane] = value.y;
    z.at[lane] = value.z;
  }
  Vec3 get(std::size_t lane) const { return {x.at[lane], y.at[lane], z.at[lane]}; }
};

/// A vector in each lane of a register, from a first lane on.
struct VectorPart {
  DoublePart x, y, z;

  [[gnu::always_inline]] void load(const Lanes3& from, std::size_t first) {
    std::memcpy(&x, from.x.at.data() + first, sizeof x);
    std::memcpy(&y, from.y.at.data() + first, sizeof y);
    std::memcpy(&z, from.z.at.data() + first, sizeof z);
  }
  [[gnu::always_inline]] void store(Lanes3& to, std::size_t first) const {
    std::memcpy(to.x.at.data() + first, &x, sizeof x);
    std::memcpy(to.y.at.data() + first, &y, sizeof y);
    std::memcpy(to.z.at.data() + first, &z, sizeof z);
  }
  [[gnu::always_inline]] void set_difference(const VectorPart& to, const VectorPart& from) {
    x = to.x - from.x;
    y = to.y - from.y;
    z = to.z - from.z;
  }
  [[gnu::always_inline]] void set_cross(const VectorPart& one, const VectorPart& other) {
    x = one.y * other.z - one.z * other.y;
    y = one.z * other.x - one.x * other.z;
    z = one.x * other.y - one.y * other.x;
  }
  [[gnu::always_inline]] void scale(const DoublePart& by) {
    x *= by;
    y *= by;
    z *= by;
  }
  [[gnu::always_inline]] void dot(const VectorPart& other, DoublePart& result) const {
    result = x * other.x + y * other.y + z * other.z;
  }
};

/// 1 / √value to rounding, for values from 1e-300 to 1e300: a guess from the exponent, and Newton's method four times,
/// y ← y (1.5 − value y² / 2). Square roots and divisions of the machine take longer.
[[gnu::always_inline]] inline void set_reciprocal_root(DoublePart& result, const DoublePart& value) {
  result = std::bit_cast<DoublePart>(0x5fe6eb50c7b537a9 - (std::bit_cast<LongPart>(value) >> 1));
  for (int step = 0; step < 4; ++step) result = result * (1.5 - 0.5 * value * result * result);
}

/// What the patches of a block are made of, and what follows from it.
struct BlockLanes {
  // Set by the caller for the lanes that are there.
  std::array<Lanes3, 4> corner_m;                     ///< of the patch, from the block's centre
  std::array<std::array<Lanes3, 3>, 2> own_corner_m;  ///< of its triangles, in the world, in their own order
  Lanes is_pair;                                      ///< 1 or 0

  // Computed.
  std::array<Lanes3, 2> normal;  ///< of the triangles: unit length, to one side; zero where there is none
  Lanes diameter_m, offset_m, bend_m;

  void compute() {
    for (std::size_t first = 0; first < simd_lanes; first += double_part_lanes) compute(first);
  }

 private:
  /// What is smaller is no length.
  static constexpr double least_squared = 1e-280;

  void compute(std::size_t first) {
    VectorPart a, b, c, d, ab, ac, ad, one, other;
    a.load(corner_m[0], first);
    b.load(corner_m[1], first);
    c.load(corner_m[2], first);
    d.load(corner_m[3], first);
    ab.set_difference(b, a);
    ac.set_difference(c, a);
    ad.set_difference(d, a);
    one.set_cross(ab, ac);
    other.set_cross(ac, ad);
    VectorPart normal_part;
    set_normal(1, other, first, normal_part);
    set_normal(0, one, first, normal_part);
    DoublePart offset, bend, diameter, pair;
    normal_part.dot(a, offset);
    normal_part.dot(ad, bend);
    bend = bend < 0.0 ? -bend : bend;
    set_diameter(b, c, d, ab, ac, ad, diameter);
    DoublePart sound;
    set_soundness(b, c, d, one, other, normal_part, sound);
    // Without a plane, or where the vertices have moved until the pair is not convex, nothing is certain, but every
    // ray near it is asked.
    std::memcpy(&pair, is_pair.at.data() + first, sizeof pair);
    bend = (sound > 0.0 ? bend * 1.0001 : diameter) * pair;
    std::memcpy(offset_m.at.data() + first, &offset, sizeof offset);
    std::memcpy(bend_m.at.data() + first, &bend, sizeof bend);
    std::memcpy(diameter_m.at.data() + first, &diameter, sizeof diameter);
  }

  /// `towards`: where the patch's own order of corners points.
  [[gnu::always_inline]] void set_normal(std::size_t side, const VectorPart& towards, std::size_t first,
                                         VectorPart& result) {
    VectorPart a, b, c;
    a.load(own_corner_m[side][0], first);
    b.load(own_corner_m[side][1], first);
    c.load(own_corner_m[side][2], first);
    b.set_difference(b, a);
    c.set_difference(c, a);
    result.set_cross(b, c);
    DoublePart squared, scale, along;
    result.dot(result, squared);
    result.dot(towards, along);
    set_reciprocal_root(scale, squared);
    scale = along < 0.0 ? -scale : scale;
    result.scale(squared > least_squared ? scale : DoublePart{});
    result.store(normal[side], first);
  }

  [[gnu::always_inline]] static void set_diameter(const VectorPart& b, const VectorPart& c, const VectorPart& d,
                                                  const VectorPart& ab, const VectorPart& ac, const VectorPart& ad,
                                                  DoublePart& result) {
    VectorPart bc, cd, bd;
    bc.set_difference(c, b);
    cd.set_difference(d, c);
    bd.set_difference(d, b);
    DoublePart longest = DoublePart{} + least_squared, squared;
    for (const VectorPart* way : std::array<const VectorPart*, 6>{&ab, &ac, &ad, &bc, &cd, &bd}) {
      way->dot(*way, squared);
      longest = squared > longest ? squared : longest;
    }
    set_reciprocal_root(result, longest);
    result *= longest;
  }

  /// Above 0 where is_convex(a, b, c, d) and there is a plane. The turns at opposite corners of a quadrilateral are the
  /// normals of the triangles there, and both pairs have the same sum.
  [[gnu::always_inline]] static void set_soundness(const VectorPart& b, const VectorPart& c, const VectorPart& d,
                                                   const VectorPart& at_b, const VectorPart& at_d,
                                                   const VectorPart& normal_part, DoublePart& result) {
    VectorPart bc, cd, at_c;
    bc.set_difference(c, b);
    cd.set_difference(d, c);
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
    normal_part.dot(normal_part, length);
    result = turn_b >= 1e-3 * least ? least : DoublePart{};
    result = length > 0.0 ? result : DoublePart{};
  }
};

}  // namespace dcem::detail
