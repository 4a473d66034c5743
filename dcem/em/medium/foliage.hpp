#pragma once
/// The loss of a wave that goes straight through the crowns of trees, in dB per metre of way inside them: the default
/// where a scene names no value of its own.
///   γ_f = 0.79·f^0.61   dB/m, f in GHz, deciduous trees in leaf
/// Source: the model for links through foliage of GEMV² (Boban, Barros & Tonguz, "Geometry-based vehicle-to-vehicle
/// channel modeling for large-scale simulation", IEEE Trans. Veh. Technol. 63(9), 2014, arXiv 1305.0124). Checked: the
/// formula stands so in the implementation of that model in Artery (gemv2/NLOSf.cc, Riebl 2018). Not checked: that it
/// comes from Goldhirsh & Vogel, "Handbook of propagation effects for vehicular and personal mobile satellite systems",
/// 1998, section 2.7.2 "Scaling between 1 GHz and 4 GHz", and there from measurements by Benzair (1991).
/// Above 4 GHz it is an extrapolation: 6.3 dB/m at 30 GHz, 9.6 dB/m at 60 GHz. What is scattered around through a deep
/// crown is left out by a constant loss per metre, so the loss of more than some ten metres comes out too high.
#include <cmath>

#include "dcem/em/surface/range_check.hpp"

namespace dcem {

inline constexpr double min_foliage_frequency_hz = 1e9;
inline constexpr double max_foliage_frequency_hz = 100e9;

/// γ_f in dB/m. `frequency_hz` in 1…100 GHz (closed), else std::invalid_argument: the lower end is that of the
/// measurements, the upper one that of models for vegetation in Recommendation ITU-R P.833.
inline double foliage_attenuation_db_per_m(double frequency_hz) {
  detail::require_within("frequency of the attenuation by foliage", frequency_hz / 1e9, min_foliage_frequency_hz / 1e9,
                         max_foliage_frequency_hz / 1e9, "GHz");
  return 0.79 * std::pow(frequency_hz / 1e9, 0.61);
}

}  // namespace dcem
