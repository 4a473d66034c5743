#pragma once
/// Two outlines that meet along a vertical line with the same numbers (facet_joints.hpp), and what several points close
/// to each other cannot see between them.
///
/// An outline hides from all points what is inside its sides moved in (inset.hpp): between two façades that leaves a
/// slit open, as wide as the points are apart. Let P + δ be any of the points, X behind the planes of both outlines and
/// inside the sides of both, moved in, but for those on the line. The plane through P + δ and the line has one outline
/// on each side (`opens` says where not); on the side on which X is, the way from P + δ to X crosses the outline within
/// all of its sides. Where the way meets the line itself it meets one of them at least, in numbers, too: all corners on
/// the line have the same x and y, so that WatertightRay puts them on the same side of a way that is not much steeper
/// than it is long.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/halves/inset.hpp"

namespace dcem {

/// An outline, and its side that lies on the line: from the corner of this number to the next.
struct JoinedOutline {
  std::span<const Vec3> corners_m;
  Plane plane;
  std::size_t side;
  double stray_m;  ///< as in `sides_moved_in`
};

namespace detail {

/// Points around one of them, which is P. None: P alone.
class PointsAround {
 public:
  PointsAround(const Vec3& from_m, std::span<const Vec3> offsets_m) : from_m_(from_m), offsets_m_(offsets_m) {
    Vec3 low_m(0.0), high_m(0.0);
    for (const Vec3& offset_m : offsets_m_) {
      low_m = glm::min(low_m, offset_m);
      high_m = glm::max(high_m, offset_m);
    }
    level_m_ = std::max({-low_m.x, -low_m.y, high_m.x, high_m.y});
    upright_m_ = std::max(-low_m.z, high_m.z);
    corners_m_ = {Vec3(low_m.x, low_m.y, 0.0), Vec3(low_m.x, high_m.y, 0.0), Vec3(high_m.x, low_m.y, 0.0),
                  Vec3(high_m.x, high_m.y, 0.0)};
  }

  const Vec3& from_m() const { return from_m_; }
  std::span<const Vec3> offsets_m() const { return offsets_m_.empty() ? std::span<const Vec3>(alone_m) : offsets_m_; }
  /// Of a rectangle around them, seen from above.
  std::span<const Vec3> corners_m() const { return std::span(corners_m_).first(offsets_m_.empty() ? 1 : 4); }
  /// How far they are from P along x or y.
  double level_m() const { return level_m_; }
  /// Whether ways from all of them to what is so far from P, measured level, are no steeper than WatertightRay allows
  /// for, where the way from P rises by no more than `steepness` times its length h along x or y. That is at least 0.7
  /// of the distance, and from the others it is enough that steepness · h + upright ≤ steepest · (h − level).
  bool are_level_before(double away_m, double steepness) const {
    constexpr double steepest = 0.999 * WatertightRay::steepest;
    return 0.7 * away_m * (steepest - steepness) > steepest * level_m_ + upright_m_;
  }

 private:
  static constexpr std::array<Vec3, 1> alone_m{Vec3(0.0)};

  Vec3 from_m_;
  std::span<const Vec3> offsets_m_;
  double level_m_ = 0.0, upright_m_ = 0.0;
  std::array<Vec3, 4> corners_m_;
};

/// Whether an outline is clearly on one side of the vertical plane through its line and a point, and on which: 1 where
/// that is left of the way to the line, −1 right of it, 0 where it is not clear. The line is that of the hull: so a
/// point before the slab that the surface lies in has the same side, as far as it may stray.
inline double side_of_line(const JoinedOutline& outline, const Vec3& from_m) {
  constexpr double on_line_m = 2e-3, clearly_m = 1e-5;
  constexpr double steep_enough = 1e-5;  // rays that are much closer to a plane are asked where its triangles begin
  const Vec3& line_m = outline.corners_m[outline.side];
  const Vec3 way_m = line_m - from_m;
  const double length_m = std::abs(way_m.x) + std::abs(way_m.y);
  double side = 0.0;
  for (const Vec3& corner_m : outline.corners_m) {
    const Vec3 beside_m = corner_m - line_m;
    const double width_m = std::abs(beside_m.x) + std::abs(beside_m.y);
    if (width_m <= on_line_m) continue;
    const double left_m2 = way_m.x * beside_m.y - way_m.y * beside_m.x;
    const double least_m2 = (outline.stray_m + clearly_m + steep_enough * width_m) * length_m;
    if (!(std::abs(left_m2) > least_m2) || left_m2 * side < 0.0) return 0.0;
    side = left_m2 > 0.0 ? 1.0 : -1.0;
  }
  return side;
}

/// Whether the two may be on one side of the plane through their line and some of the points.
inline bool opens(const JoinedOutline& one, const JoinedOutline& other, const PointsAround& points) {
  double side = 0.0;
  for (const Vec3& corner_m : points.corners_m()) {
    const double here = side_of_line(one, points.from_m() + corner_m);
    if (here == 0.0 || here * side < 0.0 || side_of_line(other, points.from_m() + corner_m) != -here) return true;
    side = here;
  }
  return false;
}

/// A slit around the line at the distance 1 m from P: level directions to the line and across, and how far it reaches
/// to each side.
struct SlitFrame {
  Vec3 ahead, across;
  double away_m, wide;

