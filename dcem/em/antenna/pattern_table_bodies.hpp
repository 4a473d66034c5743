#pragma once
/// Bodies of pattern_table.hpp.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/em/antenna/pattern_table.hpp"

namespace dcem {

DCEM_INLINE PatternTable::PatternTable(std::size_t azimuth_count, std::size_t zenith_count,
                                       std::vector<double> gain_dbi)
    : azimuth_count_(azimuth_count), zenith_count_(zenith_count), gain_dbi_(std::move(gain_dbi)) {
  const bool whole = azimuth_count >= 1 && zenith_count >= 2 && gain_dbi_.size() / azimuth_count == zenith_count &&
                     gain_dbi_.size() % azimuth_count == 0;
  if (!whole) throw std::invalid_argument("antenna pattern: expected a gain for each azimuth and zenith of the sphere");
  const auto allowed = [](double gain) { return std::abs(gain) <= highest_gain_dbi; };
  if (!std::all_of(gain_dbi_.begin(), gain_dbi_.end(), allowed)) {
    throw std::invalid_argument("antenna pattern: expected gains from -200 to 200 dBi");
  }
  unite_pole(0);
  unite_pole(zenith_count_ - 1);
  peak_dbi_ = *std::max_element(gain_dbi_.begin(), gain_dbi_.end());
}

DCEM_INLINE void PatternTable::unite_pole(std::size_t zenith) {
  const auto first = gain_dbi_.begin() + static_cast<std::ptrdiff_t>(zenith * azimuth_count_);
  const auto last = first + static_cast<std::ptrdiff_t>(azimuth_count_);
  if (std::all_of(first, last, [&](double gain) { return gain == *first; })) return;  // as it was, to the last bit
  double power = 0.0;
  for (auto gain = first; gain != last; ++gain) power += db_to_power_ratio(*gain);
  std::fill(first, last, power_ratio_to_db(power / static_cast<double>(azimuth_count_)));
}

}  // namespace dcem
