#pragma once
/// What a convex outline hides from several points at once.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "dcem/geometry/plane.hpp"

namespace dcem {

namespace detail {

/// A convex polygon of up to so many corners.
struct InsetOutline {
  static constexpr std::size_t capacity = 64;
  std::array<Vec3, capacity> corners_m;
  std::size_t count = 0;

  std::span<const Vec3> corners() const { return {corners_m.data(), count}; }

  /// Whether there may be too many corners to cut off one more.
  bool is_full() const { return count + 2 > capacity; }

  /// False where there are too many corners.
  bool assign(std::span<const Vec3> corners) {
    count = corners.size();
    if (is_full()) return false;
    std::copy(corners.begin(), corners.end(), corners_m.begin());
    return true;
  }
  /// Keeps what lies on the inner side of a plane; false where nothing is left, or too much.
  bool keep(const Vec3& inward, double offset_m) {
    const auto end = corners_m.begin() + static_cast<std::ptrdiff_t>(count);
    const auto cut_off = [&](const Vec3& corner) { return glm::dot(inward, corner) < offset_m; };
    if (std::none_of(corners_m.begin(), end, cut_off)) return count >= 3;
    std::array<Vec3, capacity> kept;
    std::size_t left = 0;
    for (std::size_t index = 0; index < count; ++index) {
      const Vec3 &from = corners_m[index], &to = corners_m[index + 1 == count ? 0 : index + 1];
      const double here = glm::dot(inward, from) - offset_m, there = glm::dot(inward, to) - offset_m;
      if (left + 2 > capacity) {
        count = capacity;
        return false;
      }
      if (here >= 0.0) kept[left++] = from;
      if ((here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0)) {
        kept[left++] = from + here / (here - there) * (to - from);
      }
    }
    std::copy(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(left), corners_m.begin());
    count = left;
    return count >= 3;
  }
};

/// The normals of planes through a point, of two outlines at most. No memory is shared with others who look.
struct MovedSides {
  std::array<Vec3, 2 * InsetOutline::capacity> normals;
  std::size_t count = 0;

  std::span<Vec3> all() { return {normals.data(), count}; }
  std::span<const Vec3> all() const { return {normals.data(), count}; }
};

/// How far a convex polygon reaches along a direction in its plane, from the foot of a point P = from_m; and between
/// which slopes along it, against the way away from the plane, all that is behind the polygon lies as seen from P, and
/// is hidden from all points P + offsets_m[i], too. It is the strip around the polygon, its two sides moved in as
/// `sides_moved_in` has it: as each of them is a sum of sides of the polygon, nothing that is inside all of those is
/// outside of it.
struct Reach {
  double low_m, high_m;
  double low, high;  ///< slopes; where the first is larger, nothing is left
};

/// `along`: in the plane, or all but. `distance_m`: of P from the plane, above 0; `towards`: the plane's normal on the
/// side of P.
inline Reach reach_along(std::span<const Vec3> corners_m, const Vec3& along, double distance_m, const Vec3& towards,
                         const Vec3& from_m, std::span<const Vec3> offsets_m) {
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const Vec3& corner_m : corners_m) {
    const double place_m = glm::dot(along, corner_m - from_m);
    low_m = std::min(low_m, place_m);
    high_m = std::max(high_m, place_m);
  }
  Reach reach{low_m, high_m, low_m / distance_m, high_m / distance_m};
  for (const Vec3& offset_m : offsets_m) {
    const double place_m = glm::dot(along, offset_m), share = 1.0 / (distance_m + glm::dot(towards, offset_m));
    reach.low = std::max(reach.low, share * (low_m - place_m));
    reach.high = std::min(reach.high, share * (high_m - place_m));
  }
  return reach;
}

/// Whether a convex polygon is clearly narrower than the points P + offsets_m[i] are apart, so that its sides, moved
/// in, leave nothing: most outlines are as small as that, and this is found out sooner. Where `sides_moved_in` answers
/// false this may say anything.
inline bool is_narrower(std::span<const Vec3> corners_m, const Plane& plane, const Vec3& from_m,
                        std::span<const Vec3> offsets_m) {
  const double height_m = signed_distance_m(plane, from_m), distance_m = std::abs(height_m);
  const Vec3 normal = plane.normal, towards = height_m > 0.0 ? normal : -normal;
  const auto leaves_nothing = [&](const Vec3& along) {
    const Reach reach = reach_along(corners_m, along, distance_m, towards, from_m, offsets_m);
    return reach.low > reach.high;
  };
  constexpr double upright = 0.1, level = 0.99;
  const double levelness = std::abs(normal.z);
  const Vec3 across = levelness > level ? Vec3(1.0, 0.0, 0.0) : Vec3(normal.y, -normal.x, 0.0);
  if (leaves_nothing(across)) return true;
  return levelness > upright && leaves_nothing(glm::cross(normal, across));
}

}  // namespace detail

