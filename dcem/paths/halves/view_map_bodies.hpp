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
  cover_with(corners_m, plane, on, stray_m, [&](int face, std::size_t row, int begin, int end, float base, float step) {
    float* const pixel = pixels_of(face) + row;
    for (int column = begin; column < end; ++column) {
      const float here = base + step * static_cast<float>(column);
      pixel[column] = pixel[column] < here ? here : pixel[column];
    }
  });
}

DCEM_INLINE void ViewMap::cover_sheet(std::span<const Vec3> corners_m, const Plane& plane, const Plane& sheet,
                                      const FaceSpan& on) {
  double around_m = 0.0, farthest_m = 0.0;
  for (const Vec3& offset_m : offsets_m_) around_m = std::max(around_m, glm::length(offset_m));
  for (const Vec3& corner_m : corners_m) farthest_m = std::max(farthest_m, glm::distance(corner_m, from_m_));
  const auto pixels = static_cast<std::size_t>(pixels_ * pixels_);
  int taken = -1;  // the last face whose sheets this is one of
  cover_with(corners_m, plane, on, 0.0, [&](int face, std::size_t row, int begin, int end, float base, float step) {
    detail::SheetLayers& sheets = sheets_[static_cast<std::size_t>(face)];
    if (face != taken) {
      sheets.take(sheet.normal, signed_distance_m(sheet, from_m_), farthest_m + around_m, pixels);
      taken = face;
    }
    float* const nearness = pixels_of(face);
    for (int column = begin; column < end; ++column) {
      const std::size_t pixel = row + static_cast<std::size_t>(column);
      const float here = base + step * static_cast<float>(column);
      if (here > nearness[pixel]) nearness[pixel] = std::max(nearness[pixel], sheets.add(pixel, here));
    }
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
    const Nearness beyond = nearness_of(face, other.plane.normal, other_m);
    const auto fill = [&](int, std::size_t row, int begin, int end, float base, float step) {
      const RowNearness second = least_in_row(beyond, static_cast<int>(row) / pixels_);
      float* const pixel = pixels_of(face) + row;
      for (int column = begin; column < end; ++column) {
        const float here = base + step * static_cast<float>(column);
        const float there = second.base + second.step * static_cast<float>(column);
        const float farther = here < there ? here : there;
        pixel[column] = pixel[column] < farther ? farther : pixel[column];
      }
    };
    cover_on(face, outline, nearness_of(face, one.plane.normal, one_m), fill);
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
      cover_on(face, outline, nearness_of(face, plane.normal, distance_m), fill);
    }
  }
}

inline ViewMap::RowNearness ViewMap::least_in_row(const Nearness& nearness, int number) const {
  const double pad = 0.5 * (std::abs(nearness.by_column) + std::abs(nearness.by_row)) + slack_of(nearness, pixels_);
  const double middle = nearness.by_row * (number + 0.5) + nearness.at_origin + 0.5 * nearness.by_column;
  return {static_cast<float>((middle - pad) * (1.0 - rounding)),
          static_cast<float>(nearness.by_column * (1.0 - rounding))};
}

template <typename Fill>
void ViewMap::cover_on(int face, const detail::FaceOutline& outline, const Nearness& nearness, Fill&& fill) {
  detail::FaceRows rows;
  if (!rows.take(outline, pixels_)) return;
  if (rows.high()[0] - rows.low()[0] < 1.0 || rows.high()[1] - rows.low()[1] < 1.0) return;  // it fills no pixel
  rows.find_crossed();
  constexpr float hair = 2e-3F;  // of a pixel
  int first_column = pixels_, last_column = -1;
  for (int number = rows.first(); number <= rows.last(); ++number) {
    if (rows.to(number) < -1e8F || rows.to(number + 1) < -1e8F) continue;
    const float from = std::max(rows.from(number), rows.from(number + 1)) + hair;
    const float to = std::min(rows.to(number), rows.to(number + 1)) - hair;
    const int begin = std::max(0, static_cast<int>(std::ceil(from)));
    const int end = std::min(pixels_, static_cast<int>(std::floor(to)));
    if (begin >= end) continue;
    const RowNearness least = least_in_row(nearness, number);
    fill(face, static_cast<std::size_t>(number * pixels_), begin, end, least.base, least.step);
    first_column = std::min(first_column, begin);
    last_column = std::max(last_column, end - 1);
  }
  if (last_column >= first_column) age_tiles(face, rows.first(), rows.last(), first_column, last_column);
}

DCEM_INLINE void ViewMap::age_tiles(int face, int first_row, int last_row, int first_column, int last_column) {
  for (int tile_row = first_row / tile_pixels; tile_row <= last_row / tile_pixels; ++tile_row) {
    char* const tile = tile_is_old_.data() + (face * tiles_ + tile_row) * tiles_;
    std::fill(tile + first_column / tile_pixels, tile + last_column / tile_pixels + 1, char{1});
  }
}

DCEM_INLINE void ViewMap::renew_tile(int face, int tile_row, int column) const {
  std::array<float, tile_pixels> least;
  least.fill(std::numeric_limits<float>::infinity());
  for (int line = 0; line < tile_pixels; ++line) {
    const float* const pixel = row(face, tile_row * tile_pixels + line) + column * tile_pixels;
    for (std::size_t at = 0; at < tile_pixels; ++at) least[at] = pixel[at] < least[at] ? pixel[at] : least[at];
  }
  const auto tile = static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column);
  tile_nearness_[tile] = *std::min_element(least.begin(), least.end());
  tile_is_old_[tile] = 0;
}

DCEM_INLINE void ViewMap::settle(const FaceSpan& on) {
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    for (int tile_row = 0; tile_row < tiles_; ++tile_row) {
      for (int column = 0; column < tiles_; ++column) {
        if (tile_is_old_[static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column)] == 0) continue;
        renew_tile(face, tile_row, column);
      }
    }
  }
}

}  // namespace dcem
