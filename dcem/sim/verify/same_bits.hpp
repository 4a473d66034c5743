#pragma once
/// Whether two results are the same to the last bit.
#include <algorithm>
#include <bit>
#include <cstdint>

#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

inline bool same_bits(const Path& a, const Path& b) {
  return same_sequence(a, b) && same_bits(a.length_m, b.length_m) &&
         std::equal(a.foliage.begin(), a.foliage.end(), b.foliage.begin(), b.foliage.end(),
                    [](const FoliageLength& x, const FoliageLength& y) {
                      return x.material == y.material && same_bits(x.length_m, y.length_m);
                    }) &&
         std::equal(a.interactions.begin(), a.interactions.end(), b.interactions.begin(),
                    [](const Interaction& x, const Interaction& y) { return same_bits(x.point_m, y.point_m); });
}

inline bool same_bits(const Complex& a, const Complex& b) {
  return same_bits(a.real(), b.real()) && same_bits(a.imag(), b.imag());
}

inline bool same_bits(const ComplexMatrix2& a, const ComplexMatrix2& b) {
  return same_bits(a(0, 0), b(0, 0)) && same_bits(a(0, 1), b(0, 1)) && same_bits(a(1, 0), b(1, 0)) &&
         same_bits(a(1, 1), b(1, 1));
}

inline bool same_bits(const Direction& a, const Direction& b) {
  return same_bits(a.azimuth_rad, b.azimuth_rad) && same_bits(a.zenith_rad, b.zenith_rad);
}

inline bool same_bits(const ChannelMatrix& a, const ChannelMatrix& b) {
  if (a.rows() != b.rows() || a.columns() != b.columns()) return false;
  for (std::size_t row = 0; row < a.rows(); ++row) {
    for (std::size_t column = 0; column < a.columns(); ++column) {
      if (!same_bits(a(row, column), b(row, column))) return false;
    }
  }
  return true;
}

inline bool same_bits(const PathContribution& a, const PathContribution& b) {
  return same_bits(a.path, b.path) && same_bits(a.transfer, b.transfer) && same_bits(a.ports, b.ports) &&
         same_bits(a.channel, b.channel) && same_bits(a.amplitude, b.amplitude) && a.has_amplitude == b.has_amplitude &&
         a.transmit_ports == b.transmit_ports && same_bits(a.power_ratio, b.power_ratio) &&
         same_bits(a.delay_s, b.delay_s) && same_bits(a.doppler_hz, b.doppler_hz) &&
         same_bits(a.departure, b.departure) && same_bits(a.arrival, b.arrival);
}

/// Of two solutions of a link; statistics are made of the paths and of diffuse power.
inline bool same_bits(const LinkResult& a, const LinkResult& b) {
  return a.transmitter == b.transmitter && a.receiver == b.receiver && a.complete == b.complete &&
         a.statistics.line_of_sight == b.statistics.line_of_sight &&
         same_bits(a.diffuse.power_ratio, b.diffuse.power_ratio) &&
         std::equal(a.paths.begin(), a.paths.end(), b.paths.begin(), b.paths.end(),
                    [](const PathContribution& x, const PathContribution& y) { return same_bits(x, y); });
}

}  // namespace dcem::detail
