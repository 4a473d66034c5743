#pragma once
/// Nodes of a wide tree whose children have other boxes than before, and the boxes above them.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/accel/wide/arrays.hpp"

namespace dcem::detail {

/// Collects nodes and makes the boxes above them tight, node by node: of what moved together most ways up are the
/// same. Allocates nothing once its lists have grown.
class LooseNodes {
 public:
  /// A box of one of its children has changed.
  void add(std::uint32_t node) {
    if (node >= is_added_.size()) is_added_.resize(node + 1, 0);
    if (is_added_[node] != 0) return;
    is_added_[node] = 1;
    nodes_.push_back(node);
  }

  /// Makes the boxes above all of them tight again, as far up as they change, and forgets them. Returns how many nodes
  /// were looked at. The boxes are those that `WideArrays::tighten_above` would leave after each of them.
  std::size_t tighten_all(WideArrays& arrays) {
    // Nodes are added behind those that are looked at. One is looked at again only where another way up to it is
    // longer.
    std::size_t visited = 0;
    for (; visited < nodes_.size(); ++visited) {
      const std::uint32_t node = nodes_[visited];
      is_added_[node] = 0;
      const NodeLane place = arrays.lane_of_node[node];
      if (place.is_none()) continue;
      const Aabb<float> box = arrays.nodes[node].box();
      if (box == arrays.box_at(place)) continue;
      arrays.set_box(place, box);
      add(place.node());
    }
    nodes_.clear();
    return visited;
  }

 private:
  std::vector<std::uint32_t> nodes_;
  std::vector<char> is_added_;  ///< per node
};

}  // namespace dcem::detail
