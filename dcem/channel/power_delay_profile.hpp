#pragma once
/// Power over delay.
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "dcem/channel/band_limited_profile.hpp"
#include "dcem/channel/pdp_mode.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/field/power_sample.hpp"

namespace dcem {

/// One bin that holds power.
struct PdpTap {
  double delay_s = 0.0;              ///< lower edge of the bin, a multiple of its width; band-limited: the tap itself
  double power_ratio = 0.0;          ///< received over transmitted power, diffuse power included
  double diffuse_power_ratio = 0.0;  ///< the share of rough surfaces in it
};

namespace detail {

/// Number n of the bin with n·bin_s ≤ delay < (n + 1)·bin_s, as these products come out in double: a delay that is a
/// multiple of the bin is in its own bin, whatever the quotient rounds to.
inline std::int64_t bin_index(double delay_s, double bin_s) {
  auto index = static_cast<std::int64_t>(std::floor(delay_s / bin_s));
  if (static_cast<double>(index) * bin_s > delay_s) --index;
  if (static_cast<double>(index + 1) * bin_s <= delay_s) ++index;
  return index;
}

}  // namespace detail

namespace detail {

inline std::vector<PdpTap> binned_profile(std::span<const PathContribution> paths, std::span<const PowerSample> diffuse,
                                          double bin_s, bool coherent) {
  struct Bin {
    Complex field{};
    double power = 0.0, diffuse = 0.0;
  };
  std::map<std::int64_t, Bin> bins;
  for (const PathContribution& path : paths) {
    Bin& bin = bins[bin_index(path.delay_s, bin_s)];
    if (coherent && path.has_amplitude) {
      bin.field += path.amplitude;
    } else {
      bin.power += path.power_ratio;
    }
  }
  for (const PowerSample& sample : diffuse) bins[bin_index(sample.delay_s, bin_s)].diffuse += sample.power_ratio;
  std::vector<PdpTap> taps;
  for (const auto& [index, bin] : bins) {
    const double specular = std::norm(bin.field) + bin.power;
    taps.push_back({static_cast<double>(index) * bin_s, specular + bin.diffuse, bin.diffuse});
  }
  return taps;
}

}  // namespace detail

/// The bins that hold a path or diffuse power, by delay. Bin n covers n·bin_s ≤ delay < (n + 1)·bin_s; what
/// band-limited bins hold and which there are, see band_limited_profile(). Precondition: bin_s > 0.
inline std::vector<PdpTap> power_delay_profile(std::span<const PathContribution> paths,
                                               std::span<const PowerSample> diffuse, double bin_s, PdpMode mode) {
  if (mode != PdpMode::band_limited) return detail::binned_profile(paths, diffuse, bin_s, mode == PdpMode::coherent);
  std::vector<PdpTap> taps;
  for (const BandLimitedTap& tap : band_limited_profile(paths, diffuse, bin_s)) {
    taps.push_back({tap.delay_s, tap.specular_power_ratio + tap.diffuse_power_ratio, tap.diffuse_power_ratio});
  }
  return taps;
}

/// The same of paths alone.
inline std::vector<PdpTap> power_delay_profile(std::span<const PathContribution> paths, double bin_s, PdpMode mode) {
  return power_delay_profile(paths, {}, bin_s, mode);
}

}  // namespace dcem
