#pragma once
/// The facets that both ends of a link may see: nothing else can scatter between them.
#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

#include "dcem/paths/halves/sight.hpp"

namespace dcem {

/// The facets that an end may see, ascending. A view of the same number of pixels gives the same facets.
inline std::vector<FacetId> facets_in_view(Sight& sight, const Scene& scene, const FacetOutlines& outlines,
                                           const LinkEnd& end, int max_transmissions) {
  std::vector<FacetId> seen;
  sight.look_from(end);
  sight.find_facets(scene, outlines, {false, max_transmissions}, true, seen);
  std::ranges::sort(seen);
  return seen;
}

/// The facets that are in both of two ascending lists.
inline std::vector<FacetId> in_both(std::span<const FacetId> one, std::span<const FacetId> other) {
  std::vector<FacetId> both;
  std::ranges::set_intersection(one, other, std::back_inserter(both));
  return both;
}

}  // namespace dcem
