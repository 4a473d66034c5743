#pragma once
/// Bodies of facet_rims.hpp.
#include <algorithm>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/lifetime/facet_rims.hpp"

namespace dcem {

DCEM_INLINE FacetRims::FacetRims(const Scene& scene) {
  std::vector<RimSide> own;
  for (const WorldFacet& facet : scene.facets()) {
    own.clear();
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      const auto& corners = scene.triangles()[facet.first_triangle + index];
      for (std::size_t side = 0; side < 3; ++side) {
        const auto [low, high] = std::minmax(corners[side], corners[(side + 1) % 3]);
        own.push_back({low, high});
      }
    }
    keep_single(own);
    sides_.insert(sides_.end(), own.begin(), own.end());
    ends_.push_back(sides_.size());
  }
}

DCEM_INLINE void FacetRims::keep_single(std::vector<RimSide>& sides) {
  std::ranges::sort(sides, {}, [](const RimSide& side) { return std::pair(side.from, side.to); });
  const auto same = [](const RimSide& one, const RimSide& other) {
    return one.from == other.from && one.to == other.to;
  };
  std::size_t kept = 0;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t next = first + 1;
    while (next < sides.size() && same(sides[first], sides[next])) ++next;
    if (next == first + 1) sides[kept++] = sides[first];
    first = next;
  }
  sides.resize(kept);
}

}  // namespace dcem
