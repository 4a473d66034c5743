#pragma once
/// A fast binary build for wide trees: binned surface-area heuristic in single precision, four numbers at a time.
///
/// The boxes steer the splits only, so their rounding costs nothing but quality. The tree is the same for any number of
/// threads.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/simd.hpp"
#include "dcem/core/parallel_for.hpp"

namespace dcem {

/// What the tree is built from.
struct WideItem {
  static constexpr std::uint32_t no_kind = 0xffffffffU;  ///< of an item that shares a block with nothing

  Float4 low, high;  ///< the box; the fourth number is 0. An empty box is a point at 0
  std::uint32_t index = 0;
  std::uint32_t kind = no_kind;  ///< items of one kind may share a block

  Float4 twice_centre() const { return low + high; }
};

/// A node of the binary tree. Children stand behind their parents.
struct WideSplit {
  float half_area_m2 = 0.0F;
  std::uint32_t left = 0, right = 0;   ///< 0: a leaf
  std::uint32_t first = 0, count = 0;  ///< positions of the items below

  bool is_leaf() const { return left == 0; }
};

namespace detail {

/// A box in single precision, empty at first; the fourth number is of no account.
struct FloatBox {
  Float4 low = Float4{} + std::numeric_limits<float>::infinity();
  Float4 high = Float4{} - std::numeric_limits<float>::infinity();

  void extend(const Float4& other_low, const Float4& other_high) {
    low = low < other_low ? low : other_low;
    high = high > other_high ? high : other_high;
  }
  void extend(const FloatBox& other) { extend(other.low, other.high); }
  float half_area() const {
    const Float4 size = high - low;
    return size[0] >= 0.0F ? size[0] * size[1] + size[1] * size[2] + size[2] * size[0] : 0.0F;
  }
  friend bool operator==(const FloatBox& one, const FloatBox& other) {
    const Int4 differ = (one.low != other.low) | (one.high != other.high);
    return (differ[0] | differ[1] | differ[2]) == 0;
  }
};

}  // namespace detail

/// Builds one tree over a list of items, which it reorders.
class WideBinner {
 public:
  static constexpr std::uint32_t bins = 16;
  static constexpr std::uint32_t levels = 56;  ///< a tree has no more

  /// The root comes first; no items: no nodes. A leaf holds one item, or up to `leaf_limit` of one kind where splitting
  /// them gains little.
  std::vector<WideSplit> build(std::span<WideItem> items, std::uint32_t leaf_limit, unsigned threads) const {
    std::vector<WideSplit> nodes;
    if (items.empty()) return nodes;
    nodes.push_back(leaf(items, 0, items.size()));
    std::vector<Branch> open{{0, levels}}, branches;
    // The top is divided here; what hangs below it is independent, and its order does not depend on who builds it.
    const std::size_t enough = std::max<std::size_t>(items.size() / 16, 1024);
    while (!open.empty()) {
      const Branch branch = open.back();
      open.pop_back();
      if (nodes[branch.node].count <= enough) {
        branches.push_back(branch);
      } else if (divide(items, nodes, branch, leaf_limit)) {
        open.push_back({nodes[branch.node].right, branch.levels - 1});
        open.push_back({nodes[branch.node].left, branch.levels - 1});
      }
    }
    std::vector<std::vector<WideSplit>> built(branches.size());
    parallel_for(branches.size(), threads, [&](std::size_t index, unsigned) {
      built[index] = build_below(items, nodes[branches[index].node], branches[index].levels, leaf_limit);
    });
    for (std::size_t index = 0; index < branches.size(); ++index) append(nodes, branches[index].node, built[index]);
    return nodes;
  }

 private:
  struct Branch {
    std::uint32_t node;
    std::uint32_t levels;  ///< that may still be used, the node's own included
  };
  struct Choice {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;
    std::uint32_t bin = 0;  ///< first bin of the right side
  };

  static WideSplit leaf(std::span<const WideItem> items, std::size_t first, std::size_t last) {
    detail::FloatBox box;
    for (const WideItem& item : items.subspan(first, last - first)) box.extend(item.low, item.high);
    return {box.half_area(), 0, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)};
  }

  static std::vector<WideSplit> build_below(std::span<WideItem> items, const WideSplit& root, std::uint32_t levels_left,
                                            std::uint32_t leaf_limit) {
    std::vector<WideSplit> nodes{root};
    std::vector<Branch> open{{0, levels_left}};
    while (!open.empty()) {
      const Branch branch = open.back();
      open.pop_back();
      if (!divide(items, nodes, branch, leaf_limit)) continue;
      open.push_back({nodes[branch.node].right, branch.levels - 1});
      open.push_back({nodes[branch.node].left, branch.levels - 1});
    }
    return nodes;
  }

  /// Hangs a subtree in place of a leaf.
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

