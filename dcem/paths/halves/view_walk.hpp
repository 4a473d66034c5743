#pragma once
/// What outlines fill and show on one face of a view (view_map.hpp): the inmost loops.
///
/// The pixels are the same for every processor (face_outline.hpp); the loops stand under the name of the instructions
/// that they are compiled for, and all say the same, to the last bit (view_kernels.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/face_rows.hpp"

namespace dcem::detail {

inline namespace DCEM_ISA {

/// Nearness in the pixels of a row: what it is in the first, and what a pixel more brings.
struct RowNearness {
  float base, step;
};

/// The least in each pixel.
inline RowNearness least_in_row(const FaceNearness& nearness, int row, int pixels) {
  const double pad = 0.5 * (std::abs(nearness.by_column) + std::abs(nearness.by_row)) + slack_of(nearness, pixels);
  const double middle = nearness.by_row * (row + 0.5) + nearness.at_origin + 0.5 * nearness.by_column;
  return {static_cast<float>((middle - pad) * (1.0 - nearness_rounding)),
          static_cast<float>(nearness.by_column * (1.0 - nearness_rounding))};
}

/// The numbers 0 … 7.
[[gnu::always_inline]] inline Float8 first_eight() {
  return Float8(std::array<float, simd_lanes>{0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F});
}

/// Calls `visit(at, columns, counts)` for the columns from `begin` to `end` − 1, eight at a time from a multiple of
/// eight on, with those that count: `at` is the first. A row has a multiple of eight.
template <typename Visit>
[[gnu::always_inline]] inline void for_each_eight(int begin, int end, Visit&& visit) {
  const Float8 lanes = first_eight(), first(static_cast<float>(begin)), last(static_cast<float>(end));
  for (int at = begin & ~7; at < end; at += 8) {
    const Float8 columns = lanes + Float8(static_cast<float>(at));
    if (!visit(at, columns, (first <= columns) & (columns < last))) return;
  }
}

/// Pixels from the first to the last of each.
struct PixelBox {
  int first_row, last_row, first_column, last_column;

  bool empty() const { return last_column < first_column; }
};

/// Notes that the tiles of some pixels may hold less than is there.
inline void age_tiles(const FacePixels& face, const PixelBox& box) {
  constexpr int to_a_side = FacePixels::tile_pixels;
  for (int tile_row = box.first_row / to_a_side; tile_row <= box.last_row / to_a_side; ++tile_row) {
    char* const tile = face.tile_is_old + static_cast<std::ptrdiff_t>(tile_row) * face.tiles;
    for (int column = box.first_column / to_a_side; column <= box.last_column / to_a_side; ++column) tile[column] = 1;
  }
}

/// Calls `fill(row, begin, end, nearness)` for runs of pixels that an outline fills, so many of them along a face, with
/// the least nearness there. Returns a box that holds all of them.
template <typename Fill>
inline PixelBox for_each_run(int pixels, const FaceOutline& outline, const FaceNearness& nearness, Fill&& fill) {
  FaceRows rows;
  if (!rows.take(outline, pixels)) return {0, 0, 0, -1};
  if (rows.high()[0] - rows.low()[0] < 1.0 || rows.high()[1] - rows.low()[1] < 1.0) return {0, 0, 0, -1};
  rows.find_crossed();
  constexpr float hair = 2e-3F;  // of a pixel
  int first_column = pixels, last_column = -1;
  for (int row = rows.first(); row <= rows.last(); ++row) {
    if (rows.to(row) < -1e8F || rows.to(row + 1) < -1e8F) continue;
    const float from = std::max(rows.from(row), rows.from(row + 1)) + hair;
    const float to = std::min(rows.to(row), rows.to(row + 1)) - hair;
    const int begin = std::max(0, static_cast<int>(std::ceil(from)));
    const int end = std::min(pixels, static_cast<int>(std::floor(to)));
    if (begin >= end) continue;
    fill(row, begin, end, least_in_row(nearness, row, pixels));
    first_column = std::min(first_column, begin);
    last_column = std::max(last_column, end - 1);
  }
  return {rows.first(), rows.last(), first_column, last_column};
}

/// The same of the pixels of a face, of which tiles are noted as old.
template <typename Fill>
inline void for_each_filled(const FacePixels& face, const FaceOutline& outline, const FaceNearness& nearness,
                            Fill&& fill) {
  const PixelBox box = for_each_run(face.pixels, outline, nearness, fill);
  if (!box.empty()) age_tiles(face, box);
}

/// Notes in pixels what is there nearer than before.
[[gnu::always_inline]] inline void bring_nearer(float* pixels, const Float8& here, const Mask8& counts) {
  const Float8 before = Float8::load(pixels);
  const Float8 now = simd::select(counts & (before < here), here, before);
  std::memcpy(pixels, &now.lanes, sizeof now.lanes);
}

/// An outline of a plane fills pixels; `pixels` are those of the face.
inline void view_cover(const FacePixels& face, float* pixels, const FaceOutline& outline,
                       const FaceNearness& nearness) {
  for_each_filled(face, outline, nearness, [&](int row, int begin, int end, const RowNearness& least) {
    float* const of_row = pixels + static_cast<std::ptrdiff_t>(row) * face.pixels;
    for_each_eight(begin, end, [&](int at, const Float8& columns, const Mask8& counts) {
      bring_nearer(of_row + at, Float8(least.base) + Float8(least.step) * columns, counts);
      return true;
    });
  });
}

/// The same with the farther one of two planes.
inline void view_cover_both(const FacePixels& face, float* pixels, const FaceOutline& outline,
                            const FaceNearness& nearness, const FaceNearness& other) {
  for_each_filled(face, outline, nearness, [&](int row, int begin, int end, const RowNearness& least) {
    float* const of_row = pixels + static_cast<std::ptrdiff_t>(row) * face.pixels;
    const RowNearness second = least_in_row(other, row, face.pixels);
    for_each_eight(begin, end, [&](int at, const Float8& columns, const Mask8& counts) {
      const Float8 here = Float8(least.base) + Float8(least.step) * columns;
      const Float8 there = Float8(second.base) + Float8(second.step) * columns;
      bring_nearer(of_row + at, simd::minimum(here, there), counts);
      return true;
    });
  });
}

inline void renew_tile(const FacePixels& face, int tile_row, int column) {
  constexpr int to_a_side = FacePixels::tile_pixels;
  static_assert(to_a_side == simd_lanes);
  Float8 least(std::numeric_limits<float>::infinity());
  for (int line = 0; line < to_a_side; ++line) {
    least = simd::minimum(Float8::load(face.row(tile_row * to_a_side + line) + column * to_a_side), least);
  }
  std::array<float, simd_lanes> numbers;
  least.store(numbers);
  float smallest = numbers[0];
  for (const float number : numbers) smallest = number < smallest ? number : smallest;
  const std::ptrdiff_t tile = static_cast<std::ptrdiff_t>(tile_row) * face.tiles + column;
  face.tile_nearness[tile] = smallest;
  face.tile_is_old[tile] = 0;
}

/// Whether all of a tile is filled by what is nearer.
[[gnu::always_inline]] inline bool tile_hides(const FacePixels& face, int tile_row, int column, float nearness) {
  const std::ptrdiff_t tile = static_cast<std::ptrdiff_t>(tile_row) * face.tiles + column;
  if (nearness <= face.tile_nearness[tile]) return true;
  if (face.tile_is_old[tile] == 0) return false;
  renew_tile(face, tile_row, column);
  return nearness <= face.tile_nearness[tile];
}

/// Whether all that is in the box around an outline is nearer than its nearest corner: pixel by pixel where the box is
/// small, by tiles otherwise. Cheaper than to ask row by row, and most that is asked about is hidden.
inline bool box_is_hidden(const FacePixels& face, const FaceRows& rows, float nearness) {
  constexpr double hair = 1e-3;  // of a pixel
  constexpr int to_a_side = FacePixels::tile_pixels;
  const int first = std::max(0, static_cast<int>(std::floor(rows.low()[0] - hair)));
  const int last = std::min(face.pixels - 1, static_cast<int>(std::floor(rows.high()[0] + hair)));
  if (last - first < to_a_side) {
    for (int row = rows.first(); row <= rows.last(); ++row) {
      const float* const pixel = face.row(row);
      for (int column = first; column <= last; ++column) {
        if (nearness > pixel[column]) return false;
      }
    }
    return true;
  }
  for (int tile_row = rows.first() / to_a_side; tile_row <= rows.last() / to_a_side; ++tile_row) {
    for (int column = first / to_a_side; column <= last / to_a_side; ++column) {
      if (!tile_hides(face, tile_row, column, nearness)) return false;
    }
  }
  return true;
}

/// Whether some of an outline of a plane, its distance divided by `nearer` ≥ 1, may be seen.
inline bool view_shows(const FacePixels& face, const FaceOutline& outline, const FaceNearness& nearness,
                       double nearer) {
  FaceRows rows;
  if (!rows.take(outline, face.pixels)) return false;
  const auto grown = static_cast<float>(nearer * (1.0 + nearness_rounding));
  const auto top = static_cast<float>(rows.nearest());
  if (box_is_hidden(face, rows, top * grown)) return false;
  rows.find_touched();
  constexpr float hair = 1e-3F;  // of a pixel
  const Float8 step(static_cast<float>(nearness.by_column)), most(top), times(grown);
  const double pad = 0.5 * (std::abs(nearness.by_column) + std::abs(nearness.by_row)) + slack_of(nearness, face.pixels);
  for (int row = rows.first(); row <= rows.last(); ++row) {
    const int begin = std::max(0, static_cast<int>(std::floor(rows.from(row) - hair)));
    const int end = std::min(face.pixels - 1, static_cast<int>(std::floor(rows.to(row) + hair))) + 1;
    const Float8 base(
        static_cast<float>(nearness.by_row * (row + 0.5) + nearness.at_origin + 0.5 * nearness.by_column + pad));
    const float* const pixels = face.row(row);
    bool is_seen = false;
    for_each_eight(begin, end, [&](int at, const Float8& columns, const Mask8& counts) {
      const Float8 plane = simd::minimum(base + step * columns, most);
      is_seen = (counts & (Float8::load(pixels + at) < plane * times)).bits() != 0;
      return !is_seen;
    });
    if (is_seen) return true;
  }
  return false;
}

/// Whether all of a box, of which the lowest and the highest corner are told, its distance divided by `nearer` ≥ 1, is
/// hidden for sure.
inline bool view_hides_box(const FacePixels& face, const FacePoint& low, const FacePoint& high, double nearer) {
  const double far = high.depth;
  // No nearer than where the face's pyramid is wide enough to hold any of the box.
  const double depth = std::max({low.depth, 0.0, low.across, -high.across, low.along, -high.along});
  if (depth < 1e-3) return false;
  const auto first = [&](double bound) {
    const double seen = bound / (bound >= 0.0 ? far : depth);
    return std::max(0, static_cast<int>(std::floor((seen + 1.0) * 0.5 * face.tiles - 1e-6)));
  };
  const auto last = [&](double bound) {
    const double seen = bound / (bound >= 0.0 ? depth : far);
    return std::min(face.tiles - 1, static_cast<int>(std::floor(std::min(seen + 1.0, 3.0) * 0.5 * face.tiles + 1e-6)));
  };
  const auto nearness = static_cast<float>(nearer * (1.0 + nearness_rounding) / depth);
  const int first_column = first(low.across), last_column = last(high.across), last_row = last(high.along);
  for (int tile_row = first(low.along); tile_row <= last_row; ++tile_row) {
    for (int column = first_column; column <= last_column; ++column) {
      if (!tile_hides(face, tile_row, column, nearness)) return false;
    }
  }
  return true;
}

}  // namespace DCEM_ISA

}  // namespace dcem::detail
