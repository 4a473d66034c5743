#pragma once
/// What an edge's image along Keller's cones is made of (keller_view.hpp): plain numbers, which are the same for every
/// processor.
#include <array>
#include <cstddef>
#include <cstdint>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/cone_items.hpp"

namespace dcem {

/// So many columns make a full turn.
inline constexpr std::uint32_t keller_columns = 512;

/// Unit vectors to azimuths a column apart, more than there are columns, so that eight can be read from each on.
struct KellerAzimuths {
  static constexpr std::size_t count = keller_columns + 2 * simd_lanes;
  std::array<float, count> cosine{}, sine{};
};

/// Where columns begin; and, a little wider, where they begin and where they end.
struct KellerSides {
  KellerAzimuths starts, wide_starts, wide_ends;
};

/// Columns of azimuth about an edge, each of one or two eights of cells along it.
struct KellerCells {
  static constexpr std::uint32_t columns = keller_columns, most_rows = 2 * simd_lanes;
  using Row = std::array<float, most_rows>;

  const KellerSides* sides = nullptr;
  float end_m = 0.0F, end_distance_m = 1.0F;  ///< where along the edge's line the end is, and how far from it
  std::uint32_t rows = simd_lanes;            ///< so many cells in a column: a multiple of eight
  Row from_m{}, to_m{};                       ///< where cells begin and end along the edge
  std::array<Row, columns> hidden{};          ///< by column: what is not nearer than this is hidden
};

/// A convex plane outline in an edge's frame: across the edge along face 0, along the normal of that, along the edge.
struct KellerOutline {
  static constexpr std::size_t most_corners = 32;
  using Corners = std::array<float, most_corners>;

  std::size_t count = 0;  ///< of corners; what stands beyond them, up to a multiple of eight, is the last one
  Corners x{}, y{}, z{};  ///< metres
  Corners place_m{};      ///< where ways over the edge that lead to a corner leave it
  float room_m = 0.0F;    ///< how far the places of what is looked at may be off
  Corners column{};       ///< in which a corner is, to within `column_error`
  std::uint32_t first_column = 0, column_count = 0;  ///< it reaches into no others
  bool is_around = false;                            ///< the edge's line goes through it …
  float through_m = 0.0F;                            ///< … at this place
  float far_m = 0.0F, size_m = 0.0F;                 ///< the largest coordinate of a corner; the most between two
  bool is_close = false;                             ///< it comes close to the edge's line
  float normal_x = 0.0F, normal_y = 0.0F, bulge = 0.0F;
  /// The nearness in a cell is (n + share) · factor, n being the normal's part along the azimuth: where the cell
  /// begins, and where it ends.
  KellerCells::Row from_share{}, to_share{}, from_factor{}, to_factor{};
  KellerCells::Row least_m{};         ///< of the plane's distance from a cell; 1 where it crosses that, or comes close
  float error_m = 0.0F;               ///< how far that may be off
  KellerCells::Row nearer{}, more{};  ///< by which factor, and by how much more, it counts as nearer
};

}  // namespace dcem
