#pragma once
/// Points side by side of which nothing lies between others.
#include <span>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The corners of the convex hull of points at one height, and those at other heights as they are: a quotient of two
/// linear functions, as by which sides are moved in, is largest at a corner.
void take_extreme_points(std::span<const Vec3> points_m, std::vector<Vec3>& result);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/extreme_points_bodies.hpp"
#endif
