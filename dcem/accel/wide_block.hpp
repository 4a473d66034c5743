#pragma once
/// Writes the numbers of a block of patches, all lanes at once.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "dcem/accel/patch_planes.hpp"
#include "dcem/accel/patches.hpp"
#include "dcem/accel/simd.hpp"
#include "dcem/accel/wide_node.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem::detail {

using Double8 = double __attribute__((vector_size(64)));

/// 1 / √value to 1e-10 of it, for values from 1e-300 to 1e300: a guess from the exponent, and Newton's method three
/// times, each y ← y · (1.5 − value · y² / 2). Square roots of the machine take several times as long.
[[gnu::always_inline]] inline void set_reciprocal_root(Double8& result, const Double8& value) {
  using Bits8 = std::int64_t __attribute__((vector_size(64)));
  Bits8 bits;
  std::memcpy(&bits, &value, sizeof bits);
  bits = 0x5fe6eb50c7b537a9 - (bits >> 1);
  std::memcpy(&result, &bits, sizeof bits);
  for (int step = 0; step < 3; ++step) result = result * (1.5 - 0.5 * value * result * result);
}

/// A number in each lane, in memory: single lanes of a vector in registers are slow to write and to read.
struct alignas(64) Lanes {
  std::array<double, simd_lanes> at{};

  [[gnu::always_inline]] void load(Double8& value) const { std::memcpy(&value, at.data(), sizeof value); }
  [[gnu::always_inline]] void store(const Double8& value) { std::memcpy(at.data(), &value, sizeof value); }
};

/// A vector in each lane, in memory.
struct Lanes3 {
  Lanes x, y, z;

  void set(std::uint32_t lane, const Vec3& value) {
    x.at[lane] = value.x;
    y.at[lane] = value.y;
    z.at[lane] = value.z;
  }
  Vec3 get(std::uint32_t lane) const { return {x.at[lane], y.at[lane], z.at[lane]}; }
};

/// A vector in each lane, in registers.
struct Vector8 {
  Double8 x, y, z;

  [[gnu::always_inline]] void load(const Lanes3& from) {
    from.x.load(x);
    from.y.load(y);
    from.z.load(z);
  }
  [[gnu::always_inline]] void store(Lanes3& to) const {
    to.x.store(x);
    to.y.store(y);
    to.z.store(z);
  }
  [[gnu::always_inline]] void set_difference(const Vector8& to, const Vector8& from) {
    x = to.x - from.x;
    y = to.y - from.y;
    z = to.z - from.z;
  }
  [[gnu::always_inline]] void set_cross(const Vector8& one, const Vector8& other) {
    x = one.y * other.z - one.z * other.y;
    y = one.z * other.x - one.x * other.z;
    z = one.x * other.y - one.y * other.x;
  }
  [[gnu::always_inline]] void dot(const Vector8& other, Double8& result) const {
    result = x * other.x + y * other.y + z * other.z;
  }
};

/// Planes in all lanes.
struct PlaneLanes {
  Lanes3 normal;
  Lanes offset;

  [[gnu::always_inline]] void set(const Vector8& direction, const Vector8& point) {
    Double8 along;
    direction.dot(point, along);
    direction.store(normal);
    offset.store(along);
  }
  PatchPlane get(std::uint32_t lane) const { return {normal.get(lane), offset.at[lane]}; }
};

/// The work on one block: `add` collects what its lanes hold, `write` computes.
class BlockWriter {
 public:
  /// `centre_m`: of the block, in the world.
  BlockWriter(std::span<const TriangleCorners> corners_m, const Vec3& centre_m)
      : corners_m_(corners_m), centre_m_(centre_m) {}

