#pragma once
/// Which points of a map that nothing reaches are indoors, though no shell around them is closed.
///
/// Houses of city meshes lack a wall here and an edge there, so that they enclose nothing (`CONVENTIONS.md`, "Maps").
/// What is under their roofs is no street without coverage, and pictures and shares of the outdoors should not count
/// it as one. A point is sheltered where
/// * no transmitter reaches it (what is reached is shown, wherever it is),
/// * the scenery is above it, and around it in all but one of sixteen directions within 100 m: under a bridge, in an
///   arcade or at a petrol station more of them are free,
/// * and no transmitter is itself in such a place: on a map of the indoors a room without coverage is what is looked
///   for.
/// Values do not change: each stays that of a receiver at the point.
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/sim/simulator.hpp"

namespace dcem::io {

/// Whether the scenery is above a point, and around it.
bool is_under_a_roof(const Simulator& simulator, const Vec3& point_m);

/// Sets `RadioMapPoint::sheltered` in maps of the same points, of all transmitters, for the simulator's current frame.
void mark_sheltered(const Simulator& simulator, const Frame& frame, std::vector<RadioMap>& maps);

}  // namespace dcem::io
