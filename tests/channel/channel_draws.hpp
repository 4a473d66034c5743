#pragma once
/// Channels drawn at random: powers over three decades, any phase, any direction.
#include <cstddef>
#include <vector>

#include "dcem/field/power_sample.hpp"
#include "tests/paths/small_scenes.hpp"

namespace dcem::test {

inline Direction drawn_direction(Draw& draw) {
  return {draw.between(-pi, pi), draw.between(0.0, pi)};
}

/// One draw after the other: the operands of a product have no order of their own.
inline Complex drawn_amplitude(Draw& draw) {
  const double length = draw.magnitude(1e-6, 3e-5);
  return length * unit_phasor(draw.between(-pi, pi));
}

/// Delays between `first_s` and `first_s + span_s`.
inline std::vector<PathContribution> drawn_paths(Draw& draw, std::size_t count, double first_s, double span_s) {
  std::vector<PathContribution> paths(count);
  for (PathContribution& path : paths) {
    path.amplitude = drawn_amplitude(draw);
    path.ports(0, 0) = path.amplitude;
    path.power_ratio = std::norm(path.amplitude);
    path.delay_s = first_s + draw.between(0.0, span_s);
    path.doppler_hz = draw.between(-3e3, 3e3);
    path.departure = drawn_direction(draw);
    path.arrival = drawn_direction(draw);
  }
  return paths;
}

/// The same between two dual-polarized antennas.
inline std::vector<PathContribution> drawn_dual_paths(Draw& draw, std::size_t count, double first_s, double span_s) {
  std::vector<PathContribution> paths = drawn_paths(draw, count, first_s, span_s);
  for (PathContribution& path : paths) {
    path.amplitude = {};
    path.has_amplitude = false;
    path.transmit_ports = 2;
    for (std::size_t out = 0; out < 2; ++out) {
      for (std::size_t in = 0; in < 2; ++in) path.ports(out, in) = drawn_amplitude(draw);
    }
    path.power_ratio = norm_squared(path.ports) / 2.0;
  }
  return paths;
}

inline std::vector<PowerSample> power_samples(const std::vector<PathContribution>& paths) {
  std::vector<PowerSample> samples;
  for (const PathContribution& path : paths) samples.push_back(power_sample(path));
  return samples;
}

inline double total_power(const std::vector<PowerSample>& samples) {
  double sum = 0.0;
  for (const PowerSample& sample : samples) sum += sample.power_ratio;
  return sum;
}

}  // namespace dcem::test
