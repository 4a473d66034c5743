#pragma once
/// Power over delay as a receiver of limited bandwidth sees it.
///
/// A receiver that measures H(f) at N frequencies B/N apart (FrequencyGrid, N odd) and transforms it back sees taps at
/// multiples of the bin 1/B. A path of amplitude h and delay τ stands in all of them, weighted by the Dirichlet kernel:
///   h[n] = Σ h D_N(n − τB),  D_N(x) = sin(πx)/(N sin(πx/N)),
/// n the number of the tap, counted from delay 0. D_N is 1 at 0, 0 at the other taps and has the period N; away from
/// its peak it falls as 1/x. Because this is a discrete Fourier transform, energy is conserved:
///   Σ_n |h[n]|² = (1/N) Σ_k |H(f_k)|²,
/// which is not Σ|h|²: paths closer than a bin interfere. Σ_n D_N(n − x)² = 1 for every x; diffuse power, whose phase
/// is random, adds P·D_N² to each tap and stays the same in sum.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/field/power_sample.hpp"

namespace dcem {

/// One tap of the profile.
struct BandLimitedTap {
  double delay_s = 0.0;               ///< a multiple of the bin; may lie before the first path, and below 0
  double specular_power_ratio = 0.0;  ///< |h[n]|²; with dual ports summed over receive, averaged over transmit ports
  double diffuse_power_ratio = 0.0;   ///< Σ P·D_N²
};

/// Taps before the first delay and after the last.
inline constexpr std::int64_t band_limited_guard_taps = 32;
/// More taps than this are refused.
inline constexpr std::int64_t band_limited_max_taps = std::int64_t{1} << 20;

/// The profile of one link for the bandwidth B = 1/bin_s: the paths' fields are added (port by port, as in
/// PathContribution::ports), the diffuse samples' powers. N is the smallest odd number of taps that reaches from the
/// first delay to the last with 32 taps more on both sides (an end within 1e-6 bins of a tap counts as on it). All N
/// taps are returned, by delay, those that hold 0 too; none where there are neither paths nor samples.
/// Throws std::invalid_argument unless bin_s is finite and > 0 and N is at most 2^20.
std::vector<BandLimitedTap> band_limited_profile(std::span<const PathContribution> paths,
                                                 std::span<const PowerSample> diffuse, double bin_s);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// A delay in bins: the nearest whole number and the rest, |fraction| ≤ ½ but for rounding. The rest is taken from the
/// delay itself: the quotient of a delay of 1e5 bins would leave it eleven digits.
struct TapPosition {
  TapPosition(double delay_s, double bin_s) {
    const double whole = std::round(delay_s / bin_s);
    if (!(std::abs(whole) < 0x1.0p51)) throw std::invalid_argument("the bin is too narrow for the delays");
    tap = static_cast<std::int64_t>(whole);
    fraction = std::fma(-whole, bin_s, delay_s) / bin_s;
  }
  std::int64_t tap = 0;
  double fraction = 0.0;
};

/// The taps first … first + count − 1.
struct TapRange {
  std::int64_t first = 0, count = 0;
};

/// The taps from the smallest delay of both kinds of contributions to the largest, with the guards.
inline TapRange tap_range(std::span<const PathContribution> paths, std::span<const PowerSample> diffuse, double bin_s) {
  double first_s = paths.empty() ? diffuse.front().delay_s : paths.front().delay_s, last_s = first_s;
  const auto include = [&](double delay_s) {
    first_s = std::min(first_s, delay_s);
    last_s = std::max(last_s, delay_s);
  };
  for (const PathContribution& path : paths) include(path.delay_s);
  for (const PowerSample& sample : diffuse) include(sample.delay_s);
  const TapPosition low(first_s, bin_s), high(last_s, bin_s);
  // Rounding of a delay that was meant to be on a tap must not change the number of taps.
  constexpr double on_tap = 1e-6;
  const std::int64_t begin = low.tap - (low.fraction < -on_tap ? 1 : 0) - band_limited_guard_taps;
  const std::int64_t end = high.tap + (high.fraction > on_tap ? 1 : 0) + band_limited_guard_taps;
  const std::int64_t count = (end - begin + 1) | 1;
  if (count > band_limited_max_taps) throw std::invalid_argument("the bin is too narrow for the span of delays");
  return {begin, count};
}

/// D_N at whole steps from a position between taps.
class DirichletKernel {
 public:
  /// `count` is N, odd.
  explicit DirichletKernel(std::int64_t count) : count_(count), steps_(static_cast<std::size_t>(count / 2 + 1)) {
    for (std::size_t m = 0; m < steps_.size(); ++m) {
      const double angle_rad = pi * static_cast<double>(m) / static_cast<double>(count);
      steps_[m] = {std::sin(angle_rad), std::cos(angle_rad)};
    }
  }

