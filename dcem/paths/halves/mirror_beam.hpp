#pragma once
/// What an image sees through its mirror, or images side by side do: what is beyond the mirror, inside the cone over
/// its outline.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/hull_sides.hpp"
#include "dcem/paths/halves/inset.hpp"

namespace dcem {

class MirrorBeam {
 public:
  /// By how much it is wider than its window: points beside a facet are left to the solver.
  static constexpr double room_m = 5e-3;

  /// Through the `window_m` of a mirror, from an image that is not in its plane. `lift_m`: how far from the mirror
  /// something counts as lying along it.
  MirrorBeam(FacetId mirror, const Plane& plane, const Vec3& image_m, std::span<const Vec3> window_m, double lift_m)
      : mirror_(mirror), hides_beyond_m_(room_m + 2.0 * lift_m) {
    const Vec3 beyond = signed_distance_m(plane, image_m) > 0.0 ? -plane.normal : plane.normal;
    sides_.push_back({beyond, glm::dot(beyond, plane.point_m) - room_m});
    const bool is_close = std::abs(signed_distance_m(plane, image_m)) < 20.0 * room_m;
    if (!is_close) inwards_.push_back(beyond);
    for_each_cone_side(image_m, window_m, [&](const Vec3& normal) {
      sides_.push_back({normal, glm::dot(normal, image_m) - room_m});
      if (!is_close) inwards_.push_back(normal);
    });
  }

  /// Through a mirror of the given `outline`, from several images on one side of it.
  MirrorBeam(FacetId mirror, const Plane& plane, std::span<const HullSide> outline, std::span<const Vec3> images_m,
             double lift_m)
      : mirror_(mirror), hides_beyond_m_(room_m + 2.0 * lift_m) {
    const Vec3 beyond = signed_distance_m(plane, images_m[0]) > 0.0 ? -plane.normal : plane.normal;
    sides_.push_back({beyond, glm::dot(beyond, plane.point_m) - room_m});
    const bool is_close = std::any_of(images_m.begin(), images_m.end(), [&](const Vec3& image_m) {
      return std::abs(signed_distance_m(plane, image_m)) < 20.0 * room_m;
    });
    if (!is_close) inwards_.push_back(beyond);
    for_each_common_side(outline, plane, beyond, images_m, [&](const Vec3& normal, double offset_m) {
      const double length = glm::length(normal);
      sides_.push_back({normal / length, offset_m / length - room_m});
      if (!is_close) inwards_.push_back(sides_.back().normal);
    });
  }

  FacetId mirror() const { return mirror_; }
  /// Normals of planes that are no farther than `room_m` outside the image, all of the beam inside: none where the
  /// image is so close to the mirror that this says little.
  std::span<const Vec3> inwards() const { return inwards_; }

  /// Whether a box is clearly outside.
  bool is_beside(const Aabb<double>& box) const {
    const Vec3 centre = box.center(), half = 0.5 * box.extent();
    return std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
      return glm::dot(side.normal, centre) + glm::dot(glm::abs(side.normal), half) < side.offset_m;
    });
  }
  /// Cuts an outline down to what is inside; false where nothing is left, or where it has too many corners to say.
  bool cut(detail::InsetOutline& outline) const {
    return std::all_of(sides_.begin(), sides_.end(),
                       [&](const Side& side) { return outline.keep(side.normal, side.offset_m); });
  }
  /// Cuts an outline down to what is so far beyond the mirror that it hides what is behind it: a leg ignores what lies
  /// along its mirror.
  bool cut_to_occluder(detail::InsetOutline& outline) const {
    return outline.keep(sides_[0].normal, sides_[0].offset_m + hides_beyond_m_);
  }
  /// Whether all of an outline is so far beyond the mirror, and `more_m`.
  bool is_occluder(std::span<const Vec3> corners_m, double more_m) const {
    const double least_m = sides_[0].offset_m + hides_beyond_m_ + more_m;
    return std::all_of(corners_m.begin(), corners_m.end(),
                       [&](const Vec3& corner_m) { return glm::dot(sides_[0].normal, corner_m) >= least_m; });
  }

 private:
  /// normal·x ≥ offset inside.
  struct Side {
    Vec3 normal;
    double offset_m;
  };

  FacetId mirror_;
  std::vector<Side> sides_;  ///< beyond the mirror comes first
  std::vector<Vec3> inwards_;
  double hides_beyond_m_;  ///< from the first side
};

}  // namespace dcem