  /// A lane that is there.
  void add(std::uint32_t lane, const Patch& patch) {
    lanes_ |= 1U << lane;
    set_quadrilateral(lane, patch);
    // Every number of the planes comes from one triangle in the order of its own corners, the pair's smaller number
    // first: then t does not feel how pairing has turned or ordered them.
    const bool swapped = is_swapped(patch);
    const TriangleCorners& own = corners_m_[patch.triangle[swapped ? 1 : 0]];
    for (std::size_t corner = 0; corner < 3; ++corner) own_m_[corner].set(lane, own[corner]);
    first_is_other_.at[lane] = swapped ? 1.0 : 0.0;
    if (!patch.is_pair()) return;
    bend_factor_.at[lane] = 1.0001;
    const TriangleCorners& other = corners_m_[patch.triangle[swapped ? 0 : 1]];
    for (std::size_t corner = 0; corner < 3; ++corner) other_m_[corner].set(lane, other[corner]);
    const std::size_t opposite = patch.corner[swapped ? 3 : 1].at;
    diagonal_from_m_.set(lane, own[(opposite + 2) % 3]);
    diagonal_to_m_.set(lane, own[(opposite + 1) % 3]);
  }

  void write(PatchBlock& block, std::span<const Patch> held, std::span<PatchPlanes> planes) {
    block.lanes = lanes_;
    set_planes();
    write_corners(block);
    Double8 diameter_m;
    set_diameter(diameter_m);
    write_float(block.reach_m, diameter_m * PatchBlock::edge_error_factor);
    write_normal(block, diameter_m);
    for (std::uint32_t rest = lanes_; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
      write_planes(lane, held[lane], planes[lane]);
    }
  }

 private:
  static bool is_swapped(const Patch& patch) { return patch.is_pair() && patch.triangle[1] < patch.triangle[0]; }

  /// A triangle becomes a quadrilateral with its fourth corner in the middle of an edge: it has no edge without length.
  void set_quadrilateral(std::uint32_t lane, const Patch& patch) {
    const auto corner = [&](std::size_t index) -> const Vec3& {
      const auto& [triangle, at] = patch.corner[index];
      return corners_m_[triangle][at];
    };
    const Vec3 a = corner(0) - centre_m_, c = corner(2) - centre_m_;
    quadrilateral_m_[0].set(lane, a);
    quadrilateral_m_[1].set(lane, corner(1) - centre_m_);
    quadrilateral_m_[2].set(lane, c);
    quadrilateral_m_[3].set(lane, patch.is_pair() ? corner(3) - centre_m_ : 0.5 * (a + c));
  }

  void set_planes() {
    Vector8 normal, along;
    span_plane(other_m_, normal, other_);
    span_plane(own_m_, normal, own_);
    // Upright on the first one, with the other one on its positive side.
    Vector8 from, upright;
    from.load(diagonal_from_m_);
    along.load(diagonal_to_m_);
    along.set_difference(along, from);
    upright.set_cross(normal, along);
    divider_.set(upright, from);
  }
  [[gnu::always_inline]] static void span_plane(const std::array<Lanes3, 3>& corner_m, Vector8& normal,
                                                PlaneLanes& plane) {
    Vector8 a, b, c;
    a.load(corner_m[0]);
    b.load(corner_m[1]);
    c.load(corner_m[2]);
    b.set_difference(b, a);
    c.set_difference(c, a);
    normal.set_cross(b, c);
    plane.set(normal, a);
  }

  void write_planes(std::uint32_t lane, const Patch& patch, PatchPlanes& result) const {
    result.triangle = patch.triangle;
    result.plane[0] = own_.get(lane);
    if (!patch.is_pair()) return;
    if (is_swapped(patch)) std::swap(result.triangle[0], result.triangle[1]);
    result.plane[1] = other_.get(lane);
    result.divider = divider_.get(lane);
  }

