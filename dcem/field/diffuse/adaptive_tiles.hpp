#pragma once
/// Integrals over triangles by tiles that are halved where it pays, the worst first.
///
/// A tile's value is the integrand at its centroid times its area. A tile that is halved across its longest edge shows
/// by the difference between its value and the sum of its halves how wrong they may still be. As the centroid rule
/// errs by the square of a tile's size, and half a tile has √½ of the size, that difference is about the halves' own
/// error. Two things could deceive it. A cut along a direction in which the integrand does not change shows nothing of
/// the other one: so what differences have shown of a tile falls by no more than a factor of 4 from a tile to its half.
/// And an integrand may be zero, or alike, wherever one looked: so there is a doubt, which begins with a bound of the
/// integrand and falls by no more than a factor of 8 at a time. The estimate is the larger of the two. A tile that is
/// too large to show a peak of the integrand may be wrong by all of that bound.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "dcem/geometry/triangle.hpp"

namespace dcem {

struct TileSettings {
  double tolerance = 0.02;                                          ///< of the sum, relative, above 0
  double longest_edge_m = std::numeric_limits<double>::infinity();  ///< larger tiles are halved unseen, above 0
  std::size_t budget = 20'000;                                      ///< tiles that may be evaluated and are not 0
};

/// One triangle of the domain, or a part of it.
struct Tile {
  TriangleCorners corners_m{};
  std::uint32_t source = 0;  ///< of the caller: which triangle
  std::uint64_t place = 1;   ///< which part of it: 1 is the whole, 2p and 2p + 1 are the halves of p, modulo 2^64
  double bound = 0.0;        ///< no less than the value can be
  double value = 0.0;
  double error = 0.0;  ///< estimate
  double shown = 0.0;  ///< what differences have shown of it
  double doubt = 0.0;  ///< what of it nobody has looked for
  bool is_evaluated = false;
  bool is_halved = false;  ///< its halves stand for it

  Vec3 centroid_m() const { return (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0; }
  /// The farthest corner's distance from the centroid.
  double radius_m() const {
    const Vec3 centre_m = centroid_m();
    return std::max({glm::distance(centre_m, corners_m[0]), glm::distance(centre_m, corners_m[1]),
                     glm::distance(centre_m, corners_m[2])});
  }
  double area_m2() const {
    return 0.5 * glm::length(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]));
  }
};

/// `Integrand` has `double bound(const Tile&)`, an upper bound of the tile's integral; `double resolution_m(const
/// Tile&)`, the longest edge of a tile that shows what the integrand does there; and `double evaluate(const Tile&,
/// std::size_t index)`, its integrand at the centroid times its area, where `index` is the tile's place in `tiles()`.
/// None is negative. It may have `double tight_bound(const Tile&)`, a lower bound from above that costs more: it is
/// asked for right after the tile has been evaluated, so that it may use what was found there. The same domain in the
/// same order gives the same bits.
template <typename Integrand>
class AdaptiveTiles {
 public:
  AdaptiveTiles(const TileSettings& settings, Integrand& integrand) : settings_(settings), integrand_(integrand) {}

  /// Adds a triangle to the domain.
  void add(const TriangleCorners& corners_m, std::uint32_t source) { append({corners_m, source}); }

  /// Evaluates and halves tiles until the errors add up to no more than the tolerance allows, or the budget is spent.
  void refine() {
    const std::size_t most_tiles = tiles_.size() + 4 * settings_.budget;  // those that are halved unseen cost, too
    recount();
    while (!queue_.empty() && evaluated_ < settings_.budget && tiles_.size() < most_tiles &&
           error_ > settings_.tolerance * total_) {
      const std::size_t worst = queue_.top().second;
      queue_.pop();
      improve(worst);
      if (error_ < 1e-3 * error_at_recount_) recount();
    }
  }

  std::span<const Tile> tiles() const { return tiles_; }
  /// How many were evaluated, without those of which the tight bound was 0.
  std::size_t evaluated() const { return evaluated_; }

