#pragma once
/// Bodies of settings.hpp.
#include <cmath>
#include <stdexcept>
#include <variant>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

DCEM_INLINE void validate(const SimulationSettings& settings) {
  const auto check = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  const PropagationSettings& propagation = settings.propagation;
  check(settings.frequency_hz > 0.0 && settings.frequency_hz <= 1e15, "frequency_hz: expected a number in (0, 1e15]");
  check(propagation.max_reflections >= 0 && propagation.max_reflections <= 10, "max_reflections: expected 0 to 10");
  check(propagation.max_transmissions >= 0 && propagation.max_transmissions <= 10,
        "max_transmissions: expected 0 to 10");
  check(propagation.max_diffractions >= 0 && propagation.max_diffractions <= 3, "max_diffractions: expected 0 to 3");
  const double least_deg = propagation.diffraction.min_exterior_angle_deg;
  check(least_deg > 180.0 && least_deg <= 360.0, "min_exterior_angle_deg: expected above 180, at most 360");
  check(!propagation.max_interactions || *propagation.max_interactions >= 0, "max_interactions: expected 0 or more");
  check(!propagation.min_path_gain_db || std::isfinite(*propagation.min_path_gain_db),
        "min_path_gain_db: expected a finite number");
  const double longest_m = propagation.max_path_length_m.value_or(1.0);
  check(longest_m >= 1e-3 && longest_m <= 1e9, "max_path_length_m: expected 0.001 to 1e9");
  const double limit_m = propagation.valid_until_limit_m.value_or(1.0);
  check(limit_m >= 1e-3 && limit_m <= 100.0, "valid_until_limit_m: expected 0.001 to 100");
  const double range_m = settings.links.range_m.value_or(1.0);
  check(range_m >= 1e-3 && range_m <= 1e9, "links: range_m: expected 0.001 to 1e9");
  const ReceiverPart part = settings.links.receivers.value_or(ReceiverPart{});
  check(part.part < part.of, "links: receivers: expected a part below the number of parts");
  if (const auto* close_in = std::get_if<CloseIn>(&propagation.path_loss.model)) validate(*close_in);
  check(propagation.rays >= 1 && propagation.rays <= 100'000'000, "rays: expected 1 to 1e8");
  check(steady_rays(propagation) >= 1 && steady_rays(propagation) <= 100'000'000, "rays_steady: expected 1 to 1e8");
  if (propagation.atmosphere) validate(*propagation.atmosphere);
  validate(propagation.diffuse);
  validate(settings.tree);
}

}  // namespace dcem
