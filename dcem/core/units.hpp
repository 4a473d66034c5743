#pragma once
/// Conversions between linear and logarithmic units, and between degrees and radians.
/// Every name says what is converted: a power ratio carries 10·log10, an amplitude ratio 20·log10.
#include <cmath>

#include "dcem/core/constants.hpp"

namespace dcem {

inline double power_ratio_to_db(double power_ratio) {
  return 10.0 * std::log10(power_ratio);
}
inline double db_to_power_ratio(double ratio_db) {
  return std::pow(10.0, ratio_db / 10.0);
}
inline double amplitude_ratio_to_db(double amplitude_ratio) {
  return 20.0 * std::log10(amplitude_ratio);
}
inline double db_to_amplitude_ratio(double ratio_db) {
  return std::pow(10.0, ratio_db / 20.0);
}
inline double watt_to_dbm(double power_w) {
  return 10.0 * std::log10(power_w) + 30.0;
}
inline double dbm_to_watt(double power_dbm) {
  return std::pow(10.0, (power_dbm - 30.0) / 10.0);
}

inline constexpr double degrees_to_radians(double angle_deg) {
  return angle_deg * (pi / 180.0);
}
inline constexpr double radians_to_degrees(double angle_rad) {
  return angle_rad * (180.0 / pi);
}

}  // namespace dcem
