#pragma once
/// What outlines show and hide in an edge's image along Keller's cones (keller_view.hpp): the inmost loops.
///
/// The cells are the same for every processor (keller_items.hpp); the loops stand under the name of the instructions
/// that they are compiled for, and all say the same (keller_kernels.hpp).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/core/constants.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/keller_items.hpp"

namespace dcem {

/// What is closer to the edge's line hides nothing, and outlines that come closer than this, or are larger, are always
/// seen.
inline constexpr float keller_hides_from_m = 0.06F, keller_close_m = 0.5F, keller_large_m = 2000.0F;
/// Nor hides what is closer than this share of the largest number: there rounding, 6e-8 of it, turns a side by more
/// than columns are wider, 4.9e-5 rad.
inline constexpr float keller_hides_from_share = 5e-3F;
/// How far places along the edge may be off, of the largest number; and by how much wider a way to what is looked at
/// may leave, as facets count a little beside themselves, and narrower one to what hides.
inline constexpr float keller_rounding = 1e-6F, keller_seen_room_m = 5e-3F, keller_hiding_room_m = 2e-3F;
/// How far `KellerOutline::column` may be off: 0.004 rad (may_face.hpp), and rounding.
inline constexpr float column_error = 0.0045F * static_cast<float>(KellerCells::columns / (2.0 * pi));
/// How far a corner reaches into columns beside its own, for what is beside it by a hair.
inline constexpr float column_room = 0.2F;
/// Places that follow for the sides of a column hold within it but for this share of what may lie between them and
/// their points: twice 1 − cos of half a column.
inline constexpr float slant_share = 4e-5F;

inline namespace DCEM_ISA {

/// Of eight half planes about an edge: between which places along it the ways leave that lead into an outline, from the
/// largest to the smallest number where there is none; how far along the edge its points are from the end at most, and
/// which share of that lies between a point and its place.
struct KellerSpans {
  Float8 from, to, along, share;
};

/// Eight half planes, by the directions in which they lie, cut an outline: where they do no farther than `least_m` from
/// the edge's line does not count.
[[gnu::always_inline]] inline KellerSpans keller_spans(const KellerCells& cells, const KellerOutline& outline,
                                                       const Float8& cosine, const Float8& sine, float least_m) {
  constexpr float far = 1e30F;
  const Float8 end(cells.end_m), end_distance(cells.end_distance_m), zero(0.0F);
  KellerSpans spans{Float8(far), Float8(-far), zero, zero};
  std::size_t last = outline.count - 1;
  Float8 across = cosine * outline.y[last] - sine * outline.x[last];
  for (std::size_t at = 0; at < outline.count; ++at) {
    const Float8 next = cosine * outline.y[at] - sine * outline.x[at];
    const Mask8 crosses = ((across < zero) & (zero <= next)) | ((next < zero) & (zero <= across));
    if (crosses.bits() != 0) {
      const Float8 share = across / (across - next);
      const Float8 ahead = cosine * outline.x[last] + sine * outline.y[last];
      const Float8 distance = ahead + share * (cosine * outline.x[at] + sine * outline.y[at] - ahead);
      const Float8 z = Float8(outline.z[last]) + share * (outline.z[at] - outline.z[last]);
      const Float8 between = distance / (distance + end_distance), slant = (end - z) * between;
      const Mask8 counts = crosses & (Float8(least_m) < distance);
      spans.from = simd::minimum(simd::select(counts, z + slant, Float8(far)), spans.from);
      spans.to = simd::maximum(simd::select(counts, z + slant, Float8(-far)), spans.to);
      spans.along = simd::maximum(simd::select(counts, simd::absolute(end - z), zero), spans.along);
      spans.share = simd::maximum(simd::select(counts, between, zero), spans.share);
    }
    across = next;
    last = at;
  }
  if (outline.is_around) {
    const Mask8 any = spans.from <= spans.to;
    spans.from = simd::select(any, simd::minimum(spans.from, Float8(outline.through_m)), spans.from);
    spans.to = simd::select(any, simd::maximum(spans.to, Float8(outline.through_m)), spans.to);
    spans.along = simd::maximum(spans.along, simd::absolute(end - outline.through_m));
  }
  return spans;
}

/// The least or the most nearness of an outline's plane in eight cells from `row` on, its normal being so much along
/// the azimuth at most and at least.
[[gnu::always_inline]] inline Float8 keller_nearness(const KellerOutline& outline, std::size_t row, const Float8& low,
                                                     const Float8& high, bool least) {
  const Float8 from_share = Float8::load(&outline.from_share[row]), to_share = Float8::load(&outline.to_share[row]);
  const Float8 from_factor = Float8::load(&outline.from_factor[row]), to_factor = Float8::load(&outline.to_factor[row]);
  const Float8 first = (low + from_share) * from_factor, second = (high + from_share) * from_factor;
  const Float8 third = (low + to_share) * to_factor, fourth = (high + to_share) * to_factor;
  return least ? simd::minimum(simd::minimum(first, second), simd::minimum(third, fourth))
               : simd::maximum(simd::maximum(first, second), simd::maximum(third, fourth));
}

/// Along the normal of an outline, in the columns from `first` to the one after `first` + 7: least and most.
struct KellerNormals {
  EightFloats low, high;

  [[gnu::always_inline]] KellerNormals(const KellerAzimuths& starts, const KellerOutline& outline, std::size_t first,
                                       float times) {
    const auto along = [&](std::size_t at) {
      return Float8::load(&starts.cosine[at]) * outline.normal_x + Float8::load(&starts.sine[at]) * outline.normal_y;
    };
    const Float8 left = along(first), right = along(first + 1);
    (simd::minimum(left, right) - times * outline.bulge).store(low);
    (simd::maximum(left, right) + times * outline.bulge).store(high);
  }
};

/// For each column that an outline reaches into, between which places along the edge ways leave that lead to it.
struct KellerReach {
  static constexpr std::size_t most = KellerCells::columns + 3 * simd_lanes;
  std::array<float, most> from, to;
};

/// Of half planes at the sides of columns, and one that no way leads to.
inline void keller_reach_at_sides(const KellerCells& cells, const KellerOutline& outline, KellerReach& reach) {
  const KellerAzimuths& starts = cells.sides->starts;
  std::size_t at = 0;
  for (; at <= outline.column_count; at += simd_lanes) {
    const std::size_t column = (outline.first_column + at) % KellerCells::columns;
    const KellerSpans spans =
        keller_spans(cells, outline, Float8::load(&starts.cosine[column]), Float8::load(&starts.sine[column]), 0.0F);
    const Float8 from = spans.from - outline.room_m, to = spans.to + outline.room_m;
    std::memcpy(&reach.from[at], &from.lanes, sizeof from.lanes);
    std::memcpy(&reach.to[at], &to.lanes, sizeof to.lanes);
  }
  reach.from[at] = 1e30F;
  reach.to[at] = -1e30F;
}

/// Corners reach into the column that they are in, and beside it.
inline void keller_add_corners(const KellerOutline& outline, KellerReach& reach) {
  constexpr auto all = static_cast<std::int32_t>(KellerCells::columns);
  for (std::size_t corner = 0; corner < outline.count; ++corner) {
    const float low = outline.place_m[corner] - outline.room_m, high = outline.place_m[corner] + outline.room_m;
    const float off = outline.column[corner] - static_cast<float>(outline.first_column);
    const auto first = static_cast<std::int32_t>(std::floor(off - column_room - column_error)),
               last = static_cast<std::int32_t>(std::floor(off + column_room + column_error));
    for (std::int32_t at = first; at <= last; ++at) {
      const auto column = static_cast<std::size_t>((at + 2 * all) % all);
      if (column >= outline.column_count) continue;
      reach.from[column] = std::min(reach.from[column], low);
      reach.to[column] = std::max(reach.to[column], high);
    }
  }
}

/// The columns between the sides: what both of them reach.
inline void keller_join_sides(const KellerOutline& outline, KellerReach& reach) {
  for (std::size_t at = 0; at < outline.column_count; at += simd_lanes) {
    const Float8 from = simd::minimum(Float8::load(&reach.from[at]), Float8::load(&reach.from[at + 1]));
    const Float8 to = simd::maximum(Float8::load(&reach.to[at]), Float8::load(&reach.to[at + 1]));
    std::memcpy(&reach.from[at], &from.lanes, sizeof from.lanes);
    std::memcpy(&reach.to[at], &to.lanes, sizeof to.lanes);
  }
}

/// The cells of a column from which an outline is seen that reaches from one place to another there, its normal being
/// so much along the azimuth at least and at most.
[[gnu::always_inline]] inline std::uint32_t keller_seen_in(const KellerCells& cells, const KellerOutline& outline,
                                                           const KellerCells::Row& hidden, const Float8& from,
                                                           const Float8& to, const Float8& low, const Float8& high) {
  std::uint32_t seen = 0;
  for (std::size_t row = 0; row < cells.rows; row += simd_lanes) {
    const Mask8 in = (from <= Float8::load(&cells.to_m[row])) & (Float8::load(&cells.from_m[row]) <= to);
    const Float8 nearness = keller_nearness(outline, row, low, high, false);
    const Float8 counted = nearness * Float8::load(&outline.nearer[row]) + Float8::load(&outline.more[row]);
    seen |= (in & (Float8::load(&hidden[row]) < counted)).bits() << row;
  }
  return seen;
}

/// The cells along the edge, a bit for each, from which an outline may be seen in some column.
inline std::uint32_t keller_shows(const KellerCells& cells, const KellerOutline& outline) {
  KellerReach reach;
  keller_reach_at_sides(cells, outline, reach);
  keller_join_sides(outline, reach);
  keller_add_corners(outline, reach);
  std::uint32_t shown = 0;
  const std::size_t count = outline.column_count;
  const Float8 first_m(cells.from_m[0]), last_m(cells.to_m[cells.rows - 1]);
  for (std::size_t at = 0; at < count; at += simd_lanes) {
    std::uint32_t lanes = ((Float8::load(&reach.from[at]) <= last_m) & (first_m <= Float8::load(&reach.to[at]))).bits();
    if (count - at < simd_lanes) lanes &= (1U << (count - at)) - 1U;
    if (lanes == 0) continue;
    const std::size_t column = (outline.first_column + at) % KellerCells::columns;
    const KellerNormals normals(cells.sides->starts, outline, column, 2.0F);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      shown |= keller_seen_in(cells, outline, cells.hidden[(column + lane) % KellerCells::columns],
                              Float8(reach.from[at + lane]), Float8(reach.to[at + lane]), Float8(normals.low[lane]),
                              Float8(normals.high[lane]));
    }
  }
  return shown;
}

/// Notes for the cells of a column of which an outline holds all ways what of it is the least nearness.
[[gnu::always_inline]] inline void keller_hide_in(const KellerCells& cells, const KellerOutline& outline,
                                                  KellerCells::Row& hidden, const Float8& from, const Float8& to,
                                                  const Float8& low, const Float8& high, float hides_from_m) {
  for (std::size_t row = 0; row < cells.rows; row += simd_lanes) {
    const Float8 nearness = keller_nearness(outline, row, low, high, true);
    const Mask8 in = (from <= Float8::load(&cells.from_m[row])) & (Float8::load(&cells.to_m[row]) <= to) &
                     (nearness < Float8(1.0F / hides_from_m));
    const Float8 before = Float8::load(&hidden[row]);
    const Float8 now = simd::select(in, simd::maximum(nearness * Float8::load(&outline.nearer[row]), before), before);
    std::memcpy(&hidden[row], &now.lanes, sizeof now.lanes);
  }
}

/// Notes what is hidden behind an outline: cells of which it holds all ways.
inline void keller_cover(KellerCells& cells, const KellerOutline& outline) {
  const float room_m = keller_hiding_room_m + keller_rounding * outline.far_m;
  const float hides_from_m = std::max(keller_hides_from_m, keller_hides_from_share * outline.far_m);
  const auto spans = [&](const KellerAzimuths& sides, std::size_t first) {
    return keller_spans(cells, outline, Float8::load(&sides.cosine[first]), Float8::load(&sides.sine[first]),
                        hides_from_m);
  };
  for (std::size_t at = 0; at < outline.column_count; at += simd_lanes) {
    const std::size_t first = (outline.first_column + at) % KellerCells::columns;
    const KellerSpans left = spans(cells.sides->wide_starts, first), right = spans(cells.sides->wide_ends, first);
    const Float8 room =
        simd::maximum(left.along, right.along) * simd::maximum(left.share, right.share) * slant_share + room_m;
    const Float8 from = simd::maximum(left.from, right.from) + room, to = simd::minimum(left.to, right.to) - room;
    std::uint32_t lanes =
        ((from < to) & (from <= Float8(cells.from_m[cells.rows - 1])) & (Float8(cells.to_m[0]) <= to)).bits();
    if (lanes == 0) continue;
    EightFloats from_m, to_m;
    from.store(from_m);
    to.store(to_m);
    const KellerNormals normals(cells.sides->starts, outline, first, 1.0F);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      keller_hide_in(cells, outline, cells.hidden[(first + lane) % KellerCells::columns], Float8(from_m[lane]),
                     Float8(to_m[lane]), Float8(normals.low[lane]), Float8(normals.high[lane]), hides_from_m);
    }
  }
}

}  // namespace DCEM_ISA

}  // namespace dcem
