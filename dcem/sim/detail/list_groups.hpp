#pragma once
/// Which points of a list look at the scene together.
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/sim/detail/map_groups.hpp"

namespace dcem::detail {

/// The points of a list in groups of at most 16, each within a box of 8 m, its points in the order of the list and
/// joined by free straight steps. A point that is not `open` (0) is a group of its own. `free(point, point)` says
/// whether a step is free.
std::vector<std::vector<std::size_t>> list_groups(std::span<const Vec3> points_m, std::span<const char> open,
                                                  const IsFree& free);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/list_groups_bodies.hpp"
#endif
