#pragma once
/// Body of edge_reach.hpp.
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/edge_reach.hpp"

namespace dcem {

DCEM_INLINE std::vector<EdgeReach::Edge> EdgeReach::edges() const {
  std::vector<std::pair<WedgeId, std::span<const SequenceElement>>> halves;
  halves_.for_each(
      [&](const Sequence& half) { halves.emplace_back(half.back().edge(), std::span(half).first(half.size() - 1)); });
  std::stable_sort(halves.begin(), halves.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Edge> edges;
  for (const auto& [id, mirrors] : halves) {
    if (edges.empty() || edges.back().id != id) edges.push_back({id, {}, {}});
    edges.back().mirrors.push_back(mirrors);
  }
  add_views(edges);
  return edges;
}

DCEM_INLINE void EdgeReach::add_views(std::span<Edge> edges) const {
  views_.for_each([&](const Sequence& view) {
    const auto edge = std::lower_bound(edges.begin(), edges.end(), view.front().edge(),
                                       [](const Edge& one, WedgeId id) { return one.id < id; });
    if (edge != edges.end() && edge->id == view.front().edge()) edge->in_view.push_back(view.back().mirror());
  });
  for (Edge& edge : edges) std::sort(edge.in_view.begin(), edge.in_view.end());
}

}  // namespace dcem
