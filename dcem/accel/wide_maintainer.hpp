#pragma once
/// Keeps a wide tree fit while the scene moves: follows what moved, and hangs it elsewhere where its old place has
/// grown.
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/accel/maintainer.hpp"
#include "dcem/accel/wide_tree.hpp"

namespace dcem {

/// Decides for one `WideTree`, whose groups are the objects of a scene. Of UpkeepSettings the policy, the limit of the
/// SAH measure and the two of reinsertion count: RT-DEFORM's measure and renewal belong to the binary tree.
class WideMaintainer {
 public:
  explicit WideMaintainer(const UpkeepSettings& settings = {}) : settings_(settings) { validate(settings); }

  const UpkeepSettings& settings() const { return settings_; }

  /// Brings the tree up to date after the triangles in `moved` have got the corners and boxes given here. A unit that
  /// was hung elsewhere counts as one rebuilt subtree of one node.
  UpkeepReport update(WideTree& tree, std::span<const std::uint32_t> moved, const TriangleView& mesh,
                      WideTree::Boxes boxes) const {
    UpkeepReport report;
    if (settings_.policy == TreePolicy::rebuild_always && !moved.empty()) {
      rebuild(tree, mesh, boxes, report);
    } else {
      const WideRefitReport refit = tree.refit(moved, mesh, boxes);
      report.nodes_refit = refit.blocks_written + refit.nodes_visited;
      if (settings_.policy == TreePolicy::adaptive && !moved.empty()) mend(tree, mesh, boxes, report);
    }
    const std::uint64_t touched = report.nodes_refit + report.nodes_rebuilt, in_use = nodes_in_use(tree);
    report.nodes_kept = in_use > touched ? in_use - touched : 0;
    report.sah_cost = tree.sah_cost();
    report.sah_cost_at_build = tree.quality().sah_at_build;
    return report;
  }

 private:
  void mend(WideTree& tree, const TriangleView& mesh, WideTree::Boxes boxes, UpkeepReport& report) const {
    report.subtrees_rebuilt = report.nodes_rebuilt =
        tree.reinsert_moved(settings_.reinsertion_growth, settings_.reinsertion_turn);
    if (tree.quality().ratio() > settings_.sah_growth_limit) rebuild(tree, mesh, boxes, report);
  }
  static void rebuild(WideTree& tree, const TriangleView& mesh, WideTree::Boxes boxes, UpkeepReport& report) {
    tree.rebuild(mesh, boxes);
    report.nodes_refit = 0;
    report.nodes_rebuilt = nodes_in_use(tree);
    report.subtrees_rebuilt = 1;
    report.root_rebuilt = true;
  }
  static std::uint64_t nodes_in_use(const WideTree& tree) {
    const WideArrays& arrays = tree.arrays();
    return arrays.nodes.size() - arrays.free_nodes.size() + arrays.blocks.size();
  }

  UpkeepSettings settings_;
};

namespace detail {

template <>
struct MaintainerOf<WideTree> {
  using type = WideMaintainer;
};

}  // namespace detail

}  // namespace dcem
