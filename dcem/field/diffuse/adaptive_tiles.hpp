#pragma once
/// Integrals over the visible parts of triangles, by tiles that are halved where it pays, the worst first.
///
/// What is visible is known to its edges before anything is integrated: a triangle is asked for its visible parts, or,
/// where it has too many, halved and asked again. On a part the integrand is smooth, and seven points give it to the
/// fifth degree. The centroid and three of the seven give it to the second: the difference is what the tile may be
/// wrong by. It says more than it has to, as the seven are better than the four. As it may be small by chance, a
/// tile's half counts with no less than a sixteenth of what the halves differed from the whole. A tile that is too
/// large to show a peak of the integrand may be wrong by all of its bound. Where the integrand is not smooth it may be
/// zero, or alike, wherever one looked: so there is a doubt, which begins with an eighth of the bound and falls by
/// no more than a factor of 8 from a tile to its half.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "dcem/field/diffuse/tile.hpp"

namespace dcem {

struct TileSettings {
  double tolerance = 0.02;                                          ///< of the sum, relative, above 0
  double longest_edge_m = std::numeric_limits<double>::infinity();  ///< larger tiles are halved unseen, above 0
  std::size_t budget = 20'000;                                      ///< tiles that may be evaluated
};

/// `Integrand` has `double limit_per_m2(const Tile&)`, an upper bound of the integrand on the tile; `double
/// resolution_m(const Tile&)`, the longest edge of a tile that shows what the integrand does there; `bool
/// visit_parts(const Tile&, visit)`, which calls `visit(corners, part)` for the visible parts of a piece, convex
/// polygons without common points and a number each, or returns false where it is to be halved first; and `double
/// density(const Tile&, const Vec3& point_m)`, its value at a visible point. None is negative. It may have `bool
/// is_smooth(const Tile&)`; without, it is smooth on all visible parts. The same domain in the same order gives the
/// same bits.
template <typename Integrand>
class AdaptiveTiles {
 public:
  AdaptiveTiles(const TileSettings& settings, Integrand& integrand) : settings_(settings), integrand_(integrand) {}

  /// Adds a triangle to the domain.
  void add(const TriangleCorners& corners_m, std::uint32_t source) {
    Tile tile{corners_m, source};
    append(tile);
  }

  /// Evaluates and halves tiles until the errors add up to no more than the tolerance allows, or the budget is spent.
  void refine() {
    const std::size_t most_tiles = tiles_.size() + 8 * settings_.budget;  // what is not evaluated costs, too
    recount();
    while (!queue_.empty() && evaluated_ < settings_.budget && tiles_.size() < most_tiles &&
           error_ > settings_.tolerance * total_) {
      const std::size_t worst = queue_.top().second;
      queue_.pop();
      error_ -= tiles_[worst].error;
      improve(worst);
      if (error_ < 1e-3 * error_at_recount_) recount();
    }
  }

  std::span<const Tile> tiles() const { return tiles_; }
  std::size_t evaluated() const { return evaluated_; }

  /// Calls `visit(tile, point_m, area_m2, density)` for the points that the sum is made of.
  template <typename Visit>
  void for_each_point(Visit&& visit) const {
    for (const Tile& tile : tiles_) {
      if (tile.state != Tile::State::evaluated) continue;
      const auto points_m = TileRule::points_m(tile.corners_m);
      const double area_m2 = tile.area_m2();
      for (std::size_t point = 0; point < TileRule::points; ++point) {
        visit(tile, points_m[point], TileRule::weight(point) * area_m2, values_[tile.values][point]);
      }
    }
  }

  /// The sum over all tiles that no others stand for, in their order.
  double total() const {
    return sum([](const Tile& tile) { return tile.value; });
  }
  /// Sum of the estimated errors of the same; what was never evaluated counts with its bound.
  double error() const {
    return sum([](const Tile& tile) { return tile.error; });
  }

 private:
  template <typename Quantity>
  double sum(Quantity&& quantity) const {
    double sum = 0.0;
    for (const Tile& tile : tiles_) sum += tile.state == Tile::State::replaced ? 0.0 : quantity(tile);
    return sum;
  }

  /// Running sums lose the digits of what was large at first.
  void recount() {
    error_ = error_at_recount_ = error();
    total_ = total();
  }

  void append(Tile& tile) {
    tile.limit_per_m2 = integrand_.limit_per_m2(tile);
    tile.error = tile.bound();
    enter(tile);
  }

