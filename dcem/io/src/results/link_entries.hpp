#pragma once
/// Specular paths and tiles of rough surfaces as one list, for the files that list paths. Private to dcem::io.
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// One of the two.
struct LinkEntry {
  const PathContribution* path = nullptr;
  const DiffuseContribution* tile = nullptr;

  const Path& geometry() const { return path != nullptr ? path->path : tile->path; }
  double power_ratio() const { return path != nullptr ? path->power_ratio : tile->sample.power_ratio; }
};

/// In the order in which paths are reported. Tiles have a geometry where `DiffuseSettings::list_paths` is set, and only
/// then may be asked for.
inline std::vector<LinkEntry> link_entries(const LinkResult& link, bool with_tiles) {
  std::vector<LinkEntry> entries;
  for (const PathContribution& path : link.paths) entries.push_back({&path, nullptr});
  if (!with_tiles) return entries;
  for (const DiffuseContribution& tile : link.diffuse.tiles) entries.push_back({nullptr, &tile});
  std::stable_sort(entries.begin(), entries.end(),
                   [](const LinkEntry& a, const LinkEntry& b) { return reported_before(a.geometry(), b.geometry()); });
  return entries;
}

/// Leaves the `count` strongest, in the order in which they stand; of equals those that stand first.
inline void keep_strongest(std::vector<LinkEntry>& entries, std::size_t count) {
  if (entries.size() <= count) return;
  std::vector<std::size_t> places(entries.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::stable_sort(places.begin(), places.end(),
                   [&](std::size_t a, std::size_t b) { return entries[a].power_ratio() > entries[b].power_ratio(); });
  places.resize(count);
  std::sort(places.begin(), places.end());
  std::vector<LinkEntry> kept;
  for (const std::size_t place : places) kept.push_back(entries[place]);
  entries = std::move(kept);
}

}  // namespace dcem::io