  /// The sum over all tiles that no halves stand for, in their order.
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
    for (const Tile& tile : tiles_) sum += tile.is_halved ? 0.0 : quantity(tile);
    return sum;
  }

  /// Running sums lose the digits of what was large at first.
  void recount() {
    error_ = error_at_recount_ = error();
    total_ = total();
  }

  std::size_t append(Tile tile) {
    tile.bound = integrand_.bound(tile);
    tile.error = tile.doubt = tile.bound;
    tiles_.push_back(tile);
    enter(tiles_.size() - 1);
    return tiles_.size() - 1;
  }

  void enter(std::size_t index) {
    error_ += tiles_[index].error;
    if (tiles_[index].error > 0.0) queue_.emplace(tiles_[index].error, index);
  }

  void improve(std::size_t index) {
    error_ -= tiles_[index].error;
    if (longest_edge_m(tiles_[index]) > settings_.longest_edge_m) return halve_unseen(index);
    if (tiles_[index].is_evaluated) return halve(index);
    evaluate(index);
    tiles_[index].doubt = std::max(tiles_[index].value, tiles_[index].bound / slowest_decay);
    estimate(tiles_[index]);
    enter(index);
  }

  void estimate(Tile& tile) const {
    const bool coarse = longest_edge_m(tile) > integrand_.resolution_m(tile);
    tile.error = std::min(tile.bound, coarse ? tile.bound : std::max(tile.shown, tile.doubt));
  }

  void evaluate(std::size_t index) {
    tiles_[index].is_evaluated = true;
    if (tiles_[index].bound == 0.0) return;
    Tile& tile = tiles_[index];
    tile.value = integrand_.evaluate(tile, index);
    total_ += tile.value;
    if constexpr (has_tight_bound) tile.bound = std::min(tile.bound, integrand_.tight_bound(tile));
    if (tile.bound > 0.0) ++evaluated_;
  }

  void halve_unseen(std::size_t index) {
    tiles_[index].is_halved = true;
    for (const Tile& half : halves(tiles_[index])) append(half);
  }

  void halve(std::size_t index) {
    const Tile whole = tiles_[index];
    tiles_[index].is_halved = true;
    total_ -= whole.value;
    const std::size_t first = tiles_.size();
    double bounds = 0.0, values = 0.0;
    for (Tile half : halves(whole)) {
      half.bound = integrand_.bound(half);
      tiles_.push_back(half);
      evaluate(tiles_.size() - 1);
      bounds += tiles_.back().bound;
      values += tiles_.back().value;
    }
    const double difference = std::abs(whole.value - values);
    for (std::size_t half = first; half < tiles_.size(); ++half) {
      const double share = bounds > 0.0 ? tiles_[half].bound / bounds : 0.5;
      tiles_[half].shown = std::max(0.5 * difference, 0.25 * whole.shown);
      tiles_[half].doubt = 2.0 * share * whole.doubt / slowest_decay;
      estimate(tiles_[half]);
      enter(half);
    }
  }

  static double longest_edge_m(const Tile& tile) {
    const auto& [a, b, c] = tile.corners_m;
    return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  }

  static std::array<Tile, 2> halves(const Tile& tile) {
    const auto& corners = tile.corners_m;
    std::size_t longest = 0;  // the edge from corner `longest` to the next one
    double longest_m = 0.0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const double length_m = glm::distance(corners[edge], corners[(edge + 1) % 3]);
      // Of edges that are as long as each other the first, however they are turned.
      if (length_m > longest_m * (1.0 + 1e-9)) longest = edge, longest_m = length_m;
    }
    const Vec3 &from = corners[longest], &to = corners[(longest + 1) % 3], &across = corners[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (from + to);
    return {Tile{{from, middle, across}, tile.source, 2 * tile.place},
            Tile{{middle, to, across}, tile.source, 2 * tile.place + 1}};
  }

  static constexpr double slowest_decay = 8.0;
  static constexpr bool has_tight_bound = requires(Integrand & integrand, const Tile& tile) {
    { integrand.tight_bound(tile) } -> std::convertible_to<double>;
  };

  TileSettings settings_;
  Integrand& integrand_;
  std::vector<Tile> tiles_;
  std::priority_queue<std::pair<double, std::size_t>> queue_;  ///< by error, then index
  std::size_t evaluated_ = 0;
  double total_ = 0.0, error_ = 0.0, error_at_recount_ = 0.0;
};

}  // namespace dcem
