#pragma once
/// Every triangle of a city in a grid, and whether a straight leg is free of them: plain arithmetic of its own, with
/// margins, for tests that share nothing with the engine's trees and filters.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "dcem/geometry/surfaces/surface_settings.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::test {

/// What is sure about a leg or a triangle in its way. Doubtful is whatever rounding or a rule of contact may decide.
enum class LegState { clear, doubtful, blocked };

/// Nearer than this a triangle that does not cross a leg makes it doubtful, metres: 10,000 times the rounding of a
/// point that two mirrors at grazing make out of coordinates of kilometres.
inline constexpr double leg_clearance_m = 1e-5;

/// A point further inside a triangle than this is surely in it, metres: rounding is a thousandth of it.
inline constexpr double surely_inside_m = 1e-6;

/// What a leg meets by right at one of its ends: the facets of the mirror or edge there. None at a device.
struct LegStop {
  std::array<std::uint32_t, 2> facets{none, none};
  static constexpr std::uint32_t none = 0xffffffff;
};

struct StraightLeg {
  Vec3 from_m, to_m;
  std::array<LegStop, 2> stops{};
};

inline double distance_between_m(const Vec3& point_m, const Vec3& start_m, const Vec3& end_m) {
  const Vec3 along_m = end_m - start_m, away_m = point_m - start_m;
  const double squared = glm::dot(along_m, along_m);
  const double share = squared > 0.0 ? std::clamp(glm::dot(away_m, along_m) / squared, 0.0, 1.0) : 0.0;
  return glm::length(away_m - share * along_m);
}

/// Between two segments: where the nearest points of their lines are both inside, there; else at one of four ends.
inline double distance_of_segments_m(const Vec3& a_m, const Vec3& b_m, const Vec3& c_m, const Vec3& d_m) {
  double nearest_m = std::min({distance_between_m(a_m, c_m, d_m), distance_between_m(b_m, c_m, d_m),
                               distance_between_m(c_m, a_m, b_m), distance_between_m(d_m, a_m, b_m)});
  const Vec3 first = b_m - a_m, second = d_m - c_m, across = glm::cross(first, second), gap = c_m - a_m;
  const double squared = glm::dot(across, across);
  if (!(squared > 0.0)) return nearest_m;
  const double one = glm::dot(glm::cross(gap, second), across) / squared;
  const double other = glm::dot(glm::cross(gap, first), across) / squared;
  if (one >= 0.0 && one <= 1.0 && other >= 0.0 && other <= 1.0) {
    nearest_m = std::min(nearest_m, std::abs(glm::dot(gap, across)) / std::sqrt(squared));
  }
  return nearest_m;
}

/// A triangle as a plane and three sides that look inwards, all distances in metres.
struct FlatTriangle {
  std::array<Vec3, 3> corners_m;
  Vec3 normal, low_m, high_m;
  std::array<Vec3, 3> inwards;
  double offset_m = 0.0;
  std::array<double, 3> side_offsets_m{};
  std::uint32_t facet = 0;

  FlatTriangle(const std::array<Vec3, 3>& corners, std::uint32_t of_facet)
      : corners_m(corners), low_m(corners[0]), high_m(corners[0]), facet(of_facet) {
    normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    offset_m = glm::dot(normal, corners[0]);
    for (std::size_t side = 0; side < 3; ++side) {
      inwards[side] = glm::normalize(glm::cross(normal, corners[(side + 1) % 3] - corners[side]));
      side_offsets_m[side] = glm::dot(inwards[side], corners[side]);
      low_m = glm::min(low_m, corners[side]);
      high_m = glm::max(high_m, corners[side]);
    }
  }

