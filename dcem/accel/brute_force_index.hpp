#pragma once
/// No tree at all as a `SpatialIndex`: asks every triangle, to check the others.
#include "dcem/accel/box_index.hpp"
#include "dcem/accel/brute_force.hpp"

namespace dcem {

using BruteForceIndex = BoxIndex<BruteForce<double>, BruteForceUpdater<double>>;

static_assert(SpatialIndex<BruteForceIndex>);

}  // namespace dcem
