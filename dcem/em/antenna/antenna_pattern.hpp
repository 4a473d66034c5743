#pragma once
/// How much power an antenna sends where: its gain over the directions of its own axes.
///
/// Directions are those of the antenna: azimuth φ from local +x towards local +y, in (−π, π]; zenith θ from local +z,
/// in [0, π]; at the poles φ = 0, as in polarization.hpp. A gain is a power ratio to an isotropic antenna that is fed
/// the same. A pattern has no polarization and no phase: those are the antenna's (antenna.hpp).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/antenna/pattern_table.hpp"
#include "dcem/em/antenna/polarization.hpp"
#include "dcem/em/antenna/user_pattern.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Gain 1 in every direction. Radiates what it is fed: its radiated share is 1.
struct IsotropicPattern {
  friend bool operator==(const IsotropicPattern&, const IsotropicPattern&) = default;
};

/// A thin half-wave dipole along local z, without loss: G = D·(cos(π/2·cos θ)/sin θ)².
/// D = 4/Cin(2π) = 1.64092 (2.15 dBi), because ∫ cos²(π/2·cos θ)/sin θ dθ over [0, π] is Cin(2π)/2, with
/// Cin(x) = ∫ (1 − cos t)/t dt over [0, x]. Source: Balanis, Antenna Theory, 3rd ed., eqs. (4-84) to (4-91).
/// G is 0 along the wire. Its radiated share is 1.
struct HalfWaveDipole {
  friend bool operator==(const HalfWaveDipole&, const HalfWaveDipole&) = default;
};

/// The element of 3GPP TR 38.901, Table 7.3-1, boresight along local +x. In dB, angles in degrees:
///   A_V = min(12·((θ − 90)/65)², 30), A_H = min(12·(φ/65)², 30), G = 8 − min(A_V + A_H, 30).
/// A model of a panel's element, not a solution of Maxwell's equations: its integral over the sphere is 0.6568·4π, so
/// 0.6568 of the power (−1.83 dB) is radiated and the rest is taken as lost in the antenna. At the poles φ = 0.
struct Tr38901Element {
  friend bool operator==(const Tr38901Element&, const Tr38901Element&) = default;
};

/// Gains from a table, which any number of antennas share. Its radiated share is what the table says: `radiated_share`.
struct TabulatedPattern {
  std::shared_ptr<const PatternTable> table;  ///< never empty in an antenna that `validate` has passed

  friend bool operator==(const TabulatedPattern&, const TabulatedPattern&) = default;
};

/// The built-in patterns, and one for those of the caller's own.
using AntennaPattern = std::variant<IsotropicPattern, HalfWaveDipole, Tr38901Element, TabulatedPattern, UserPattern>;

/// Directivity of the half-wave dipole, 4/Cin(2π).
inline constexpr double half_wave_dipole_directivity = 1.6409223769845851836;

/// Power gain (linear) towards a direction: any azimuth, zenith in [0, π]. Finite and not negative.
double power_gain(const AntennaPattern& pattern, double azimuth_rad, double zenith_rad);

/// Power gain (linear) towards a direction of any length but 0, in the antenna's axes.
double power_gain(const AntennaPattern& pattern, const Vec3& local_direction);

/// The largest power gain (linear) of all directions.
inline double peak_power_gain(const AntennaPattern& pattern) {
  if (const auto* own = std::get_if<UserPattern>(&pattern)) return own->model->peak_power_gain();
  const auto* tabulated = std::get_if<TabulatedPattern>(&pattern);
  // The others look along +x, or are the same all around z.
  return tabulated ? db_to_power_ratio(tabulated->table->peak_dbi()) : power_gain(pattern, 0.0, 0.5 * pi);
}

/// What is radiated of the power fed in: the mean of the gain over the sphere, ∫ G dΩ/4π. Above 1 the pattern makes
/// power out of nothing. Numerical: Simpson's rule over zenith in 2·`half_steps` steps, the sum over twice as many
/// azimuths; with the default 1e-6 of the result for the closed forms, for tables as good as their own steps.
double radiated_share(const AntennaPattern& pattern, std::size_t half_steps = 180);

/// The pattern as a table of `azimuth_count`·`zenith_count` nodes. A gain of 0 becomes −200 dBi, the least of a table.
PatternTable tabulated(const AntennaPattern& pattern, std::size_t azimuth_count, std::size_t zenith_count);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline double pattern_gain(const IsotropicPattern&, double, double) {
  return 1.0;
}

