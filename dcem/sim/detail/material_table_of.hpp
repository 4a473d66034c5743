#pragma once
/// A scene's own materials as the surface model of a simulation.
#include "dcem/em/surface/material_table.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::detail {

/// Throws std::invalid_argument where a material is not tabled at the frequency.
MaterialTable material_table_of(const Scene& scene, const SimulationSettings& settings);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/material_table_of_bodies.hpp"
#endif
