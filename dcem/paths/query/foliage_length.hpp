#pragma once
/// How far a leg runs inside foliage.
#include <vector>

#include "dcem/paths/path.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// Adds what a straight leg runs through to `foliage`, one entry per material in the order in which they come.
void add_foliage_along(const Scene& scene, const Vec3& from_m, const Vec3& to_m, const IgnoredBodies& ignored,
                       std::vector<FoliageLength>& foliage);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/query/foliage_length_bodies.hpp"
#endif
