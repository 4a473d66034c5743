#pragma once
/// What solving links took, and a device as fields see it: shared by the parts of `Simulator`.
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/field/diffuse/diffuse_contribution.hpp"
#include "dcem/field/radio_end.hpp"
#include "dcem/paths/discover/search_counters.hpp"
#include "dcem/paths/halves/link_halves.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/detail/frame_links.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

/// What links took.
struct Spent {
  Spent& operator+=(const Spent& other) {
    work += other.work;
    cache += other.cache;
    return *this;
  }

  WorkCounters work;
  CacheCounters cache;
};

/// Links, and what they took.
struct Solved {
  std::vector<LinkResult> links;
  Spent spent;
};

/// Those of a frame; `by_worker`: what the receivers took that each thread has solved, `of_transmitters` beside. Sums
/// of counts, and the largest of a figure, do not depend on which those are.
inline Solved sum_up(FrameLinks&& links, std::span<const Spent> by_worker, const WorkCounters& of_transmitters) {
  Solved all{std::move(links).take(), {of_transmitters, {}}};
  for (const Spent& one : by_worker) all.spent += one;
  return all;
}

inline void add_search_work(const SearchCounters& counters, WorkCounters& work) {
  work.rays += counters.rays;
  work.legs += counters.solver.legs;
  work.sequences_proposed += counters.sequences_proposed;
  work.sequences_solved += counters.solver.sequences_solved;
  work.nodes_visited += counters.solver.traversal.nodes_visited;
  work.primitives_tested += counters.solver.traversal.primitives_tested;
}

/// Pixels of a view of so many facets, `most` at most: where they are few, little can be hidden, and to fill many
/// pixels takes longer than it saves. By measurement.
inline int pixels_for_facets(int most, std::size_t facets) {
  return std::min(most, facets <= 256 ? 64 : facets <= 1'024 ? 128 : most);
}

/// Pixels of the view maps of so many transmitters: 6 MB each, less where they are many.
inline int view_pixels_for(std::size_t transmitters) {
  if (transmitters <= 4) return 2 * PathHalf::default_pixels;
  return transmitters <= 64 ? PathHalf::default_pixels : transmitters <= 1024 ? PathHalf::default_pixels / 2 : 64;
}
/// The same where very many receivers pay for what a coarse map shows: 25 MB each at most.
inline int fine_view_pixels_for(std::size_t transmitters) {
  return transmitters <= 4 ? 1024 : transmitters <= 16 ? 512 : view_pixels_for(transmitters);
}

/// A device in a frame as fields see it.
inline RadioEnd radio_end(const Device& device, const DeviceState& state) {
  return {state.position_m, state.velocity_mps, device.antenna, state.rotation, device.power_dbm};
}

inline void add_diffuse_work(const DiffusePower& diffuse, WorkCounters& work) {
  work.nodes_visited += diffuse.traversal.nodes_visited;
  work.primitives_tested += diffuse.traversal.primitives_tested;
  work.diffuse_tiles += diffuse.tiles_evaluated;
  work.diffuse_links_unfinished += diffuse.converged ? 0 : 1;
  if (!(diffuse.power_ratio > 0.0)) return;  // of nothing there is no share
  const double residual_db = power_ratio_to_db(1.0 + diffuse.residual_ratio / diffuse.power_ratio);
  work.diffuse_residual_db = std::max(work.diffuse_residual_db, residual_db);
}

}  // namespace dcem::detail