  double above_m(const Vec3& point_m) const { return glm::dot(normal, point_m) - offset_m; }
  /// How far the foot of a point is inside the nearest side; negative outside.
  double inside_m(const Vec3& point_m) const {
    return std::min({glm::dot(inwards[0], point_m) - side_offsets_m[0],
                     glm::dot(inwards[1], point_m) - side_offsets_m[1],
                     glm::dot(inwards[2], point_m) - side_offsets_m[2]});
  }
  double distance_m(const Vec3& point_m) const {
    if (inside_m(point_m) >= 0.0) return std::abs(above_m(point_m));
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t side = 0; side < 3; ++side) {
      nearest_m = std::min(nearest_m, distance_between_m(point_m, corners_m[side], corners_m[(side + 1) % 3]));
    }
    return nearest_m;
  }
  /// From a segment that does not cross it.
  double distance_m(const StraightLeg& leg) const {
    double nearest_m = std::min(distance_m(leg.from_m), distance_m(leg.to_m));
    for (std::size_t side = 0; side < 3; ++side) {
      nearest_m =
          std::min(nearest_m, distance_of_segments_m(leg.from_m, leg.to_m, corners_m[side], corners_m[(side + 1) % 3]));
    }
    return nearest_m;
  }
};

class CityTriangles {
 public:
  explicit CityTriangles(const Scene& scene) : scene_(scene) {
    for (std::uint32_t index = 0; index < scene.triangles().size(); ++index) {
      triangles_.emplace_back(scene.corners_m(index), scene.facet_of_triangle(index).value);
      low_m_ = index == 0 ? triangles_[0].low_m : glm::min(low_m_, triangles_.back().low_m);
      high_m_ = index == 0 ? triangles_[0].high_m : glm::max(high_m_, triangles_.back().high_m);
    }
    columns_ = cell_of(high_m_.x, low_m_.x) + 1;
    rows_ = cell_of(high_m_.y, low_m_.y) + 1;
    cells_.resize(columns_ * rows_);
    for (std::uint32_t index = 0; index < triangles_.size(); ++index) {
      const FlatTriangle& triangle = triangles_[index];
      for (std::size_t row = row_at(triangle.low_m.y); row <= row_at(triangle.high_m.y); ++row) {
        for (std::size_t column = column_at(triangle.low_m.x); column <= column_at(triangle.high_m.x); ++column) {
          cells_[row * columns_ + column].push_back(index);
        }
      }
    }
  }

  const std::vector<FlatTriangle>& triangles() const { return triangles_; }
  const Vec3& low_m() const { return low_m_; }
  const Vec3& high_m() const { return high_m_; }

  LegState state(const StraightLeg& leg) const {
    bool doubtful = false;
    const bool blocked = any_beside(leg.from_m, leg.to_m, [&](const FlatTriangle& triangle) {
      const LegState met = meeting(leg, triangle);
      doubtful = doubtful || met == LegState::doubtful;
      return met == LegState::blocked;
    });
    return blocked ? LegState::blocked : doubtful ? LegState::doubtful : LegState::clear;
  }

