#pragma once
/// Which edges some facets have.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/scene/scene.hpp"

namespace dcem {

/// The edges of some facets, ascending, each once. Of many facets they are marked, and the marks are in order already;
/// of few they are sorted.
inline void collect_edges(const Scene& scene, std::span<const FacetId> facets, std::vector<WedgeId>& edges) {
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
