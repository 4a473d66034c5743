#pragma once
/// What a frame brings forth.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/accel/tree_settings.hpp"
#include "dcem/channel/link_statistics.hpp"
#include "dcem/field/diffuse/diffuse_contribution.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/discover/cache_counters.hpp"

namespace dcem {

/// One transmitter and one receiver in one frame.
struct LinkResult {
  std::size_t transmitter = 0;          ///< index into the scene's transmitters
  std::size_t receiver = 0;             ///< index into the receivers that were solved
  bool complete = false;                ///< every valid path within the declared orders is there
  std::vector<PathContribution> paths;  ///< specular, by delay, then kinds, then points
  DiffusePower diffuse;                 ///< of rough surfaces; empty where it is not asked for
  LinkStatistics statistics;
  /// No path appears or vanishes while no point of either end or of any body has moved by more than this since the
  /// frame, metres. None where it is not asked for, or nothing is proved.
  std::optional<double> valid_until_m{};
};

/// A link that is asked for: indices of its ends among devices of the caller's.
struct LinkRequest {
  std::size_t transmitter = 0;
  std::size_t receiver = 0;
};

/// Work done, counted. Counts do not depend on the number of threads.
struct WorkCounters {
  std::uint64_t rays = 0;                ///< rays shot to discover sequences, branches included
  std::uint64_t legs = 0;                ///< legs tested for obstruction
  std::uint64_t sequences_proposed = 0;  ///< distinct sequences of facets, over all receivers
  std::uint64_t sequences_solved = 0;    ///< (sequence, transmitter) pairs handed to the image method
  std::uint64_t paths = 0;
  std::uint64_t diffuse_tiles = 0;             ///< points of rough surfaces that were looked at
  std::uint64_t diffuse_links_unfinished = 0;  ///< links whose diffuse power has not converged within its budget
  double diffuse_residual_db = 0.0;            ///< largest estimate of what may be missing of a link's diffuse power
  std::uint64_t nodes_visited = 0;
  std::uint64_t primitives_tested = 0;

  WorkCounters& operator+=(const WorkCounters& other) {
    rays += other.rays;
    legs += other.legs;
    sequences_proposed += other.sequences_proposed;
    sequences_solved += other.sequences_solved;
    paths += other.paths;
    diffuse_tiles += other.diffuse_tiles;
    diffuse_links_unfinished += other.diffuse_links_unfinished;
    diffuse_residual_db = std::max(diffuse_residual_db, other.diffuse_residual_db);
    nodes_visited += other.nodes_visited;
    primitives_tested += other.primitives_tested;
    return *this;
  }
};

struct FrameResult {
  std::size_t index = 0;
  double time_s = 0.0;
  std::vector<LinkResult> links;  ///< by transmitter, then receiver; links of absent devices are left out
  WorkCounters work;
  TreeUpdateReport tree;       ///< how the tree followed the frame
  CacheCounters cache;         ///< what became of the remembered sequences; zero where the cache is off
  double update_time_s = 0.0;  ///< wall-clock time to move the scene and the tree
  double solve_time_s = 0.0;   ///< wall-clock time to find paths and compute fields
};

}  // namespace dcem
