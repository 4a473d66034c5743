#pragma once
/// Builds a wide tree: a binary tree over quads and objects, collapsed to eight children a node.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/accel/wide/build/collapse.hpp"
#include "dcem/accel/wide/build/leaf_optimizer.hpp"
#include "dcem/accel/wide/build/quads.hpp"
#include "dcem/accel/wide/build/reinsertion_optimizer.hpp"
#include "dcem/accel/wide/settings.hpp"
#include "dcem/accel/wide/update/leaf_writer.hpp"
#include "dcem/core/thread_pool.hpp"

namespace dcem {

/// Fills the arrays of one tree.
class WideBuilder {
 public:
  explicit WideBuilder(const WideBuildSettings& settings) : settings_(settings) {}

  /// Group i has the quads [first_quad[i], first_quad[i + 1]). Corners, origin and presence are set in `arrays`.
  void build(WideArrays& arrays, std::span<const Quad> quads, std::span<const std::uint32_t> first_quad) {
    arrays_ = &arrays;
    quads_ = quads;
    arrays.take_node();  // the root is node 0, before the nodes of any object
    const std::size_t objects = first_quad.size() - 1;
    arrays.object_root.assign(objects, WideChild{});
    std::vector<WideItem> items;
    items.reserve(quads.size());
    for (std::uint32_t object = 0; object < objects; ++object) {
      if (first_quad[object + 1] - first_quad[object] > settings_.object_subtree_limit) {
        for (std::uint32_t quad = first_quad[object]; quad < first_quad[object + 1]; ++quad) {
          items.push_back(item_around(arrays_->box_of_quad(quads_[quad]), quad, object));
        }
      } else if (first_quad[object + 1] > first_quad[object]) {
        items.push_back(build_object(object, first_quad[object], first_quad[object + 1]));
      }
    }
    if (items.empty()) return;
    build_root(items);
    write_boxes();
  }

 private:
  WideItem item_around(const Aabb<double>& box, std::uint32_t index, std::uint32_t kind) const {
    WideItem item{Float4{}, Float4{}, index, kind};
    const Aabb<float> rounded = arrays_->rounded_out(box);
    for (int axis = 0; axis < 3 && !rounded.empty(); ++axis) {
      item.low[axis] = rounded.min[axis];
      item.high[axis] = rounded.max[axis];
    }
    if (settings_.divide_by_size) item.note_size();
    return item;
  }
  /// Makes an object's own subtree and the item that stands for it.
  WideItem build_object(std::uint32_t object, std::uint32_t first, std::uint32_t last) {
    std::vector<WideItem> own;
    Aabb<double> box;
    for (std::uint32_t quad = first; quad < last; ++quad) {
      const Aabb<double> held = arrays_->box_of_quad(quads_[quad]);
      own.push_back(item_around(held, quad, object));
      box.extend(held);
    }
    const WideChild root = own.size() <= simd_lanes ? build_leaf(own, object) : build_tree(own);
    arrays_->object_root[object] = root;
    (root.is_leaf() ? arrays_->object_rooted_at_leaf[root.index()] : arrays_->object_rooted_at_node[root.index()]) =
        object;
    return item_around(box, object, WideItem::no_kind);
  }

  /// The binary tree that the wide one is made from.
  std::vector<WideSplit> divided(std::span<WideItem> items) const {
    std::vector<WideSplit> binary = WideBinner().build(items, settings_.leaf_limit, settings_.threads);
    if (settings_.quality == WideQuality::fast) return binary;
    if (settings_.quality == WideQuality::good) {
      LeafOptimizer::optimize(binary, items, settings_.costs, 1);
      return binary;
    }
    // What reinsertion leaves behind regrouping improves, and the other way round; a third turn gains next to nothing.
    for (int turn = 0; turn < 2; ++turn) {
      reinsert(binary, items);
      LeafOptimizer::optimize(binary, items, settings_.costs, 10);
    }
    return binary;
  }

  /// A better binary tree is not always a better wide one.
  void reinsert(std::vector<WideSplit>& binary, std::span<WideItem> items) const {
    const std::vector<WideSplit> before = binary;
    const std::vector<WideItem> items_before(items.begin(), items.end());
    const double cost_before_m2 = WideCollapse(binary, items, settings_.costs).cost_m2();
    ReinsertionOptimizer::optimize(binary, items, settings_.threads);
    if (WideCollapse(binary, items, settings_.costs).cost_m2() <= cost_before_m2) return;
    binary = before;
    std::copy(items_before.begin(), items_before.end(), items.begin());
  }

