#pragma once
/// Which discovery and which cache a scene gets.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// Facets up to which `automatic` chooses exact discovery, by the orders: the number of sequences grows with their
/// power.
inline std::size_t automatic_exact_facet_limit(const PropagationSettings& propagation) {
  const int reflections = reflection_order(propagation), diffractions = diffraction_order(propagation);
  const std::size_t by_reflections = reflections <= 2 ? exact_discovery_facet_limit : reflections == 3 ? 200 : 32;
  const std::size_t by_diffractions = diffractions == 0   ? exact_discovery_facet_limit
                                      : diffractions == 1 ? 150
                                      : diffractions == 2 ? 30
                                                          : 12;
  return std::min(by_reflections, by_diffractions);
}

/// Exact or sampled: what a simulation with these settings really does. Throws std::invalid_argument where exact
/// discovery is asked for by name in a scene that is too large for it: what was asked for is never weakened in silence.
inline Discovery resolve_discovery(const PropagationSettings& propagation, const Scene& scene) {
  const std::size_t facets = scene.surface_count();
  if (propagation.discovery == Discovery::exact && facets > exact_discovery_facet_limit) {
    throw std::invalid_argument("discovery exact: not in this version for " + std::to_string(facets) +
                                " facets; expected at most " + std::to_string(exact_discovery_facet_limit));
  }
  if (propagation.discovery != Discovery::automatic) return propagation.discovery;
  return facets <= automatic_exact_facet_limit(propagation) ? Discovery::exact : Discovery::sampled;
}

/// Off or seed: what a simulation that discovers in this way really remembers. Throws std::invalid_argument where
/// `seed` is asked for by name and discovery is exact: there is nothing that few rays could add to.
inline CacheMode resolve_cache(const PropagationSettings& propagation, Discovery discovery) {
  const bool sampled = discovery == Discovery::sampled;
  if (propagation.cache == CacheMode::seed && !sampled) {
    throw std::invalid_argument("cache seed: goes with sampled discovery, and discovery is exact; expected cache off");
  }
  if (propagation.cache != CacheMode::automatic) return propagation.cache;
  return sampled ? CacheMode::seed : CacheMode::off;
}

}  // namespace dcem
