#pragma once
/// Power over Doppler shift.
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/field/power_sample.hpp"

namespace dcem {

/// One bin that holds power.
struct DopplerBin {
  double doppler_hz = 0.0;   ///< its middle: a multiple of the bin width
  double power_ratio = 0.0;  ///< received over transmitted power
};

namespace detail {

/// Number n of the bin with (n − ½)·bin_hz ≤ doppler < (n + ½)·bin_hz, as these products come out in double.
inline std::int64_t doppler_bin_index(double doppler_hz, double bin_hz) {
  const double quotient = doppler_hz / bin_hz;
  // Beyond, neither the borders of a bin nor its number can be told apart.
  if (!(std::abs(quotient) < 0x1.0p51)) throw std::invalid_argument("the Doppler bin is too narrow for the shifts");
  double index = std::floor(quotient + 0.5);
  if ((index - 0.5) * bin_hz > doppler_hz) index -= 1.0;
  if ((index + 0.5) * bin_hz <= doppler_hz) index += 1.0;
  return static_cast<std::int64_t>(index);
}

}  // namespace detail

/// The bins that hold power, by ascending shift; together they hold all of it. Bin n is centred on n·bin_hz and covers
/// n·bin_hz − bin_hz/2 ≤ f < n·bin_hz + bin_hz/2, so what does not move is in the middle of bin 0. Throws
/// std::invalid_argument unless bin_hz is finite and > 0 and every shift is less than 2^51 bins.
inline std::vector<DopplerBin> doppler_spectrum(std::span<const PowerSample> samples, double bin_hz) {
  if (!(bin_hz > 0.0) || !std::isfinite(bin_hz)) {
    throw std::invalid_argument("the width of a Doppler bin must be finite and greater than 0");
  }
  std::map<std::int64_t, double> powers;
  for (const PowerSample& sample : samples) {
    if (sample.power_ratio > 0.0) {
      powers[detail::doppler_bin_index(sample.doppler_hz, bin_hz)] += sample.power_ratio;
    }
  }
  std::vector<DopplerBin> bins;
  for (const auto& [index, power_ratio] : powers) bins.push_back({static_cast<double>(index) * bin_hz, power_ratio});
  return bins;
}

}  // namespace dcem