  /// Calls action(n, D_N(n − tap − fraction)) for n = 0 … N − 1, in another order; 0 ≤ tap < N, |fraction| ≤ ½.
  /// With m = n − tap brought into −N/2 … N/2 by the kernel's period, sin(π(m − fraction)) = −(−1)^m sin(π·fraction):
  /// one sine serves all taps. The difference in the denominator cancels at most a factor of 3.
  template <typename Action>
  void for_each_tap(std::int64_t tap, double fraction, Action&& action) const {
    const double n = static_cast<double>(count_);
    const double numerator = std::sin(pi * fraction) / n;
    const double s = std::sin(pi * fraction / n), c = std::cos(pi * fraction / n);
    // Below 1e-9 the peak differs from 1 by less than the rounding of 1.
    action(static_cast<std::size_t>(tap), std::abs(fraction) < 1e-9 ? 1.0 : numerator / s);
    for (std::int64_t m = 1; m <= count_ / 2; ++m) {
      const Step& step = steps_[static_cast<std::size_t>(m)];
      const double odd = m % 2 == 0 ? -numerator : numerator;
      action(wrapped(tap + m), odd / (step.sine * c - step.cosine * s));
      action(wrapped(tap - m), -odd / (step.sine * c + step.cosine * s));
    }
  }

 private:
  struct Step {
    double sine = 0.0, cosine = 0.0;  // of πm/N
  };

  std::size_t wrapped(std::int64_t tap) const {
    return static_cast<std::size_t>(tap < 0 ? tap + count_ : tap >= count_ ? tap - count_ : tap);
  }

  std::int64_t count_;
  std::vector<Step> steps_;
};

inline void add_scaled(ComplexMatrix2& sum, double factor, const ComplexMatrix2& matrix) {
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t column = 0; column < 2; ++column) sum(row, column) += factor * matrix(row, column);
  }
}

inline std::vector<ComplexMatrix2> band_limited_fields(std::span<const PathContribution> paths,
                                                       const DirichletKernel& kernel, const TapRange& range,
                                                       double bin_s) {
  std::vector<ComplexMatrix2> fields(static_cast<std::size_t>(range.count));
  for (const PathContribution& path : paths) {
    const TapPosition position(path.delay_s, bin_s);
    kernel.for_each_tap(position.tap - range.first, position.fraction,
                        [&](std::size_t tap, double weight) { add_scaled(fields[tap], weight, path.ports); });
  }
  return fields;
}

}  // namespace detail

inline std::vector<BandLimitedTap> band_limited_profile(std::span<const PathContribution> paths,
                                                        std::span<const PowerSample> diffuse, double bin_s) {
  if (!(bin_s > 0.0) || !std::isfinite(bin_s)) throw std::invalid_argument("a bin must be finite and wider than 0");
  if (paths.empty() && diffuse.empty()) return {};
  const detail::TapRange range = detail::tap_range(paths, diffuse, bin_s);
  const detail::DirichletKernel kernel(range.count);
  const std::vector<ComplexMatrix2> fields = detail::band_limited_fields(paths, kernel, range, bin_s);
  const int transmit_ports = paths.empty() ? 1 : paths.front().transmit_ports;
  std::vector<BandLimitedTap> taps(fields.size());
  for (std::size_t tap = 0; tap < taps.size(); ++tap) {
    taps[tap].delay_s = static_cast<double>(range.first + static_cast<std::int64_t>(tap)) * bin_s;
    taps[tap].specular_power_ratio = norm_squared(fields[tap]) / transmit_ports;
  }
  for (const PowerSample& sample : diffuse) {
    const detail::TapPosition position(sample.delay_s, bin_s);
    kernel.for_each_tap(position.tap - range.first, position.fraction, [&](std::size_t tap, double weight) {
      taps[tap].diffuse_power_ratio += sample.power_ratio * weight * weight;
    });
  }
  return taps;
}

}  // namespace dcem
