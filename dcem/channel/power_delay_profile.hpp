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

/// The bins that hold at least one path, by delay. Bin n covers n·bin_s ≤ delay < (n + 1)·bin_s. Precondition: bin_s >
/// 0.
inline std::vector<PdpTap> power_delay_profile(std::span<const PathContribution> paths, double bin_s, PdpMode mode) {
  struct Bin {
    Complex field{};
    double power = 0.0;
  };
  std::map<std::int64_t, Bin> bins;
  for (const PathContribution& path : paths) {
    Bin& bin = bins[static_cast<std::int64_t>(std::floor(path.delay_s / bin_s))];
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
