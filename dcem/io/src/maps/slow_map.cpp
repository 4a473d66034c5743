#include "dcem/io/slow_map.hpp"

#include "dcem/sim/discovery.hpp"

namespace dcem::io {

std::optional<std::string> slow_map_hint(const PropagationSettings& propagation, const SearchPlan& plan,
                                         std::size_t facets, std::size_t points) {
  constexpr std::size_t many_facets = 2500, many_points = 1000;
  const bool is_large = facets >= many_facets && points >= many_points;
  if (!is_large || plan.exhaustive || exactly_searched_interactions(propagation, plan) < 3) return std::nullopt;
  return "all paths of three interactions at " + std::to_string(points) + " points of a scene of " +
         std::to_string(facets) +
         " facets: this takes some fifty times as long as of two; propagation.max_interactions 2 gives a first look";
}

}  // namespace dcem::io
