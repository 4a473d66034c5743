#pragma once
/// Bodies of receiver_part.hpp.
#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/receiver_part.hpp"

namespace dcem {

namespace detail {

/// The bits of a number with a zero before each.
inline std::uint64_t spread_bits(std::uint32_t number) {
  std::uint64_t bits = number;
  bits = (bits | bits << 16U) & 0x0000ffff0000ffffULL;
  bits = (bits | bits << 8U) & 0x00ff00ff00ff00ffULL;
  bits = (bits | bits << 4U) & 0x0f0f0f0f0f0f0f0fULL;
  bits = (bits | bits << 2U) & 0x3333333333333333ULL;
  return (bits | bits << 1U) & 0x5555555555555555ULL;
}

/// The place of a square of this width on the curve. Places are within 1e9 m and squares at least 1e-3 m wide; those
/// that are too many to number share one.
inline std::uint64_t place_on_curve(const Vec3& position_m, double width_m) {
  const auto number = [&](double along_m) {
    constexpr double middle = 2147483648.0;
    return static_cast<std::uint32_t>(std::clamp(std::floor(along_m / width_m) + middle, 0.0, 2.0 * middle - 1.0));
  };
  return spread_bits(number(position_m.x)) | spread_bits(number(position_m.y)) << 1U;
}

/// Receivers that are there, along the curve.
inline std::vector<std::uint32_t> receivers_along_curve(std::span<const std::optional<Vec3>> receivers_m,
                                                        double width_m) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for (std::size_t index = 0; index < receivers_m.size(); ++index) {
    if (!receivers_m[index]) continue;
    keys.emplace_back(place_on_curve(*receivers_m[index], width_m), static_cast<std::uint32_t>(index));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  for (const auto& key : keys) order.push_back(key.second);
  return order;
}

}  // namespace detail

DCEM_INLINE void keep_part(const ReceiverPart& part, std::optional<double> range_m,
                           std::span<const std::optional<Vec3>> receivers_m,
                           std::vector<std::vector<std::uint32_t>>& chosen) {
  if (!range_m) {
    for (std::size_t index = 0; index < chosen.size(); ++index) {
      if (index % part.of != part.part) chosen[index].clear();
    }
    return;
  }
  std::uint64_t all = 0, before = 0;
  for (const auto& of_one : chosen) all += of_one.size();
  for (const std::uint32_t index : detail::receivers_along_curve(receivers_m, *range_m)) {
    const std::uint64_t own = chosen[index].size();
    // The part in which its middle link lies; at most 1e5 devices and 1e6 parts: no overflow.
    const std::uint64_t middle = 2 * before + own;
    before += own;
    if (own > 0 && middle * part.of / (2 * all) != part.part) chosen[index].clear();
  }
}

}  // namespace dcem
