#pragma once
/// Bodies of view_map.hpp: how a view is emptied, and what surfaces fill in it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/view_map.hpp"

namespace dcem {

DCEM_INLINE void ViewMap::look_from(const Vec3& point_m, ThreadPool& pool) {
  from_m_ = point_m;
  offsets_m_.clear();
  faces_ = {};
  make_room(cube_pixels_);
  pool.for_each(static_cast<std::size_t>(faces()), [&](std::size_t face, unsigned) {
    std::fill_n(pixels_of(static_cast<int>(face)), pixels_ * pixels_, 0.0F);
  });
}

DCEM_INLINE void ViewMap::cover(std::span<const Vec3> corners_m, const Plane& plane, const FaceSpan& on,
                                double stray_m) {
  cover_with(corners_m, plane, on, stray_m,
             [&](int face, const detail::FaceOutline& outline, const Nearness& nearness) {
               detail::view_kernels().cover(view_of(face), pixels_of(face), outline, nearness);
             });
}

DCEM_INLINE void ViewMap::cover_sheet(std::span<const Vec3> corners_m, const Plane& plane, const Plane& sheet,
                                      const FaceSpan& on) {
  double around_m = 0.0, farthest_m = 0.0;
  for (const Vec3& offset_m : offsets_m_) around_m = std::max(around_m, glm::length(offset_m));
  for (const Vec3& corner_m : corners_m) farthest_m = std::max(farthest_m, glm::distance(corner_m, from_m_));
  const auto pixels = static_cast<std::size_t>(pixels_ * pixels_);
  int taken = -1;  // the last face whose sheets this is one of
  cover_with(corners_m, plane, on, 0.0, [&](int face, const detail::FaceOutline& outline, const Nearness& all) {
    detail::SheetLayers& sheets = sheets_[static_cast<std::size_t>(face)];
    if (face != taken) {
      sheets.take(sheet.normal, signed_distance_m(sheet, from_m_), farthest_m + around_m, pixels);
      taken = face;
    }
    float* const nearness = pixels_of(face);
    detail::for_each_filled(view_of(face), outline, all, [&](int row, int begin, int end, const auto& least) {
      for (int column = begin; column < end; ++column) {
        const auto pixel = static_cast<std::size_t>(row * pixels_ + column);
        const float here = least.base + least.step * static_cast<float>(column);
        if (here > nearness[pixel]) nearness[pixel] = std::max(nearness[pixel], sheets.add(pixel, here));
      }
    });
  });
}

DCEM_INLINE void ViewMap::cover_between(const JoinedOutline& one, const JoinedOutline& other, const FaceSpan& on) {
  constexpr double upright = 0.01;
  if (std::abs(one.plane.normal.z) > upright || std::abs(other.plane.normal.z) > upright) return;
  const detail::PointsAround points(from_m_, offsets_m_);
  detail::InsetOutline both;
  const double three_pixels = 6.0 / pixels_;
  if (!slit_around(one, other, points, three_pixels, both) || !is_over_upright_face(both.corners(), on)) return;
  if (opens(one, other, points) || !keep_inside(one, other, points, both)) return;
  const double away_m = least_away_m(one, other, from_m_, both);
  const double one_m = -signed_distance_m(one.plane, from_m_), other_m = -signed_distance_m(other.plane, from_m_);
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    detail::FaceOutline outline;
    if (!points.are_level_before(away_m, faces_.steepness(face))) continue;
    if (!outline_on(face, both.corners(), 1.02, outline) || outline.size() < 3) continue;
    detail::view_kernels().cover_both(view_of(face), pixels_of(face), outline,
                                      nearness_of(face, one.plane.normal, one_m),
                                      nearness_of(face, other.plane.normal, other_m));
  }
}

/// Whether some of a polygon is seen on a face on which not all may be too steep.
DCEM_INLINE bool ViewMap::is_over_upright_face(std::span<const Vec3> corners_m, const FaceSpan& on) const {
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    detail::FaceOutline outline;
    if (faces_.steepness(face) < WatertightRay::steepest && outline_on(face, corners_m, 1.02, outline)) return true;
  }
  return false;
}

template <typename Fill>
void ViewMap::cover_with(std::span<const Vec3> corners_m, const Plane& plane, const FaceSpan& on, double stray_m,
                         Fill&& fill) {
  const double distance_m = -signed_distance_m(plane, from_m_);
  if (corners_m.size() > detail::FaceOutline::most_corners || distance_m == 0.0) return;
  if (offsets_m_.empty() && stray_m == 0.0) return cover_as_it_is(corners_m, plane, distance_m, on, fill);
  detail::MovedSides sides;
  detail::InsetOutline smaller;
  if (!sides_moved_in(corners_m, plane, from_m_, offsets_m_, sides, stray_m)) return;
  if (!inset_outline(corners_m, from_m_, sides.all(), smaller)) return;
  if (smaller.count > detail::FaceOutline::most_corners) return;
  cover_as_it_is(smaller.corners(), plane, distance_m, on, fill);
}

template <typename Fill>
void ViewMap::cover_as_it_is(std::span<const Vec3> corners_m, const Plane& plane, double distance_m, const FaceSpan& on,
                             Fill&& fill) {
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    detail::FaceOutline outline;
    // Over the rim, so that pixels at the rim are filled, too.
    if (outline_on(face, corners_m, 1.02, outline) && outline.size() >= 3) {
      fill(face, outline, nearness_of(face, plane.normal, distance_m));
    }
  }
}

DCEM_INLINE void ViewMap::settle(const FaceSpan& on) {
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    for (int tile_row = 0; tile_row < tiles_; ++tile_row) {
      for (int column = 0; column < tiles_; ++column) {
        if (tile_is_old_[static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column)] == 0) continue;
        detail::renew_tile(view_of(face), tile_row, column);
      }
    }
  }
}

}  // namespace dcem
