#pragma once
/// Cuts convex parts of a flat surface along planes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/halves/hull_sides.hpp"
#include "dcem/paths/visible/part_list.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
class PartCutter {
 public:
  /// A corner no farther from a side than this is on it, metres: beyond rounding at 10 km, and less than a mesh means.
  static constexpr double on_side_m = 1e-7;

  /// Pieces that are narrower are left out.
  explicit PartCutter(double least_width_m) : least_width_m_(least_width_m) {}

  /// Cuts what is inside of all sides out of each part. `inside(part, polygon, next)` may put it, or what is left of
  /// it, into the list that is made. Where nothing of a part is inside it stays as it is.
  template <typename Inside>
  void cut(PartList& parts, std::span<const HullSide> sides, Inside&& inside) {
    next_.clear_parts();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const std::span<const Vec3> polygon = parts.corners_m(part);
      if (is_apart(polygon, sides) || !split(polygon, sides)) {
        next_.add(polygon, parts.crossed(part));
        continue;
      }
      std::size_t first = 0;
      for (const std::size_t end : ends_) {
        next_.add(std::span(outside_).subspan(first, end - first), parts.crossed(part));
        first = end;
      }
      inside(part, std::span<const Vec3>(polygon_), next_);
    }
    parts.swap_parts(next_);
  }

  /// Cuts each of some polygons along a plane, and keeps both sides.
  void cut_apart(std::vector<std::vector<Vec3>>& polygons, const HullSide& side) {
    const std::size_t count = polygons.size();
    for (std::size_t index = 0; index < count; ++index) {
      std::vector<Vec3> within = polygons[index], beyond = polygons[index];
      keep_inside(within, side);
      keep_inside(beyond, {-side.normal, -side.offset_m});
      if (!is_piece(within) || !is_piece(beyond)) continue;
      polygons[index] = std::move(within);
      polygons.push_back(std::move(beyond));
    }
  }

  /// The part of a polygon that is inside of a side, in place.
  void keep_inside(std::vector<Vec3>& polygon, const HullSide& side) {
    measure(polygon, side);
    inside_.clear();
    cut_polygon(polygon, [&](const Vec3& corner, bool is_inside) {
      if (is_inside) inside_.push_back(corner);
    });
    polygon.swap(inside_);
  }

  /// Whether a polygon is wide enough to be a part.
  bool is_piece(std::span<const Vec3> polygon) const {
    if (polygon.size() < 3) return false;
    double length_squared = 0.0;
    for (const Vec3& corner : polygon) {
      const Vec3 way = corner - polygon[0];
      length_squared = std::max(length_squared, glm::dot(way, way));
    }
    return twice_area_m2(polygon) > 2.0 * least_width_m_ * std::sqrt(length_squared);
  }

 private:
  static double above_m(const HullSide& side, const Vec3& point_m) {
    return glm::dot(side.normal, point_m) - side.offset_m;
  }

  static bool is_apart(std::span<const Vec3> polygon, std::span<const HullSide> sides) {
    return std::any_of(sides.begin(), sides.end(), [&](const HullSide& side) {
      return std::all_of(polygon.begin(), polygon.end(),
                         [&](const Vec3& corner) { return above_m(side, corner) <= on_side_m; });
    });
  }

  /// Leaves what is inside in `polygon_`, and what is outside in convex pieces in `outside_`; false: nothing is inside.
  bool split(std::span<const Vec3> polygon, std::span<const HullSide> sides) {
    polygon_.assign(polygon.begin(), polygon.end());
    outside_.clear();
    ends_.clear();
    for (const HullSide& side : sides) {
      if (!measure(polygon_, side)) continue;
      const std::size_t first = outside_.size();
      inside_.clear();
      cut_polygon(polygon_,
                  [&](const Vec3& corner, bool is_inside) { (is_inside ? inside_ : outside_).push_back(corner); });
      if (is_piece(std::span<const Vec3>(outside_).subspan(first))) {
        ends_.push_back(outside_.size());
      } else {
        outside_.resize(first);
      }
      polygon_.swap(inside_);
      if (polygon_.size() < 3) return false;
    }
    return is_piece(polygon_);
  }

  /// Distances of the corners from a side; false: none is outside.
  bool measure(std::span<const Vec3> polygon, const HullSide& side) {
    above_m_.clear();
    bool any_outside = false;
    for (const Vec3& corner : polygon) {
      const double above = above_m(side, corner);
      above_m_.push_back(std::abs(above) <= on_side_m ? 0.0 : above);
      any_outside = any_outside || above_m_.back() < 0.0;
    }
    return any_outside;
  }

  /// Calls `take(corner, is_inside)` around the polygon; corners on the side belong to both.
  template <typename Take>
  void cut_polygon(std::span<const Vec3> polygon, Take&& take) const {
    for (std::size_t index = 0; index < polygon.size(); ++index) {
      const std::size_t next = index + 1 == polygon.size() ? 0 : index + 1;
      const double here = above_m_[index], there = above_m_[next];
      if (here >= 0.0) take(polygon[index], true);
      if (here <= 0.0) take(polygon[index], false);
      if ((here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0)) {
        const Vec3 crossing = polygon[index] + here / (here - there) * (polygon[next] - polygon[index]);
        take(crossing, true);
        take(crossing, false);
      }
    }
  }

  double least_width_m_;
  PartList next_;
  std::vector<Vec3> polygon_, inside_, outside_;
  std::vector<std::size_t> ends_;  ///< of the pieces in `outside_`
  std::vector<double> above_m_;
};

}  // namespace dcem
