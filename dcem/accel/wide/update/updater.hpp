#pragma once
/// Keeps a wide tree fit while the scene moves: follows what moved, and mends what that has degraded, at the least
/// price that will do.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/settings.hpp"
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

/// What rays of a drive spend on a tree, against what they spent when the tree was new. Counts, no times: the same for
/// every machine and any number of threads.
class WideStepMeter {
 public:
  /// What so many rays spend after a build is what the others are compared with.
  static constexpr std::uint64_t rays_of_base = 10'000;

  /// The tree is new.
  void restart() { *this = {}; }

  /// Tells what some rays have spent. Which kinds of rays they are must not change much from frame to frame.
  void add(const TraversalCounters& spent, std::uint64_t rays) {
    const auto nodes = static_cast<double>(spent.nodes_visited), count = static_cast<double>(rays);
    if (rays == 0) return;
    nodes_per_ray_ = nodes_per_ray_ > 0.0 ? nodes_per_ray_ + (nodes / count - nodes_per_ray_) / 8.0 : nodes / count;
    if (base_rays_ < static_cast<double>(rays_of_base)) {
      base_nodes_ += nodes;
      base_rays_ += count;
    } else {
      // What better frames spare is not saved up for worse ones: the tree as it is now counts.
      wasted_nodes_ = std::max(0.0, wasted_nodes_ + nodes - base_nodes_ / base_rays_ * count);
    }
  }

  /// Nodes visited per ray, a mean that forgets a frame in eight; 0 before there were rays.
  double steps_per_ray() const { return nodes_per_ray_; }
  /// The same for the rays that followed the build; 0 before there were rays.
  double steps_at_build() const { return base_rays_ > 0.0 ? base_nodes_ / base_rays_ : 0.0; }
  /// Nodes visited since the build that a new tree would have spared.
  double wasted_nodes() const { return wasted_nodes_; }

 private:
  double nodes_per_ray_ = 0.0, base_nodes_ = 0.0, base_rays_ = 0.0, wasted_nodes_ = 0.0;
};

/// Decides for one `WideBvh`, whose objects are the objects of a scene.
///
/// In this order, each only where it is switched on, and only in frames in which something moved:
/// 1. Refit: always.
/// 2. Reinsertion of objects whose surroundings have grown (WideBvh::reinsert_moved).
/// 3. Rotations along the paths that were touched (WideBvh::rotate_touched).
/// 4. The two measures of degradation along these paths (degradation.hpp); a subtree past one of the limits is built
/// anew in
///    place, the smallest first: what it has mended is no degradation of a larger one.
/// 5. What rays have wasted: once that would have paid for building all nodes anew, they are; with reinsertion, in each
///    frame one child of the root. Who rents until the rent has reached the price, and then buys, never
///    pays twice as much as who knew before.
/// 6. All nodes in the same way, too, where that makes them better, once refits have visited them often enough that
///    building them anew is small change: neither measure sees a tree that might be better than it ever was. Once, too,
///    in the first frame in which something moves: a whole build weighs an object as one quad, and where there are many
///    its nodes are not the best over the leaves that came out.
/// 7. The whole tree, leaves included, where the others do not help.
class WideUpdater {
 public:
  explicit WideUpdater(const WideUpdateSettings& settings = {}) : settings_(settings) { validate(settings); }

  const WideUpdateSettings& settings() const { return settings_; }
  const WideStepMeter& steps() const { return steps_; }

  /// Tells what rays have spent since the last update. Without it, steps per ray decide nothing.
  void note_rays(const TraversalCounters& spent, std::uint64_t rays) { steps_.add(spent, rays); }

  /// Brings the tree up to date after the triangles in `moved` have got the corners and boxes given here. An object
  /// that was put elsewhere counts as one rebuilt subtree of one node.
  /// `pool`: as in `WideBvh::refit`.
  TreeUpdateReport update(WideBvh& tree, std::span<const std::uint32_t> moved, const TriangleView& mesh,
                          WideBvh::Boxes boxes, ThreadPool* pool = nullptr);

  /// Whether a subtree is due by either measure. Where a node has nothing but leaves, it can be built in one way
  /// only: such a node is never degraded.
  bool is_degraded(const Degradation& degradation) const;

 private:
  TrackedMeasures watch() const;

  void mend(WideBvh& tree, const TriangleView& mesh, WideBvh::Boxes boxes, TreeUpdateReport& report, ThreadPool* pool);

  void renew_where_due(WideBvh& tree, TreeUpdateReport& report) {
    if (parts_.empty()) begin_renewal_where_due(tree);
    if (!parts_.empty()) renew_next_part(tree, report);
  }

  void begin_renewal_where_due(const WideBvh& tree);

  /// Not all at once, which would make one frame ten times as dear as the others, but one child of the
  /// root, and the next one in the next frame. That needs objects to be put elsewhere, or those that have driven away
  /// stay in the entry that they were in.
  void begin_renewal(const WideBvh& tree, double wanted_share);

  void renew_next_part(WideBvh& tree, TreeUpdateReport& report);

  void rebuild_degraded(WideBvh& tree, TreeUpdateReport& report);

  /// Whether it changed anything.
  bool rebuild_subtree(WideBvh& tree, std::uint32_t node, double wanted_share, TreeUpdateReport& report);

  void rebuild(WideBvh& tree, const TriangleView& mesh, WideBvh::Boxes boxes, TreeUpdateReport& report);
  void note_new_root(TreeUpdateReport& report);
  static std::uint64_t nodes_in_use(const WideBvh& tree);

  static constexpr double infinity = std::numeric_limits<double>::infinity();
  /// To this share Σ cost · surface must fall where a measure asks for a new plan: objects inserted one by one by what
  /// rays cost are as good as a plan that says it gains less.
  static constexpr double worth_writing = 0.97;

  WideUpdateSettings settings_;
  WideStepMeter steps_;
  std::uint64_t frames_moved_ = 0;           ///< frames in which something moved
  double visited_since_renewal_ = infinity;  ///< nodes and leaves, by refits; infinite after a whole build
  std::vector<std::uint32_t> degraded_;      ///< candidates
  std::vector<std::uint32_t> parts_;         ///< nodes whose turn is still to come in a renewal
  double wanted_of_parts_ = infinity;        ///< as WideBvh::rebuild_subtree has it
  bool is_renewed_ = false;                  ///< whether one of them has changed anything
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/accel/wide/update/updater_bodies.hpp"
#endif