  void write_corners(PatchBlock& block) const {
    Float8 size{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Lanes3& from = quadrilateral_m_[corner];
      auto& to = block.corner_m[corner];
      write_coordinates(from.x, to[0], size);
      write_coordinates(from.y, to[1], size);
      write_coordinates(from.z, to[2], size);
    }
    std::array<float, simd_lanes> sizes;
    std::memcpy(sizes.data(), &size, sizeof size);
    block.size_m = *std::max_element(sizes.begin(), sizes.end());
  }
  [[gnu::always_inline]] static void write_coordinates(const Lanes& from, std::array<float, simd_lanes>& to,
                                                       Float8& size) {
    Double8 value;
    from.load(value);
    const Float8 rounded = __builtin_convertvector(value, Float8);
    std::memcpy(to.data(), &rounded, sizeof rounded);
    simd::set_maximum(size, rounded);
    simd::set_maximum(size, -rounded);
  }
  [[gnu::always_inline]] static void write_float(std::array<float, simd_lanes>& to, const Double8& value) {
    const Float8 rounded = __builtin_convertvector(value, Float8);
    std::memcpy(to.data(), &rounded, sizeof rounded);
  }

  /// The longest distance between two corners.
  void set_diameter(Double8& diameter_m) const {
    Double8 longest{};
    for (std::size_t one = 0; one < 3; ++one) {
      for (std::size_t other = one + 1; other < 4; ++other) {
        Vector8 from, way;
        Double8 squared;
        from.load(quadrilateral_m_[one]);
        way.load(quadrilateral_m_[other]);
        way.set_difference(way, from);
        way.dot(way, squared);
        longest = squared > longest ? squared : longest;
      }
    }
    Double8 reciprocal;
    longest = longest > least_squared ? longest : Double8{} + least_squared;
    set_reciprocal_root(reciprocal, longest);
    diameter_m = longest * reciprocal;
  }

  [[gnu::always_inline]] void write_normal(PatchBlock& block, const Double8& diameter_m) const {
    Vector8 normal, other, a, d;  // normal: of the patch's first triangle
    Double8 is_other, squared, scale, offset, bend_m, factor;
    normal.load(own_.normal);
    other.load(other_.normal);
    first_is_other_.load(is_other);
    normal.x = is_other > 0.0 ? other.x : normal.x;
    normal.y = is_other > 0.0 ? other.y : normal.y;
    normal.z = is_other > 0.0 ? other.z : normal.z;
    normal.dot(normal, squared);
    set_reciprocal_root(scale, squared);
    scale = squared > least_squared ? scale : Double8{};
    normal.x *= scale;
    normal.y *= scale;
    normal.z *= scale;
    a.load(quadrilateral_m_[0]);
    d.load(quadrilateral_m_[3]);
    normal.dot(a, offset);
    d.set_difference(d, a);
    normal.dot(d, bend_m);
    bend_m = bend_m < 0.0 ? -bend_m : bend_m;
    bend_factor_.load(factor);
    // Without a plane nothing is certain, but every ray near it is asked.
    bend_m = (squared > least_squared ? bend_m : diameter_m) * factor;
    write_float(block.normal[0], normal.x);
    write_float(block.normal[1], normal.y);
    write_float(block.normal[2], normal.z);
    write_float(block.offset_m, offset);
    write_float(block.bend_m, bend_m);
  }

  /// What is smaller is no length.
  static constexpr double least_squared = 1e-280;

  std::span<const TriangleCorners> corners_m_;
  Vec3 centre_m_;
  std::uint32_t lanes_ = 0;
  std::array<Lanes3, 4> quadrilateral_m_;  ///< from the centre
  std::array<Lanes3, 3> own_m_, other_m_;  ///< of the smaller number of a pair, and of the other
  Lanes3 diagonal_from_m_, diagonal_to_m_;
  Lanes first_is_other_;  ///< 1 where the first triangle of a pair has the larger number
  Lanes bend_factor_;     ///< a little over 1; 0 where there is no pair, which has no bend
  PlaneLanes own_, other_, divider_;
};

}  // namespace dcem::detail
