#pragma once
/// The simulator and what it takes and gives: enough for most programs. Whoever works with a part alone includes that
/// part, such as `dcem/accel/wide_index.hpp` or `dcem/em/diffraction/utd.hpp` (docs/using_the_library.md); reading and
/// writing files is `dcem/io/`.
#include "dcem/core/units.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/sim/simulator.hpp"
