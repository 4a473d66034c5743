#pragma once
/// What is hidden from a point, or from several points close to each other, for sure: a map of surfaces that fill whole
/// pixels, on the faces of a cube or on one that looks through a window.
///
/// Each pixel holds the depth of a surface that is known to fill the pixel by itself. Something is hidden where all
/// pixels that it touches are filled by surfaces that are nearer. The map errs on one side alone: what it calls hidden
/// cannot be seen from the point; what it shows may be hidden nevertheless.
/// Source: conservative rasterization as in Hasselgren, Akenine-Möller and Ohlsson, GPU Gems 2, chapter 42, 2005.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/face_outline.hpp"
#include "dcem/paths/halves/inset.hpp"
#include "dcem/paths/halves/view_frame.hpp"

namespace dcem {

class ViewMap {
 public:
  /// What is nearer by this factor is never hidden.
  static constexpr double always_seen = 1e30;

  /// So many pixels along each side of the six faces: a multiple of 8, at most 1024.
  explicit ViewMap(int pixels) : cube_pixels_(pixels) {
    clear(pixels);
    DCEM_ASSERT(pixels > 0 && pixels % tile_pixels == 0 && pixels <= detail::FaceRows::most_pixels);
  }

  /// Empties the map, which from now on is that of another point. With `offsets_m` it is that of all points
  /// `point_m + offsets_m[i]`, too, seen from `point_m`: outlines hide only what they hide from all of them.
  void look_from(const Vec3& point_m, std::span<const Vec3> offsets_m = {}) {
    from_m_ = point_m;
    offsets_m_.assign(offsets_m.begin(), offsets_m.end());
    faces_ = {};
    clear(cube_pixels_);
  }
  /// The same of points that look through a convex window, and `room_m` around it: there is nothing else to be seen.
  /// `inwards`: the normals of planes by the point which all of it is inside.
  void look_through(const Vec3& point_m, std::span<const Vec3> window_m, double room_m, std::span<const Vec3> inwards,
                    std::span<const Vec3> offsets_m = {}) {
    from_m_ = point_m;
    offsets_m_.assign(offsets_m.begin(), offsets_m.end());
    const int pixels = offsets_m_.empty() ? window_pixels : crowd_window_pixels;
    const auto frame = detail::frame_of_window(point_m, {window_m, room_m, least_pixel_m, pixels, offsets_m_});
    faces_ = frame ? detail::ViewFaces(*frame) : detail::ViewFaces(inwards);
    clear(frame ? pixels : cube_pixels_);
  }
  const Vec3& from_m() const { return from_m_; }

  /// Notes a convex polygon, corners in order around it, that nothing passes.
  void cover(std::span<const Vec3> corners_m, const Plane& plane);

  /// Whether a convex polygon, its distance divided by `nearer` ≥ 1, may be seen.
  bool shows(std::span<const Vec3> corners_m, const Plane& plane, double nearer);
  /// Whether a straight line, its distance divided by `nearer` ≥ 1, may be seen.
  bool shows(const Vec3& from_m, const Vec3& to_m, double nearer);
  /// Whether a point that is known to within `beside_m`, its distance divided by `nearer` ≥ 1, is hidden for sure.
  bool hides(const Vec3& point_m, double nearer, double beside_m = 0.0) const;
  /// Whether all of a box is hidden for sure, and would be `margin_m` nearer.
  bool hides(const Aabb<double>& box, double margin_m) const;

 private:
  static constexpr int tile_pixels = 8;
  /// Through a window, of a pixel where the window is: what strays by 2 µm strays by less than the margin of a pixel.
  static constexpr double least_pixel_m = 1e-3;
  static constexpr int window_pixels = 32;  ///< by measurement: with more of them views take longer than they save
  static constexpr int crowd_window_pixels = 64;  ///< of several points, which see more through it
  static constexpr double rounding = 1e-5;  ///< relative, of nearness in single precision: 80 units of the last place

  /// 1/depth of a plane over a face: by_column·x + by_row·y + at_origin, in pixels.
  struct Nearness {
    double by_column, by_row, at_origin;
  };

