#pragma once
/// What one path brings to a link.
#include <cstddef>
#include <vector>

#include "dcem/em/complex.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

/// A direction that points away from a device.
struct Direction {
  double azimuth_rad = 0.0;  ///< from +x towards +y, in (−π, π]
  double zenith_rad = 0.0;   ///< from +z, in [0, π]
};

/// What a path brings from each transmitting to each receiving element. An element with two ports (VH) counts twice:
/// index = element·2 + port. Empty (no rows) where both ends are single elements.
class ChannelMatrix {
 public:
  ChannelMatrix() = default;
  ChannelMatrix(std::size_t rows, std::size_t columns) : columns_(columns), entries_(rows * columns) {}

  bool empty() const { return entries_.empty(); }
  std::size_t rows() const { return columns_ == 0 ? 0 : entries_.size() / columns_; }  ///< receiving elements
  std::size_t columns() const { return columns_; }                                     ///< transmitting elements
  Complex& operator()(std::size_t row, std::size_t column) { return entries_[row * columns_ + column]; }
  const Complex& operator()(std::size_t row, std::size_t column) const { return entries_[row * columns_ + column]; }
  friend bool operator==(const ChannelMatrix&, const ChannelMatrix&) = default;

 private:
  std::size_t columns_ = 0;
  std::vector<Complex> entries_;
};

/// A path with its field. Power is relative to the power fed into the transmitting antenna. Of an array, everything but
/// `channel` is that of one element at the array's centre: `amplitude`, powers and what is made of them know no beam.
struct PathContribution {
  Path path;
  /// [receive component][transmit component], each in (θ̂, φ̂) of the outgoing direction at the device; holds λ/(4πL),
  /// every coefficient, close-in excess and exp(−jkL).
  ComplexMatrix2 transfer{};
  /// `transfer` between the two Jones vectors and antenna gains. Not meaningful where `has_amplitude` is false.
  Complex amplitude{};
  bool has_amplitude = true;  ///< false where an antenna is dual-polarized: there is a matrix, not a number
  /// [receive port][transmit port]; a dual-polarized antenna has two ports, any other the first alone.
  ComplexMatrix2 ports{};
  int transmit_ports = 1;
  /// [receiving element][transmitting element], where an end is an array.
  ChannelMatrix channel{};
  double power_ratio = 0.0;  ///< |amplitude|²; with dual ports summed over receive and averaged over transmit ports
  double delay_s = 0.0;
  double doppler_hz = 0.0;  ///< positive when the path shortens
  Direction departure;
  Direction arrival;
};

}  // namespace dcem
