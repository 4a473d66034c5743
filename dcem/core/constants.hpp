#pragma once
/// Physical constants in SI units (CODATA 2018; the speed of light is exact by definition).
#include <numbers>

namespace dcem {

inline constexpr double pi = std::numbers::pi;
inline constexpr double speed_of_light_mps = 299'792'458.0;
inline constexpr double vacuum_permittivity_f_per_m = 8.854'187'8128e-12;
inline constexpr double free_space_impedance_ohm = 376.730'313'668;
inline constexpr double boltzmann_constant_j_per_k = 1.380'649e-23;  ///< exact by definition

}  // namespace dcem
