#pragma once
/// The binary tree of `bvh.hpp` as a `SpatialIndex`: the plain one.
#include "dcem/accel/binary/updater.hpp"
#include "dcem/accel/box_index.hpp"
#include "dcem/accel/bvh.hpp"

namespace dcem {

using BinaryIndex = BoxIndex<Bvh<double>, BvhUpdater<double>>;

static_assert(SpatialIndex<BinaryIndex>);

}  // namespace dcem
