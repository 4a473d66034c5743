#pragma once
/// Walls and roofs of a town. Private to dcem::io.
#include <vector>

#include "dcem/io/import.hpp"
#include "dcem/io/src/import/city_plan.hpp"
#include "dcem/io/src/import/obj_draft.hpp"

namespace dcem::io {

/// Whether shells are closed at their foot: foliage must be, houses stand on the ground without a floor.
enum class Foot { open, closed };

/// Adds the parts: roofs, outer walls from the foot up, and between parts of different heights the step alone. Edges
/// meet in common corners, so that a block is one closed shell. Counts and sizes are added to the report.
void add_town(const std::vector<TownPart>& parts, Foot foot, ObjDraft& obj, ImportReport& report);

/// Adds a rectangle at height 0 around everything, of the material `ground`.
void add_flat_ground(const Vec2& low_m, const Vec2& high_m, ObjDraft& obj);

}  // namespace dcem::io