  /// With `more` to each side of what the points need; none where they are too close.
  static std::optional<SlitFrame> of(const JoinedOutline& one, const PointsAround& points, double more) {
    const Vec3 way_m = one.corners_m[one.side] - points.from_m();
    const double away_m = std::hypot(way_m.x, way_m.y), reach_m = 1.5 * points.level_m();
    if (!(away_m > 2.0 * reach_m + 1e-3)) return std::nullopt;
    const Vec3 ahead(way_m.x / away_m, way_m.y / away_m, 0.0);
    return SlitFrame{ahead, {-ahead.y, ahead.x, 0.0}, away_m, reach_m / (away_m - reach_m) + more};
  }
};

/// All of the slit that is as high as both outlines are at the line; false where that is less than `least`.
inline bool slit_around(const JoinedOutline& one, const JoinedOutline& other, const PointsAround& points,
                        const SlitFrame& frame, double least, InsetOutline& result) {
  const auto ends_of = [](const JoinedOutline& outline) {
    const double from_m = outline.corners_m[outline.side].z;
    const double to_m = outline.corners_m[(outline.side + 1) % outline.corners_m.size()].z;
    return std::minmax({from_m, to_m});
  };
  const auto [one_low_m, one_high_m] = ends_of(one);
  const auto [other_low_m, other_high_m] = ends_of(other);
  const double low = (std::max(one_low_m, other_low_m) - points.from_m().z) / frame.away_m;
  const double high = (std::min(one_high_m, other_high_m) - points.from_m().z) / frame.away_m;
  if (high - low < least) return false;
  const auto corner = [&](double aside, double height) {
    return points.from_m() + frame.ahead + aside * frame.across + Vec3(0.0, 0.0, height);
  };
  const double wide = frame.wide;
  return result.assign(std::array{corner(-wide, low), corner(wide, low), corner(wide, high), corner(-wide, high)});
}

/// The places across the slit, at the distance 1 m from P and against the way to the line, that are inside the side of
/// an outline far from the line, as all points see it.
inline void keep_before_far_side(const JoinedOutline& outline, const PointsAround& points, const SlitFrame& frame,
                                 double& from, double& to) {
  const double height_m = signed_distance_m(outline.plane, points.from_m()), distance_m = std::abs(height_m);
  const Vec3 normal = outline.plane.normal, towards = height_m > 0.0 ? normal : -normal;
  const Vec3 along(normal.y, -normal.x, 0.0);
  const Reach reach = reach_along(outline.corners_m, along, distance_m, towards, points.from_m(), points.offsets_m());
  const double line_m = frame.away_m * glm::dot(along, frame.ahead);
  const bool ends_high = reach.high_m - line_m > line_m - reach.low_m;
  const Vec3 inwards = ends_high ? -along - reach.high * towards : along + reach.low * towards;
  const double straight = glm::dot(inwards, frame.ahead), aside = glm::dot(inwards, frame.across);
  if (aside > 0.0) from = std::max(from, -straight / aside);
  if (aside < 0.0) to = std::min(to, -straight / aside);
}

/// Whether the two are so narrow that their far sides, moved in, leave nothing of the slit: `keep_inside` would find
/// that, too, for ten times the price. It is asked at the height of P: of outlines that are all but upright it may give
/// up a sliver at another height, by which less is hidden.
inline bool is_closed_between(const JoinedOutline& one, const JoinedOutline& other, const PointsAround& points,
                              const SlitFrame& frame) {
  double from = -frame.wide, to = frame.wide;
  keep_before_far_side(one, points, frame, from, to);
  keep_before_far_side(other, points, frame, from, to);
  return from >= to;
}

/// Leaves what is inside all sides of both but for those on the line, as all points see them; false where that is
/// nothing.
inline bool keep_inside(const JoinedOutline& one, const JoinedOutline& other, const PointsAround& points,
                        InsetOutline& result) {
  MovedSides sides;
  const auto add_sides = [&](const JoinedOutline& outline) {
    return sides_moved_in(outline.corners_m, outline.plane, points.from_m(), points.offsets_m(), sides, outline.stray_m,
                          outline.side);
  };
  return add_sides(one) && add_sides(other) && std::ranges::all_of(sides.all(), [&](const Vec3& normal) {
           return result.keep(normal, glm::dot(normal, points.from_m()));
         });
}

/// How far away, measured level, what is behind both outlines and inside one around the line is at least. 1/distance is
/// linear over that one: it is largest at a corner.
inline double least_away_m(const JoinedOutline& one, const JoinedOutline& other, const Vec3& from_m,
                           const InsetOutline& around) {
  const auto nearest = [&](const Plane& plane) {
    const double height_m = signed_distance_m(plane, from_m);
    double nearness = 0.0;
    for (const Vec3& corner_m : around.corners()) {
      nearness = std::max(nearness, glm::dot(plane.normal, corner_m - from_m) / -height_m);
    }
    return nearness;
  };
  return 1.0 / std::min(nearest(one.plane), nearest(other.plane));
}

}  // namespace detail

}  // namespace dcem
