#pragma once
/// Where a path over straight edges meets them.
///
/// Fermat: of all polylines from one end over the edges to the other, the path is the shortest. For one edge the point
/// is known in closed form: unfolded around the edge, the path is straight. For several the length is a strictly convex
/// function of the points' places along their edges (unless an end and all edges lie on one line), so Newton's method
/// finds the only minimum. Mirrors between the edges are isometries: the caller unfolds them first.
/// Source: Keller, J. Opt. Soc. Am. 52, 1962 (law of edge diffraction, the stationary point of the length).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

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

/// The point of one edge between two others: z = z₁ + (z₂ − z₁) d₁/(d₁ + d₂), with z along the edge and d across it.
/// Nothing is between two points that both lie on the line: false.
inline bool place_between(const Vec3& from_m, const EdgeLine& line, const Vec3& to_m, double& place_m) {
  const double from_z = glm::dot(from_m - line.start_m, line.direction);
  const double to_z = glm::dot(to_m - line.start_m, line.direction);
  const double from_d = glm::distance(from_m, line.at(from_z)), to_d = glm::distance(to_m, line.at(to_z));
  if (!(from_d > in_plane_guard_m) || !(to_d > in_plane_guard_m)) return false;
  place_m = from_z + (to_z - from_z) * (from_d / (from_d + to_d));
  return true;
}

/// Gradient of the length, and the tridiagonal matrix of its second derivatives, at some places.
struct LengthModel {
  std::array<double, largest_edge_count> gradient{};
  std::array<double, largest_edge_count> diagonal{};
  std::array<double, largest_edge_count> beside{};  ///< second derivative by place i and i + 1
};

inline LengthModel length_model(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                                const EdgePlaces& places_m) {
  LengthModel model;
  Vec3 before_m = from_m;
  for (std::size_t index = 0; index <= lines.size(); ++index) {
    const bool last = index == lines.size();
    const Vec3 here_m = last ? to_m : lines[index].at(places_m[index]);
    const double length_m = glm::distance(before_m, here_m);
    const Vec3 unit = length_m > 0.0 ? (here_m - before_m) / length_m : Vec3(0.0);
    const double curvature = length_m > 0.0 ? 1.0 / length_m : 0.0;
    const double along_here = last ? 0.0 : glm::dot(unit, lines[index].direction);
    const double along_before = index == 0 ? 0.0 : glm::dot(unit, lines[index - 1].direction);
    if (!last) {
      model.gradient[index] += along_here;
      model.diagonal[index] += curvature * (1.0 - along_here * along_here);
    }
    if (index > 0) {
      model.gradient[index - 1] -= along_before;
      model.diagonal[index - 1] += curvature * (1.0 - along_before * along_before);
    }
    if (!last && index > 0) {
      const double cosine = glm::dot(lines[index - 1].direction, lines[index].direction);
      model.beside[index - 1] = -curvature * (cosine - along_before * along_here);
    }
    before_m = here_m;
  }
  return model;
}

/// Solves the tridiagonal system of one Newton step (Thomas); false where it is singular.
inline bool newton_step(const LengthModel& model, std::size_t count, EdgePlaces& step_m) {
  std::array<double, largest_edge_count> pivot = model.diagonal, right{};
  for (std::size_t index = 0; index < count; ++index) {
    right[index] = -model.gradient[index];
    if (index > 0) {
      const double factor = model.beside[index - 1] / pivot[index - 1];
      pivot[index] -= factor * model.beside[index - 1];
      right[index] -= factor * right[index - 1];
    }
    if (!(pivot[index] > 0.0)) return false;
  }
  for (std::size_t index = count; index-- > 0;) {
    const double above = index + 1 < count ? model.beside[index] * step_m[index + 1] : 0.0;
    step_m[index] = (right[index] - above) / pivot[index];
  }
  return true;
}

inline double polyline_length_m(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                                const EdgePlaces& places_m) {
  double length_m = 0.0;
  Vec3 before_m = from_m;
  for (std::size_t index = 0; index < lines.size(); ++index) {
    const Vec3 here_m = lines[index].at(places_m[index]);
    length_m += glm::distance(before_m, here_m);
    before_m = here_m;
  }
  return length_m + glm::distance(before_m, to_m);
}

/// How far a place may be from the law of diffraction: the difference of the cosines on its two sides.
inline constexpr double keller_tolerance = 1e-13;

inline double largest_gradient(const LengthModel& model, std::size_t count) {
  double largest = 0.0;
  for (std::size_t index = 0; index < count; ++index) largest = std::max(largest, std::abs(model.gradient[index]));
  return largest;
}

