#pragma once
/// A few receivers side by side, that look at the scene together.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/paths/halves/common_cone.hpp"
#include "dcem/paths/halves/extreme_points.hpp"
#include "dcem/paths/halves/lanes.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
class Crowd {
 public:
  static constexpr std::size_t most_points = 2 * simd_lanes;

  static constexpr int default_pixels = 384;  ///< along a side of the view map: by measurement in cities

  explicit Crowd(int map_pixels = default_pixels) : sight_(map_pixels) {}

  /// Looks from 1 to `most_points` points, which touch nothing and ride on nothing.
  void look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                 std::span<const Vec3> points_m, const HalfSettings& settings) {
    points_m_.assign(points_m.begin(), points_m.end());
    take_extreme_points(points_m, extreme_m_);
    origin_m_ = lanes.origin_m();
    sight_.look_from(points_m);
    sight_.find_scenery(scene, outlines, settings, layers_[0]);
    sight_.find_bodies(scene, outlines, settings, {}, layers_[1]);
    radius_m_ = 0.0;
    for (const Vec3& point_m : points_m) {
      radius_m_ = std::max(radius_m_, glm::distance(point_m, sight_.position_m()));
    }
  }

  const Sight& sight() const { return sight_; }
  std::span<const Vec3> points_m() const { return points_m_; }
  double radius_m() const { return radius_m_; }
  /// What of the scenery, and what of all that moves, any of the points may see.
  std::span<const SeenLayer, 2> layers() const { return layers_; }

  std::size_t packs() const { return (points_m_.size() + simd_lanes - 1) / simd_lanes; }
  /// The points of a pack, and which of its lanes hold one.
  LanePoints pack(std::size_t number) const { return {part(points_m_, number), origin_m_}; }
  std::uint32_t lanes_of(std::size_t number) const { return (1U << part(points_m_, number).size()) - 1U; }

  /// The images of a pack's points in a plane.
  LanePoints images(std::size_t number, const Plane& plane) const {
    std::array<Vec3, simd_lanes> images_m;
    const std::span<const Vec3> points_m = part(points_m_, number);
    for (std::size_t at = 0; at < points_m.size(); ++at) images_m[at] = mirrored(plane, points_m[at]);
    return {{images_m.data(), points_m.size()}, origin_m_};
  }

  /// The points on one `side` (1 or −1) of a plane, in the order in which they are.
  void points_beside(const Plane& plane, double side, std::vector<Vec3>& result_m) const {
    take_beside(points_m_, plane, side, result_m);
  }

  /// What the images of all points on one `side` (1 or −1) of a mirror may see through it; false where no point is
  /// there. The cone of each image is inside. Mostly all points are on one side: then those between others need not be
  /// asked, of which no quotient is larger than that of all others (extreme_points.hpp).
  bool cone(const FacetOutlines& outlines, FacetId facet, const Plane& plane, double side,
            std::vector<HalfSpace>& result) const {
    take_beside(extreme_m_, plane, side, scratch_m_);
    if (scratch_m_.size() < extreme_m_.size()) points_beside(plane, side, scratch_m_);
    if (scratch_m_.empty()) return false;
    common_cone(outlines.sides(facet), plane, side * plane.normal, scratch_m_, origin_m_, result);
    return true;
  }

 private:
  static void take_beside(std::span<const Vec3> points_m, const Plane& plane, double side,
                          std::vector<Vec3>& result_m) {
    result_m.clear();
    for (const Vec3& point_m : points_m) {
      if (side * signed_distance_m(plane, point_m) > in_plane_guard_m) result_m.push_back(point_m);
    }
  }
  static std::span<const Vec3> part(std::span<const Vec3> points_m, std::size_t number) {
    return points_m.subspan(number * simd_lanes,
                            std::min<std::size_t>(simd_lanes, points_m.size() - number * simd_lanes));
  }
  Sight sight_;
  std::array<SeenLayer, 2> layers_;
  std::vector<Vec3> points_m_;
  std::vector<Vec3> extreme_m_;  ///< those that are not between others
  Vec3 origin_m_{0.0};
  double radius_m_ = 0.0;
  mutable std::vector<Vec3> scratch_m_;
};

}  // namespace dcem
