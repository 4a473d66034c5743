#pragma once
/// Bodies of map_groups.hpp.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/map_groups.hpp"

namespace dcem::detail {

DCEM_INLINE std::size_t group_side(double spacing_m) {
  constexpr double widest_m = 8.0;
  constexpr std::size_t most = 4;
  const double steps = spacing_m > 0.0 ? widest_m / spacing_m : static_cast<double>(most);
  return std::min(most, 1 + static_cast<std::size_t>(std::min(steps, static_cast<double>(most))));
}

DCEM_INLINE GridGroups::GridGroups(const ReceiverGrid& grid, std::span<const char> open)
    : columns_(grid.columns()),
      rows_(grid.rows()),
      spacing_m_(grid.spacing_m),
      side_{group_side(grid.spacing_m[0]), group_side(grid.spacing_m[1])},
      open_(open),
      group_of_(grid.size(), none) {}

DCEM_INLINE std::vector<std::vector<std::size_t>> GridGroups::take() {
  std::erase_if(groups_, [](const std::vector<std::size_t>& group) { return group.empty(); });
  return std::move(groups_);
}

DCEM_INLINE GridGroups::Box GridGroups::box_of(const std::vector<std::size_t>& group) const {
  Box box{rows_, 0, columns_, 0};
  for (const std::size_t cell : group) {
    const std::size_t row = cell / columns_, column = cell % columns_;
    box = {std::min(box.low_row, row), std::max(box.high_row, row), std::min(box.low_column, column),
           std::max(box.high_column, column)};
  }
  return box;
}

DCEM_INLINE bool GridGroups::are_near(const std::vector<std::size_t>& one,
                                      const std::vector<std::size_t>& other) const {
  constexpr std::size_t more_steps = 2;
  constexpr double widest_m = 10.0;
  const Box first = box_of(one), second = box_of(other);
  const std::array<std::size_t, 2> steps{
      std::max(first.high_column, second.high_column) - std::min(first.low_column, second.low_column),
      std::max(first.high_row, second.high_row) - std::min(first.low_row, second.low_row)};
  const auto are_few = [&](std::size_t axis) {
    return steps[axis] < side_[axis] + more_steps && static_cast<double>(steps[axis]) * spacing_m_[axis] <= widest_m;
  };
  return are_few(0) && are_few(1);
}

template <typename Visit>
void GridGroups::for_each_beside(std::size_t cell, Visit&& visit) const {
  const std::size_t row = cell / columns_, column = cell % columns_;
  if (column > 0) visit(cell - 1);
  if (column + 1 < columns_) visit(cell + 1);
  if (row > 0) visit(cell - columns_);
  if (row + 1 < rows_) visit(cell + columns_);
}

DCEM_INLINE void GridGroups::fill_tiles(const IsFree& free) {
  for (std::size_t first_row = 0; first_row < rows_; first_row += side_[1]) {
    for (std::size_t first_column = 0; first_column < columns_; first_column += side_[0]) {
      for (std::size_t row = first_row; row < std::min(rows_, first_row + side_[1]); ++row) {
        for (std::size_t column = first_column; column < std::min(columns_, first_column + side_[0]); ++column) {
          fill_from(row * columns_ + column, free);
        }
      }
    }
  }
}

DCEM_INLINE void GridGroups::fill_from(std::size_t seed, const IsFree& free) {
  if (open_[seed] == 0 || group_of_[seed] != none) return;
  const auto number = static_cast<std::uint32_t>(groups_.size());
  std::vector<std::size_t> group{seed};
  group_of_[seed] = number;
  for (std::size_t next = 0; next < group.size(); ++next) {
    const std::size_t from = group[next];
    for_each_beside(from, [&](std::size_t to) {
      if (open_[to] == 0 || group_of_[to] != none || tile_of(to) != tile_of(seed) || !free(from, to)) return;
      group_of_[to] = number;
      group.push_back(to);
    });
  }
  std::ranges::sort(group);
  groups_.push_back(std::move(group));
}

DCEM_INLINE void GridGroups::join_small(const IsFree& free) {
  for (std::uint32_t number = 0; number < groups_.size(); ++number) {
    if (groups_[number].empty() || 2 * groups_[number].size() > most_points) continue;
    const std::uint32_t other = group_beside(number, free);
    if (other == none) continue;
    for (const std::size_t cell : groups_[number]) group_of_[cell] = other;
    groups_[other].insert(groups_[other].end(), groups_[number].begin(), groups_[number].end());
    std::ranges::sort(groups_[other]);
    groups_[number].clear();
  }
}

DCEM_INLINE std::uint32_t GridGroups::group_beside(std::uint32_t number, const IsFree& free) const {
  const std::vector<std::size_t>& group = groups_[number];
  std::uint32_t best = none;
  for (const std::size_t cell : group) {
    for_each_beside(cell, [&](std::size_t to) {
      const std::uint32_t other = group_of_[to];
      if (other == none || other == number || other == best) return;
      if (group.size() + groups_[other].size() > most_points || !are_near(group, groups_[other])) return;
      if (best != none && groups_[other].size() <= groups_[best].size()) return;
      if (free(cell, to)) best = other;
    });
  }
  return best;
}

DCEM_INLINE std::vector<std::vector<std::size_t>> map_groups(const ReceiverGrid& grid, std::span<const char> open,
                                                             const IsFree& free) {
  GridGroups groups(grid, open);
  groups.fill_tiles(free);
  groups.join_small(free);
  return groups.take();
}

}  // namespace dcem::detail
