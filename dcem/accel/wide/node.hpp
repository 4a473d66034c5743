#pragma once
/// The parts of a wide tree: nodes of eight boxes, and leaves of eight quads in its leaves.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem {

namespace detail {

/// Levels of nodes and leaves, that of the root being 1. The tree over all and the tree of an object are no deeper than
/// the binary trees they are made from, each wide node standing for one of their nodes at least; an edit makes nodes
/// only above `wide_edit_depth_limit`, so that what it pushes down, a leaf or an object, is pushed no further than a
/// built tree reaches.
inline constexpr std::uint32_t wide_build_depth_limit = 56;
inline constexpr std::uint32_t wide_depth_limit = 2 * wide_build_depth_limit + 1;
inline constexpr std::uint32_t wide_edit_depth_limit = 40;
static_assert(wide_edit_depth_limit < wide_build_depth_limit);

}  // namespace detail

/// What an entry of a node leads to: another node, a leaf of quads, or nothing.
struct WideChild {
  static constexpr std::uint32_t leaf_flag = 0x80000000U;
  static constexpr std::uint32_t none_code = 0xffffffffU;

  std::uint32_t code = none_code;

  static WideChild node(std::uint32_t index) { return {index}; }
  static WideChild leaf(std::uint32_t index) { return {index | leaf_flag}; }
  bool is_none() const { return code == none_code; }
  bool is_leaf() const { return (code & leaf_flag) != 0; }
  std::uint32_t index() const { return code & ~leaf_flag; }
  friend bool operator==(const WideChild&, const WideChild&) = default;
};

/// A lane of a node, as one number.
struct NodeLane {
  static constexpr std::uint32_t none_code = 0xffffffffU;

  std::uint32_t code = none_code;

  static NodeLane at(std::uint32_t node, std::uint32_t lane) { return {node * simd_lanes + lane}; }
  bool is_none() const { return code == none_code; }
  std::uint32_t node() const { return code / simd_lanes; }
  std::uint32_t lane() const { return code % simd_lanes; }
  friend bool operator==(const NodeLane&, const NodeLane&) = default;
};

/// Eight boxes and what is in them. Boxes are rounded outwards from the double ones, metres from the tree's origin. A
/// lane without child has an empty box (+∞, −∞), which no ray meets.
struct alignas(64) WideNode {
  /// [2 axis]: the lower, [2 axis + 1]: the upper bounds of all lanes.
  std::array<std::array<float, simd_lanes>, 6> bounds_m;
  std::array<WideChild, simd_lanes> child;

  WideNode() {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) set_box(lane, {});
  }

  Aabb<float> box(std::uint32_t lane) const {
    return {{bounds_m[0][lane], bounds_m[2][lane], bounds_m[4][lane]},
            {bounds_m[1][lane], bounds_m[3][lane], bounds_m[5][lane]}};
  }
  void set_box(std::uint32_t lane, const Aabb<float>& box) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<std::size_t>(2 * axis);
      bounds_m[row][lane] = box.min[axis];
      bounds_m[row + 1][lane] = box.max[axis];
    }
  }
  /// The box around all lanes.
  Aabb<float> box() const {
    const auto lower = [](const Float4& one, const Float4& other) { return one < other ? one : other; };
    const auto upper = [](const Float4& one, const Float4& other) { return one > other ? one : other; };
    const Float4 min = fold(0, lower), max = fold(1, upper);
    return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
  }
  std::uint32_t child_count() const {
    std::uint32_t count = 0;
    for (const WideChild& one : child) count += one.is_none() ? 0U : 1U;
    return count;
  }

 private:
  /// What `choose` leaves of the eight numbers in the rows of x, y and z, all lower or all upper bounds.
  template <typename Choose>
  Float4 fold(std::size_t first_row, Choose&& choose) const {
    const auto halves = [&](std::size_t axis) {
      Float4 low, high;
      std::memcpy(&low, bounds_m[first_row + 2 * axis].data(), sizeof low);
      std::memcpy(&high, bounds_m[first_row + 2 * axis].data() + 4, sizeof high);
      return choose(low, high);
    };
    const Float4 x = halves(0), y = halves(1), z = halves(2);
    const Float4 xy = choose(__builtin_shufflevector(x, y, 0, 1, 4, 5), __builtin_shufflevector(x, y, 2, 3, 6, 7));
    const Float4 zz = choose(__builtin_shufflevector(z, z, 0, 1, 4, 5), __builtin_shufflevector(z, z, 2, 3, 6, 7));
    return choose(__builtin_shufflevector(xy, zz, 0, 2, 4, 6), __builtin_shufflevector(xy, zz, 1, 3, 5, 7));
  }
};

/// Eight quads, each one triangle or two that make a flat convex quadrilateral a b c d. In a triangle d is the middle
/// of a c.
///
/// The numbers serve to say of a ray that it surely misses a quad or surely hits it; where neither is sure, double
/// precision decides. The quads of leaf b have the numbers 8 b + lane.
struct alignas(64) QuadLeaf {
  /// [corner][axis][lane], from the centre. First, so that no row of eight lies across two lines of memory.
  std::array<std::array<std::array<float, simd_lanes>, 3>, 4> corner_m{};
  std::array<float, 3> centre_m{};  ///< from the tree's origin, exact
  float size_m = 0.0F;              ///< no corner has a larger coordinate, from the centre
  float reach_m = 0.0F;             ///< edge_error_factor · the longest distance between two corners of a quad
  float bend_m = 0.0F;              ///< how far d is from the plane of a, b, c, at most
  std::uint32_t lanes = 0;          ///< bit i: there is a quad in lane i, and it is in the scene
  std::uint32_t object = 0;         ///< whose quads they are
  std::array<std::array<float, simd_lanes>, 3> normal{};  ///< of a, b, c; zero where they have none

  /// Room for the rounding of the edge functions: see WideRay::meets(const QuadLeaf&, …).
  static constexpr double edge_error_factor = 10.0;
};
static_assert(sizeof(WideNode) == 256 && sizeof(QuadLeaf) == 512, "lines of memory are what rays wait for");

}  // namespace dcem
