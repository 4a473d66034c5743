#pragma once
/// A scene's own materials as the surface model of a simulation.
#include "dcem/em/surface/material_table.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::detail {

/// Throws std::invalid_argument where a material is not tabled at the frequency.
inline MaterialTable material_table_of(const Scene& scene, const SimulationSettings& settings) {
  return MaterialTable({scene.materials().begin(), scene.materials().end()}, settings.frequency_hz, settings.itu);
}

}  // namespace dcem::detail