  void enter(const Tile& tile) {
    tiles_.push_back(tile);
    wait(tiles_.size() - 1);
  }
  void wait(std::size_t index) {
    error_ += tiles_[index].error;
    if (tiles_[index].error > 0.0) queue_.emplace(tiles_[index].error, index);
  }

  void improve(std::size_t index) {
    const Tile tile = tiles_[index];
    const double edge_m = tile.longest_edge_m();
    if (edge_m > settings_.longest_edge_m) return halve_unseen(index);
    if (tile.state == Tile::State::unseen) return look(index);
    if (tile.state == Tile::State::evaluated) return halve(index);
    if (edge_m > integrand_.resolution_m(tile)) return halve_unseen(index);
    evaluate(tiles_[index]);
    const double doubt = std::max(tiles_[index].value, tiles_[index].bound() / slowest_decay);
    estimate(tiles_[index], 0.0, doubt);
    wait(index);
  }

  /// Puts its visible parts in the place of a piece.
  void look(std::size_t index) {
    const Tile piece = tiles_[index];
    const bool are_found = integrand_.visit_parts(piece, [&](std::span<const Vec3> corners_m, std::uint32_t part) {
      for (std::size_t corner = 1; corner + 1 < corners_m.size(); ++corner) {
        Tile tile = piece;
        tile.corners_m = {corners_m[0], corners_m[corner], corners_m[corner + 1]};
        tile.part = part;
        tile.state = Tile::State::visible;
        tile.is_piece = tile.corners_m == piece.corners_m;
        append(tile);
      }
    });
    if (!are_found) return halve_unseen(index);
    tiles_[index].state = Tile::State::replaced;
  }

  void evaluate(Tile& tile) {
    const auto points_m = TileRule::points_m(tile.corners_m);
    std::array<double, TileRule::points> values;
    for (std::size_t point = 0; point < TileRule::points; ++point) {
      values[point] = integrand_.density(tile, points_m[point]);
    }
    const double near_corners = values[1] + values[2] + values[3], near_edges = values[4] + values[5] + values[6];
    const double area_m2 = tile.area_m2();
    tile.value = area_m2 * (TileRule::of_centroid * values[0] + TileRule::of_near_corner * near_corners +
                            TileRule::of_near_edge * near_edges);
    const double lower = area_m2 * (TileRule::lower_centroid * values[0] + TileRule::lower_near_corner * near_corners);
    tile.error = std::abs(tile.value - lower);
    tile.state = Tile::State::evaluated;
    tile.values = static_cast<std::uint32_t>(values_.size());
    values_.push_back(values);
    total_ += tile.value;
    ++evaluated_;
  }

  void halve_unseen(std::size_t index) {
    std::array<Tile, 2> halves = tiles_[index].halves();
    tiles_[index].state = Tile::State::replaced;
    for (Tile& half : halves) append(half);
  }

  void halve(std::size_t index) {
    const Tile whole = tiles_[index];
    total_ -= whole.value;
    tiles_[index].state = Tile::State::replaced;
    std::array<Tile, 2> halves = whole.halves();
    for (Tile& half : halves) {
      half.limit_per_m2 = integrand_.limit_per_m2(half);
      evaluate(half);
    }
    const double least = least_share_shown * std::abs(whole.value - halves[0].value - halves[1].value);
    const double bounds = halves[0].bound() + halves[1].bound();
    for (Tile& half : halves) {
      const double share = bounds > 0.0 ? half.bound() / bounds : 0.5;
      estimate(half, least, 2.0 * share * whole.doubt / slowest_decay);
      enter(half);
    }
  }

  /// The error of a tile that has been evaluated, no less than `least`; `doubt`: what of it nobody has looked for,
  /// unless it is smooth.
  void estimate(Tile& tile, double least, double doubt) const {
    bool is_smooth = true;
    if constexpr (requires { integrand_.is_smooth(tile); }) is_smooth = integrand_.is_smooth(tile);
    tile.doubt = is_smooth ? 0.0 : doubt;
    tile.error = std::min(tile.bound(), std::max({tile.error, least, tile.doubt}));
  }

  static constexpr double least_share_shown = 1.0 / 16.0;
  static constexpr double slowest_decay = 8.0;

  TileSettings settings_;
  Integrand& integrand_;
  std::vector<Tile> tiles_;
  std::vector<std::array<double, TileRule::points>> values_;
  std::priority_queue<std::pair<double, std::size_t>> queue_;  ///< by error, then index
  std::size_t evaluated_ = 0;
  double total_ = 0.0, error_ = 0.0, error_at_recount_ = 0.0;
};

}  // namespace dcem