  WideChild build_tree(std::span<WideItem> items) {
    const std::vector<WideSplit> binary = divided(items);
    const WideCollapse collapse(binary, items, settings_.costs);
    const WideChild root = build_child(binary, collapse, items, 0);
    if (!root.is_leaf()) fill_node(root.index(), binary, collapse, items, 0);
    return root;
  }

  void build_root(std::span<WideItem> items) {
    const std::vector<WideSplit> binary = divided(items);
    const WideCollapse collapse(binary, items, settings_.costs);
    make_room(binary, collapse, items);
    if (collapse.is_leaf(0)) {
      attach(build_child(binary, collapse, items, 0), NodeLane::at(0, 0));
    } else {
      fill_node(0, binary, collapse, items, 0);
    }
  }

  /// Room for what the tree below the root will have, and no more.
  void make_room(std::span<const WideSplit> binary, const WideCollapse& collapse, std::span<const WideItem> items) {
    std::size_t nodes = arrays_->nodes.size(), leaves = arrays_->leaves.size();
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const std::uint32_t slot = open.back();
      open.pop_back();
      if (!collapse.is_leaf(slot)) {
        ++nodes;
        collapse.for_each_entry(slot, [&](std::uint32_t entry) { open.push_back(entry); });
      } else if (items[binary[slot].first].kind != WideItem::no_kind) {
        ++leaves;
      }
    }
    arrays_->reserve(nodes, leaves);
  }

  /// A leaf, or a node that is filled later.
  WideChild build_child(std::span<const WideSplit> binary, const WideCollapse& collapse,
                        std::span<const WideItem> items, std::uint32_t slot) {
    if (!collapse.is_leaf(slot)) return WideChild::node(arrays_->take_node());
    const std::span<const WideItem> held = items.subspan(binary[slot].first, binary[slot].count);
    if (held.front().kind == WideItem::no_kind) return arrays_->object_root[held.front().index];
    return build_leaf(held, held.front().kind);
  }

  WideChild build_leaf(std::span<const WideItem> held, std::uint32_t object) {
    const std::uint32_t leaf = arrays_->add_leaf(object);
    for (std::uint32_t lane = 0; lane < held.size(); ++lane) {
      const Quad& quad = quads_[held[lane].index];
      arrays_->quads[leaf * simd_lanes + lane] = quad;
      for (const std::uint32_t triangle : quad.triangles()) {
        arrays_->quad_of_triangle[triangle] = leaf * simd_lanes + lane;
      }
    }
    arrays_->find_run(leaf);
    return WideChild::leaf(leaf);
  }

  void fill_node(std::uint32_t node, std::span<const WideSplit> binary, const WideCollapse& collapse,
                 std::span<const WideItem> items, std::uint32_t slot) {
    std::array<std::uint32_t, simd_lanes> entries;
    const std::size_t count = collapse.entries(slot, entries);
    // Siblings side by side in memory, because a ray that looks at one often looks at the next.
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      attach(build_child(binary, collapse, items, entries[lane]), NodeLane::at(node, lane));
    }
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if (collapse.is_leaf(entries[lane])) continue;
      fill_node(arrays_->child_at(NodeLane::at(node, lane)).index(), binary, collapse, items, entries[lane]);
    }
  }

  /// Boxes come last, all at once.
  void attach(WideChild child, NodeLane place) { arrays_->attach(child, place, {}); }

  void write_boxes() {
    std::vector<Aabb<float>> boxes(arrays_->leaves.size());
    parallel_for(boxes.size() / leaves_at_a_time + 1, settings_.threads, [&](std::size_t part, unsigned) {
      const std::size_t last = std::min(boxes.size(), (part + 1) * leaves_at_a_time);
      for (std::size_t leaf = part * leaves_at_a_time; leaf < last; ++leaf) {
        boxes[leaf] = arrays_->write_leaf(static_cast<std::uint32_t>(leaf));
      }
    });
    for (std::uint32_t leaf = 0; leaf < boxes.size(); ++leaf) {
      arrays_->note_extent(boxes[leaf]);
      arrays_->set_box(arrays_->lane_of_leaf[leaf], boxes[leaf]);
    }
    tighten_below(0);
  }

  void tighten_below(std::uint32_t node) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = arrays_->nodes[node].child[lane];
      if (child.is_none() || child.is_leaf()) continue;
      tighten_below(child.index());
      arrays_->set_box(NodeLane::at(node, lane), arrays_->nodes[child.index()].box());
    }
  }

  static constexpr std::size_t leaves_at_a_time = 256;

  WideBuildSettings settings_;
  WideArrays* arrays_ = nullptr;
  std::span<const Quad> quads_;
};

}  // namespace dcem
