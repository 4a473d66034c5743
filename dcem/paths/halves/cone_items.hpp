#pragma once
/// What walks of cones go through (cone_walk.hpp): plain numbers, eight side by side, which are the same for every
/// processor.
#include <array>
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

/// Eight boxes by their corners.
struct EightBoxes {
  std::array<EightFloats, 6> corner{};  ///< x, y and z of the lower ones, then of the upper ones
  std::uint32_t used = 0;               ///< bit i: lane i holds a box
};

/// A box by its middle.
struct CentredBox {
  std::array<float, 3> centre, half;
};

/// A side of a window: its first corner, and the way to the next one.
struct WindowSide {
  std::array<float, 3> from, along;
};

/// A convex window in the plane normal·x = offset, with its sides in order. `turn`: 1 where they run counterclockwise,
/// seen from where the normal points to; otherwise −1.
struct WindowOutline {
  HalfSpace plane;
  float turn;
  std::span<const WindowSide> sides;
};

/// Clusters of eight items, groups of eight clusters, and blocks of eight groups, by their boxes.
struct BoxTree {
  std::span<const EightBoxes> blocks, groups, clusters;
};

/// Eight parts of edges, each on its edge's line, as one end sees them.
struct EightParts {
  std::array<EightFloats, 3> start{}, direction{};
  EightFloats from{}, to{};         ///< along the edge
  EightFloats place{}, distance{};  ///< of the end, along the edge and from its line
};

/// One part by itself, in three fours.
struct alignas(16) PartRecord {
  std::array<float, 4> start_from{}, direction_to{}, place_distance{};
};

/// Eight images of an end, and what each of them sees through its mirror: as many half spaces as a mirror of four sides
/// has.
struct EightImages {
  static constexpr std::size_t plane_count = 5;
  std::array<EightFloats, 3> place{};
  std::array<std::array<EightFloats, 4>, plane_count> planes{};
};

/// Points side by side, by their coordinates, each of which can be read up to seven beyond the last.
struct PointRow {
  std::array<const float*, 3> place;
  std::size_t count;
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

}  // namespace dcem
