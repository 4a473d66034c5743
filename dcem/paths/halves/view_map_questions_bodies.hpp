#pragma once
/// Bodies of view_map.hpp: what is asked of a view.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/view_map.hpp"

namespace dcem {

DCEM_INLINE bool ViewMap::shows(std::span<const Vec3> corners_m, const Plane& plane, double nearer,
                                const FaceSpan& on) const {
  const double distance_m = -signed_distance_m(plane, from_m_);
  const bool says_nothing = std::abs(distance_m) < 1e-6 || nearer >= always_seen;
  if (says_nothing || corners_m.size() > detail::FaceOutline::most_corners) return true;
  if (std::ranges::any_of(corners_m, [&](const Vec3& corner_m) { return is_below_all_hidden(corner_m); })) return true;
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    detail::FaceOutline outline;
    if (outline_on(face, corners_m, 1.0 + 1e-6, outline) &&
        detail::view_kernels().shows(view_of(face), outline, nearness_of(face, plane.normal, distance_m), nearer)) {
      return true;
    }
  }
  return false;
}

DCEM_INLINE bool ViewMap::shows(const Vec3& from_m, const Vec3& to_m, double nearer) const {
  if (is_below_all_hidden(from_m) || is_below_all_hidden(to_m)) return true;
  const std::array<Vec3, 2> ends_m{from_m, to_m};
  for (int face = 0; face < faces_.count(); ++face) {
    detail::FaceOutline line;
    if (!outline_on(face, ends_m, 1.0 + 1e-6, line)) continue;
    const detail::FacePoint &first = line[0], &last = line[line.size() > 1 ? 1 : 0];
    const double near = std::min(first.depth, last.depth), far = std::max(first.depth, last.depth);
    if (near < 1e-3) return true;
    // A piece is taken to be as near as its nearer end.
    const int pieces = 1 + static_cast<int>(std::min(15.0, 8.0 * (far / near - 1.0)));
    const auto at = [&](int number) -> detail::FacePoint {
      const double share = static_cast<double>(number) / pieces;
      return {first.across + share * (last.across - first.across), first.along + share * (last.along - first.along),
              first.depth + share * (last.depth - first.depth)};
    };
    for (int piece = 0; piece < pieces; ++piece) {
      detail::FaceOutline part;
      part.add(at(piece));
      part.add(at(piece + 1));
      const double nearest = 1.0 / std::min(part[0].depth, part[1].depth);
      if (detail::view_kernels().shows(view_of(face), part, {0.0, 0.0, nearest}, nearer)) return true;
    }
  }
  return false;
}

DCEM_INLINE std::optional<ViewMap::PointPixels> ViewMap::pixels_of_point(const Vec3& point_m, double nearer,
                                                                         const Vec3& beside_m) const {
  const Vec3 offset_m = point_m - from_m_, size = glm::abs(offset_m);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const double depth = size[axis];
  const double nearer_m = beside_m[axis], least_depth_m = depth - nearer_m;
  if (depth < 1e-3 || least_depth_m < 0.5 * depth || point_m.z - beside_m.z < least_height_m_) return std::nullopt;
  // On the face, x/d moves to (x + Δx)/(d + Δd), by (Δx − Δd x/d)/(d + Δd). Close to a rim of it the map says nothing.
  const auto blur = [&](int at, double place) {
    return (1.0 + 1e-6) * (beside_m[at] + std::abs(place) * nearer_m) / least_depth_m;
  };
  const int right = (axis + 1) % 3, up = (axis + 2) % 3;
  const double across = offset_m[right] / depth, along = offset_m[up] / depth;
  const double aside = blur(right, across), above = blur(up, along);
  const bool is_vague = aside > 0.0 || above > 0.0;
  if (is_vague && std::max(std::abs(across) + aside, std::abs(along) + above) >= 1.0) return std::nullopt;
  const auto pixel = [&](double place) {
    return std::clamp(static_cast<int>((place + 1.0) * 0.5 * pixels_), 0, pixels_ - 1);
  };
  const int face = 2 * axis + (offset_m[axis] < 0.0 ? 1 : 0);
  const auto nearness = static_cast<float>(nearer * (1.0 + detail::nearness_rounding) / least_depth_m);
  return PointPixels{
      {pixel(along - above), pixel(along + above)}, {pixel(across - aside), pixel(across + aside)}, face, nearness};
}

DCEM_INLINE bool ViewMap::hides(const PointPixels& of) const {
  const bool is_small = of.rows.last - of.rows.first < tile_pixels && of.columns.last - of.columns.first < tile_pixels;
  return is_small ? pixels_hide(of.face, of.rows, of.columns, of.nearness)
                  : tiles_hide(of.face, of.rows, of.columns, of.nearness);
}

DCEM_INLINE bool ViewMap::pixels_hide(int face, const PixelRange& rows, const PixelRange& columns,
                                      float nearness) const {
  for (int number = rows.first; number <= rows.last; ++number) {
    const float* const pixels = row(face, number);
    for (int column = columns.first; column <= columns.last; ++column) {
      if (nearness > pixels[column]) return false;
    }
  }
  return true;
}

/// The same, tile by tile. Tiles are not renewed for it: several threads may ask.
DCEM_INLINE bool ViewMap::tiles_hide(int face, const PixelRange& rows, const PixelRange& columns,
                                     float nearness) const {
  const auto within = [](const PixelRange& all, int tile) {
    return PixelRange{std::max(all.first, tile * tile_pixels),
                      std::min(all.last, tile * tile_pixels + tile_pixels - 1)};
  };
  for (int tile_row = rows.first / tile_pixels; tile_row <= rows.last / tile_pixels; ++tile_row) {
    for (int column = columns.first / tile_pixels; column <= columns.last / tile_pixels; ++column) {
      const auto tile = static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column);
      if (nearness <= tile_nearness_[tile]) continue;
      if (!pixels_hide(face, within(rows, tile_row), within(columns, column), nearness)) return false;
    }
  }
  return true;
}

DCEM_INLINE bool ViewMap::hides(const Aabb<double>& box, double nearer, const FaceSpan& on) const {
  if (is_below_all_hidden(box.min)) return false;
  const Vec3 low_m = box.min - from_m_, high_m = box.max - from_m_;
  const bool inside = low_m.x <= 0 && low_m.y <= 0 && low_m.z <= 0 && high_m.x >= 0 && high_m.y >= 0 && high_m.z >= 0;
  if (inside) return false;
  const FaceSpan faces = faces_.in(on);
  for (int face = faces.first; face < faces.last; ++face) {
    const auto [low, high] = faces_.box(face, {low_m, high_m});
    if (is_beside(low, high)) continue;
    if (!detail::view_kernels().hides_box(view_of(face), low, high, nearer)) return false;
  }
  return true;
}

}  // namespace dcem
