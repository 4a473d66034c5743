#pragma once
/// Bodies of keller_view.hpp: an outline in the edge's frame.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/keller_view.hpp"

namespace dcem {

DCEM_INLINE bool KellerView::place(std::span<const Vec3> corners_m) {
  const std::size_t count = corners_m.size(), padded = (count + simd_lanes - 1) / simd_lanes * simd_lanes;
  if (padded > KellerOutline::most_corners) return false;
  KellerOutline& outline = outline_;
  outline.count = count;
  for (std::size_t at = 0; at < count; ++at) {
    const Vec3 away = corners_m[at] - start_m_;
    outline.x[at] = static_cast<float>(glm::dot(axes_[0], away));
    outline.y[at] = static_cast<float>(glm::dot(axes_[1], away));
    outline.z[at] = static_cast<float>(glm::dot(axes_[2], away));
  }
  for (std::size_t at = count; at < padded; ++at) {
    outline.x[at] = outline.x[count - 1];
    outline.y[at] = outline.y[count - 1];
    outline.z[at] = outline.z[count - 1];
  }
  measure();
  const Float8 end(cells_.end_m), end_distance(cells_.end_distance_m);
  Mask8 is_close = Float8(0.0F) < Float8(0.0F);
  Float8 along(0.0F), share(0.0F);
  for (std::size_t at = 0; at < padded; at += simd_lanes) {
    const Float8 x = Float8::load(&outline.x[at]), y = Float8::load(&outline.y[at]), z = Float8::load(&outline.z[at]);
    const Float8 distance = simd::square_root(x * x + y * y);
    const Float8 between = distance / (distance + end_distance), met = z + (end - z) * between;
    std::memcpy(&outline.place_m[at], &met.lanes, sizeof met.lanes);
    along = simd::maximum(along, simd::absolute(end - z));
    share = simd::maximum(share, between);
    is_close = is_close | (distance < Float8(keller_close_m));
  }
  outline.is_close = is_close.bits() != 0;
  EightFloats alongs, shares;
  along.store(alongs);
  share.store(shares);
  outline.room_m = keller_seen_room_m + keller_rounding * outline.far_m +
                   slant_share * *std::ranges::max_element(alongs) * *std::ranges::max_element(shares);
  return true;
}

DCEM_INLINE void KellerView::measure() {
  outline_.far_m = outline_.size_m = 0.0F;
  for (const KellerOutline::Corners* along : {&outline_.x, &outline_.y, &outline_.z}) {
    const auto [least, most] =
        std::minmax_element(along->begin(), along->begin() + static_cast<std::ptrdiff_t>(outline_.count));
    outline_.far_m = std::max({outline_.far_m, -*least, *most});
    outline_.size_m = std::max(outline_.size_m, *most - *least);
  }
}

/// Where all corners are met beyond what is looked from, seen from the end, all of the outline is: ways that leave
/// beyond a place that is itself beyond the end fill a cone.
DCEM_INLINE bool KellerView::is_beside() const {
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (std::size_t at = 0; at < outline_.count; ++at) {
    least = std::min(least, outline_.place_m[at] - outline_.room_m);
    most = std::max(most, outline_.place_m[at] + outline_.room_m);
  }
  return (last() >= cells_.end_m && least > last()) || (first() <= cells_.end_m && most < first());
}

/// Whether it holds no cell from one end to the other: where its corners are met in less than one.
DCEM_INLINE bool KellerView::is_too_small() const {
  const auto [least, most] = std::minmax_element(
      outline_.place_m.begin(), outline_.place_m.begin() + static_cast<std::ptrdiff_t>(outline_.count));
  return *most - *least < 0.9F * (cells_.to_m[0] - cells_.from_m[0]) || *most < cells_.from_m[0] || last() < *least;
}

/// From cells that a plane crosses, or comes close to, all of it may be seen, and it hides nothing.
DCEM_INLINE void KellerView::place_plane(const Plane& plane, double lift_m) {
  const double offset = glm::dot(plane.normal, plane.point_m - start_m_), along = glm::dot(plane.normal, axes_[2]);
  outline_.normal_x = static_cast<float>(glm::dot(plane.normal, axes_[0]));
  outline_.normal_y = static_cast<float>(glm::dot(plane.normal, axes_[1]));
  // 1 − cos of half a column is 1.9e-5.
  outline_.bulge = 2e-4F * std::sqrt(outline_.normal_x * outline_.normal_x + outline_.normal_y * outline_.normal_y);
  outline_.through_m = static_cast<float>(std::abs(along) > 1e-12 ? offset / along : 1e30);
  const Float8 slope(static_cast<float>(along)), start(static_cast<float>(offset)), zero(0.0F), one(1.0F);
  const Float8 per_m(static_cast<float>(along / static_cast<double>(cells_.end_distance_m)));
  const Float8 lift(static_cast<float>(lift_m));
  outline_.error_m = static_cast<float>(
      5e-7 * (std::abs(offset) + std::abs(along) * static_cast<double>(std::max(std::abs(first()), std::abs(last())))));
  for (std::size_t row = 0; row < cells_.rows; row += simd_lanes) {
    const Float8 from = Float8::load(&cells_.from_m[row]), to = Float8::load(&cells_.to_m[row]);
    const Float8 first = start - slope * from, last = start - slope * to;
    const Float8 least = simd::minimum(simd::absolute(first), simd::absolute(last));
    const Mask8 is_close = ((first < zero) & (zero <= last)) | ((last < zero) & (zero <= first)) |
                           (least <= lift + lift + (1e-4F + 4.0F * outline_.error_m));
    const auto put = [row](KellerCells::Row& to_row, const Float8& numbers) {
      std::memcpy(&to_row[row], &numbers.lanes, sizeof numbers.lanes);
    };
    put(outline_.from_share, (from - cells_.end_m) * per_m);
    put(outline_.to_share, (to - cells_.end_m) * per_m);
    put(outline_.from_factor, simd::select(is_close, zero, one / first));
    put(outline_.to_factor, simd::select(is_close, zero, one / last));
    put(outline_.least_m, simd::select(is_close, one, least));
    put(outline_.more, simd::select(is_close, Float8(1e30F), zero));
  }
}

DCEM_INLINE void KellerView::count_nearer(double by_m) {
  constexpr float rounding = 1e-5F;
  const bool is_nearer = by_m > 0.0;
  const Float8 by(static_cast<float>(by_m) + (is_nearer ? outline_.error_m : -outline_.error_m)),
      room(is_nearer ? 1.0F + rounding : 1.0F - rounding);
  for (std::size_t row = 0; row < cells_.rows; row += simd_lanes) {
    const Float8 least = Float8::load(&outline_.least_m[row]), nearer = least / (least - by) * room;
    std::memcpy(&outline_.nearer[row], &nearer.lanes, sizeof nearer.lanes);
  }
}

/// Which columns the outline reaches into, and some more.
DCEM_INLINE void KellerView::find_columns() {
  constexpr float turn = KellerCells::columns, half_turn = turn / 2.0F;
  const auto turned = [](float by) { return by > half_turn ? by - turn : by < -half_turn ? by + turn : by; };
  float last = detail::rough_column(outline_.x[0], outline_.y[0]), sum = 0.0F, least = 0.0F, most = 0.0F;
  outline_.column[0] = last;
  for (std::size_t at = 1; at < outline_.count; ++at) {
    const float column = detail::rough_column(outline_.x[at], outline_.y[at]);
    sum += turned(column - last);
    least = std::min(least, sum);
    most = std::max(most, sum);
    outline_.column[at] = last = column;
  }
  outline_.is_around = std::abs(sum + turned(outline_.column[0] - last)) > half_turn;
  if (outline_.is_around || most - least > half_turn - 4.0F * (1.0F + column_error)) {
    find_close();
    outline_.first_column = 0;
    outline_.column_count = KellerCells::columns;
    return;
  }
  const float room = column_room + 2.0F * column_error;
  const float first = std::floor(outline_.column[0] + least - room);
  outline_.first_column = static_cast<std::uint32_t>(static_cast<std::int32_t>(first)) % KellerCells::columns;
  outline_.column_count = static_cast<std::uint32_t>(std::ceil(outline_.column[0] + most + room) - first);
}

/// Where the edge's line goes through the outline close to its rim, or past it, it is not told apart which.
DCEM_INLINE void KellerView::find_close() {
  for (std::size_t at = 0, last = outline_.count - 1; at < outline_.count; last = at++) {
    const float dx = outline_.x[at] - outline_.x[last], dy = outline_.y[at] - outline_.y[last];
    const float along = -(outline_.x[last] * dx + outline_.y[last] * dy);
    const float share = std::clamp(along / (dx * dx + dy * dy + 1e-12F), 0.0F, 1.0F);
    const float x = outline_.x[last] + share * dx, y = outline_.y[last] + share * dy;
    if (x * x + y * y < keller_close_m * keller_close_m) outline_.is_close = true;
  }
}

}  // namespace dcem
