#pragma once
/// The images of a crowd's points in a mirror, and in two: where they are, and what those in two may see.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/crowd_beams.hpp"
#include "dcem/paths/halves/crowd_gates.hpp"

namespace dcem {

/// The images of all points in a mirror, and the lanes of those that are on the side of it that is looked at.
struct PackImages {
  static constexpr std::size_t most = Crowd::most_points / simd_lanes;

  std::array<LanePoints, most> packs;
  std::array<std::uint32_t, most> lanes;
};

/// Holds scratch memory: one per thread. Gates and beams must stay.
template <typename Index>
class CrowdImages {
 public:
  CrowdImages(const CrowdGates<Index>& gates, const CrowdBeams& beams)
      : gates_(gates), beams_(beams), scene_(gates.scene()), lanes_(gates.lanes()) {}

  /// Works out the images in all mirrors of the crowd.
  void lay_out() {
    images_.clear();
    for (const CrowdMirror& mirror : beams_.mirrors()) {
      const LanePoints none(Vec3(0.0));
      PackImages images{{none, none}, {}};
      for (std::size_t pack = 0; pack < pack_count(); ++pack) {
        images.packs[pack] = gates_.crowd().images(pack, scene_.facet(mirror.facet).plane);
        images.lanes[pack] = gates_.lanes_beside(pack, mirror.facet, mirror.side);
      }
      images_.push_back(images);
    }
  }

  /// The images in a mirror, by its place among the crowd's.
  const PackImages& in(std::uint32_t place) const { return images_[place]; }

  /// Works out what the images in two mirrors may see, of the points whose first image is on one side of the second
  /// mirror; false where there are none.
  bool look_over(std::uint32_t place, FacetId middle, double side) {
    const CrowdMirror& mirror = beams_.mirrors()[place];
    const Plane& plane = scene_.facet(middle).plane;
    beside_m_.clear();
    for (const Vec3& image_m : mirror.images_m) {
      if (side * signed_distance_m(plane, image_m) > in_plane_guard_m) beside_m_.push_back(image_m);
    }
    if (beside_m_.empty()) return false;
    twice_ = mirrored(plane, mirror.middle_m + lanes_.origin_m()) - lanes_.origin_m();
    common_cone_over_two(gates_.outlines().sides(middle), plane, side, beside_m_, mirror.cone, lanes_.origin_m(),
                         glm::length(twice_) + lanes_.reach_m(), cone_);
    twice_error_m_ = gates_.error_with(2.0 * glm::length(twice_) + lanes_.reach_m());
    for (std::size_t pack = 0; pack < pack_count(); ++pack) {
      const LanePoints& images = images_[place].packs[pack];
      twice_images_.packs[pack] = mirrored_in(lanes_.plane(middle), images);
      twice_images_.lanes[pack] = gates_.lanes_beside(images, images_[place].lanes[pack], middle, side, twice_error_m_);
    }
    return true;
  }
  /// Of the two mirrors that were looked over last: the images, how far they may be off, that of the crowd's middle,
  /// and what they may see.
  const PackImages& in_two() const { return twice_images_; }
  float error_m() const { return twice_error_m_; }
  const Vec3& middle_m() const { return twice_; }
  std::span<const HalfSpace> cone() const { return cone_; }

 private:
  std::size_t pack_count() const { return gates_.packs().size(); }
  static LanePoints mirrored_in(const HalfSpace& plane, const LanePoints& points) {
    const Float8 twice = Float8(2.0F) * (dot(points, plane.x, plane.y, plane.z) - plane.offset);
    return {points.x - twice * plane.x, points.y - twice * plane.y, points.z - twice * plane.z};
  }

  const CrowdGates<Index>& gates_;
  const CrowdBeams& beams_;
  const Scene& scene_;
  const LaneScene& lanes_;
  std::vector<PackImages> images_;  ///< by the place of the mirror
  std::vector<HalfSpace> cone_;
  std::vector<Vec3> beside_m_;
  Vec3 twice_{0.0};
  float twice_error_m_ = 0.0F;
  PackImages twice_images_{{LanePoints(Vec3(0.0)), LanePoints(Vec3(0.0))}, {}};
};

}  // namespace dcem