/// Moves `places_m` along a Newton step as far as helps: the length falls as it should, or, where rounding hides that,
/// the gradient halves. False where no share of the step does.
inline bool walk_along(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m, const LengthModel& model,
                       const EdgePlaces& step_m, EdgePlaces& places_m) {
  double slope = 0.0;
  for (std::size_t index = 0; index < lines.size(); ++index) slope += model.gradient[index] * step_m[index];
  const double before_m = polyline_length_m(from_m, lines, to_m, places_m);
  const double defect = largest_gradient(model, lines.size());
  double share = 1.0;
  for (int halving = 0; halving < 50; ++halving, share /= 2.0) {
    EdgePlaces next_m = places_m;
    for (std::size_t index = 0; index < lines.size(); ++index) next_m[index] += share * step_m[index];
    const bool shorter = polyline_length_m(from_m, lines, to_m, next_m) < before_m + 0.1 * share * slope;
    if (!shorter && !(largest_gradient(length_model(from_m, lines, to_m, next_m), lines.size()) < 0.5 * defect)) {
      continue;
    }
    places_m = next_m;
    return true;
  }
  return false;
}

/// Newton's method, damped, from the places given. Each place ends within rounding of the law of diffraction.
inline bool descend_from(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m, EdgePlaces& places_m) {
  // Where rounding of far coordinates allows no better.
  const double good_enough = 1e-9 + 8e-16 * (glm::length(from_m) + glm::length(to_m));
  for (int round = 0; round < 100; ++round) {
    const LengthModel model = length_model(from_m, lines, to_m, places_m);
    const double defect = largest_gradient(model, lines.size());
    if (defect < keller_tolerance) return true;
    EdgePlaces step_m{};
    if (!newton_step(model, lines.size(), step_m) || !walk_along(from_m, lines, to_m, model, step_m, places_m)) {
      return defect < good_enough;
    }
  }
  return largest_gradient(length_model(from_m, lines, to_m, places_m), lines.size()) < good_enough;
}

/// Whether every point is off the lines of its neighbours: points that coincide, or lie along an edge, meet the law of
/// diffraction by accident.
inline bool is_proper(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                      const EdgePlaces& places_m) {
  for (std::size_t index = 0; index < lines.size(); ++index) {
    const Vec3 before_m = index == 0 ? from_m : lines[index - 1].at(places_m[index - 1]);
    const Vec3 after_m = index + 1 == lines.size() ? to_m : lines[index + 1].at(places_m[index + 1]);
    for (const Vec3& neighbour_m : {before_m, after_m}) {
      const Vec3 away_m = neighbour_m - lines[index].start_m;
      const double across_m = glm::length(away_m - glm::dot(away_m, lines[index].direction) * lines[index].direction);
      if (!(across_m > in_plane_guard_m)) return false;
    }
  }
  return true;
}

/// From several starts: where edges meet in a corner the length has a kink in which a descent may end.
inline bool shortest_over(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m, EdgePlaces& places_m) {
  struct Start {
    double share;  ///< of each edge's length
    int sweeps;    ///< over single edges before the descent; they may lead into a kink
  };
  for (const Start start : {Start{0.5, 4}, Start{0.5, 0}, Start{0.31, 1}, Start{0.77, 0}, Start{0.13, 0},
                            Start{0.94, 0}, Start{0.13, 2}, Start{0.94, 2}}) {
    for (std::size_t index = 0; index < lines.size(); ++index) places_m[index] = start.share * lines[index].length_m;
    for (int sweep = 0; sweep < start.sweeps; ++sweep) {
      for (std::size_t index = 0; index < lines.size(); ++index) {
        const Vec3 before_m = index == 0 ? from_m : lines[index - 1].at(places_m[index - 1]);
        const Vec3 after_m = index + 1 == lines.size() ? to_m : lines[index + 1].at(places_m[index + 1]);
        place_between(before_m, lines[index], after_m, places_m[index]);  // no place there: the old one will do
      }
    }
    if (descend_from(from_m, lines, to_m, places_m) && is_proper(from_m, lines, to_m, places_m)) return true;
  }
  return false;
}

}  // namespace detail

/// Places of diffraction on one to three edges, between two ends; edges and ends are unfolded where mirrors lie between
/// them. False where a place is not strictly inside its edge, or where the shortest way is no way over edges: an end on
/// the line of its edge, two points in one.
inline bool diffraction_places(const Vec3& from_m, std::span<const EdgeLine> lines, const Vec3& to_m,
                               EdgePlaces& places_m) {
  const std::size_t count = lines.size();
  const bool found = count == 1 ? detail::place_between(from_m, lines[0], to_m, places_m[0])
                                : detail::shortest_over(from_m, lines, to_m, places_m);
  if (!found) return false;
  for (std::size_t index = 0; index < count; ++index) {
    if (!(places_m[index] > in_plane_guard_m && places_m[index] < lines[index].length_m - in_plane_guard_m)) {
      return false;
    }
  }
  return true;
}

}  // namespace dcem
