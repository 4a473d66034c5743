#pragma once
/// Directions and polarization at an antenna.
///
/// Every direction here points OUT of the antenna: at the transmitter along the departing ray, at the receiver towards
/// the last point of the path. Azimuth φ is counted from +x towards +y, zenith θ from +z, and
///   θ̂ = (cos θ cos φ, cos θ sin φ, −sin θ),  φ̂ = (−sin φ, cos φ, 0),  θ̂ × φ̂ = d.
/// Seen from the two ends of a line θ̂(−d) = θ̂(d) and φ̂(−d) = −φ̂(d). Pole rule: for d = ±z, φ = 0; there θ̂ = ±x and
/// φ̂ = y, so that at the poles alone it is θ̂ that changes its sign between the two ends.
#include <cmath>
#include <cstdint>
#include <optional>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"

namespace dcem {

namespace detail {

struct HorizontalDirection {
  double cosine, sine;  ///< of the azimuth
};

inline HorizontalDirection horizontal_direction(const Vec3& direction) {
  double x = direction.x;
  double y = direction.y;
  // Next to the pole the quotients below would be taken between numbers that have lost their digits.
  if (std::hypot(x, y) < 1e-290) {
    x *= 1e300;
    y *= 1e300;
  }
  const double horizontal = std::hypot(x, y);
  if (horizontal == 0.0) return {1.0, 0.0};
  return {x / horizontal, y / horizontal};
}

}  // namespace detail

/// Azimuth in (−π, π]; 0 at the poles. `direction` of any length but 0.
inline double azimuth_rad(const Vec3& direction) {
  if (direction.x == 0.0 && direction.y == 0.0) return 0.0;
  const double azimuth = std::atan2(direction.y, direction.x);
  return azimuth <= -pi ? pi : azimuth;  // −x has one azimuth, whatever the sign of a zero or rounded y
}

/// Zenith angle in [0, π]: 0 is up. `direction` of any length but 0.
inline double zenith_rad(const Vec3& direction) {
  return std::atan2(std::hypot(direction.x, direction.y), direction.z);
}

/// Unit vector of growing zenith angle at the outgoing direction (any length but 0).
inline Vec3 theta_hat(const Vec3& direction) {
  const double length = std::hypot(direction.x, direction.y, direction.z);
  DCEM_ASSERT(length > 0.0);
  const auto [cos_azimuth, sin_azimuth] = detail::horizontal_direction(direction);
  const double cos_zenith = direction.z / length;
  const double sin_zenith = std::hypot(direction.x, direction.y) / length;
  return {cos_zenith * cos_azimuth, cos_zenith * sin_azimuth, -sin_zenith};
}

/// Unit vector of growing azimuth at the outgoing direction.
inline Vec3 phi_hat(const Vec3& direction) {
  const auto [cos_azimuth, sin_azimuth] = detail::horizontal_direction(direction);
  return {-sin_azimuth, cos_azimuth, 0.0};
}

/// Field components along (θ̂, φ̂) of the outgoing direction.
using JonesVector = ComplexVector2;

enum class PolarizationKind : std::uint8_t {
  vertical,        ///< V: θ̂, (1, 0)
  horizontal,      ///< H: φ̂, (0, 1)
  slant,           ///< (cos ζ, sin ζ)
  right_circular,  ///< RHC: (1, −j)/√2
  left_circular,   ///< LHC: (1, +j)/√2
  dual             ///< VH: two ports, V and H; the 2×2 transfer itself is what is wanted
};

struct Polarization {
  PolarizationKind kind = PolarizationKind::vertical;
  double slant_angle_rad = 0.0;  ///< ζ, from θ̂ towards φ̂; only for slant

  friend bool operator==(const Polarization&, const Polarization&) = default;
};

/// The unit Jones vector of a polarization; nothing for `dual`, which has two (see Antenna::port_jones).
inline std::optional<JonesVector> jones_vector(const Polarization& polarization) {
  const double half = std::sqrt(0.5);
  switch (polarization.kind) {
    case PolarizationKind::vertical:
      return JonesVector{1.0, 0.0};
    case PolarizationKind::horizontal:
      return JonesVector{0.0, 1.0};
    case PolarizationKind::slant:
      return JonesVector{std::cos(polarization.slant_angle_rad), std::sin(polarization.slant_angle_rad)};
    case PolarizationKind::right_circular:
      return JonesVector{half, Complex(0.0, -half)};
    case PolarizationKind::left_circular:
      return JonesVector{half, Complex(0.0, half)};
    case PolarizationKind::dual:
      break;
  }
  return std::nullopt;
}

/// What a receiving port makes of a transfer matrix and a transmitting port: c_rxᵀ·T·c_tx, both vectors in (θ̂, φ̂) of
/// the direction out of their antenna, each as its antenna would transmit. No conjugate: an antenna answers to a field
/// E with E·c (reciprocity theorem), so that swapping the ends, which transposes T, changes nothing, and on a line of
/// sight RHC hears RHC. Texts that write c_rxᴴ mean by c_rx the incident field; for linear polarizations it is the
/// same.
inline Complex port_coupling(const JonesVector& receive, const ComplexMatrix2& transfer, const JonesVector& transmit) {
  const ComplexVector2 field = transfer * transmit;
  return receive[0] * field[0] + receive[1] * field[1];
}

}  // namespace dcem
