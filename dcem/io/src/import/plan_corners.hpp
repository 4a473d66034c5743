#pragma once
/// Who stands on which side of every edge of a plan. Private to dcem::io.
#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

/// A corner on the grid of outlines; equal where the corners are one.
struct GridCorner {
  std::int64_t x = 0, y = 0;
  auto operator<=>(const GridCorner&) const = default;
};

inline GridCorner grid_corner(const Vec2& corner_m) {
  return {std::llround(corner_m.x / outline_grid_m), std::llround(corner_m.y / outline_grid_m)};
}

/// Calls `action(from, to)` for each edge of an area, which lies to the left of it.
template <typename Action>
void for_each_edge(const Area& area, const Action& action) {
  const auto walk = [&](const Ring& ring) {
    for (std::size_t index = 0; index < ring.size(); ++index) action(ring[index], ring[(index + 1) % ring.size()]);
  };
  walk(area.outer);
  for (const Ring& hole : area.holes) walk(hole);
}

/// The edges of the pieces that the plane was cut into.
class PlanCorners {
 public:
  explicit PlanCorners(const std::vector<PlanePiece>& pieces) : pieces_(pieces) {
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
      for_each_edge(pieces[piece].area, [&](const Vec2& from, const Vec2& to) {
        left_of_[{grid_corner(from), grid_corner(to)}] = piece;
        spokes_[grid_corner(from)].push_back(to);
        spokes_[grid_corner(to)].push_back(from);
      });
    }
  }

  /// Of the neighbours that count, the one with the longest common border.
  template <typename Counts>
  std::optional<std::size_t> longest_neighbour(std::size_t piece, const Counts& counts) const {
    std::map<std::size_t, double> border_m;
    for_each_edge(pieces_[piece].area, [&](const Vec2& from, const Vec2& to) {
      const std::optional<std::size_t> other = left_of(to, from);
      if (other && *other != piece && counts(*other)) border_m[*other] += glm::length(to - from);
    });
    if (border_m.empty()) return std::nullopt;
    return std::max_element(border_m.begin(), border_m.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

  /// Corners around which the ground rises more than once: at some height four walls meet there. `height_m(piece)` is
  /// asked with nothing for the open plane.
  template <typename Height>
  std::vector<Vec2> pinches(const Height& height_m) const {
    std::vector<Vec2> found;
    for (const auto& [corner, ends] : spokes_) {
      const Vec2 here = outline_grid_m * Vec2(static_cast<double>(corner.x), static_cast<double>(corner.y));
      std::map<double, Vec2> by_angle;
      for (const Vec2& end : ends) by_angle.emplace(std::atan2(end.y - here.y, end.x - here.x), end);
      std::vector<double> around_m;
      for (const auto& [angle, end] : by_angle) around_m.push_back(height_m(left_of(here, end)));
      if (rises(around_m) > 1) found.push_back(here);
    }
    return found;
  }

 private:
  std::optional<std::size_t> left_of(const Vec2& from, const Vec2& to) const {
    const auto found = left_of_.find({grid_corner(from), grid_corner(to)});
    return found == left_of_.end() ? std::nullopt : std::optional(found->second);
  }

  /// How often a closed round of heights turns from falling to rising.
  static std::size_t rises(const std::vector<double>& around_m) {
    std::vector<bool> up;
    for (std::size_t index = 0; index < around_m.size(); ++index) {
      const double next_m = around_m[(index + 1) % around_m.size()];
      if (next_m != around_m[index]) up.push_back(next_m > around_m[index]);
    }
    std::size_t count = 0;
    for (std::size_t index = 0; index < up.size(); ++index) {
      if (!up[index] && up[(index + 1) % up.size()]) ++count;
    }
    return count;
  }

  const std::vector<PlanePiece>& pieces_;
  std::map<std::pair<GridCorner, GridCorner>, std::size_t> left_of_;
  std::map<GridCorner, std::vector<Vec2>> spokes_;
};

}  // namespace dcem::io
