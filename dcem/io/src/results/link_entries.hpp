#pragma once
/// Specular paths and tiles of rough surfaces as one list, for the files that list paths. Private to dcem::io.
#include <algorithm>
#include <vector>

#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// One of the two.
struct LinkEntry {
  const PathContribution* path = nullptr;
  const DiffuseContribution* tile = nullptr;

  const Path& geometry() const { return path != nullptr ? path->path : tile->path; }
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

}  // namespace dcem::io
