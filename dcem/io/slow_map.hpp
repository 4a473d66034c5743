#pragma once
/// A word before a map that takes hours where another setting would take minutes.
#include <cstddef>
#include <optional>
#include <string>

#include "dcem/sim/search_plan.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io {

/// What to do about three interactions, all of whose paths are searched, at a thousand points or more of a city: in
/// Munich (17,269 facets) such a point takes 0.13 s of processor time and one of two interactions 0.0025 s. `facets`:
/// of the scene; `points`: of all maps of a frame. Nothing where a map is small.
std::optional<std::string> slow_map_hint(const PropagationSettings& propagation, const SearchPlan& plan,
                                         std::size_t facets, std::size_t points);

}  // namespace dcem::io
