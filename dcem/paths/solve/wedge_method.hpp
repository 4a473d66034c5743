#pragma once
/// Where a path over straight edges meets them.
///
/// Fermat: of all polylines from one end over the edges to the other, the path is the shortest. For one edge the point
/// is known in closed form: unfolded around the edge, the path is straight. For two or three the length is a convex
/// function of the points' places along their edges; given the second point, the others are known, and what is left is
/// the zero of a slope that grows along the second edge. Mirrors between the edges are isometries: the caller unfolds
/// them first.
/// Source: Keller, J. Opt. Soc. Am. 52, 1962 (law of edge diffraction, the stationary point of the length).
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "dcem/core/error.hpp"
#include "dcem/geometry/plane.hpp"

namespace dcem {

/// Largest number of edges of one path.
inline constexpr std::size_t largest_edge_count = 3;

/// A line through an edge: `start_m` is where places are counted from, `direction` is of unit length.
struct EdgeLine {
  Vec3 start_m{0.0};
  Vec3 direction{0.0};
  double length_m = 0.0;

  Vec3 at(double place_m) const { return start_m + place_m * direction; }
};

/// Places of diffraction along the edges, from the first end to the second.
using EdgePlaces = std::array<double, largest_edge_count>;

namespace detail {

/// The place of one edge between two others: z = z₁ + (z₂ − z₁) d₁/(d₁ + d₂), with z along the edge and d across it.
inline double place_between(const Vec3& from_m, const EdgeLine& line, const Vec3& to_m) {
  const double from_z = glm::dot(from_m - line.start_m, line.direction);
  const double to_z = glm::dot(to_m - line.start_m, line.direction);
  const double from_d = glm::distance(from_m, line.at(from_z)), to_d = glm::distance(to_m, line.at(to_z));
  const double sum = from_d + to_d;
  return sum > 0.0 ? from_z + (to_z - from_z) * (from_d / sum) : from_z;
}

/// Two or three edges. For a place on the second one the others follow in closed form, so the length is a function of
/// that place alone; it is convex, and its slope, by which the law of diffraction fails there, grows along the edge.
class SecondEdge {
 public:
  SecondEdge(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m, EdgePlaces& places_m)
      : from_m_(from_m), lines_(lines), to_m_(to_m), places_m_(places_m) {}

  /// Moves all places to those of the shortest polyline. False where its place is not inside the second edge, or where
  /// the slope jumps through zero: there edges meet, and the shortest way goes through their corner.
  bool settle() {
    double low_m = 0.0, high_m = lines_[1].length_m;
    double low = slope_beside(low_m, 1.0), high = slope_beside(high_m, -1.0);
    if (!(low < 0.0) || !(high > 0.0)) return false;
    for (bool halve = false;; halve = !halve) {  // every other step halves the interval, the others are secants
      const double secant_m = low_m - low * ((high_m - low_m) / (high - low));
      double next_m = halve || !(secant_m > low_m && secant_m < high_m) ? 0.5 * (low_m + high_m) : secant_m;
      const double next = slope_beside(next_m, high_m - next_m > beside_m ? 1.0 : -1.0);
      if (!(std::abs(next) > as_good_as_zero)) return true;
      if (!(next_m > low_m && next_m < high_m)) return std::abs(next) < jump;
      (next < 0.0 ? low_m : high_m) = next_m;
      (next < 0.0 ? low : high) = next;
    }
  }

 private:
  static constexpr double as_good_as_zero = 1e-15;  ///< rounding of a cosine
  static constexpr double beside_m = 1e-6;          ///< far enough for a direction of nine digits
  static constexpr double jump = 1e-6;              ///< more than rounding of far coordinates makes of a slope of zero

  /// The slope at a place; where two points are one there, because edges meet, the leg between them has no direction,
  /// and the place moves a little, `onwards` (1 or −1) along the edge.
  double slope_beside(double& place_m, double onwards) {
    const double there = slope(place_m);
    if (!merged_) return there;
    place_m += onwards * beside_m;
    return slope(place_m);
  }

  double slope(double place_m) {
    const Vec3 here_m = lines_[1].at(place_m);
    places_m_[0] = place_between(from_m_, lines_[0], here_m);
    places_m_[1] = place_m;
    if (lines_.size() == 3) places_m_[2] = place_between(here_m, lines_[2], to_m_);
    const Vec3 after_m = lines_.size() == 3 ? lines_[2].at(places_m_[2]) : to_m_;
    merged_ = false;
    return cosine(here_m - lines_[0].at(places_m_[0])) - cosine(after_m - here_m);
  }
  double cosine(const Vec3& leg_m) {
    const double length_m = glm::length(leg_m);
    merged_ = merged_ || length_m < beside_m;
    return length_m > 0.0 ? glm::dot(leg_m, lines_[1].direction) / length_m : 0.0;
  }

  const Vec3& from_m_;
  std::span<const EdgeLine> lines_;
  const Vec3& to_m_;
  EdgePlaces& places_m_;
  bool merged_ = false;  ///< two points were one at the place asked for last
};

/// Whether every point is inside its edge and off the lines of its neighbours: points that coincide, or lie along an
/// edge, meet the law of diffraction by accident.
inline bool is_proper(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                      const EdgePlaces& places_m) {
  for (std::size_t index = 0; index < lines.size(); ++index) {
    const EdgeLine& line = lines[index];
    if (!(places_m[index] > in_plane_guard_m && places_m[index] < line.length_m - in_plane_guard_m)) return false;
    const Vec3 before_m = index == 0 ? from_m : lines[index - 1].at(places_m[index - 1]);
    const Vec3 after_m = index + 1 == lines.size() ? to_m : lines[index + 1].at(places_m[index + 1]);
    for (const Vec3& neighbour_m : {before_m, after_m}) {
      const Vec3 away_m = neighbour_m - line.start_m;
      if (!(glm::length(away_m - glm::dot(away_m, line.direction) * line.direction) > in_plane_guard_m)) return false;
    }
  }
  return true;
}

}  // namespace detail

/// Places of diffraction on one to three edges, between two ends; edges and ends are unfolded where mirrors lie between
/// them. False where a place is not strictly inside its edge, or where the shortest way is no way over edges: an end on
/// the line of its edge, two points in one.
inline bool diffraction_places(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                               EdgePlaces& places_m) {
  DCEM_ASSERT(!lines.empty() && lines.size() <= largest_edge_count);
  if (lines.size() == 1) {
    places_m[0] = detail::place_between(from_m, lines[0], to_m);
  } else if (!detail::SecondEdge(from_m, lines, to_m, places_m).settle()) {
    return false;
  }
  return detail::is_proper(from_m, lines, to_m, places_m);
}

}  // namespace dcem
