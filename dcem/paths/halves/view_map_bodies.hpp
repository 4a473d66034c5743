#pragma once
/// Bodies of view_map.hpp: how a view is emptied, and what surfaces fill in it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
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
  pool.for_each(static_cast<std::size_t>(faces()), [&](std::size_t face, unsigned) { empty(static_cast<int>(face)); });
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
  const int block = sheets_[0].block_pixels(), blocks = pixels_ / block;
  int taken = -1;  // the last face whose sheets this is one of
  cover_with(corners_m, plane, on, 0.0, [&](int face, const detail::FaceOutline& outline, const Nearness& all) {
    detail::SheetLayers& sheets = sheets_[static_cast<std::size_t>(face)];
    if (face != taken) {
      sheets.take(sheet.normal, signed_distance_m(sheet, from_m_), farthest_m + around_m,
                  static_cast<std::size_t>(blocks * blocks));
      taken = face;
    }
    const Nearness of_blocks{all.by_column * block, all.by_row * block, all.at_origin};
    const auto fill = [&](int row, int begin, int end, const auto& least) {
      for (int column = begin; column < end; ++column) {
        const float here = least.base + least.step * static_cast<float>(column);
        const std::array<int, 2> first{block * row, block * column};
        if (!is_nearer(face, first, block, here)) continue;
        bring_nearer(face, first, block, sheets.add(static_cast<std::size_t>(row * blocks + column), here));
      }
    };
    detail::PixelBox box = detail::for_each_run(blocks, outline, of_blocks, fill);
    if (box.empty()) return;
    box = {block * box.first_row, block * box.last_row + block - 1, block * box.first_column,
           block * box.last_column + block - 1};
    detail::age_tiles(view_of(face), box);
  });
}

/// Whether something is nearer than what fills some pixel of a block.
DCEM_INLINE bool ViewMap::is_nearer(int face, const std::array<int, 2>& first, int block, float nearness) const {
  for (int line = first[0]; line < first[0] + block; ++line) {
    const float* const pixels = row(face, line) + first[1];
    if (std::any_of(pixels, pixels + block, [&](float pixel) { return nearness > pixel; })) return true;
  }
  return false;
}

DCEM_INLINE void ViewMap::bring_nearer(int face, const std::array<int, 2>& first, int block, float nearness) {
  for (int line = first[0]; line < first[0] + block; ++line) {
    float* const pixels = pixels_of(face) + static_cast<std::ptrdiff_t>(line) * pixels_ + first[1];
    for (int at = 0; at < block; ++at) pixels[at] = std::max(pixels[at], nearness);
  }
}

DCEM_INLINE void ViewMap::cover_between(const JoinedOutline& one, const JoinedOutline& other, const FaceSpan& on) {
  constexpr double upright = 0.01;
  if (std::abs(one.plane.normal.z) > upright || std::abs(other.plane.normal.z) > upright) return;
  const detail::PointsAround points(from_m_, offsets_m_);
  detail::InsetOutline both;
  const double three_pixels = 6.0 / pixels_;
  const std::optional<detail::SlitFrame> slit = detail::SlitFrame::of(one, points, three_pixels);
  if (!slit || !slit_around(one, other, points, *slit, three_pixels, both) || opens(one, other, points)) return;
  if (is_closed_between(one, other, points, *slit) || !is_over_upright_face(both.corners(), on)) return;
  if (!keep_inside(one, other, points, both)) return;
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
  if (detail::is_narrower(corners_m, plane, from_m_, offsets_m_)) return;
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
