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
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/core/fetch.hpp"
#include "dcem/core/raw_vector.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/extreme_points.hpp"
#include "dcem/paths/halves/face_outline.hpp"
#include "dcem/paths/halves/inset.hpp"
#include "dcem/paths/halves/joined_outlines.hpp"
#include "dcem/paths/halves/sheet_layers.hpp"
#include "dcem/paths/halves/view_frame.hpp"
#include "dcem/paths/halves/view_kernels.hpp"

namespace dcem {

class ThreadPool;

/// Surfaces are noted and asked for on all faces, or on some of them: what is said of a face depends on nothing that
/// was noted on another, and threads may work on a face each.
class ViewMap {
 public:
  using FaceSpan = detail::FaceSpan;
  /// What is nearer by this factor is never hidden.
  static constexpr double always_seen = 1e30;

  /// So many pixels along each side of the six faces: a multiple of 8, at most 1024. It looks from somewhere before it
  /// is asked anything.
  explicit ViewMap(int pixels) : cube_pixels_(pixels) {
    DCEM_ASSERT(pixels > 0 && pixels % tile_pixels == 0 && pixels <= detail::FaceRows::most_pixels);
  }

  /// Empties the map, which from now on is that of another point.
  void look_from(const Vec3& point_m) {
    from_m_ = point_m;
    offsets_m_.clear();
    faces_ = {};
    clear(cube_pixels_);
  }
  /// The same, emptied by several threads: what is several megabytes large takes longest where it has never been used.
  void look_from(const Vec3& point_m, ThreadPool& pool);
  /// From now on it is the map of all points `point_m + offsets_m[i]`, seen from `point_m`: outlines hide only what
  /// they hide from all of them. Face by face: `empty` each before anything is noted or asked about on it.
  void look_from_by_face(const Vec3& point_m, std::span<const Vec3> offsets_m) {
    from_m_ = point_m;
    take_extreme_points(offsets_m, offsets_m_);
    faces_ = {};
    make_room(cube_pixels_);
  }
  /// Nothing has been noted on a face.
  void empty(int face) {
    const std::size_t tiles = static_cast<std::size_t>(tiles_) * static_cast<std::size_t>(tiles_),
                      first = static_cast<std::size_t>(face) * tiles;
    std::fill_n(pixels_of(face), pixels_ * pixels_, 0.0F);
    std::ranges::fill(std::span(tile_nearness_).subspan(first, tiles), 0.0F);
    std::ranges::fill(std::span(tile_is_old_).subspan(first, tiles), char{0});
  }
  /// Empties the map, which is that of points that look through a convex window, and `room_m` around it: there is
  /// nothing else to be seen.
  /// `inwards`: the normals of planes by the point which all of it is inside.
  void look_through(const Vec3& point_m, std::span<const Vec3> window_m, double room_m, std::span<const Vec3> inwards,
                    std::span<const Vec3> offsets_m = {}) {
    from_m_ = point_m;
    take_extreme_points(offsets_m, offsets_m_);
    const int pixels = offsets_m_.empty() ? window_pixels : crowd_window_pixels;
    const auto frame = detail::frame_of_window(point_m, {window_m, room_m, least_pixel_m, pixels, offsets_m_});
    faces_ = frame ? detail::ViewFaces(*frame) : detail::ViewFaces(inwards);
    clear(frame ? pixels : cube_pixels_);
  }
  /// The same of points that look from the middle of a cube into a cell of one of its faces: all pixels are there, and
  /// there is nothing else to be seen.
  void look_into(const Vec3& point_m, std::span<const Vec3> cell_m, std::span<const Vec3> offsets_m = {}) {
    from_m_ = point_m;
    take_extreme_points(offsets_m, offsets_m_);
    faces_ = detail::ViewFaces(detail::frame_of_window(point_m, {cell_m, 0.0, 0.0, cube_pixels_}).value());
    clear(cube_pixels_);
  }
  /// From now on nothing below this height is hidden, until it looks from somewhere else.
  void hide_nothing_below(double height_m) { least_height_m_ = height_m; }
  const Vec3& from_m() const { return from_m_; }
  int pixels() const { return pixels_; }
  int faces() const { return faces_.count(); }
  /// How wide a pixel is at a distance of one.
  double pixel_width() const { return faces_.least_width() / pixels_; }
  /// Whether it is that of one point alone.
  bool is_of_one_point() const { return offsets_m_.empty(); }

  /// From now on a way may cross so many sheets: what is behind more of them is hidden. Parallel ones no farther apart
  /// than `pile_m` are one. Before anything is covered.
  void count_sheets(int crossed, double pile_m) {
    for (detail::SheetLayers& sheets : sheets_) sheets.count(crossed, pile_m);
  }

  /// Notes a convex polygon, corners in order around it, that nothing passes; with `stray_m` a surface over it that is
  /// nowhere farther in front of it.
  void cover(std::span<const Vec3> corners_m, const Plane& plane, const FaceSpan& on = {}, double stray_m = 0.0);
  /// Notes what two such polygons hide together, around the line on which they meet. The planes are all but vertical.
  void cover_between(const JoinedOutline& one, const JoinedOutline& other, const FaceSpan& on = {});
  /// Notes a convex polygon of a sheet with a plane of its own. Sheets that a leg might count as one are one.
  void cover_sheet(std::span<const Vec3> corners_m, const Plane& plane, const Plane& sheet, const FaceSpan& on = {});
  /// Nothing more is covered.
  void forget_sheets() { sheets_ = {}; }

