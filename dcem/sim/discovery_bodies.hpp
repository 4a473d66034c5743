#pragma once
/// Bodies of discovery.hpp.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/covered.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/search_size.hpp"

namespace dcem {

DCEM_INLINE std::size_t automatic_exact_facet_limit(const PropagationSettings& propagation) {
  const int reflections = reflection_order(propagation), diffractions = diffraction_order(propagation);
  const std::size_t by_reflections = reflections <= 2 ? exact_discovery_facet_limit : reflections == 3 ? 200 : 32;
  const std::size_t by_diffractions = diffractions == 0   ? exact_discovery_facet_limit
                                      : diffractions == 1 ? 150
                                      : diffractions == 2 ? 30
                                                          : 12;
  return std::min(by_reflections, by_diffractions);
}

DCEM_INLINE bool halves_cover(int joined, const PropagationSettings& propagation) {
  return halves_cover(joined, diffraction_order(propagation), interaction_order(propagation));
}

namespace detail {

/// The largest `max_interactions` with which an exact search ends.
inline int most_interactions_that_end(PropagationSettings propagation, const Scene& scene) {
  int most = interaction_order(propagation);
  for (; most > 1; --most) {
    propagation.max_interactions = most;
    if (halves_cover(most_joined_interactions, propagation) || search_ends(propagation, scene)) break;
  }
  return most;
}

[[noreturn]] inline void refuse_endless_search(const PropagationSettings& propagation, const Scene& scene) {
  const double sequences = estimated_sequences(propagation, scene);
  // Where there are edges, rays may propose more chains than can be tried, too.
  const char* const otherwise = diffraction_order(propagation) == 0 ? ", or discovery sampled" : "";
  throw std::invalid_argument("discovery exact: " + std::to_string(scene.surface_count()) + " facets and " +
                              std::to_string(scene.wedges().size()) + " edges make about " + rough_number(sequences) +
                              " sequences of up to " + std::to_string(reflection_order(propagation)) +
                              " reflections and " + std::to_string(diffraction_order(propagation)) +
                              " diffractions for a link, about " + rough_duration(sequences / sequences_tried_per_s) +
                              " of one thread; expected max_interactions " +
                              std::to_string(most_interactions_that_end(propagation, scene)) + " or less" + otherwise);
}

[[noreturn]] inline void refuse_many_facets(std::size_t facets) {
  throw std::invalid_argument("discovery exact: not in this version for " + std::to_string(facets) +
                              " facets, except for at most three interactions, one of them a diffraction, or two; "
                              "expected max_interactions 3 and max_diffractions 1, max_interactions 2, or at most " +
                              std::to_string(exact_discovery_facet_limit) + " facets");
}

}  // namespace detail

DCEM_INLINE SearchPlan plan_search(const PropagationSettings& propagation, const Scene& scene) {
  if (propagation.discovery == Discovery::sampled) return {Discovery::sampled};
  const std::size_t facets = scene.surface_count();
  const bool is_small = facets <= automatic_exact_facet_limit(propagation);
  if (is_small && search_ends(propagation, scene)) return {Discovery::exact, true};
  constexpr int joined = most_joined_interactions;
  if (halves_cover(joined, propagation)) return {Discovery::exact, false, joined};
  if (propagation.discovery == Discovery::automatic) return {Discovery::sampled, false, joined};
  if (facets > exact_discovery_facet_limit) detail::refuse_many_facets(facets);
  if (!search_ends(propagation, scene)) detail::refuse_endless_search(propagation, scene);
  return {Discovery::exact, true};
}

DCEM_INLINE Discovery resolve_discovery(const PropagationSettings& propagation, const Scene& scene) {
  return plan_search(propagation, scene).discovery;
}

DCEM_INLINE int exactly_searched_interactions(const PropagationSettings& propagation, const SearchPlan& plan) {
  const int order = interaction_order(propagation);
  return plan.discovery == Discovery::exact ? order : std::min(plan.joined, order);
}

DCEM_INLINE bool is_found_exactly(const Path& path, int exact_interactions, Discovery done) {
  return done == Discovery::exact || halves_cover(exact_interactions, path);
}

DCEM_INLINE CacheMode resolve_cache(const PropagationSettings& propagation, Discovery discovery) {
  const bool sampled = discovery == Discovery::sampled;
  if (propagation.cache == CacheMode::seed && !sampled) {
    throw std::invalid_argument(
        "cache seed: goes with sampled discovery, and discovery is exact; expected cache exact or off");
  }
  if (propagation.cache == CacheMode::exact && sampled) {
    throw std::invalid_argument(
        "cache exact: goes with exact discovery, and discovery is sampled; expected cache seed or off");
  }
  if (propagation.cache != CacheMode::automatic) return propagation.cache;
  return sampled ? CacheMode::seed : CacheMode::exact;
}

/// What changes paths with every step, as weak or long ones that are dropped do, leaves nothing to be proved.
DCEM_INLINE std::string_view why_no_lifetimes(const PropagationSettings& propagation, Discovery discovery) {
  const int interactions = interaction_order(propagation);
  if (interactions > 2) return "paths may have more than two interactions; expected max_interactions 2";
  if (interactions == 2 && diffraction_order(propagation) == 2) {
    return "paths may have two diffractions; expected max_diffractions 1";
  }
  if (propagation.min_path_gain_db) return "weak paths are dropped; expected no min_path_gain_db";
  if (propagation.max_path_length_m) return "long paths are dropped; expected no max_path_length_m";
  if (!propagation.line_of_sight && propagation.max_transmissions > 0) {
    return "free lines of sight are dropped; expected line_of_sight true, or max_transmissions 0";
  }
  if (discovery == Discovery::sampled) return "discovery is sampled; expected discovery exact";
  const bool remembers = propagation.cache == CacheMode::automatic || propagation.cache == CacheMode::exact;
  return remembers ? "" : "the cache is off; expected cache exact";
}

}  // namespace dcem
