#pragma once
/// Triangles that an integral over surfaces is made of, their halves and their points.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dcem/geometry/triangle.hpp"

namespace dcem {

/// The seven points of a tile, and what each stands for. J. Radon 1948, degree 5: weights 9/40 and (155 ∓ √15)/1200 at
/// barycentric (6 ∓ √15)/21.
struct TileRule {
  static constexpr std::size_t points = 7;
  static constexpr double near_corner = 0.10128650732345633, near_edge = 0.47014206410511505;
  static constexpr double of_centroid = 0.225, of_near_corner = 0.12593918054482717, of_near_edge = 0.13239415278850616;
  /// Of the rule of second degree on the centroid and the points near corners.
  static constexpr double lower_near_corner = 0.17195902724135767, lower_centroid = 1.0 - 3.0 * lower_near_corner;

  /// Centroid, three points near corners, three near edges: the same bits in whatever order the corners come.
  static std::array<Vec3, points> points_m(const TriangleCorners& corners_m) {
    TriangleCorners sorted_m = corners_m;
    std::ranges::sort(sorted_m, lexicographic_less);
    const Vec3 sum = sorted_m[0] + sorted_m[1] + sorted_m[2];
    std::array<Vec3, points> all{sum / 3.0};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      all[1 + corner] = near_corner * sum + (1.0 - 3.0 * near_corner) * corners_m[corner];
      all[4 + corner] = near_edge * sum + (1.0 - 3.0 * near_edge) * corners_m[corner];
    }
    return all;
  }
  static double weight(std::size_t point) {
    return point == 0 ? of_centroid : point < 4 ? of_near_corner : of_near_edge;
  }
};

/// One triangle of the domain, a piece of it, or a visible part of a piece.
struct Tile {
  enum class State : std::uint8_t {
    unseen,     ///< nobody has asked what of it is visible
    visible,    ///< all of it is
    evaluated,  ///< and it has a value
    replaced    ///< others stand for it
  };

  TriangleCorners corners_m{};
  std::uint32_t source = 0;  ///< of the caller: which triangle
  std::uint64_t place = 1;   ///< which piece of it: 1 is the whole, 2p and 2p + 1 are the halves of p, modulo 2^64
  std::uint32_t part = 0;    ///< of the caller: which visible part; the same for all that it is halved into
  State state = State::unseen;
  bool is_piece = true;       ///< all of the piece; a part of one keeps its place, and so do its halves
  double limit_per_m2 = 0.0;  ///< no less than the integrand can be
  double value = 0.0;
  double error = 0.0;        ///< estimate; what was never evaluated counts with its bound
  double doubt = 0.0;        ///< what of it nobody has looked for
  std::uint32_t values = 0;  ///< where those of its points are

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
  double longest_edge_m() const {
    const auto& [a, b, c] = corners_m;
    return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  }
  double bound() const { return limit_per_m2 * area_m2(); }

  /// Both halves, cut across the longest edge; of edges that are as long as each other the first, however they are
  /// turned.
  std::array<Tile, 2> halves() const;
};

inline std::array<Tile, 2> Tile::halves() const {
  std::size_t longest = 0;  // the edge from corner `longest` to the next one
  double longest_m = 0.0;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const double length_m = glm::distance(corners_m[edge], corners_m[(edge + 1) % 3]);
    if (length_m > longest_m * (1.0 + 1e-9)) longest = edge, longest_m = length_m;
  }
  const Vec3 &from = corners_m[longest], &to = corners_m[(longest + 1) % 3], &across = corners_m[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (from + to);
  Tile one = *this;
  one.value = one.error = 0.0;
  if (state == State::evaluated) one.state = State::visible;
  Tile other = one;
  one.corners_m = {from, middle, across};
  other.corners_m = {middle, to, across};
  if (is_piece) one.place = 2 * place, other.place = 2 * place + 1;
  return {one, other};
}

/// The piece of a whole triangle around a point of it whose edges are no longer than that, or the smallest with a
/// number.
inline std::uint64_t place_around(const TriangleCorners& whole_m, const Vec3& point_m, double longest_edge_m) {
  constexpr int most_halvings = 60;
  Tile piece{whole_m};
  for (int halving = 0; halving < most_halvings && piece.longest_edge_m() > longest_edge_m; ++halving) {
    const std::array<Tile, 2> halves = piece.halves();
    const auto& [from_m, middle_m, across_m] = halves[0].corners_m;
    const Vec3 side = glm::cross(across_m - middle_m, glm::cross(from_m - middle_m, across_m - middle_m));
    piece = halves[glm::dot(side, point_m - middle_m) >= 0.0 ? 0 : 1];
  }
  return piece.place;
}

}  // namespace dcem
