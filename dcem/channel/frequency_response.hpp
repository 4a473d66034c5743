#pragma once
/// The channel over a band of frequencies, and over delay as a sum of impulses.
///
///   H(f) = Σ h exp(−j2π(f − f0)τ)
/// over the paths of a link, h their complex amplitudes at the frequency f0 of the simulation (which hold exp(−j2πf0τ)
/// already), τ their delays. Spreading and coefficients are those at f0 for the whole band: right where they change
/// little over it. Diffuse power has no phase and no place here.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/field/path_contribution.hpp"

namespace dcem {

/// The middles of `points` equal parts of the band, ascending and symmetrical about its centre:
///   f_k = f0 + (k − (N − 1)/2)·B/N,  k = 0 … N − 1.
/// They reach from f0 − B/2 + B/(2N) to f0 + B/2 − B/(2N). With an odd N the middle one is f0, with N = 1 the only one.
struct FrequencyGrid {
  double centre_hz = 0.0;     ///< f0, the frequency for which the paths were computed
  double bandwidth_hz = 0.0;  ///< B
  std::size_t points = 1;     ///< N

  /// f_k − f0: free of the rounding that f_k itself has at tens of gigahertz.
  double offset_hz(std::size_t k) const {
    const double steps = static_cast<double>(k) - 0.5 * (static_cast<double>(points) - 1.0);
    return steps * bandwidth_hz / static_cast<double>(points);
  }
  double frequency_hz(std::size_t k) const { return centre_hz + offset_hz(k); }
};

/// H(f_k) of a link whose two antennas have one port each. Without paths all zeros. Throws std::invalid_argument for a
/// path without an amplitude (a dual-polarized antenna: port_frequency_response) and for a grid without points or with
/// a bandwidth that is negative or not finite.
std::vector<Complex> frequency_response(std::span<const PathContribution> paths, const FrequencyGrid& grid);

/// H(f_k) from transmit port to receive port, [receive port][transmit port] as in PathContribution::ports. For every
/// link; entries of ports that an antenna does not have are 0. Throws std::invalid_argument for such a grid.
std::vector<ComplexMatrix2> port_frequency_response(std::span<const PathContribution> paths, const FrequencyGrid& grid);

/// One impulse: h δ(t − τ).
struct ImpulseTap {
  double delay_s = 0.0;
  Complex amplitude{};
};

/// An impulse per path, by delay, paths of one delay in their order. H(f0 + ν) = Σ amplitude·exp(−j2πν·delay). Throws
/// std::invalid_argument for a path without an amplitude.
std::vector<ImpulseTap> impulse_response(std::span<const PathContribution> paths);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// exp(−j2π·offset·delay). Whole cycles are taken off before the angle is formed, and what the rounding of the product
/// took from it is put back: the phase of a path of many cycles is as good as that of a short one.
inline Complex delay_phasor(double offset_hz, double delay_s) {
  const double cycles = offset_hz * delay_s;
  const double rounding = std::fma(offset_hz, delay_s, -cycles);
  return unit_phasor(-2.0 * pi * ((cycles - std::round(cycles)) + rounding));
}

inline void check_amplitudes(std::span<const PathContribution> paths) {
  const auto has_amplitude = [](const PathContribution& path) { return path.has_amplitude; };
  if (!std::all_of(paths.begin(), paths.end(), has_amplitude)) {
    throw std::invalid_argument("a link with a dual-polarized antenna has a matrix, not an amplitude");
  }
}

/// Σ coefficient(path)·exp(−j2π(f_k − f0)τ) for each k.
template <typename Value, typename Coefficient>
std::vector<Value> sum_over_band(std::span<const PathContribution> paths, const FrequencyGrid& grid,
                                 Coefficient&& coefficient) {
  if (grid.points == 0 || !(grid.bandwidth_hz >= 0.0) || !std::isfinite(grid.bandwidth_hz)) {
    throw std::invalid_argument("a frequency grid needs a point and a finite bandwidth of at least 0");
  }
  std::vector<Value> response(grid.points);
  for (std::size_t k = 0; k < grid.points; ++k) {
    const double offset_hz = grid.offset_hz(k);
    for (const PathContribution& path : paths) {
      response[k] = response[k] + delay_phasor(offset_hz, path.delay_s) * coefficient(path);
    }
  }
  return response;
}

}  // namespace detail

inline std::vector<Complex> frequency_response(std::span<const PathContribution> paths, const FrequencyGrid& grid) {
  detail::check_amplitudes(paths);
  return detail::sum_over_band<Complex>(paths, grid, [](const PathContribution& path) { return path.amplitude; });
}

inline std::vector<ComplexMatrix2> port_frequency_response(std::span<const PathContribution> paths,
                                                           const FrequencyGrid& grid) {
  return detail::sum_over_band<ComplexMatrix2>(paths, grid, [](const PathContribution& path) { return path.ports; });
}

inline std::vector<ImpulseTap> impulse_response(std::span<const PathContribution> paths) {
  detail::check_amplitudes(paths);
  std::vector<ImpulseTap> taps;
  for (const PathContribution& path : paths) taps.push_back({path.delay_s, path.amplitude});
  std::stable_sort(taps.begin(), taps.end(),
                   [](const ImpulseTap& a, const ImpulseTap& b) { return a.delay_s < b.delay_s; });
  return taps;
}

}  // namespace dcem