  /// Whether a convex polygon, its distance divided by `nearer` ≥ 1, may be seen.
  bool shows(std::span<const Vec3> corners_m, const Plane& plane, double nearer, const FaceSpan& on = {}) const;
  /// Whether a straight line, its distance divided by `nearer` ≥ 1, may be seen.
  bool shows(const Vec3& from_m, const Vec3& to_m, double nearer) const;
  /// From the first to the last.
  struct PixelRange {
    int first, last;
  };
  /// The pixels in which a point is seen, and its nearness there.
  struct PointPixels {
    PixelRange rows, columns;
    int face;
    float nearness;
  };
  /// Those of a point that is known to within `beside_m`, axis by axis, its distance divided by `nearer` ≥ 1; none
  /// where they say nothing of it.
  std::optional<PointPixels> pixels_of_point(const Vec3& point_m, double nearer,
                                             const Vec3& beside_m = Vec3(0.0)) const;
  /// Asks for the first of them before they are looked at.
  [[gnu::always_inline]] void fetch_pixels(const PointPixels& of) const {
    fetch(row(of.face, of.rows.first)[of.columns.first]);
  }
  /// Whether what is in them is hidden for sure.
  bool hides(const PointPixels& of) const;
  bool hides(const Vec3& point_m, double nearer, const Vec3& beside_m = Vec3(0.0)) const {
    const std::optional<PointPixels> pixels = pixels_of_point(point_m, nearer, beside_m);
    return pixels && hides(*pixels);
  }
  /// Whether nothing of a box is over a face.
  bool is_beside(const Aabb<double>& box, int face) const {
    const auto [low, high] = faces_.box(face, {box.min - from_m_, box.max - from_m_});
    return is_beside(low, high);
  }
  /// Whether all of a box, its distance divided by `nearer` ≥ 1, is hidden for sure; what is beside the faces is.
  bool hides(const Aabb<double>& box, double nearer, const FaceSpan& on = {}) const;
  /// Ends drawing for now: from here on questions write nothing, and several threads may ask.
  void settle(const FaceSpan& on = {});

 private:
  static constexpr int tile_pixels = detail::FacePixels::tile_pixels;
  /// Through a window, of a pixel where the window is: what strays by 2 µm strays by less than the margin of a pixel.
  static constexpr double least_pixel_m = 1e-3;
  static constexpr int window_pixels = 32;  ///< by measurement: with more of them views take longer than they save
  static constexpr int crowd_window_pixels = 64;  ///< of several points, which see more through it
  using Nearness = detail::FaceNearness;

  void clear(int pixels) {
    make_room(pixels);
    std::fill(nearness_.begin(), nearness_.end(), 0.0F);
  }
  /// The same, but for the pixels.
  void make_room(int pixels) {
    least_height_m_ = -std::numeric_limits<double>::infinity();
    pixels_ = pixels;
    tiles_ = pixels / tile_pixels;
    nearness_.resize(static_cast<std::size_t>(faces_.count() * pixels * pixels));
    tile_nearness_.assign(static_cast<std::size_t>(faces_.count() * tiles_ * tiles_), 0.0F);
    tile_is_old_.assign(tile_nearness_.size(), 0);
    for (detail::SheetLayers& sheets : sheets_) sheets.clear();
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
  /// Of a block, so many pixels to a side from a row and a column on: whether some pixel is filled by nothing as near,
  /// and filling all of them at least so near.
  bool is_nearer(int face, const std::array<int, 2>& first, int block, float nearness) const;
  void bring_nearer(int face, const std::array<int, 2>& first, int block, float nearness);
  bool is_over_upright_face(std::span<const Vec3> corners_m, const FaceSpan& on) const;
  template <typename Fill>
  void cover_with(std::span<const Vec3> corners_m, const Plane& plane, const FaceSpan& on, double stray_m, Fill&& fill);
  template <typename Fill>
  void cover_as_it_is(std::span<const Vec3> corners_m, const Plane& plane, double distance_m, const FaceSpan& on,
                      Fill&& fill);
  bool is_below_all_hidden(const Vec3& point_m) const { return point_m.z < least_height_m_; }
  bool pixels_hide(int face, const PixelRange& rows, const PixelRange& columns, float nearness) const;
  bool tiles_hide(int face, const PixelRange& rows, const PixelRange& columns, float nearness) const;
  static bool is_beside(const detail::FacePoint& low, const detail::FacePoint& high) {
    const double far = high.depth;
    return far <= 0.0 || low.across > far || -high.across > far || low.along > far || -high.along > far;
  }
  float* pixels_of(int face) { return nearness_.data() + static_cast<std::size_t>(face * pixels_ * pixels_); }
  const float* row(int face, int number) const {
    return nearness_.data() + static_cast<std::size_t>((face * pixels_ + number) * pixels_);
  }
  detail::FacePixels view_of(int face) const {
    const auto first_tile = static_cast<std::ptrdiff_t>(face) * tiles_ * tiles_;
    return {row(face, 0), tile_nearness_.data() + first_tile, tile_is_old_.data() + first_tile, pixels_, tiles_};
  }

  int cube_pixels_, pixels_ = 0, tiles_ = 0;
  detail::ViewFaces faces_;
  Vec3 from_m_{0.0};
  double least_height_m_ = -std::numeric_limits<double>::infinity();  ///< of what may be hidden
  std::vector<Vec3> offsets_m_;                                       ///< of further points
  RawVector<float> nearness_;  ///< 1/depth of what fills the pixel; 0: nothing does
  // Worked out when they are asked for, until the map is settled.
  mutable std::vector<float> tile_nearness_;   ///< no more than the smallest of 8 × 8 pixels …
  mutable std::vector<char> tile_is_old_;      ///< … and whether it may be less
  std::array<detail::SheetLayers, 6> sheets_;  ///< by face, while surfaces are covered
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/view_map_bodies.hpp"
#include "dcem/paths/halves/view_map_questions_bodies.hpp"
#endif