  /// Divides a node in two. False where it stays a leaf.
  static bool divide(std::span<WideItem> items, std::vector<WideSplit>& nodes, const Branch& branch,
                     std::uint32_t leaf_limit) {
    const WideSplit node = nodes[branch.node];
    if (node.count == 1) return false;
    const std::span<WideItem> own = items.subspan(node.first, node.count);
    const std::size_t middle = place_split(own, branch.levels);
    const WideSplit left = leaf(items, node.first, node.first + middle);
    const WideSplit right = leaf(items, node.first + middle, node.first + node.count);
    if (node.count <= leaf_limit && left.half_area_m2 + right.half_area_m2 >= 0.95F * node.half_area_m2 &&
        shares_kind(own)) {
      return false;
    }
    nodes[branch.node].left = static_cast<std::uint32_t>(nodes.size());
    nodes[branch.node].right = static_cast<std::uint32_t>(nodes.size() + 1);
    nodes.push_back(left);
    nodes.push_back(right);
    return true;
  }

  static bool shares_kind(std::span<const WideItem> items) {
    return items.front().kind != WideItem::no_kind &&
           std::all_of(items.begin(), items.end(),
                       [&](const WideItem& item) { return item.kind == items.front().kind; });
  }

  /// Reorders the items; the first `middle` of them go to the left.
  static std::size_t place_split(std::span<WideItem> items, std::uint32_t levels_left) {
    if (items.size() == 2) return 1;
    Float4 low = items.front().twice_centre(), high = low;
    for (const WideItem& item : items) {
      const Float4 centre = item.twice_centre();
      low = low < centre ? low : centre;
      high = high > centre ? high : centre;
    }
    // Slightly less than the number of bins: the largest centre falls into the last one.
    const Float4 scale = (Float4{} + (static_cast<float>(bins) * 0.9999F)) / (high - low);
    // Halving needs this many levels more.
    const bool must_halve = levels_left <= static_cast<std::uint32_t>(std::bit_width(items.size())) + 1;
    const Choice choice = must_halve ? Choice{} : best_choice(items, low, scale);
    if (choice.axis < 0) return halve(items, high - low);
    const auto right = std::partition(items.begin(), items.end(), [&](const WideItem& item) {
      return bin_of(item, low, scale)[choice.axis] < static_cast<std::int32_t>(choice.bin);
    });
    return static_cast<std::size_t>(right - items.begin());
  }

  static Int4 bin_of(const WideItem& item, const Float4& low, const Float4& scale) {
    return __builtin_convertvector((item.twice_centre() - low) * scale, Int4);
  }

  static Choice best_choice(std::span<const WideItem> items, const Float4& low, const Float4& scale) {
    std::array<std::array<detail::FloatBox, bins>, 3> boxes;
    std::array<std::array<std::uint32_t, bins>, 3> counts{};
    std::array<bool, 3> usable{};
    for (int axis = 0; axis < 3; ++axis) usable[static_cast<std::size_t>(axis)] = std::isfinite(scale[axis]);
    for (const WideItem& item : items) {
      const Int4 bin = bin_of(item, low, scale);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!usable[axis]) continue;
        const auto slot = static_cast<std::size_t>(bin[static_cast<int>(axis)]);
        boxes[axis][slot].extend(item.low, item.high);
        // What shares a block with nothing is a unit, and takes a block of its own at least.
        counts[axis][slot] += item.kind == WideItem::no_kind ? simd_lanes : 1;
      }
    }
    Choice best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (usable[axis]) try_axis(boxes[axis], counts[axis], static_cast<int>(axis), best);
    }
    return best;
  }

  /// What tracing so many items takes, up to a factor: they come in blocks of eight, so that a split that fills them is
  /// worth more. (Whole blocks alone: large patches end up in blocks with small ones. Powers below 1: lopsided trees.)
  static float weight_of(std::uint32_t count) {
    const std::uint32_t blocks = (count + simd_lanes - 1) / simd_lanes;
    return static_cast<float>(count) + 5.0F * static_cast<float>(blocks);
  }

  static void try_axis(std::span<const detail::FloatBox, bins> boxes, std::span<const std::uint32_t, bins> counts,
                       int axis, Choice& best) {
    std::array<float, bins> right_cost{};
    detail::FloatBox box;
    std::uint32_t count = 0;
    for (std::uint32_t bin = bins - 1; bin > 0; --bin) {
      box.extend(boxes[bin].low, boxes[bin].high);
      count += counts[bin];
      right_cost[bin] = count > 0 ? box.half_area() * weight_of(count) : std::numeric_limits<float>::infinity();
    }
    box = {};
    count = 0;
    for (std::uint32_t bin = 1; bin < bins; ++bin) {
      box.extend(boxes[bin - 1].low, boxes[bin - 1].high);
      count += counts[bin - 1];
      if (count == 0) continue;
      const float cost = box.half_area() * weight_of(count) + right_cost[bin];
      if (cost < best.cost) best = {cost, axis, bin};
    }
  }

  /// Where no plane divides, or levels run short: the median along the longest axis.
  static std::size_t halve(std::span<WideItem> items, const Float4& extent) {
    int axis = extent[1] > extent[0] ? 1 : 0;
    if (extent[2] > extent[axis]) axis = 2;
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(), [&](const WideItem& one, const WideItem& other) {
      const float a = one.twice_centre()[axis], b = other.twice_centre()[axis];
      return a != b ? a < b : one.index < other.index;
    });
    return items.size() / 2;
  }
};

}  // namespace dcem
