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

#include "dcem/accel/lane_keys.hpp"
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

/// Of a box of so many metres along the axes.
inline float half_area_of(const Float4& size_m) {
  const Float4 faces_m2 = size_m * __builtin_shufflevector(size_m, size_m, 1, 2, 0, 3);
  return faces_m2[0] + faces_m2[1] + faces_m2[2];
}

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
    return size[0] >= 0.0F ? half_area_of(size) : 0.0F;
  }
  friend bool operator==(const FloatBox& one, const FloatBox& other) {
    const Int4 differ = (one.low != other.low) | (one.high != other.high);
    return (differ[0] | differ[1] | differ[2]) == 0;
  }
};

/// The same as one number in eight: the lower bounds, and the upper ones below zero, so that all are minima.
struct BinBox {
  Float8 bounds = std::numeric_limits<float>::infinity();

  BinBox() = default;
  explicit BinBox(const WideItem& item) : bounds(item.low, -item.high) {}
  void extend(const BinBox& other) { bounds = simd::minimum(bounds, other.bounds); }
  /// Meaningless where it is empty.
  float half_area() const { return half_area_of(-bounds.last_four() - bounds.first_four()); }
};

}  // namespace detail

/// Builds one tree over a list of items, which it reorders.
class WideBinner {
 public:
  static constexpr std::uint32_t bins = 16;
  static constexpr std::uint32_t levels = 56;    ///< a tree has no more
  static constexpr std::size_t sweep_limit = 8;  ///< so few items are divided at the best of all places

  /// The root comes first; no items: no nodes. A leaf holds one item, or up to `leaf_limit` of one kind where splitting
  /// them gains little.
  std::vector<WideSplit> build(std::span<WideItem> items, std::uint32_t leaf_limit, unsigned threads) const {
    std::vector<WideSplit> nodes;
    if (items.empty()) return nodes;
    std::vector<WideItem> spare(items.size());
    std::vector<Branch> open{{0, levels, {}}}, branches;
    nodes.push_back(leaf(items, 0, items.size(), open.front().centres));
    // The top is divided here; what hangs below it is independent, and its order does not depend on who builds it.
    const std::size_t enough = std::max<std::size_t>(items.size() / 16, 1024);
    while (!open.empty()) {
      const Branch branch = open.back();
      open.pop_back();
      if (nodes[branch.node].count <= enough) {
        branches.push_back(branch);
      } else {
        divide(items, spare, nodes, branch, leaf_limit, open);
      }
    }
    std::vector<std::vector<WideSplit>> built(branches.size());
    parallel_for(branches.size(), threads, [&](std::size_t index, unsigned) {
      built[index] = build_below(items, spare, nodes[branches[index].node], branches[index], leaf_limit);
    });
    for (std::size_t index = 0; index < branches.size(); ++index) append(nodes, branches[index].node, built[index]);
    return nodes;
  }

 private:
  struct Branch {
    std::uint32_t node;
    std::uint32_t levels;      ///< that may still be used, the node's own included
    detail::FloatBox centres;  ///< around twice the centres of its items
  };
  struct Choice {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;
    std::uint32_t place = 0;  ///< first bin, or item, of the right side
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

