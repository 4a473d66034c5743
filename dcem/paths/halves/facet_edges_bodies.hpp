#pragma once
/// Bodies of facet_edges.hpp.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/facet_edges.hpp"

namespace dcem {

DCEM_INLINE void collect_edges(const Scene& scene, std::span<const FacetId> facets, std::vector<WedgeId>& edges) {
  constexpr std::size_t bits = 64;
  const std::size_t words = (scene.wedges().size() + bits - 1) / bits;
  const auto for_each = [&](auto&& take) {
    for (const FacetId facet : facets) {
      for (const WedgeId id : scene.wedges_of_facet(facet)) take(id);
    }
  };
  edges.clear();
  if (4 * facets.size() < words) {
    for_each([&](WedgeId id) { edges.push_back(id); });
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return;
  }
  std::vector<std::uint64_t> marks(words);
  for_each([&](WedgeId id) { marks[id.value / bits] |= std::uint64_t{1} << (id.value % bits); });
  for (std::size_t word = 0; word < words; ++word) {
    for (std::uint64_t left = marks[word]; left != 0; left &= left - 1) {
      edges.push_back(
          WedgeId(static_cast<std::uint32_t>(bits * word) + static_cast<std::uint32_t>(std::countr_zero(left))));
    }
  }
}

}  // namespace dcem
