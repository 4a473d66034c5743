#pragma once
/// Which parts of a wide tree a box may overlap, eight at a time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dcem/accel/wide/node.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem::detail {

inline namespace DCEM_ISA {

/// A lane whose box ends at infinity is empty, and no box overlaps it, not even one without ends: these have the
/// largest numbers for ends.
inline Aabb<float> with_ends(Aabb<float> box) {
  constexpr float largest_m = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::max(box.min[axis], -largest_m);
    box.max[axis] = std::min(box.max[axis], largest_m);
  }
  return box;
}

/// The children of a node whose boxes overlap one with ends, which counts from the tree's origin as they do.
inline std::uint32_t children_overlapping(const WideNode& node, const Aabb<float>& box) {
  const auto row = [&](std::size_t number) { return Float8::load(node.bounds_m[number].data()); };
  const Mask8 x = (row(0) <= Float8(box.max.x)) & (Float8(box.min.x) <= row(1));
  const Mask8 y = (row(2) <= Float8(box.max.y)) & (Float8(box.min.y) <= row(3));
  const Mask8 z = (row(4) <= Float8(box.max.z)) & (Float8(box.min.z) <= row(5));
  return (x & y & z).bits();
}

/// The quads of a leaf that a box may overlap, which counts from the tree's origin: no other one has a triangle that
/// does. Corners have been rounded by at most 2⁻²⁴ of the leaf's size, ends of the box by as much of their own, and
/// both by what differences of large coordinates lose in double precision. (Both go through the same roundings, which
/// keep order; the room does not rely on that.)
inline std::uint32_t quads_overlapping(const QuadLeaf& leaf, const Aabb<double>& box, double lost_m) {
  std::uint32_t lanes = leaf.lanes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto row = [&](std::size_t corner) { return Float8::load(leaf.corner_m[corner][axis].data()); };
    const Float8 a = row(0), b = row(1), c = row(2), d = row(3);
    const Float8 lower = simd::minimum(simd::minimum(a, b), simd::minimum(c, d));
    const Float8 upper = simd::maximum(simd::maximum(a, b), simd::maximum(c, d));
    const double centre_m = static_cast<double>(leaf.centre_m[axis]);
    const int number = static_cast<int>(axis);
    const double from_m = box.min[number] - centre_m, to_m = box.max[number] - centre_m;
    const double size_m = static_cast<double>(leaf.size_m);
    const auto room_m = [&](double end_m) { return (std::abs(end_m) + size_m) * 0x1p-22 + lost_m; };
    const auto from = static_cast<float>(from_m - room_m(from_m)), to = static_cast<float>(to_m + room_m(to_m));
    lanes &= ((lower <= Float8(to)) & (Float8(from) <= upper)).bits();
  }
  return lanes;
}

}  // namespace DCEM_ISA

}  // namespace dcem::detail
