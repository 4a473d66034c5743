#pragma once
/// A fast binary build for wide trees: the tree is the same for any number of threads.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/accel/wide/build/item.hpp"
#include "dcem/accel/wide/build/splitter.hpp"
#include "dcem/accel/wide/node.hpp"
#include "dcem/core/thread_pool.hpp"

namespace dcem {

/// Builds one tree over a list of items, which it reorders.
class WideBinner {
 public:
  /// No deeper than `detail::wide_build_depth_limit`. The root comes first; no items: no nodes. A leaf holds one item,
  /// or up to `leaf_limit` of one kind where splitting them gains little. With one thread nothing is allocated once the
  /// lists have grown.
  void build(std::span<WideItem> items, std::uint32_t leaf_limit, unsigned threads, std::vector<WideSplit>& nodes) {
    nodes.clear();
    if (items.empty()) return;
    constexpr std::size_t many = 1U << 16;  // what is not used of a large list takes no memory
    if (items.size() >= many) nodes.reserve(2 * items.size());
    if (spare_.size() < items.size()) spare_.resize(items.size());
    branches_.clear();
    open_.assign(1, {0, detail::wide_build_depth_limit, {}});
    nodes.push_back(leaf(items, 0, items.size(), open_.front().centres));
    // The top is divided here; what is below it is independent, and its order does not depend on who builds it.
    const std::size_t enough = std::max<std::size_t>(items.size() / 16, 1024);
    while (!open_.empty()) {
      const Branch branch = open_.back();
      open_.pop_back();
      if (nodes[branch.node].count <= enough) {
        branches_.push_back(branch);
      } else {
        divide(items, spare_, nodes, branch, leaf_limit, open_);
      }
    }
    if (threads == 1) {
      for (const Branch& branch : branches_) divide_all(items, spare_, nodes, branch, leaf_limit, open_);
    } else {
      build_branches(items, leaf_limit, threads, nodes);
    }
  }
  std::vector<WideSplit> build(std::span<WideItem> items, std::uint32_t leaf_limit, unsigned threads) {
    std::vector<WideSplit> nodes;
    build(items, leaf_limit, threads, nodes);
    return nodes;
  }

 private:
  struct Branch {
    std::uint32_t node;
    std::uint32_t levels_left;  ///< that may still be used, the node's own included
    detail::FloatBox centres;   ///< around twice the centres of its items
  };

  static WideSplit leaf(std::span<const WideItem> items, std::size_t first, std::size_t last,
                        detail::FloatBox& centres) {
    detail::FloatBox box;
    for (const WideItem& item : items.subspan(first, last - first)) {
      box.extend(item.low, item.high);
      const Float4 centre = item.twice_centre();
      centres.extend(centre, centre);
    }
    return {box.half_area(), 0, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)};
  }

  /// What is below a node. `open` is empty before and after.
  static void divide_all(std::span<WideItem> items, std::span<WideItem> spare, std::vector<WideSplit>& nodes,
                         const Branch& top, std::uint32_t leaf_limit, std::vector<Branch>& open) {
    open.push_back(top);
    while (!open.empty()) {
      const Branch branch = open.back();
      open.pop_back();
      divide(items, spare, nodes, branch, leaf_limit, open);
    }
  }

  /// In threads, each branch in a list of its own: the lists one after the other are what one thread would have made.
  void build_branches(std::span<WideItem> items, std::uint32_t leaf_limit, unsigned threads,
                      std::vector<WideSplit>& nodes) {
    std::vector<std::vector<WideSplit>> built(branches_.size());
    parallel_for(branches_.size(), threads, [&](std::size_t index, unsigned) {
      Branch top = branches_[index];
      built[index].push_back(nodes[top.node]);
      top.node = 0;
      std::vector<Branch> open;
      divide_all(items, spare_, built[index], top, leaf_limit, open);
    });
    for (std::size_t index = 0; index < built.size(); ++index) append(nodes, branches_[index].node, built[index]);
  }

  /// Attaches a subtree in place of a leaf.
  static void append(std::vector<WideSplit>& nodes, std::uint32_t node, std::span<const WideSplit> subtree) {
    const auto shift = static_cast<std::uint32_t>(nodes.size() - 1);
    const auto moved = [&](WideSplit split) {
      if (!split.is_leaf()) {
        split.left += shift;
        split.right += shift;
      }
      return split;
    };
    nodes[node] = moved(subtree.front());
    for (const WideSplit& split : subtree.subspan(1)) nodes.push_back(moved(split));
  }

  /// Divides a node in two, which are left to do, unless it stays a leaf.
  static void divide(std::span<WideItem> items, std::span<WideItem> spare, std::vector<WideSplit>& nodes,
                     const Branch& branch, std::uint32_t leaf_limit, std::vector<Branch>& open) {
    const WideSplit node = nodes[branch.node];
    if (node.count == 1) return;
    const std::span<WideItem> own = items.subspan(node.first, node.count);
    // Halving needs this many levels more.
    const bool must_halve = branch.levels_left <= static_cast<std::uint32_t>(std::bit_width(own.size())) + 1;
    const std::size_t to_left = must_halve
                                    ? WideSplitter::halve(own, branch.centres.high - branch.centres.low)
                                    : WideSplitter::divide(own, spare.subspan(node.first, node.count), branch.centres);
    const std::size_t middle = node.first + to_left;
    const auto next = static_cast<std::uint32_t>(nodes.size());
    Branch one{next, branch.levels_left - 1, {}}, other{next + 1, branch.levels_left - 1, {}};
    const WideSplit left = leaf(items, node.first, middle, one.centres);
    const WideSplit right = leaf(items, middle, node.first + node.count, other.centres);
    if (node.count <= leaf_limit && left.half_area_m2 + right.half_area_m2 >= 0.95F * node.half_area_m2 &&
        shares_kind(own)) {
      return;
    }
    nodes[branch.node].left = next;
    nodes[branch.node].right = next + 1;
    nodes.push_back(left);
    nodes.push_back(right);
    open.push_back(other);
    open.push_back(one);
  }

  static bool shares_kind(std::span<const WideItem> items) {
    return items.front().kind != WideItem::no_kind &&
           std::all_of(items.begin(), items.end(),
                       [&](const WideItem& item) { return item.kind == items.front().kind; });
  }

  std::vector<WideItem> spare_;
  std::vector<Branch> open_, branches_;
};

}  // namespace dcem