  void clear(int pixels) {
    pixels_ = pixels;
    tiles_ = pixels / tile_pixels;
    nearness_.assign(static_cast<std::size_t>(faces_.count() * pixels * pixels), 0.0F);
    tile_nearness_.assign(static_cast<std::size_t>(faces_.count() * tiles_ * tiles_), 0.0F);
  }
  Nearness nearness_of(int face, const Vec3& normal, double distance_m) const {
    const detail::FacePoint turned = faces_.normal(face, normal);
    const double per_pixel = 2.0 / pixels_;
    return {turned.across / distance_m * per_pixel, turned.along / distance_m * per_pixel,
            (turned.depth - turned.across - turned.along) / distance_m};
  }
  /// The part of a polygon on a face, which reaches a little over its rim; false where there is none.
  bool outline_on(int face, std::span<const Vec3> corners_m, double reach, detail::FaceOutline& outline) const {
    bool in_front = false;
    for (const Vec3& corner : corners_m) {
      outline.add(faces_.point(face, corner - from_m_));
      in_front = in_front || outline[outline.size() - 1].depth > 0.0;
    }
    if (!in_front) return false;
    outline.clip(reach);
    return outline.size() > 0;
  }
  bool shows_on(int face, const detail::FaceOutline& outline, const Nearness& nearness, double nearer);
  void cover_as_it_is(std::span<const Vec3> corners_m, const Plane& plane, double distance_m);
  void cover_on(int face, const detail::FaceOutline& outline, const Nearness& nearness);
  void renew_tiles(int face, int first_row, int last_row, int first_column, int last_column);
  bool hides_on(int face, const detail::FacePoint& low, const detail::FacePoint& high, double margin_m) const;
  /// What single precision may add to or take from a nearness that is summed over a row.
  static double slack_of(const Nearness& nearness, int pixels) {
    return 4e-7 * ((std::abs(nearness.by_column) + std::abs(nearness.by_row)) * pixels + std::abs(nearness.at_origin));
  }
  float* row(int face, int number) {
    return nearness_.data() + static_cast<std::size_t>((face * pixels_ + number) * pixels_);
  }
  const float* row(int face, int number) const {
    return nearness_.data() + static_cast<std::size_t>((face * pixels_ + number) * pixels_);
  }