/// With 1 − |cos θ| = sin²θ/(1 + |cos θ|) the numerator is sin(π/2·sin²θ/(1 + |cos θ|)): the quotient goes to 0 at the
/// poles like sin θ, without a difference of nearly equal numbers.
inline double pattern_gain(const HalfWaveDipole&, double, double zenith_rad) {
  const double sine = std::abs(std::sin(zenith_rad));
  if (sine < 1e-15) return 0.0;  // a direction is no better known: straight down has the sine of the rounding of π
  const double field = std::sin(0.5 * pi * sine * sine / (1.0 + std::abs(std::cos(zenith_rad)))) / sine;
  return half_wave_dipole_directivity * field * field;
}

/// Of one cut of the element: 12 dB at 65°, which is 3 dB at the half of that width, down to 30 dB.
inline double tr38901_attenuation_db(double off_axis_rad) {
  const double beam_widths = radians_to_degrees(off_axis_rad) / 65.0;
  return std::min(12.0 * beam_widths * beam_widths, 30.0);
}

inline double pattern_gain(const Tr38901Element&, double azimuth_rad, double zenith_rad) {
  const double vertical_db = tr38901_attenuation_db(zenith_rad - 0.5 * pi);
  const double horizontal_db = tr38901_attenuation_db(std::remainder(azimuth_rad, 2.0 * pi));
  return db_to_power_ratio(8.0 - std::min(vertical_db + horizontal_db, 30.0));
}

inline double pattern_gain(const TabulatedPattern& pattern, double azimuth_rad, double zenith_rad) {
  DCEM_ASSERT(pattern.table != nullptr);
  return db_to_power_ratio(pattern.table->gain_dbi(azimuth_rad, zenith_rad));
}

/// Of port 0.
inline double pattern_gain(const UserPattern& pattern, double azimuth_rad, double zenith_rad) {
  DCEM_ASSERT(pattern.model != nullptr);
  const double sine = std::sin(zenith_rad);
  const Vec3 direction(sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), std::cos(zenith_rad));
  const JonesVector field = pattern.model->field(direction, 0);
  return std::norm(field[0]) + std::norm(field[1]);
}

}  // namespace detail

inline double power_gain(const AntennaPattern& pattern, double azimuth_rad, double zenith_rad) {
  return std::visit([&](const auto& kind) { return detail::pattern_gain(kind, azimuth_rad, zenith_rad); }, pattern);
}

inline double power_gain(const AntennaPattern& pattern, const Vec3& local_direction) {
  if (std::holds_alternative<IsotropicPattern>(pattern)) return 1.0;  // needs no angles
  return power_gain(pattern, azimuth_rad(local_direction), zenith_rad(local_direction));
}

inline double radiated_share(const AntennaPattern& pattern, std::size_t half_steps) {
  const std::size_t rows = 2 * std::max<std::size_t>(half_steps, 1), columns = 2 * rows;
  const double step_rad = pi / static_cast<double>(rows);
  double sum = 0.0;
  for (std::size_t row = 1; row < rows; ++row) {  // the poles weigh nothing
    const double zenith_rad = static_cast<double>(row) * step_rad;
    const double weight = (row % 2 == 1 ? 4.0 : 2.0) / 3.0 * std::sin(zenith_rad);
    for (std::size_t column = 0; column < columns; ++column) {
      sum += weight * power_gain(pattern, static_cast<double>(column) * step_rad, zenith_rad);
    }
  }
  return sum * step_rad * step_rad / (4.0 * pi);
}

inline PatternTable tabulated(const AntennaPattern& pattern, std::size_t azimuth_count, std::size_t zenith_count) {
  std::vector<double> gain_dbi;
  for (std::size_t row = 0; row < zenith_count; ++row) {
    const double zenith_rad = pi * (static_cast<double>(row) / static_cast<double>(zenith_count - 1));
    for (std::size_t column = 0; column < azimuth_count; ++column) {
      const double azimuth_rad = 2.0 * pi * (static_cast<double>(column) / static_cast<double>(azimuth_count));
      const double gain = power_gain(pattern, azimuth_rad, zenith_rad);
      gain_dbi.push_back(std::max(power_ratio_to_db(gain), -PatternTable::highest_gain_dbi));
    }
  }
  return {azimuth_count, zenith_count, std::move(gain_dbi)};
}

}  // namespace dcem
