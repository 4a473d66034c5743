#pragma once
/// From a sequence of mirrors to an exact path: the image method, in double.
///
/// Every plane mirror is an isometry. With R_0 the receiver and R_i its image after the mirrors 1…i, counted from the
/// receiver, a path over k mirrors is as long as the straight segment from the transmitter to R_k. Folding it back: the
/// first point after the transmitter is where that segment meets mirror k; the next is where the segment from there to
/// R_(k−1) meets mirror k−1; and so on down to the receiver.
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/geometry/plane.hpp"

namespace dcem {

/// Appends the image of `images.back()` in `plane`.
inline void append_image(std::vector<Vec3>& images_m, const Plane& plane) {
  images_m.push_back(mirrored(plane, images_m.back()));
}

/// Reflection points from the transmitter to the receiver, into `points_m`. False where a leg does not pass from one
/// side of its mirror's plane to the image on the other: there is no such path on the planes, let alone on the facets.
///
/// `planes` and `images_m` count from the receiver; images_m[0] is the receiver, images_m[i] its image after mirror i.
/// `Planes` is a callable: index (0-based, from the receiver) to `const Plane&`.
template <typename Planes>
bool reflection_points(const Vec3& transmitter_m, const std::vector<Vec3>& images_m, std::size_t order, Planes&& planes,
                       std::vector<Vec3>& points_m) {
  points_m.clear();
  Vec3 from_m = transmitter_m;
  for (std::size_t mirror = order; mirror-- > 0;) {
    const Plane& plane = planes(mirror);
    const Vec3& image_m = images_m[mirror + 1];
    const double from_distance_m = signed_distance_m(plane, from_m);
    const double image_distance_m = signed_distance_m(plane, image_m);
    if (!(std::abs(from_distance_m) > in_plane_guard_m) || !(std::abs(image_distance_m) > in_plane_guard_m))
      return false;
    if ((from_distance_m > 0.0) == (image_distance_m > 0.0)) return false;
    from_m += from_distance_m / (from_distance_m - image_distance_m) * (image_m - from_m);
    points_m.push_back(from_m);
  }
  return true;
}

}  // namespace dcem