  static std::vector<WideSplit> build_below(std::span<WideItem> items, std::span<WideItem> spare, const WideSplit& root,
                                            const Branch& top, std::uint32_t leaf_limit) {
    std::vector<WideSplit> nodes{root};
    std::vector<Branch> open{{0, top.levels, top.centres}};
    while (!open.empty()) {
      const Branch branch = open.back();
      open.pop_back();
      divide(items, spare, nodes, branch, leaf_limit, open);
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

  /// Divides a node in two, which are left to do, unless it stays a leaf.
  static void divide(std::span<WideItem> items, std::span<WideItem> spare, std::vector<WideSplit>& nodes,
                     const Branch& branch, std::uint32_t leaf_limit, std::vector<Branch>& open) {
    const WideSplit node = nodes[branch.node];
    if (node.count == 1) return;
    const std::span<WideItem> own = items.subspan(node.first, node.count);
    const std::size_t middle = node.first + place_split(own, spare.subspan(node.first, node.count), branch);
    const auto next = static_cast<std::uint32_t>(nodes.size());
    Branch one{next, branch.levels - 1, {}}, other{next + 1, branch.levels - 1, {}};
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

  /// Reorders the items. Returns how many of them go to the left.
  static std::size_t place_split(std::span<WideItem> items, std::span<WideItem> spare, const Branch& branch) {
    if (items.size() == 2) return 1;
    const Float4 extent = branch.centres.high - branch.centres.low;
    // Halving needs this many levels more.
    if (branch.levels <= static_cast<std::uint32_t>(std::bit_width(items.size())) + 1) return halve(items, extent);
    if (items.size() <= sweep_limit) return sweep(items, branch.centres.low);
    // Slightly less than the number of bins: the largest centre falls into the last one. An axis on which all centres
    // are the same has one bin, and no split.
    const Int4 divides = (extent > 0.0F) & (extent < std::numeric_limits<float>::infinity());
    const Float4 scale = divides ? (Float4{} + (static_cast<float>(bins) * 0.9999F)) / extent : Float4{};
    const Float4 low = divides ? branch.centres.low : Float4{};
    const Choice choice = best_choice(items, low, scale);
    if (choice.axis < 0) return halve(items, extent);
    return partition(items, spare, [&](const WideItem& item) {
      return bin_of(item, low, scale)[choice.axis] < static_cast<std::int32_t>(choice.place);
    });
  }

  /// Those for which `goes_left(item)` holds first; the order stays. Without branches: which way an item goes no
  /// processor foresees.
  template <typename GoesLeft>
  static std::size_t partition(std::span<WideItem> items, std::span<WideItem> spare, GoesLeft&& goes_left) {
    std::size_t left = 0, right = 0;
    for (const WideItem& each : items) {
      const WideItem item = each;
      const std::size_t is_left = goes_left(item) ? 1 : 0;
      items[left] = spare[right] = item;
      left += is_left;
      right += 1 - is_left;
    }
    std::copy_n(spare.begin(), right, items.begin() + static_cast<std::ptrdiff_t>(left));
    return left;
  }

  static Int4 bin_of(const WideItem& item, const Float4& low, const Float4& scale) {
    return __builtin_convertvector((item.twice_centre() - low) * scale, Int4);
  }
  /// What shares a block with nothing is a unit, and takes a block of its own at least.
  static std::uint32_t count_of(const WideItem& item) { return item.kind == WideItem::no_kind ? simd_lanes : 1; }

  static Choice best_choice(std::span<const WideItem> items, const Float4& low, const Float4& scale) {
    std::array<std::array<detail::BinBox, bins>, 3> boxes;
    std::array<std::array<std::uint32_t, bins>, 3> counts{};
    for (const WideItem& item : items) {
      const detail::BinBox box(item);
      const Int4 bin = bin_of(item, low, scale);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto slot = static_cast<std::size_t>(bin[static_cast<int>(axis)]);
        boxes[axis][slot].extend(box);
        counts[axis][slot] += count_of(item);
      }
    }
    Choice best;
    for (int axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<std::size_t>(axis);
      if (scale[axis] > 0.0F) try_axis(boxes[index], counts[index], axis, best);
    }
    return best;
  }

  /// For few items: every place to divide them, on every axis.
  static std::size_t sweep(std::span<WideItem> items, const Float4& low) {
    std::array<Ranks, 3> ranks;
    rank(items, low, ranks);
    std::array<detail::BinBox, sweep_limit> boxes;
    std::array<std::uint32_t, sweep_limit> counts;
    Choice best;
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t item = 0; item < items.size(); ++item) {
        const auto place = static_cast<std::size_t>(ranks[static_cast<std::size_t>(axis)][item]);
        boxes[place] = detail::BinBox(items[item]);
        counts[place] = count_of(items[item]);
      }
      try_axis(std::span(boxes).first(items.size()), std::span(counts).first(items.size()), axis, best);
    }
    if (best.axis < 0) return items.size() / 2;  // boxes too large for a number
    std::array<WideItem, sweep_limit> before;
    std::copy(items.begin(), items.end(), before.begin());
    const Ranks& places = ranks[static_cast<std::size_t>(best.axis)];
    for (std::size_t item = 0; item < items.size(); ++item)
      items[static_cast<std::size_t>(places[item])] = before[item];
    return best.place;
  }

  using Ranks = std::array<std::int32_t, sweep_limit>;
  static_assert(sweep_limit == simd_lanes);

  /// The place of each item among all by their centres, per axis.
  static void rank(std::span<const WideItem> items, const Float4& low, std::array<Ranks, 3>& ranks) {
    std::array<std::array<float, simd_lanes>, 3> places;
    for (auto& axis : places) axis.fill(std::numeric_limits<float>::infinity());
    for (std::size_t item = 0; item < items.size(); ++item) {
      const Float4 centre = items[item].twice_centre() - low;
      for (int axis = 0; axis < 3; ++axis) places[static_cast<std::size_t>(axis)][item] = centre[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) ranks[axis] = detail::LaneKeys(Float8(places[axis])).ranks();
  }

  /// What tracing so many items takes, up to a factor: they come in blocks of eight, so that a split that fills them is
  /// worth more. (Whole blocks alone: large patches end up in blocks with small ones. Powers below 1: lopsided trees.)
  static float weight_of(std::uint32_t count) {
    const std::uint32_t blocks = (count + simd_lanes - 1) / simd_lanes;
    return static_cast<float>(count) + 5.0F * static_cast<float>(blocks);
  }

  /// Divides before each of the places, none of them or some empty.
  static void try_axis(std::span<const detail::BinBox> boxes, std::span<const std::uint32_t> counts, int axis,
                       Choice& best) {
    std::array<float, bins> right_cost;
    detail::BinBox box;
    std::uint32_t count = 0;
    for (std::size_t place = boxes.size() - 1; place > 0; --place) {
      box.extend(boxes[place]);
      count += counts[place];
      right_cost[place] = count > 0 ? box.half_area() * weight_of(count) : std::numeric_limits<float>::infinity();
    }
    box = {};
    count = 0;
    for (std::size_t place = 1; place < boxes.size(); ++place) {
      box.extend(boxes[place - 1]);
      count += counts[place - 1];
      if (count == 0) continue;
      const float cost = box.half_area() * weight_of(count) + right_cost[place];
      if (cost < best.cost) best = {cost, axis, static_cast<std::uint32_t>(place)};
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
