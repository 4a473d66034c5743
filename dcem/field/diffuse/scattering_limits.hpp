#pragma once
/// What bounds and tiles need to know of materials, whatever the angle: worked out once for all links.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/em/surface/material_table.hpp"

namespace dcem {

/// By material.
struct ScatteringLimits {
  /// No less than the power that a sheet lets pass, at any angle: the largest of many angles, and a little more.
  std::vector<double> transmission;
  /// The angle in rad within which the power that is reflected rises or falls, where it does so again and again: layers
  /// make fringes that no distance shows. At most 1.
  std::vector<double> reflection_width_rad;
  std::vector<double> transmission_width_rad;  ///< the same of what a sheet lets pass
};

namespace detail {

inline constexpr int limit_angles = 512;  ///< from the normal to grazing incidence

/// The shortest way in steps from a maximum to a minimum, or back, that differ by a tenth of the largest value.
inline std::size_t shortest_swing(const std::vector<double>& values) {
  const double least = 0.1 * *std::max_element(values.begin(), values.end());
  std::size_t shortest = values.size(), last_turn = 0, extreme = 0;
  int direction = 0;  // up or down; 0: not yet known
  for (std::size_t index = 1; index < values.size(); ++index) {
    const double beyond = (values[index] - values[extreme]) * (direction == 0 ? 1.0 : direction);
    if (direction != 0 && beyond > 0.0) {
      extreme = index;
    } else if (std::abs(beyond) > least) {
      if (direction != 0 && last_turn > 0) shortest = std::min(shortest, extreme - last_turn);
      last_turn = extreme;
      direction = values[index] > values[extreme] ? 1 : -1;
      extreme = index;
    }
  }
  return shortest;
}

}  // namespace detail

template <SurfaceModel Surface>
ScatteringLimits scattering_limits(const Surface& surface, std::size_t materials) {
  const auto width_rad = [](const std::vector<double>& values) {
    return std::min(1.0, 0.5 * pi * static_cast<double>(detail::shortest_swing(values)) / detail::limit_angles);
  };
  const auto power_of = [](const PolarizedCoefficients& both) { return std::norm(both.te) + std::norm(both.tm); };
  ScatteringLimits limits;
  for (std::size_t index = 0; index < materials; ++index) {
    const MaterialId material(static_cast<std::uint32_t>(index));
    double most = 0.0;
    std::vector<double> passed, reflected;
    for (int step = 0; step <= detail::limit_angles; ++step) {
      const double cosine = std::cos(0.5 * pi * step / detail::limit_angles);
      const PolarizedCoefficients through = surface.response(material, cosine).transmission;
      most = std::max({most, std::norm(through.te), std::norm(through.tm)});
      passed.push_back(power_of(through));
      if constexpr (ScatteringModel<Surface>) {
        reflected.push_back(power_of(surface.smooth_reflection(material, cosine)));
      } else {
        reflected.push_back(0.0);
      }
    }
    limits.transmission.push_back(1.05 * most);
    limits.reflection_width_rad.push_back(width_rad(reflected));
    limits.transmission_width_rad.push_back(width_rad(passed));
  }
  return limits;
}

}  // namespace dcem