  /// Whether `test(triangle)` is true of any triangle whose box is within `beside_m` of that of a segment's pieces, one
  /// piece for each row of the grid; some are asked about more than once.
  template <typename Test>
  bool any_beside(const Vec3& from_m, const Vec3& to_m, Test&& test) const {
    const Vec3 low_m = glm::min(from_m, to_m) - Vec3(beside_m), high_m = glm::max(from_m, to_m) + Vec3(beside_m);
    for (std::size_t row = row_at(low_m.y); row <= row_at(high_m.y); ++row) {
      const auto [left_m, right_m] = reach_in_row_m(from_m, to_m, row);
      for (std::size_t column = column_at(left_m); column <= column_at(right_m); ++column) {
        for (const std::uint32_t index : cells_[row * columns_ + column]) {
          const FlatTriangle& triangle = triangles_[index];
          if (triangle.low_m.z > high_m.z || triangle.high_m.z < low_m.z) continue;
          if (test(triangle)) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr double cell_m = 8.0;
  static constexpr double beside_m = 0.01;  ///< more than all margins, and than the rounding of a cell's rim

  static std::size_t cell_of(double place_m, double low_m) {
    return static_cast<std::size_t>(std::max(0.0, (place_m - low_m) / cell_m));
  }
  std::size_t column_at(double x_m) const { return std::min(cell_of(x_m, low_m_.x), columns_ - 1); }
  std::size_t row_at(double y_m) const { return std::min(cell_of(y_m, low_m_.y), rows_ - 1); }

  /// Between which x a segment runs in a row and `beside_m` around it. The first and the last row reach to infinity.
  std::pair<double, double> reach_in_row_m(const Vec3& from_m, const Vec3& to_m, std::size_t row) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double floor_m = low_m_.y + static_cast<double>(row) * cell_m;
    const double lower_m = row == 0 ? -infinity : floor_m - beside_m;
    const double upper_m = row + 1 == rows_ ? infinity : floor_m + cell_m + beside_m;
    const double rise_m = to_m.y - from_m.y;
    double first = 0.0, last = 1.0;
    if (std::abs(rise_m) > beside_m) {
      const double enters = (lower_m - from_m.y) / rise_m, leaves = (upper_m - from_m.y) / rise_m;
      first = std::clamp(std::min(enters, leaves), 0.0, 1.0);
      last = std::clamp(std::max(enters, leaves), 0.0, 1.0);
    }
    const double one_m = from_m.x + first * (to_m.x - from_m.x), other_m = from_m.x + last * (to_m.x - from_m.x);
    return {std::min(one_m, other_m) - beside_m, std::max(one_m, other_m) + beside_m};
  }

  LegState meeting(const StraightLeg& leg, const FlatTriangle& triangle) const {
    const double from_m = triangle.above_m(leg.from_m), to_m = triangle.above_m(leg.to_m);
    if (std::min(from_m, to_m) > leg_clearance_m || std::max(from_m, to_m) < -leg_clearance_m) return LegState::clear;
    for (const LegStop& stop : leg.stops) {
      if (triangle.facet == stop.facets[0] || triangle.facet == stop.facets[1]) return LegState::clear;
    }
    const double drop_m = from_m - to_m;
    const double share = drop_m == 0.0 ? 0.0 : std::clamp(from_m / drop_m, 0.0, 1.0);
    const Vec3 point_m = leg.from_m + share * (leg.to_m - leg.from_m);
    const double off_m = 1e-9 * glm::distance(leg.from_m, leg.to_m) / std::abs(drop_m);  // a nanometre, at that angle
    const bool crosses = (from_m > 0.0) != (to_m > 0.0) && std::min(std::abs(from_m), std::abs(to_m)) > 1e-7 &&
                         triangle.inside_m(point_m) > surely_inside_m + off_m;
    if (!crosses && triangle.distance_m(leg) > leg_clearance_m) return LegState::clear;
    const LegState along = lies_along(leg, triangle, point_m);
    if (std::abs(drop_m) > leg_clearance_m && along == LegState::clear) return LegState::clear;
    return crosses && along == LegState::blocked ? LegState::blocked : LegState::doubtful;
  }

  /// The rule of contact: what lies along a face at an end of the leg, within the weld tolerance and tilted by less
  /// than 6° (cosine 0.995), does not block there. Clear: it surely does not; blocked: the rule surely does not hold.
  LegState lies_along(const StraightLeg& leg, const FlatTriangle& triangle, const Vec3& point_m) const {
    constexpr double slack_m = 1e-5, cosine = 0.995, slack = 0.001;
    const Vec3& normal = scene_.facet(FacetId(triangle.facet)).plane.normal;
    LegState found = LegState::blocked;
    for (const LegStop& stop : leg.stops) {
      for (const std::uint32_t facet : stop.facets) {
        if (facet == LegStop::none) continue;
        const Plane& plane = scene_.facet(FacetId(facet)).plane;
        const double off_m = std::abs(glm::dot(plane.normal, point_m - plane.point_m));
        const double tilt = std::abs(glm::dot(plane.normal, normal));
        const double weld_m = scene_.settings().weld_tolerance_m;
        if (off_m < weld_m - slack_m && tilt > cosine + slack) return LegState::clear;
        if (off_m < weld_m + slack_m && tilt > cosine - slack) found = LegState::doubtful;
      }
    }
    return found;
  }

  const Scene& scene_;
  std::vector<FlatTriangle> triangles_;
  Vec3 low_m_{0.0}, high_m_{0.0};
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace dcem::test