  int cube_pixels_, pixels_ = 0, tiles_ = 0;
  detail::ViewFaces faces_;
  Vec3 from_m_{0.0};
  std::vector<Vec3> offsets_m_;       ///< of further points
  std::vector<float> nearness_;       ///< 1/depth of what fills the pixel; 0: nothing does
  std::vector<float> tile_nearness_;  ///< the smallest of 8 × 8 pixels
  detail::FaceRows rows_;
  std::vector<Vec3> normals_;  ///< room for sides that have been moved
};

// ---------------------------------------------------------------------------------------------------------------------

inline void ViewMap::cover(std::span<const Vec3> corners_m, const Plane& plane) {
  const double distance_m = -signed_distance_m(plane, from_m_);
  if (corners_m.size() > detail::FaceOutline::most_corners || distance_m == 0.0) return;
  if (offsets_m_.empty()) return cover_as_it_is(corners_m, plane, distance_m);
  normals_.clear();
  detail::InsetOutline smaller;
  if (!sides_moved_in(corners_m, plane, from_m_, offsets_m_, normals_)) return;
  if (!inset_outline(corners_m, from_m_, normals_, smaller)) return;
  if (smaller.count <= detail::FaceOutline::most_corners) cover_as_it_is(smaller.corners(), plane, distance_m);
}

inline void ViewMap::cover_as_it_is(std::span<const Vec3> corners_m, const Plane& plane, double distance_m) {
  for (int face = 0; face < faces_.count(); ++face) {
    detail::FaceOutline outline;
    // Over the rim, so that pixels at the rim are filled, too.
    if (outline_on(face, corners_m, 1.02, outline) && outline.size() >= 3) {
      cover_on(face, outline, nearness_of(face, plane.normal, distance_m));
    }
  }
}

inline void ViewMap::cover_on(int face, const detail::FaceOutline& outline, const Nearness& nearness) {
  if (!rows_.find(outline, pixels_)) return;
  constexpr float hair = 2e-3F;  // of a pixel
  const auto step = static_cast<float>(nearness.by_column);
  const double pad = 0.5 * (std::abs(nearness.by_column) + std::abs(nearness.by_row)) + slack_of(nearness, pixels_);
  int first_column = pixels_, last_column = -1;
  for (int number = rows_.first; number <= rows_.last; ++number) {
    const auto line = static_cast<std::size_t>(number);
    if (rows_.crossed_to[line] < -1e8F || rows_.crossed_to[line + 1] < -1e8F) continue;
    const float from = std::max(rows_.crossed_from[line], rows_.crossed_from[line + 1]) + hair;
    const float to = std::min(rows_.crossed_to[line], rows_.crossed_to[line + 1]) - hair;
    const int begin = std::max(0, static_cast<int>(std::ceil(from)));
    const int end = std::min(pixels_, static_cast<int>(std::floor(to)));
    if (begin >= end) continue;
    const auto base =
        static_cast<float>(nearness.by_row * (number + 0.5) + nearness.at_origin + 0.5 * nearness.by_column - pad);
    float* const pixel = row(face, number);
    for (int column = begin; column < end; ++column) {
      const float here = (base + step * static_cast<float>(column)) * static_cast<float>(1.0 - rounding);
      pixel[column] = pixel[column] < here ? here : pixel[column];
    }
    first_column = std::min(first_column, begin);
    last_column = std::max(last_column, end - 1);
  }
  if (last_column >= first_column) renew_tiles(face, rows_.first, rows_.last, first_column, last_column);
}

inline void ViewMap::renew_tiles(int face, int first_row, int last_row, int first_column, int last_column) {
  for (int tile_row = first_row / tile_pixels; tile_row <= last_row / tile_pixels; ++tile_row) {
    for (int column = first_column / tile_pixels; column <= last_column / tile_pixels; ++column) {
      std::array<float, tile_pixels> least;
      least.fill(std::numeric_limits<float>::infinity());
      for (int line = 0; line < tile_pixels; ++line) {
        const float* const pixel = row(face, tile_row * tile_pixels + line) + column * tile_pixels;
        for (std::size_t at = 0; at < tile_pixels; ++at) least[at] = pixel[at] < least[at] ? pixel[at] : least[at];
      }
      tile_nearness_[static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column)] =
          *std::min_element(least.begin(), least.end());
    }
  }
}

inline bool ViewMap::shows(std::span<const Vec3> corners_m, const Plane& plane, double nearer) {
  const double distance_m = -signed_distance_m(plane, from_m_);
  const bool says_nothing = std::abs(distance_m) < 1e-6 || nearer >= always_seen;
  if (says_nothing || corners_m.size() > detail::FaceOutline::most_corners) return true;
  for (int face = 0; face < faces_.count(); ++face) {
    detail::FaceOutline outline;
    if (outline_on(face, corners_m, 1.0 + 1e-6, outline) &&
        shows_on(face, outline, nearness_of(face, plane.normal, distance_m), nearer)) {
      return true;
    }
  }
  return false;
}

inline bool ViewMap::shows(const Vec3& from_m, const Vec3& to_m, double nearer) {
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
      if (shows_on(face, part, {0.0, 0.0, nearest}, nearer)) return true;
    }
  }
  return false;
}

