#pragma once
/// How many chains `ChainJoiner` makes of two reaches, before any is made: without mirrors between edges, as in sampled
/// search.
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/paths/discover/edge_reach.hpp"

namespace dcem {

/// About how many chains of a link there are, by the most interactions that a chain may have: entry i for i of them, up
/// to `limits.max_interactions`. Chains that pass an edge twice in a row are counted along, though none is made.
std::vector<double> count_chains(std::span<const EdgeReach::Edge> receiver,
                                 std::span<const EdgeReach::Edge> transmitter, const ChainLimits& limits);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Halves by how many mirrors they have.
using HalvesByMirrors = std::vector<double>;

inline HalvesByMirrors halves_by_mirrors(std::span<const EdgeReach::Edge> edges, std::size_t most) {
  HalvesByMirrors halves(most + 1, 0.0);
  for (const EdgeReach::Edge& edge : edges) {
    for (const auto& mirrors : edge.mirrors) {
      if (mirrors.size() <= most) ++halves[mirrors.size()];
    }
  }
  return halves;
}

/// Adds what two sets of halves make, each with each and `times` over, with so many edges in all.
inline void add_joined(const HalvesByMirrors& one, const HalvesByMirrors& other, double times, std::size_t edges,
                       const ChainLimits& limits, std::vector<double>& chains) {
  for (std::size_t near = 0; near < one.size(); ++near) {
    for (std::size_t far = 0; far < other.size() && near + far <= limits.max_reflections; ++far) {
      const std::size_t interactions = near + far + edges;
      if (interactions < chains.size()) chains[interactions] += times * one[near] * other[far];
    }
  }
}

/// Those over one edge: of halves that end at the same.
inline void add_chains_at_one_edge(std::span<const EdgeReach::Edge> receiver,
                                   std::span<const EdgeReach::Edge> transmitter, const ChainLimits& limits,
                                   std::vector<double>& chains) {
  auto far = transmitter.begin();
  for (const EdgeReach::Edge& near : receiver) {
    while (far != transmitter.end() && far->id < near.id) ++far;
    if (far == transmitter.end() || far->id != near.id) continue;
    add_joined(halves_by_mirrors({&near, 1}, limits.max_reflections),
               halves_by_mirrors({&*far, 1}, limits.max_reflections), 1.0, 1, limits, chains);
  }
}

}  // namespace detail

inline std::vector<double> count_chains(std::span<const EdgeReach::Edge> receiver,
                                        std::span<const EdgeReach::Edge> transmitter, const ChainLimits& limits) {
  std::vector<double> chains(limits.max_interactions + 1, 0.0);
  if (limits.max_diffractions > 0) detail::add_chains_at_one_edge(receiver, transmitter, limits, chains);
  const auto near = detail::halves_by_mirrors(receiver, limits.max_reflections);
  const auto far = detail::halves_by_mirrors(transmitter, limits.max_reflections);
  double between = 1.0;  // ways to choose the edges between the first and the last
  for (std::size_t edges = 2; edges <= limits.max_diffractions; ++edges) {
    detail::add_joined(near, far, between, edges, limits, chains);
    between *= static_cast<double>(transmitter.size());
  }
  for (std::size_t most = 1; most < chains.size(); ++most) chains[most] += chains[most - 1];
  return chains;
}

}  // namespace dcem
