#pragma once
/// A plan for building a part of a wide tree anew above its leaves and objects.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/accel/wide/build/collapse.hpp"
#include "dcem/accel/wide/levels.hpp"

namespace dcem {

namespace detail {

/// What a node leads to where its level ends: a leaf or an object.
struct WideLeaf {
  WideChild child;
  Aabb<float> box;
};

/// Σ cost · half surface over what hangs in one node.
inline double weighted_area(const WideArrays& arrays, const WideNode& node) {
  double sum_m2 = 0.0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const double cost = node.child[lane].is_leaf() ? arrays.costs.leaf : arrays.costs.node;
    if (!node.child[lane].is_none()) sum_m2 += cost * static_cast<double>(node.box(lane).half_area());
  }
  return sum_m2;
}

/// The same over all that is below a node in its level.
inline double level_area_below(const WideArrays& arrays, std::uint32_t node) {
  double sum_m2 = weighted_area(arrays, arrays.nodes[node]);
  for (const WideChild child : arrays.nodes[node].child) {
    if (is_level_node(arrays, child)) sum_m2 += level_area_below(arrays, child.index());
  }
  return sum_m2;
}

/// A plan for the part of a level that hangs below one node. Changes nothing.
class WidePlan {
 public:
  WidePlan() = default;
  WidePlan(const WideArrays& arrays, std::uint32_t node, unsigned threads, bool by_size = true) {
    make(arrays, node, threads, by_size);
  }
  // Nothing in it outlives the edit that it is made for.
  WidePlan(const WidePlan&) : WidePlan() {}
  WidePlan& operator=(const WidePlan&) { return *this; }
  ~WidePlan() = default;

  /// `by_size`: see WideBuildSettings::divide_by_size. With one thread nothing is allocated once the lists have grown.
  void make(const WideArrays& arrays, std::uint32_t node, unsigned threads, bool by_size = true) {
    leaves_.clear();
    collect(arrays, node);
    set_items_around(arrays.nodes[node].box(), by_size);
    binner_.build(items_, 1, threads, binary_);
    collapse_.plan(binary_, items_, arrays.costs);
  }

  bool empty() const { return leaves_.empty(); }
  /// Of a binary node that becomes no wide one.
  bool is_leaf(std::uint32_t slot) const { return collapse_.is_leaf(slot); }
  const WideLeaf& leaf(std::uint32_t slot) const { return leaves_[items_[binary_[slot].first].index]; }

  /// What the wide node of a binary one holds, the largest first. Returns how many.
  std::size_t entries(std::uint32_t slot, std::array<std::uint32_t, simd_lanes>& found) const {
    return collapse_.entries(slot, found);
  }

  /// Σ cost · half surface of what will be below the node.
  double weighted_area_m2(const WideCosts& costs, std::uint32_t slot = 0) const {
    double sum_m2 = 0.0;
    if (slot == 0 && is_leaf(0)) return weight_m2(costs, 0);
    collapse_.for_each_entry(slot, [&](std::uint32_t entry) {
      sum_m2 += weight_m2(costs, entry);
      if (!is_leaf(entry)) sum_m2 += weighted_area_m2(costs, entry);
    });
    return sum_m2;
  }

  /// Levels of wide nodes.
  std::uint32_t levels(std::uint32_t slot = 0) const {
    if (is_leaf(slot)) return 0;
    std::uint32_t below = 0;
    collapse_.for_each_entry(slot, [&](std::uint32_t entry) { below = std::max(below, levels(entry)); });
    return below + 1;
  }

 private:
  double weight_m2(const WideCosts& costs, std::uint32_t slot) const {
    const bool is_quad_leaf = is_leaf(slot) && leaf(slot).child.is_leaf();
    return (is_quad_leaf ? costs.leaf : costs.node) * static_cast<double>(binary_[slot].half_area_m2);
  }

  void collect(const WideArrays& arrays, std::uint32_t node) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = arrays.nodes[node].child[lane];
      if (is_level_node(arrays, child)) {
        collect(arrays, child.index());
      } else if (!child.is_none()) {
        leaves_.push_back({child, arrays.nodes[node].box(lane)});
      }
    }
  }

  void set_items_around(const Aabb<float>& all, bool by_size) {
    // What is absent is put where it stretches nothing.
    const Aabb<float> middle =
        all.empty() ? Aabb<float>{Vector3<float>(0.0F), Vector3<float>(0.0F)} : Aabb<float>{all.center(), all.center()};
    items_.clear();
    for (const WideLeaf& leaf : leaves_) {
      const Aabb<float>& box = leaf.box.empty() ? middle : leaf.box;
      items_.push_back({Float4{box.min.x, box.min.y, box.min.z, 0.0F}, Float4{box.max.x, box.max.y, box.max.z, 0.0F},
                        static_cast<std::uint32_t>(items_.size()), WideItem::no_kind});
      if (by_size) items_.back().note_size();
    }
  }

  std::vector<WideLeaf> leaves_;
  std::vector<WideItem> items_;
  WideBinner binner_;
  std::vector<WideSplit> binary_;
  WideCollapse collapse_;
};

}  // namespace detail

}  // namespace dcem
