#pragma once
/// Antennas: a pattern, a polarization, how they are mounted, and how many of them stand side by side.
///
/// The field of an antenna towards a direction is √(gain of the pattern there × gain) times the unit Jones vector of
/// its polarization, the same Jones vector in every direction, in (θ̂, φ̂) of the antenna's own axes. Such a field has no
/// limit at the antenna's poles (a tangential field on the sphere has a zero somewhere); where the pattern is not 0
/// there, the antenna is a device of bookkeeping, as in 3GPP TR 38.901 and Sionna RT. A half-wave dipole with vertical
/// polarization is a real one.
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <variant>

#include "dcem/core/error.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/antenna/antenna_array.hpp"
#include "dcem/em/antenna/antenna_pattern.hpp"
#include "dcem/em/antenna/polarization.hpp"
#include "dcem/geometry/pose.hpp"

namespace dcem {

/// How an antenna is turned against what carries it: yaw about z, then pitch about y (down positive), then roll about
/// x, as a pose turns. Local +x is the boresight.
struct Orientation {
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;

  friend bool operator==(const Orientation&, const Orientation&) = default;
};

/// Columns are the antenna's axes in those of its carrier.
inline Mat3 rotation_matrix(const Orientation& orientation) {
  return rotation_matrix(Pose{Vec3(0.0), orientation.yaw_rad, orientation.pitch_rad, orientation.roll_rad});
}

struct Antenna {
  double gain_dbi = 0.0;  ///< on top of the pattern's own gain
  Polarization polarization{};
  AntennaPattern pattern{};   ///< of one element
  Orientation orientation{};  ///< against the device that carries it; turns pattern, polarization and array
  AntennaArray array{};       ///< one element, or several that are all alike

  bool is_dual() const { return polarization.kind == PolarizationKind::dual; }

  /// 2 for `dual` (port 0 is V, port 1 is H), else 1.
  std::size_t port_count() const { return is_dual() ? 2 : 1; }

  /// The field of a port of one element towards an outgoing unit direction in the world, in (θ̂, φ̂) of the world: √gain
  /// times a unit Jones vector. `rotation` has the antenna's axes in the world as its columns (carrier times
  /// `orientation`: see RadioEnd); `port` < port_count().
  ///
  /// A rotation about z alone leaves the bases as they are and so changes no bit of the Jones vector; the pole rule
  /// then is the world's.
  JonesVector port_jones(const Vec3& direction, std::size_t port, const Mat3& rotation = Mat3(1.0)) const;

  /// The same for an antenna with one port; not for `dual`.
  JonesVector jones(const Vec3& direction, const Mat3& rotation = Mat3(1.0)) const {
    DCEM_ASSERT(!is_dual());
    return port_jones(direction, 0, rotation);
  }

  friend bool operator==(const Antenna&, const Antenna&) = default;
};

/// Throws std::invalid_argument when a number is not finite, a table is missing or the array is not one.
void validate(const Antenna& antenna);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Components along (θ̂, φ̂) of the world of a field that has the components `own` along those of the antenna. Both
/// pairs are right-handed about the same direction, so one is the other turned by an angle ψ about it.
inline JonesVector turned_jones(const JonesVector& own, const Mat3& rotation, const Vec3& local_direction,
                                const Vec3& direction) {
  if (rotation[2] == Vec3(0.0, 0.0, 1.0)) return own;
  const Vec3 own_theta = rotation * theta_hat(local_direction);
  const double cosine = glm::dot(own_theta, theta_hat(direction));
  const double sine = glm::dot(own_theta, phi_hat(direction));
  return {cosine * own[0] - sine * own[1], sine * own[0] + cosine * own[1]};
}

}  // namespace detail

inline JonesVector Antenna::port_jones(const Vec3& direction, std::size_t port, const Mat3& rotation) const {
  DCEM_ASSERT(port < port_count());
  const Vec3 local_direction = direction * rotation;  // the transpose times the direction
  if (const auto* own = std::get_if<UserPattern>(&pattern)) {
    const double gain = db_to_amplitude_ratio(gain_dbi);
    const JonesVector field = own->model->field(glm::normalize(local_direction), port);
    return detail::turned_jones({gain * field[0], gain * field[1]}, rotation, local_direction, direction);
  }
  const double amplitude = db_to_amplitude_ratio(gain_dbi) * std::sqrt(power_gain(pattern, local_direction));
  const JonesVector vertical_or_horizontal{port == 0 ? 1.0 : 0.0, port == 0 ? 0.0 : 1.0};
  const JonesVector jones = jones_vector(polarization).value_or(vertical_or_horizontal);
  return detail::turned_jones({amplitude * jones[0], amplitude * jones[1]}, rotation, local_direction, direction);
}

inline void validate(const Antenna& antenna) {
  if (!std::isfinite(antenna.gain_dbi)) throw std::invalid_argument("antenna: the gain must be finite");
  if (!std::isfinite(antenna.polarization.slant_angle_rad))
    throw std::invalid_argument("antenna: the slant angle must be finite");
  const Orientation& turned = antenna.orientation;
  if (!is_finite(Vec3(turned.yaw_rad, turned.pitch_rad, turned.roll_rad)))
    throw std::invalid_argument("antenna: the angles of its orientation must be finite");
  const auto* tabulated = std::get_if<TabulatedPattern>(&antenna.pattern);
  if (tabulated != nullptr && tabulated->table == nullptr)
    throw std::invalid_argument("antenna: its tabulated pattern has no table");
  const auto* own = std::get_if<UserPattern>(&antenna.pattern);
  if (own != nullptr && own->model == nullptr) throw std::invalid_argument("antenna: its own pattern has no model");
  if (own != nullptr && !(own->model->peak_power_gain() >= 0.0 && std::isfinite(own->model->peak_power_gain())))
    throw std::invalid_argument("antenna: the peak gain of its own pattern must be finite and not negative");
  validate(antenna.array);
}

}  // namespace dcem
