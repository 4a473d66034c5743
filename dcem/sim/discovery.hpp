#pragma once
/// Which discovery and which cache a scene gets.
#include <cstddef>
#include <string_view>

#include "dcem/paths/path.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/search_plan.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// Facets up to which `automatic` chooses exact discovery, by the orders: the number of sequences grows with their
/// power.
std::size_t automatic_exact_facet_limit(const PropagationSettings& propagation);

/// Whether halves find every path within the orders, in a scene of any size.
bool halves_cover(int joined, const PropagationSettings& propagation);

/// What a simulation with these settings really does: small scenes are searched exhaustively, where that ends; in
/// others short sequences are found from halves, and rays look for longer ones. Throws std::invalid_argument where
/// exact discovery is asked for by name and cannot be had: what was asked for is never weakened in silence.
SearchPlan plan_search(const PropagationSettings& propagation, const Scene& scene);

/// Exact or sampled: whether a simulation with these settings finds every path. Throws as `plan_search` does.
Discovery resolve_discovery(const PropagationSettings& propagation, const Scene& scene);

/// Reflections and diffractions together up to which all paths are found: one diffraction among them, or two alone.
int exactly_searched_interactions(const PropagationSettings& propagation, const SearchPlan& plan);

/// Whether all paths of a path's kind are found, not only those that rays come by. `exact_interactions` as above.
bool is_found_exactly(const Path& path, int exact_interactions, Discovery done);

/// Off or seed: what a simulation that discovers in this way really remembers. Throws std::invalid_argument where
/// `seed` is asked for by name and discovery is exact: there is nothing that few rays could add to.
CacheMode resolve_cache(const PropagationSettings& propagation, Discovery discovery);

/// Why no link gets a `valid_until_m` that was asked for, and what would give it one; empty where they do.
std::string_view why_no_lifetimes(const PropagationSettings& propagation, Discovery discovery);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/discovery_bodies.hpp"
#endif
