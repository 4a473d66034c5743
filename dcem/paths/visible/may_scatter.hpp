#pragma once
/// Whether a surface can scatter from one end of a link to the other.
#include <algorithm>
#include <cmath>

#include "dcem/paths/query/link_end.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Whether a facet can scatter between two ends at all: both on one side of it, neither mounted on it.
inline bool may_scatter(const Scene& scene, const LinkEnd& transmitter, const LinkEnd& receiver, FacetId id) {
  const WorldFacet& facet = scene.facet(id);
  if (!facet.present || !facet.scatters) return false;
  if (transmitter.ignored_body == facet.body || receiver.ignored_body == facet.body) return false;
  const double from_m = signed_distance_m(facet.plane, transmitter.position_m);
  const double to_m = signed_distance_m(facet.plane, receiver.position_m);
  if (std::abs(from_m) <= in_plane_guard_m || std::abs(to_m) <= in_plane_guard_m || (from_m > 0.0) != (to_m > 0.0)) {
    return false;
  }
  const auto is_mounted = [&](const LinkEnd& end) { return std::ranges::binary_search(end.mounted_on, id); };
  return !is_mounted(transmitter) && !is_mounted(receiver);
}

}  // namespace dcem
