#pragma once
/// Antennas. In this version the pattern is isotropic: the same gain and polarization in every direction. Such a vector
/// antenna does not exist (a tangential field on the sphere has a zero somewhere); it is a device of bookkeeping.
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "dcem/core/error.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/polarization.hpp"

namespace dcem {

struct Antenna {
  double gain_dbi = 0.0;
  Polarization polarization;

  bool is_dual() const { return polarization.kind == PolarizationKind::dual; }

  /// 2 for `dual` (port 0 is V, port 1 is H), else 1.
  std::size_t port_count() const { return is_dual() ? 2 : 1; }

  /// √gain times the unit Jones vector of a port, towards an outgoing direction; `port` < port_count().
  JonesVector port_jones(const Vec3& direction, std::size_t port) const;

  /// The same for an antenna with one port; not for `dual`.
  JonesVector jones(const Vec3& direction) const {
    DCEM_ASSERT(!is_dual());
    return port_jones(direction, 0);
  }

  friend bool operator==(const Antenna&, const Antenna&) = default;
};

inline JonesVector Antenna::port_jones(const Vec3& /*direction*/, std::size_t port) const {
  DCEM_ASSERT(port < port_count());
  const double amplitude = db_to_amplitude_ratio(gain_dbi);
  const JonesVector vertical_or_horizontal{port == 0 ? 1.0 : 0.0, port == 0 ? 0.0 : 1.0};
  const JonesVector jones = jones_vector(polarization).value_or(vertical_or_horizontal);
  return {amplitude * jones[0], amplitude * jones[1]};
}

/// Throws std::invalid_argument when the gain or the slant angle is not finite.
inline void validate(const Antenna& antenna) {
  if (!std::isfinite(antenna.gain_dbi)) throw std::invalid_argument("antenna: the gain must be finite");
  if (!std::isfinite(antenna.polarization.slant_angle_rad))
    throw std::invalid_argument("antenna: the slant angle must be finite");
}

}  // namespace dcem
