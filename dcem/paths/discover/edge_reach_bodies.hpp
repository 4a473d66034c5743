#pragma once
/// Bodies of edge_reach.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/edge_reach.hpp"

namespace dcem {

namespace detail {

/// An edge and a second number, which counts where the edges are the same.
inline std::uint64_t key_of(WedgeId edge, std::uint32_t second) {
  return std::uint64_t{edge.value} << 32U | second;
}
inline WedgeId edge_of(std::uint64_t key) {
  return WedgeId(key >> 32U);
}
inline std::uint32_t second_of(std::uint64_t key) {
  return static_cast<std::uint32_t>(key);
}

}  // namespace detail

DCEM_INLINE std::span<const EdgeReach::Edge> EdgeReach::edges() {
  list_ways();
  list_views();
  return edges_;
}

DCEM_INLINE void EdgeReach::list_ways() {
  keys_.clear();
  for (std::size_t number = 0; number < halves_.size(); ++number) {
    keys_.push_back(detail::key_of(halves_[number].back().edge(), static_cast<std::uint32_t>(number)));
  }
  std::ranges::sort(keys_);
  ways_.clear();
  ways_.reserve(keys_.size());  // edges point to them
  edges_.clear();
  for (const std::uint64_t key : keys_) {
    const std::span<const SequenceElement> half = halves_[detail::second_of(key)];
    ways_.push_back(half.first(half.size() - 1));
    const WedgeId id = detail::edge_of(key);
    if (edges_.empty() || edges_.back().id != id) edges_.push_back({id, {&ways_.back(), 0}, {}});
    edges_.back().mirrors = {edges_.back().mirrors.data(), edges_.back().mirrors.size() + 1};
  }
}

DCEM_INLINE void EdgeReach::list_views() {
  keys_.clear();
  views_.for_each([&](std::span<const SequenceElement> view) {
    keys_.push_back(detail::key_of(view.front().edge(), view.back().mirror().value));
  });
  std::ranges::sort(keys_);
  viewed_.clear();
  viewed_.reserve(keys_.size());
  auto edge = edges_.begin();
  for (const std::uint64_t key : keys_) {
    while (edge != edges_.end() && edge->id < detail::edge_of(key)) ++edge;
    if (edge == edges_.end()) return;
    if (edge->id != detail::edge_of(key)) continue;
    viewed_.emplace_back(detail::second_of(key));
    edge->in_view = {edge->in_view.empty() ? &viewed_.back() : edge->in_view.data(), edge->in_view.size() + 1};
  }
}

}  // namespace dcem
