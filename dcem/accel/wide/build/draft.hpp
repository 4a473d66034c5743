#pragma once
/// A wide tree in the making, between a plan and the binary tree that shows it: quads can move from leaf to leaf.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/wide/build/binary_tree.hpp"
#include "dcem/accel/wide/build/collapse.hpp"

namespace dcem {

/// Nodes and leaves with what they hold. The sum that it speaks of is Σ cost · surface of them all.
class WideDraft {
 public:
  /// A wide node, or a leaf.
  struct Entry {
    detail::FloatBox box;
    float half_area_m2 = 0.0F;
    float cost = 0.0F;  ///< of a visit; 0 for the root, which is always visited
    std::uint32_t parent = 0;
    std::uint32_t count = 0;
    std::array<std::uint32_t, simd_lanes> held{};  ///< entries, or items of a leaf
    bool is_leaf = false;
    std::uint32_t kind = WideItem::no_kind;

    bool is_full() const { return count == simd_lanes; }
    void add(std::uint32_t one) { held[count++] = one; }
    void remove(std::uint32_t one) {
      const auto end = held.begin() + count;
      std::copy(std::find(held.begin(), end, one) + 1, end, std::find(held.begin(), end, one));
      --count;
    }
    double weight_m2() const { return static_cast<double>(cost) * static_cast<double>(half_area_m2); }
  };

  WideDraft(std::span<const WideSplit> splits, std::span<const WideItem> items, const WideCollapse& plan,
            const WideCosts& costs)
      : costs_(costs), items_(items.begin(), items.end()) {
    entries_.emplace_back();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, 0}};  // slot, entry
    while (!open.empty()) {
      const auto [slot, entry] = open.back();
      open.pop_back();
      if (entry != 0 && plan.is_leaf(slot)) {
        fill_leaf(entry, splits[slot]);
        continue;
      }
      plan.for_each_entry(slot, [&, above = entry](std::uint32_t below) {
        const std::uint32_t added = add_entry(above, costs_.node);
        entries_[above].add(added);
        open.emplace_back(below, added);
      });
    }
    for (std::uint32_t entry = entry_count(); entry-- > 0;) fit(entry);
  }

  std::uint32_t entry_count() const { return static_cast<std::uint32_t>(entries_.size()); }
  /// The root is 0; leaves that lost everything stay, unused.
  Entry& entry(std::uint32_t slot) { return entries_[slot]; }
  const WideItem& item(std::uint32_t number) const { return items_[number]; }

  /// Makes the box of an entry tight. Returns by how much the sum has grown.
  double fit(std::uint32_t slot) {
    Entry& entry = entries_[slot];
    const double before_m2 = entry.weight_m2();
    entry.box = {};
    for (std::uint32_t lane = 0; lane < entry.count; ++lane) {
      const std::uint32_t held = entry.held[lane];
      entry.is_leaf ? entry.box.extend(items_[held].low, items_[held].high) : entry.box.extend(entries_[held].box);
    }
    entry.half_area_m2 = entry.box.half_area();
    return entry.weight_m2() - before_m2;
  }
  /// The same for an entry and all above, as far up as boxes change.
  double fit_from(std::uint32_t slot) {
    double grown_m2 = 0.0;
    while (true) {
      const detail::FloatBox before = entries_[slot].box;
      grown_m2 += fit(slot);
      if (slot == 0 || entries_[slot].box == before) return grown_m2;
      slot = entries_[slot].parent;
    }
  }

  /// Into a leaf with a free lane, or into a new one below a node.
  void put(std::uint32_t item, std::uint32_t kind, std::uint32_t spot) {
    std::uint32_t leaf = spot;
    if (!entries_[spot].is_leaf) {
      leaf = add_entry(spot, costs_.leaf);
      entries_[leaf].is_leaf = true;
      entries_[leaf].kind = kind;
      entries_[spot].add(leaf);
    }
    entries_[leaf].add(item);
    fit(leaf);
    fit_from(entries_[leaf].parent);
  }

  /// The wide tree as a binary one: the entries of each node are joined in pairs, the smallest box around two first. A
  /// tree that would get deeper than detail::wide_build_depth_limit is not stored.
  void store(std::vector<WideSplit>& splits, std::span<WideItem> items) const {
    std::vector<std::uint32_t> order{0};  // parents first
    for (std::size_t at = 0; at < order.size(); ++at) {
      const Entry& entry = entries_[order[at]];
      if (!entry.is_leaf) order.insert(order.end(), entry.held.begin(), entry.held.begin() + entry.count);
    }
    std::vector<detail::BinaryNode> nodes;
    std::vector<WideItem> held;
    held.reserve(items.size());
    std::vector<std::uint32_t> made(entries_.size());  // the binary node of an entry
    for (std::size_t at = order.size(); at-- > 0;) {
      const Entry& entry = entries_[order[at]];
      if (entry.is_leaf) {
        made[order[at]] = add_leaf(entry, nodes, held);
        continue;
      }
      std::array<std::uint32_t, simd_lanes> parts;
      for (std::uint32_t lane = 0; lane < entry.count; ++lane) parts[lane] = made[entry.held[lane]];
      made[order[at]] = detail::join(std::span(parts).first(entry.count), nodes);
    }
    std::vector<WideItem> placed(items.size());
    std::vector<WideSplit> result = detail::in_order(nodes, made[0], held, placed);
    if (detail::depth_of_tree(result) > detail::wide_build_depth_limit) return;
    splits = std::move(result);
    std::copy(placed.begin(), placed.end(), items.begin());
  }

 private:
  std::uint32_t add_entry(std::uint32_t parent, double cost) {
    entries_.emplace_back();
    entries_.back().parent = parent;
    entries_.back().cost = static_cast<float>(cost);
    return entry_count() - 1;
  }

  void fill_leaf(std::uint32_t entry, const WideSplit& split) {
    Entry& leaf = entries_[entry];
    leaf.is_leaf = true;
    leaf.cost = static_cast<float>(costs_.leaf);
    leaf.kind = items_[split.first].kind;
    for (std::uint32_t item = split.first; item < split.first + split.count; ++item) leaf.add(item);
  }

  std::uint32_t add_leaf(const Entry& leaf, std::vector<detail::BinaryNode>& nodes, std::vector<WideItem>& held) const {
    nodes.push_back({leaf.box, leaf.half_area_m2, 0, 0, static_cast<std::uint32_t>(held.size()), leaf.count});
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) held.push_back(items_[leaf.held[lane]]);
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }

  WideCosts costs_;
  std::vector<WideItem> items_;
  std::vector<Entry> entries_;
};

}  // namespace dcem
