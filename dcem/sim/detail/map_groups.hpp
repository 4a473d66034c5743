#pragma once
/// Which points of a map look at the scene together.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dcem/scene/device.hpp"

namespace dcem::detail {

/// Whether a straight step between two points is free.
using IsFree = std::function<bool(std::size_t, std::size_t)>;

/// How many neighbours along one axis share a view. Farther apart than some metres they see too much together.
std::size_t group_side(double spacing_m);

/// Open points of a grid in groups: which are in each, ascending, and of each cell in which it is.
class GridGroups {
 public:
  static constexpr std::size_t most_points = 16;
  static constexpr std::uint32_t none = 0xffffffffU;

  /// `open` holds what is not 0 for an open cell. Cells are counted row by row.
  GridGroups(const ReceiverGrid& grid, std::span<const char> open);

  /// What is joined by free straight steps, tile by tile. `free(cell, cell)` says whether a step is free.
  void fill_tiles(const IsFree& free);
  /// Where tiles are cut up into small groups, these join others beside them, as far as no two points are farther apart
  /// along x or y than two steps more than in a tile, and than 10 m: a view of few points costs as much as one of many.
  void join_small(const IsFree& free);

  std::vector<std::vector<std::size_t>> take();

 private:
  struct Box {
    std::size_t low_row, high_row, low_column, high_column;
  };

  Box box_of(const std::vector<std::size_t>& group) const;
  bool are_near(const std::vector<std::size_t>& one, const std::vector<std::size_t>& other) const;
  /// Calls `visit(cell)` for the cells beside one.
  template <typename Visit>
  void for_each_beside(std::size_t cell, Visit&& visit) const;
  /// The tile of a cell.
  std::array<std::size_t, 2> tile_of(std::size_t cell) const {
    return {cell / columns_ / side_[1], cell % columns_ / side_[0]};
  }
  void fill_from(std::size_t seed, const IsFree& free);
  /// The largest group beside one that it may join, or none.
  std::uint32_t group_beside(std::uint32_t number, const IsFree& free) const;

  std::size_t columns_, rows_;
  std::array<double, 2> spacing_m_;
  std::array<std::size_t, 2> side_;  ///< of a tile, along x and y
  std::span<const char> open_;
  std::vector<std::uint32_t> group_of_;  ///< by cell
  std::vector<std::vector<std::size_t>> groups_;
};

/// The open points of a grid in groups of at most 16 that free straight steps join. `open` holds what is not 0 for an
/// open cell; `free(cell, cell)` says whether a step is free.
std::vector<std::vector<std::size_t>> map_groups(const ReceiverGrid& grid, std::span<const char> open,
                                                 const IsFree& free);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/map_groups_bodies.hpp"
#endif
