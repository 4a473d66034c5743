#pragma once
/// What one path brings to a link.
#include "dcem/em/complex.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

/// A direction that points away from a device.
struct Direction {
  double azimuth_rad = 0.0;  ///< from +x towards +y, in (−π, π]
  double zenith_rad = 0.0;   ///< from +z, in [0, π]
};

/// A path with its field. Power is relative to the power fed into the transmitting antenna.
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
  double power_ratio = 0.0;  ///< |amplitude|²; with dual ports summed over receive and averaged over transmit ports
  double delay_s = 0.0;
  double doppler_hz = 0.0;  ///< positive when the path shortens
  Direction departure;
  Direction arrival;
};

}  // namespace dcem
