#pragma once
/// Bodies of keller_view.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/constants.hpp"
#include "dcem/paths/halves/keller_view.hpp"

namespace dcem {

namespace detail {

/// Azimuths a column apart, from a share of a column on.
inline KellerAzimuths keller_azimuths(double from) {
  KellerAzimuths azimuths;
  for (std::size_t at = 0; at < KellerAzimuths::count; ++at) {
    const double angle_rad = (static_cast<double>(at) + from) * 2.0 * pi / KellerCells::columns;
    azimuths.cosine[at] = static_cast<float>(std::cos(angle_rad));
    azimuths.sine[at] = static_cast<float>(std::sin(angle_rad));
  }
  return azimuths;
}

inline const KellerSides& keller_sides() {
  constexpr double wider = 0.004;  // far above rounding
  static const KellerSides sides{keller_azimuths(0.0), keller_azimuths(-wider), keller_azimuths(1.0 + wider)};
  return sides;
}

}  // namespace detail

DCEM_INLINE KellerView::KellerView() {
  cells_.sides = &detail::keller_sides();
}

DCEM_INLINE void KellerView::look_from(const Wedge& edge, std::span<const EdgePart> parts) {
  constexpr float room_m = 0.01F;  // a path's point may be beside a part by less
  constexpr float long_m = 4.0F;
  start_m_ = edge.start_m;
  axes_ = {edge.tangent, edge.normal, edge_direction(edge)};
  cells_.end_m = parts.front().place;
  cells_.end_distance_m = parts.front().distance;
  const float from = parts.front().from - room_m, length = parts.back().to + room_m - from;
  cells_.rows = length > long_m ? KellerCells::most_rows : simd_lanes;
  const float row_m = length / static_cast<float>(cells_.rows);
  for (std::uint32_t row = 0; row < cells_.rows; ++row) {
    cells_.from_m[row] = from + row_m * static_cast<float>(row);
    cells_.to_m[row] = from + row_m * static_cast<float>(row + 1);
  }
  open_cells(edge, parts);
}

/// Nothing is seen from between the parts, nor between the faces where the edge is solid; what is looked at may be a
/// column beside the exterior.
DCEM_INLINE void KellerView::open_cells(const Wedge& edge, std::span<const EdgePart> parts) {
  constexpr float everything = std::numeric_limits<float>::infinity(), room_m = 0.01F;
  KellerCells::Row open{}, shut;
  shut.fill(everything);
  for (std::uint32_t row = 0; row < cells_.rows; ++row) {
    const bool is_lit = std::ranges::any_of(parts, [&](const EdgePart& part) {
      return part.from - room_m <= cells_.to_m[row] && cells_.from_m[row] <= part.to + room_m;
    });
    open[row] = is_lit ? 0.0F : everything;
  }
  constexpr double per_rad = KellerCells::columns / (2.0 * pi);
  const auto exterior = static_cast<std::uint32_t>(std::ceil(edge.exterior_angle_rad * per_rad));
  for (std::uint32_t column = 0; column < KellerCells::columns; ++column) {
    cells_.hidden[column] = column <= exterior || column + 1 == KellerCells::columns ? open : shut;
  }
}

DCEM_INLINE bool KellerView::hides(const Aabb<double>& box) const {
  constexpr float room_m = 0.02F, nearer_boxes = 1.006F;
  const Vec3 middle = box.center() - start_m_, half = 0.5 * box.extent();
  std::array<float, 3> at{}, reach{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<float>(glm::dot(axes_[axis], middle));
    reach[axis] = static_cast<float>(glm::dot(glm::abs(axes_[axis]), half)) + 1e-3F;
  }
  const float distance_m = std::sqrt(at[0] * at[0] + at[1] * at[1]);
  const float radius_m = std::sqrt(reach[0] * reach[0] + reach[1] * reach[1]);
  const float nearest_m = std::max(distance_m - radius_m, 0.0F), farthest_m = distance_m + radius_m;
  const auto place = [&](float z, bool near) {
    const float rho_m = near ? nearest_m : farthest_m;
    return z + (cells_.end_m - z) * (rho_m / (rho_m + cells_.end_distance_m));
  };
  const float low = at[2] - reach[2], high = at[2] + reach[2];
  const float from = place(low, low < cells_.end_m) - room_m, to = place(high, high > cells_.end_m) + room_m;
  if (to < first() || last() < from) return true;
  if (nearest_m < keller_close_m) return false;
  const float share = radius_m / distance_m;  // arcsin s ≤ s + (π/2 − 1) s³
  constexpr auto per_rad = static_cast<float>(KellerCells::columns / (2.0 * pi));
  const float half_columns = share * (1.0F + 0.571F * share * share) * per_rad + column_error + column_room;
  const float column = detail::rough_column(at[0], at[1]);
  const auto left = static_cast<std::int32_t>(std::floor(column - half_columns)),
             right = static_cast<std::int32_t>(std::floor(column + half_columns));
  const Float8 nearness(nearer_boxes / nearest_m);
  for (std::size_t row = 0; row < cells_.rows; row += simd_lanes) {
    const std::uint32_t in =
        ((Float8::load(&cells_.from_m[row]) <= Float8(to)) & (Float8(from) <= Float8::load(&cells_.to_m[row]))).bits();
    if (in == 0) continue;
    for (std::int32_t at_column = left; at_column <= right; ++at_column) {
      const KellerCells::Row& hidden = cells_.hidden[static_cast<std::uint32_t>(at_column) % KellerCells::columns];
      if ((in & (Float8::load(&hidden[row]) < nearness).bits()) != 0) return false;
    }
  }
  return true;
}

DCEM_INLINE std::uint32_t KellerView::look_at(std::span<const Vec3> corners_m, const Plane& plane, double lift_m) {
  const std::uint32_t all = (1U << cells_.rows) - 1U;
  if (!place(corners_m)) return all;
  if (!outline_.is_close && is_beside()) return 0;
  find_columns();
  if (outline_.is_close || outline_.size_m > keller_large_m) return all;
  place_plane(plane, lift_m);
  count_nearer(lift_m);
  return detail::keller_kernels().shows(cells_, outline_);
}

DCEM_INLINE void KellerView::cover(std::span<const Vec3> corners_m, const Plane& plane, double lift_m, double stray_m) {
  constexpr auto least_count = static_cast<std::uint32_t>(1.0F + 2.0F * (column_room + 2.0F * column_error));
  if (!place(corners_m) || outline_.is_close || is_too_small()) return;
  find_columns();
  if (outline_.is_close || outline_.column_count < least_count) return;
  place_plane(plane, lift_m);
  count_nearer(-stray_m);
  detail::keller_kernels().cover(cells_, outline_);
}

}  // namespace dcem
