#pragma once
/// Power over delay.
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "dcem/channel/path_contribution.hpp"

namespace dcem {

/// How the paths that fall into one bin are added.
enum class PdpMode {
  incoherent,  ///< Σ|h|²
  coherent     ///< |Σh|²; dual-polarized links, which have no single h, add powers
};

/// One bin that holds power.
struct PdpTap {
  double delay_s = 0.0;      ///< lower edge of the bin: a multiple of the bin width
  double power_ratio = 0.0;  ///< received over transmitted power
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

/// The bins that hold at least one path, by delay. Bin n covers n·bin_s ≤ delay < (n + 1)·bin_s. Precondition: bin_s >
/// 0.
inline std::vector<PdpTap> power_delay_profile(std::span<const PathContribution> paths, double bin_s, PdpMode mode) {
  struct Bin {
    Complex field{};
    double power = 0.0;
  };
  std::map<std::int64_t, Bin> bins;
  for (const PathContribution& path : paths) {
    Bin& bin = bins[detail::bin_index(path.delay_s, bin_s)];
    if (mode == PdpMode::coherent && path.has_amplitude) {
      bin.field += path.amplitude;
    } else {
      bin.power += path.power_ratio;
    }
  }
  std::vector<PdpTap> taps;
  for (const auto& [index, bin] : bins) {
    taps.push_back({static_cast<double>(index) * bin_s, std::norm(bin.field) + bin.power});
  }
  return taps;
}

}  // namespace dcem
