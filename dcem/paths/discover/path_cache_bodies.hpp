#pragma once
/// Bodies of path_cache.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/path_cache.hpp"

namespace dcem {

DCEM_INLINE Sequence sequence_of(const Path& path) {
  Sequence sequence;
  for (auto interaction = path.interactions.rbegin(); interaction != path.interactions.rend(); ++interaction) {
    if (interaction->kind == InteractionKind::reflection) sequence.emplace_back(interaction->facet);
    if (interaction->kind == InteractionKind::diffraction) sequence.emplace_back(interaction->wedge);
  }
  return sequence;
}

DCEM_INLINE std::size_t PathCache::clear() {
  std::size_t forgotten = 0;
  for (const Link& link : links_) forgotten += link ? link->size() : 0;
  links_.clear();
  proposals_.clear();
  reach_.clear();
  return forgotten;
}

DCEM_INLINE std::size_t PathCache::select(std::span<const std::uint32_t> transmitters) {
  std::vector<Link> kept(transmitters.size());
  for (std::size_t link = 0; link < transmitters.size(); ++link) {
    const auto before = std::lower_bound(transmitters_.begin(), transmitters_.end(), transmitters[link]);
    if (before == transmitters_.end() || *before != transmitters[link]) continue;
    const auto place = static_cast<std::size_t>(before - transmitters_.begin());
    if (place < links_.size()) kept[link] = std::exchange(links_[place], std::nullopt);
  }
  std::size_t forgotten = 0;
  for (const Link& link : links_) forgotten += link ? link->size() : 0;
  links_ = std::move(kept);
  transmitters_.assign(transmitters.begin(), transmitters.end());
  return forgotten;
}

DCEM_INLINE void PathCache::remember(std::size_t transmitter, std::span<const Path> paths) {
  std::vector<Sequence>& sequences = links_.at(transmitter).emplace();
  for (const Path& path : paths) sequences.push_back(sequence_of(path));
}

}  // namespace dcem
