#pragma once
/// Which images of an end in two mirrors may see anything: a cheap test before their cones are made.
///
/// Compiled for each level of instructions, as the walks of cones are (cone_kernels.hpp).
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/cone_items.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// No component is larger, nor the length.
inline float size_of(const std::array<float, 3>& of) {
  return std::abs(of[0]) + std::abs(of[1]) + std::abs(of[2]);
}

/// Of eight images, those that may see some of the boxes beyond a window: in single precision, with room for its
/// rounding.
///
/// Error: boxes have room for what their corners and the plane are off. An image a that is off by e, and a side of the
/// window, turn the plane through both: with a the way from the side's corner to the image, s the side and c that to
/// the box, (a × s)·c is off by e |s| |c|, however far away the box is. e: 2⁻²⁴ for each of some ten roundings of the
/// image, of that which it was mirrored from (two heights away), and of the corner.
[[gnu::always_inline]] inline std::uint32_t seeing_through(const Float8& x, const Float8& y, const Float8& z,
                                                           const WindowOutline& window,
                                                           std::span<const CentredBox> boxes, std::uint32_t lanes) {
  const HalfSpace& plane = window.plane;
  const Float8 height = x * plane.x + y * plane.y + z * plane.z - plane.offset;
  const Float8 side = Float8(-window.turn) * height;  // of any length
  // Rounding of the images and of the sides through them.
  const Float8 room = Float8(1e-2F) + Float8(1e-5F) * (simd::absolute(x) + simd::absolute(y) + simd::absolute(z));
  std::uint32_t seeing = lanes & (simd::absolute(height) <= room).bits();  // nothing is known of them
  const Float8 off = Float8(1.5e-6F) * (simd::absolute(x) + simd::absolute(y) + simd::absolute(z)) +
                     Float8(2e-6F) * simd::absolute(height);
  for (const CentredBox& box : boxes) {
    const auto [cx, cy, cz] = box.centre;
    const Float8 hx = room + box.half[0], hy = room + box.half[1], hz = room + box.half[2];
    const Float8 reach = simd::absolute(Float8(plane.x)) * hx + simd::absolute(Float8(plane.y)) * hy +
                         simd::absolute(Float8(plane.z)) * hz;
    const Float8 beyond = Float8(plane.offset - (plane.x * cx + plane.y * cy + plane.z * cz)) * height;
    std::uint32_t left = lanes & ~seeing & ~(beyond + simd::absolute(height) * reach < Float8(0.0F)).bits();
    for (std::size_t at = 0; at < window.sides.size() && left != 0; ++at) {
      const auto& [from, along] = window.sides[at];
      const Float8 ax = x - from[0], ay = y - from[1], az = z - from[2];
      const Float8 nx = side * (az * along[1] - ay * along[2]), ny = side * (ax * along[2] - az * along[0]),
                   nz = side * (ay * along[0] - ax * along[1]);
      const float dx = cx - from[0], dy = cy - from[1], dz = cz - from[2];
      const Float8 inside =
          nx * dx + ny * dy + nz * dz + simd::absolute(nx) * hx + simd::absolute(ny) * hy + simd::absolute(nz) * hz;
      const float turned = size_of(along) * (std::abs(dx) + std::abs(dy) + std::abs(dz));
      const Float8 error = simd::absolute(side) * (off + Float8(5e-7F * size_of(from))) * Float8(turned);
      left &= ~(inside + error < Float8(0.0F)).bits();
    }
    seeing |= left;
    if (seeing == lanes) break;
  }
  return seeing;
}

/// Tells of the images of a row that, mirrored in the window's plane, may see some of the boxes through it.
inline void visit_mirrored(const PointRow& row, const WindowOutline& window, std::span<const CentredBox> boxes,
                           const EightsVisitor& visit) {
  const HalfSpace& plane = window.plane;
  for (std::size_t first = 0; first < row.count; first += simd_lanes) {
    const Float8 x = Float8::load(row.place[0] + first), y = Float8::load(row.place[1] + first),
                 z = Float8::load(row.place[2] + first);
    const Float8 twice = Float8(2.0F) * (x * plane.x + y * plane.y + z * plane.z - plane.offset);
    const std::size_t left = row.count - first;
    const std::uint32_t lanes = seeing_through(x - twice * plane.x, y - twice * plane.y, z - twice * plane.z, window,
                                               boxes, left < simd_lanes ? (1U << left) - 1U : 0xffU);
    if (lanes != 0) visit(first, lanes);
  }
}

}  // namespace DCEM_ISA

}  // namespace dcem