/// The sides of a convex polygon as half spaces through a point P = from_m, each moved inwards so far that what is
/// inside all of them and behind the polygon is hidden by it from all points P + offsets_m[i], too. False where a point
/// is not clearly on the same side of the plane as P, or there are too many corners.
///
/// With d the distance of P from the plane, n its normal towards P, and m the normal of a side in the plane, inwards,
/// the plane through P and the side has the normal N = m + (β/d) n, β being the distance of P's foot outside the side.
/// P + δ sees a point X that lies e behind the plane inside the side if N·(X − P) ≥ e (−N·δ)/(d + n·δ). As e is less
/// than −n·(X − P), it is enough that (N + κ n)·(X − P) ≥ 0 with κ = max(0, −N·δ/(d + n·δ)).
/// What is said of the polygon holds of any surface over it, too, that is nowhere farther in front of the plane than
/// `stray_m`, and not behind it: N is that of the plane or of one so much nearer, whichever turns inwards more.
/// `left_out`: the number of a side that is not asked for.
inline bool sides_moved_in(std::span<const Vec3> corners_m, const Plane& plane, const Vec3& from_m,
                           std::span<const Vec3> offsets_m, detail::MovedSides& result, double stray_m = 0.0,
                           std::size_t left_out = detail::InsetOutline::capacity) {
  constexpr double hair_m = 1e-5;  // corners may be off the plane by some micrometres
  const double height_m = signed_distance_m(plane, from_m), farthest_m = std::abs(height_m);
  const double nearest_m = farthest_m - stray_m;
  const Vec3 towards = height_m > 0.0 ? plane.normal : -plane.normal;
  double reach_m = 0.0;
  for (const Vec3& offset_m : offsets_m) reach_m = std::max(reach_m, std::abs(glm::dot(towards, offset_m)));
  if (!(nearest_m > 1.001 * reach_m + hair_m) || corners_m.size() > detail::InsetOutline::capacity) return false;
  Vec3 centre_m(0.0);
  for (const Vec3& corner : corners_m) centre_m += corner / static_cast<double>(corners_m.size());
  const std::size_t first = result.count;
  if (first + corners_m.size() > result.normals.size()) return false;
  std::array<double, detail::InsetOutline::capacity> turned;  // how far towards the points, at most
  std::array<double, detail::InsetOutline::capacity> outside_m;
  for (std::size_t index = 0; index < corners_m.size(); ++index) {
    const Vec3 &from = corners_m[index], &to = corners_m[index + 1 == corners_m.size() ? 0 : index + 1];
    Vec3 inward = glm::cross(plane.normal, to - from);
    const double length = glm::length(inward);
    if (!(length > 1e-9) || index == left_out) continue;  // its neighbours move the corner by as much
    inward *= (glm::dot(inward, centre_m - from) < 0.0 ? -1.0 : 1.0) / length;
    const std::size_t side = result.count - first;
    outside_m[side] = glm::dot(inward, from - from_m);
    turned[side] = std::max(outside_m[side] / farthest_m, outside_m[side] / nearest_m);
    result.normals[result.count++] = inward;
  }
  const std::span<Vec3> sides = result.all().subspan(first);
  for (const double distance_m : {farthest_m, nearest_m}) {
    for (const Vec3& offset_m : offsets_m) {
      const double ahead_m = glm::dot(towards, offset_m), share = -1.0 / (distance_m + ahead_m);
      for (std::size_t side = 0; side < sides.size(); ++side) {
        const double own = outside_m[side] / distance_m;
        turned[side] = std::max(turned[side], own + share * (glm::dot(sides[side], offset_m) + own * ahead_m));
      }
    }
    if (stray_m == 0.0) break;
  }
  for (std::size_t side = 0; side < sides.size(); ++side) sides[side] += (turned[side] + hair_m / nearest_m) * towards;
  return true;
}

/// The part of a convex polygon inside half spaces through a point; false where nothing is left.
inline bool inset_outline(std::span<const Vec3> corners_m, const Vec3& from_m, std::span<const Vec3> normals,
                          detail::InsetOutline& result) {
  return result.assign(corners_m) && std::all_of(normals.begin(), normals.end(), [&](const Vec3& normal) {
           return result.keep(normal, glm::dot(normal, from_m));
         });
}

}  // namespace dcem
