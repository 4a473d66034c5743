#pragma once
/// Bodies of sight.hpp: how a `Sight` looks a second time, cell by cell.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/hiding_outlines.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

DCEM_INLINE std::size_t Sight::count_small(const FacetOutlines& outlines, std::span<const FacetId> seen) const {
  constexpr double small_pixels = 4.0;  // in the middle of a face, by measurement
  const double share = small_pixels / (0.5 * map_.pixels());
  return static_cast<std::size_t>(std::ranges::count_if(seen, [&](FacetId id) {
    const Aabb<double>& box = outlines.of(id).box;
    return glm::length(box.extent()) < share * glm::distance(box.center(), position_m());
  }));
}

/// Once more, cell by cell, with as many pixels for a crowded cell as a face has in the map: leaves what these show.
DCEM_INLINE void Sight::look_closer(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                    std::vector<FacetId>& seen, ThreadPool* pool) {
  if (beam_ || seen.size() < settings.closer_from) return;
  if (settings.closer_from > 0 && count_small(outlines, seen) < settings.closer_from) return;
  cells_.look_from(position_m());
  shown_.assign(seen.size(), 0);
  for (std::uint32_t place = 0; place < seen.size(); ++place) {
    if (!cells_.add(place, scene.hull_m(scene.facet(seen[place])))) shown_[place] = 1;
  }
  look_into_all(scene, outlines, settings, seen, pool);
  std::size_t kept = 0;
  for (std::size_t place = 0; place < seen.size(); ++place) {
    if (shown_[place] != 0) seen[kept++] = seen[place];
  }
  seen.resize(kept);
}

/// Each thread has a map of its own, for one cell after the other. Of one thread alone it stays.
DCEM_INLINE void Sight::look_into_all(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                      std::span<const FacetId> seen, ThreadPool* pool) {
  const int pixels = std::min(map_.pixels(), most_cell_pixels);
  if (pool == nullptr || pool->size() == 1) {
    if (!cell_map_) cell_map_.emplace(pixels);
    for (int cell = 0; cell < detail::ViewCells::count; ++cell) {
      look_into(scene, outlines, settings, cell, seen, *cell_map_);
    }
    return;
  }
  std::vector<std::optional<ViewMap>> maps(pool->size());
  pool->for_each(detail::ViewCells::count, [&](std::size_t cell, unsigned worker) {
    if (!maps[worker]) maps[worker].emplace(pixels);
    look_into(scene, outlines, settings, static_cast<int>(cell), seen, *maps[worker]);
  });
}

/// Marks the facets that are shown in a cell. Others may mark them at the same time.
DCEM_INLINE void Sight::look_into(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                  int cell, std::span<const FacetId> seen, ViewMap& map) {
  const std::span<const std::uint32_t> places = cells_.in(cell);
  const auto mark = [&](std::uint32_t place) { std::atomic_ref(shown_[place]).store(1, std::memory_order_relaxed); };
  if (places.size() < crowded) return std::ranges::for_each(places, mark), void();
  map.look_into(position_m(), cells_.corners_m(cell), offsets_m_);
  count_sheets(scene, settings, map);
  hide_nothing_below_feet(outlines, map);
  // Nearer, what strays may stray by more than the margin of a pixel, 0.002 of it; at the corners of the cube pixels
  // are a third as wide as in the middle of its faces.
  const double margin_rad = 2e-3 / (3.0 * 4.0 * map.pixels());
  const auto is_close = [&](FacetId id) {
    const FacetOutline& outline = outlines.of(id);
    const double away_m =
        glm::distance(glm::clamp(position_m(), outline.box.min, outline.box.max), position_m()) - 2.0 * radius_m_;
    return away_m * margin_rad < std::min(outline.stray_m, detail::flat_facet_m) || away_m < 0.1;
  };
  for (const std::uint32_t place : places) {
    if (!is_close(seen[place])) cover(scene, outlines, seen[place], settings, map);
  }
  for (const std::uint32_t place : places) {
    if (std::atomic_ref(shown_[place]).load(std::memory_order_relaxed) != 0) continue;
    const WorldFacet& facet = scene.facet(seen[place]);
    const bool is_seen = reaches_under_feet(outlines, seen[place]) ||
                         map.shows(scene.hull_m(facet), facet.plane, nearer_on(scene, outlines, seen[place]));
    if (is_seen) mark(place);
  }
}

}  // namespace dcem
