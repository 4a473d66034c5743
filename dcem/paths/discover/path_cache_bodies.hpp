#pragma once
/// Bodies of path_cache.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/path_cache.hpp"

namespace dcem {

DCEM_INLINE void sequence_of(const Path& path, Sequence& sequence) {
  sequence.clear();
  for (auto interaction = path.interactions.rbegin(); interaction != path.interactions.rend(); ++interaction) {
    if (interaction->kind == InteractionKind::reflection) sequence.emplace_back(interaction->facet);
    if (interaction->kind == InteractionKind::diffraction) sequence.emplace_back(interaction->wedge);
  }
}

DCEM_INLINE std::size_t PathCache::count_in(std::span<const Link> links) {
  std::size_t count = 0;
  for (const Link& link : links) count += link.is_there ? link.sequences.size() : 0;
  return count;
}

DCEM_INLINE std::size_t PathCache::clear() {
  const std::size_t forgotten = count_in(links_);
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
    if (place < links_.size()) kept[link] = std::exchange(links_[place], {});
  }
  const std::size_t forgotten = count_in(links_);
  links_ = std::move(kept);
  transmitters_.assign(transmitters.begin(), transmitters.end());
  return forgotten;
}

DCEM_INLINE void PathCache::begin_frame(std::size_t transmitters) {
  std::swap(links_, before_);
  links_.resize(transmitters);
  for (Link& link : links_) link.is_there = false;
}

DCEM_INLINE void PathCache::remember(std::size_t transmitter, std::span<const Path> paths) {
  Link& link = links_.at(transmitter);
  link.is_there = true;
  link.sequences.clear();
  for (const Path& path : paths) {
    sequence_of(path, sequence_);
    link.sequences.insert(sequence_);
  }
}

}  // namespace dcem
