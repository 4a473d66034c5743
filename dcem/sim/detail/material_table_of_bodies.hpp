#pragma once
/// Body of material_table_of.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/material_table_of.hpp"

namespace dcem::detail {

DCEM_INLINE MaterialTable material_table_of(const Scene& scene, const SimulationSettings& settings) {
  return MaterialTable({scene.materials().begin(), scene.materials().end()}, settings.frequency_hz, settings.itu);
}

}  // namespace dcem::detail
