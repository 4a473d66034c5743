#pragma once
/// Cuts a flat polygon into triangles by clipping ears. tinyobjloader's own cutting takes the shorter diagonal of a
/// quadrilateral even where it runs outside, and judges corners by their place relative to the origin; both put walls
/// where there are none. Private to dcem::io.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

/// Cuts one polygon after the other; keeps its memory in between.
class PolygonCutter {
 public:
  /// Triangles as indices into `corners_m`, n − 2 of them, with the winding of the polygon. No corner is left out: one
  /// in the midst of a straight edge stays a corner of a triangle, so that neighbours still share their edges.
  const std::vector<std::array<std::size_t, 3>>& cut(std::span<const Vec3> corners_m) {
    triangles_.clear();
    crosses_itself_ = false;
    start_ = 0;
    project(corners_m);
    remaining_.resize(corners_m.size());
    for (std::size_t index = 0; index < remaining_.size(); ++index) remaining_[index] = index;
    while (remaining_.size() > 3) clip(find_ear());
    triangles_.push_back({remaining_[0], remaining_[1], remaining_[2]});
    return triangles_;
  }

  /// Whether the last polygon could be cut only by force: it crosses itself or has no area.
  bool crosses_itself() const { return crosses_itself_; }

 private:
  /// On the coordinate plane that the polygon faces most, so that it runs counterclockwise.
  void project(std::span<const Vec3> corners_m) {
    Vec3 normal(0.0);  // Newell's method, relative to a corner: far from the origin the products lose their digits
    for (std::size_t index = 0; index < corners_m.size(); ++index) {
      normal += glm::cross(corners_m[index] - corners_m[0], corners_m[(index + 1) % corners_m.size()] - corners_m[0]);
    }
    const Vec3 size = glm::abs(normal);
    const int dropped = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
    const double sign = normal[dropped] < 0.0 ? -1.0 : 1.0;
    points_.clear();
    for (const Vec3& corner : corners_m)
      points_.emplace_back(sign * (corner[u] - corners_m[0][u]), corner[v] - corners_m[0][v]);
  }

  /// Twice the signed area of a triangle: positive where it runs counterclockwise.
  static double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  std::size_t before(std::size_t place) const {
    return remaining_[(place + remaining_.size() - 1) % remaining_.size()];
  }
  std::size_t after(std::size_t place) const { return remaining_[(place + 1) % remaining_.size()]; }
  double turn_at(std::size_t place) const {
    return turn(points_[before(place)], points_[remaining_[place]], points_[after(place)]);
  }

  /// A convex corner whose triangle holds no other corner, edges included. Only corners that do not stick out can be in
  /// the way.
  bool is_ear(std::size_t place) const {
    if (!(turn_at(place) > 0.0)) return false;
    const Vec2 &a = points_[before(place)], &b = points_[remaining_[place]], &c = points_[after(place)];
    for (std::size_t other = 0; other < remaining_.size(); ++other) {
      const Vec2& point = points_[remaining_[other]];
      if (point == a || point == b || point == c) continue;
      const bool inside = turn(a, b, point) >= 0.0 && turn(b, c, point) >= 0.0 && turn(c, a, point) >= 0.0;
      if (inside && !(turn_at(other) > 0.0)) return false;
    }
    return true;
  }

  std::size_t find_ear() {
    for (std::size_t step = 0; step < remaining_.size(); ++step) {
      const std::size_t place = (start_ + step) % remaining_.size();
      if (!is_ear(place)) continue;
      start_ = place + 1;  // going round, instead of clipping at one place, avoids fans of slivers
      return place;
    }
    crosses_itself_ = true;
    return 0;
  }

  void clip(std::size_t place) {
    triangles_.push_back({before(place), remaining_[place], after(place)});
    remaining_.erase(remaining_.begin() + static_cast<std::ptrdiff_t>(place));
  }

  std::vector<Vec2> points_;
  std::vector<std::size_t> remaining_;
  std::size_t start_ = 0;
  std::vector<std::array<std::size_t, 3>> triangles_;
  bool crosses_itself_ = false;
};

}  // namespace dcem::io
