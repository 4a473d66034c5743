#pragma once
/// Bodies of updater.hpp.
#include <cmath>

#include "dcem/accel/wide/update/updater.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem {

DCEM_INLINE TreeUpdateReport WideUpdater::update(WideBvh& tree, std::span<const std::uint32_t> moved,
                                                 const TriangleView& mesh, WideBvh::Boxes boxes, ThreadPool* pool) {
  TreeUpdateReport report;
  if (settings_.policy == TreePolicy::rebuild_always && !moved.empty()) {
    rebuild(tree, mesh, boxes, report);
  } else {
    tree.watch(watch());
    const WideRefitReport refit = tree.refit(moved, mesh, boxes, pool);
    report.nodes_refit = refit.leaves_written + refit.nodes_visited;
    visited_since_renewal_ += static_cast<double>(report.nodes_refit);
    if (settings_.policy == TreePolicy::adaptive && !moved.empty()) mend(tree, mesh, boxes, report, pool);
  }
  const std::uint64_t touched = report.nodes_refit + report.nodes_rebuilt, in_use = nodes_in_use(tree);
  report.nodes_kept = in_use > touched ? in_use - touched : 0;
  report.sah_cost = tree.sah_cost();
  report.sah_cost_at_build = tree.quality().sah_at_build;
  return report;
}

DCEM_INLINE bool WideUpdater::is_degraded(const Degradation& degradation) const {
  return degradation.inner_nodes > 1 && (degradation.sah_growth() > settings_.sah_growth_limit ||
                                         degradation.deformation() > settings_.deformation_limit);
}

DCEM_INLINE TrackedMeasures WideUpdater::watch() const {
  if (settings_.policy != TreePolicy::adaptive) return {};
  return {settings_.subtree_rebuilds && std::isfinite(settings_.sah_growth_limit),
          settings_.subtree_rebuilds && std::isfinite(settings_.deformation_limit), settings_.rotations_per_node > 0};
}

DCEM_INLINE void WideUpdater::mend(WideBvh& tree, const TriangleView& mesh, WideBvh::Boxes boxes,
                                   TreeUpdateReport& report, ThreadPool* pool) {
  report.reinserted = tree.reinsert_moved(settings_.reinsertion_growth, settings_.reinsertion_turn, pool);
  report.subtrees_rebuilt = report.nodes_rebuilt = report.reinserted;
  const bool looks_closer = ++frames_moved_ % settings_.check_interval == 0;
  if (looks_closer && settings_.rotations_per_node > 0) {
    report.rotated = tree.rotate_touched(settings_.rotations_per_node);
  }
  if (settings_.subtree_rebuilds) {
    if (looks_closer && tree.tracked().measures()) rebuild_degraded(tree, report);
    renew_where_due(tree, report);
  }
  const double limit = settings_.subtree_rebuilds ? settings_.rebuild_growth_limit : settings_.sah_growth_limit;
  if (tree.quality().ratio() > limit) rebuild(tree, mesh, boxes, report);
}

DCEM_INLINE void WideUpdater::begin_renewal_where_due(const WideBvh& tree) {
  const auto leaves = static_cast<double>(tree.arrays().leaves.size());
  const auto all = static_cast<double>(nodes_in_use(tree));
  if (steps_.wasted_nodes() > settings_.subtree_rebuild_price * leaves) {
    begin_renewal(tree, infinity);
  } else if (std::isfinite(settings_.renewal_ratio) && visited_since_renewal_ > settings_.renewal_ratio * all) {
    begin_renewal(tree, worth_writing);
  }
}

DCEM_INLINE void WideUpdater::begin_renewal(const WideBvh& tree, double wanted_share) {
  if (std::isfinite(settings_.reinsertion_growth)) {
    for (const WideChild child : tree.arrays().nodes[0].child) {
      if (detail::is_level_node(tree.arrays(), child)) parts_.push_back(child.index());
    }
  }
  if (parts_.empty()) parts_.push_back(0);
  wanted_of_parts_ = wanted_share;
  visited_since_renewal_ = 0.0;
}

DCEM_INLINE void WideUpdater::renew_next_part(WideBvh& tree, TreeUpdateReport& report) {
  const std::uint32_t node = parts_.back();
  parts_.pop_back();
  // Another edit may have given it up.
  if (detail::is_used_node(tree.arrays(), node)) {
    is_renewed_ = rebuild_subtree(tree, node, wanted_of_parts_, report) || is_renewed_;
  }
  if (!parts_.empty() || !is_renewed_) return;
  note_new_root(report);
  is_renewed_ = false;
}

DCEM_INLINE void WideUpdater::rebuild_degraded(WideBvh& tree, TreeUpdateReport& report) {
  const std::span<const std::uint32_t> measured = tree.measure();
  degraded_.assign(measured.begin(), measured.end());
  for (const std::uint32_t node : degraded_) {
    // One that was rebuilt_in_place from further above than was asked for may have taken others with it.
    if (detail::is_used_node(tree.arrays(), node) && is_degraded(tree.degradation()[node]))
      rebuild_subtree(tree, node, worth_writing, report);
  }
}

DCEM_INLINE bool WideUpdater::rebuild_subtree(WideBvh& tree, std::uint32_t node, double wanted_share,
                                              TreeUpdateReport& report) {
  const std::size_t written = tree.rebuild_subtree(node, wanted_share);
  report.nodes_rebuilt += written;
  report.subtrees_rebuilt += written > 0 ? 1U : 0U;
  report.rebuilt_in_place += written > 0 ? 1U : 0U;
  return written > 0;
}

DCEM_INLINE void WideUpdater::rebuild(WideBvh& tree, const TriangleView& mesh, WideBvh::Boxes boxes,
                                      TreeUpdateReport& report) {
  tree.rebuild(mesh, boxes);
  report.nodes_refit = 0;
  report.nodes_rebuilt = nodes_in_use(tree);
  report.subtrees_rebuilt = 1;
  note_new_root(report);
  visited_since_renewal_ = infinity;
  parts_.clear();
  is_renewed_ = false;
}

DCEM_INLINE void WideUpdater::note_new_root(TreeUpdateReport& report) {
  report.root_rebuilt = true;
  steps_.restart();
}

DCEM_INLINE std::uint64_t WideUpdater::nodes_in_use(const WideBvh& tree) {
  const WideArrays& arrays = tree.arrays();
  return arrays.nodes.size() - arrays.free_nodes.size() + arrays.leaves.size();
}

}  // namespace dcem
