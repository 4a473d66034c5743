#pragma once
/// Which edges some facets have.
#include <span>
#include <vector>

#include "dcem/scene/scene.hpp"

namespace dcem {

/// The edges of some facets, ascending, each once. Of many facets they are marked, and the marks are in order already;
/// of few they are sorted.
void collect_edges(const Scene& scene, std::span<const FacetId> facets, std::vector<WedgeId>& edges);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/facet_edges_bodies.hpp"
#endif