inline bool ViewMap::shows_on(int face, const detail::FaceOutline& outline, const Nearness& nearness, double nearer) {
  if (!rows_.find(outline, pixels_)) return false;
  constexpr float hair = 1e-3F;  // of a pixel
  const auto step = static_cast<float>(nearness.by_column);
  const auto grown = static_cast<float>(nearer * (1.0 + rounding));
  const auto top = static_cast<float>(rows_.nearest);
  const double pad = 0.5 * (std::abs(nearness.by_column) + std::abs(nearness.by_row)) + slack_of(nearness, pixels_);
  for (int number = rows_.first; number <= rows_.last; ++number) {
    const auto line = static_cast<std::size_t>(number);
    const int begin = std::max(0, static_cast<int>(std::floor(rows_.touched_from[line] - hair)));
    const int end = std::min(pixels_ - 1, static_cast<int>(std::floor(rows_.touched_to[line] + hair)));
    const auto base =
        static_cast<float>(nearness.by_row * (number + 0.5) + nearness.at_origin + 0.5 * nearness.by_column + pad);
    const float* const pixel = row(face, number);
    int seen = 0;
    for (int column = begin; column <= end; ++column) {
      const float plane = base + step * static_cast<float>(column);
      seen |= static_cast<int>((plane < top ? plane : top) * grown > pixel[column]);
    }
    if (seen != 0) return true;
  }
  return false;
}

inline bool ViewMap::hides(const Vec3& point_m, double nearer, double beside_m) const {
  const Vec3 offset_m = point_m - from_m_, size = glm::abs(offset_m);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const double depth = size[axis];
  if (depth < 1e-3) return false;
  // Moved by beside_m, the point moves by less than this on the face; close to a rim of it the map says nothing.
  const double blur = 2.5 * beside_m / depth;
  if (blur > 0.5) return false;
  const double across = offset_m[(axis + 1) % 3] / depth, along = offset_m[(axis + 2) % 3] / depth;
  if (beside_m > 0.0 && std::max(std::abs(across), std::abs(along)) + blur >= 1.0) return false;
  const auto pixel = [&](double place) {
    return std::clamp(static_cast<int>((place + 1.0) * 0.5 * pixels_), 0, pixels_ - 1);
  };
  const int face = 2 * axis + (offset_m[axis] < 0.0 ? 1 : 0);
  const auto nearness = static_cast<float>(nearer * (1.0 + rounding) / (depth - beside_m));
  const int last_row = pixel(along + blur), last_column = pixel(across + blur);
  for (int number = pixel(along - blur); number <= last_row; ++number) {
    for (int column = pixel(across - blur); column <= last_column; ++column) {
      if (nearness > row(face, number)[column]) return false;
    }
  }
  return true;
}

inline bool ViewMap::hides(const Aabb<double>& box, double margin_m) const {
  const Vec3 low_m = box.min - from_m_, high_m = box.max - from_m_;
  const bool inside = low_m.x <= 0 && low_m.y <= 0 && low_m.z <= 0 && high_m.x >= 0 && high_m.y >= 0 && high_m.z >= 0;
  if (inside) return false;
  for (int face = 0; face < faces_.count(); ++face) {
    const auto [low, high] = faces_.box(face, {low_m, high_m});
    if (!hides_on(face, low, high, margin_m)) return false;
  }
  return true;
}

inline bool ViewMap::hides_on(int face, const detail::FacePoint& low, const detail::FacePoint& high,
                              double margin_m) const {
  const double far = high.depth;
  if (far <= 0.0 || low.across > far || -high.across > far || low.along > far || -high.along > far) return true;
  // No nearer than where the face's pyramid is wide enough to hold any of the box.
  const double depth = std::max({low.depth, 0.0, low.across, -high.across, low.along, -high.along});
  if (depth - margin_m < 1e-3) return false;
  const auto first = [&](double bound) {
    const double seen = bound / (bound >= 0.0 ? far : depth);
    return std::max(0, static_cast<int>(std::floor((seen + 1.0) * 0.5 * tiles_ - 1e-6)));
  };
  const auto last = [&](double bound) {
    const double seen = bound / (bound >= 0.0 ? depth : far);
    return std::min(tiles_ - 1, static_cast<int>(std::floor(std::min(seen + 1.0, 3.0) * 0.5 * tiles_ + 1e-6)));
  };
  const auto nearness = static_cast<float>((1.0 + rounding) / (depth - margin_m));
  for (int tile_row = first(low.along); tile_row <= last(high.along); ++tile_row) {
    for (int column = first(low.across); column <= last(high.across); ++column) {
      if (nearness > tile_nearness_[static_cast<std::size_t>((face * tiles_ + tile_row) * tiles_ + column)])
        return false;
    }
  }
  return true;
}

}  // namespace dcem
