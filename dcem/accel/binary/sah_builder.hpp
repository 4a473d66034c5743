#pragma once
/// Builds a binary tree over boxes by the surface-area heuristic (SAH).
#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dcem/accel/binary/build_item.hpp"
#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/core/error.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem {

/// Top-down builder. Binned SAH over the bounds of the centres, every split tried in small ranges, the object median
/// where no plane divides or where depth runs short. The tree depends on the set of boxes alone, not on their order.
///
/// Formula: a split of a node with surface A into n₁, n₂ primitives with surfaces A₁, A₂ costs
/// C_t + C_i (A₁ n₁ + A₂ n₂) / A, a leaf C_i n (MacDonald, Booth 1990; bins: Wald 2007).
template <std::floating_point Scalar>
class SahBuilder {
 public:
  using Item = BuildItem<Scalar>;
  using Node = BvhNode<Scalar>;

  explicit SahBuilder(const SahSettings& settings) : settings_(settings) { require_valid_settings(settings); }

  /// Reorders `items` and returns the nodes over them: the root first, then children in pairs at (1, 2), (3, 4), …, the
  /// child with the larger surface first. A leaf's `first` is a position in `items`; below any node the positions are
  /// contiguous. At most `levels` levels, which must be at least 1 + log₂ of the number of items. No items: no nodes.
  std::vector<Node> build(std::span<Item> items, std::uint32_t levels = maximum_build_depth) {
    nodes_.clear();
    if (items.empty()) return {};
    DCEM_ASSERT(levels <= maximum_build_depth && levels > median_levels(items.size()));
    items_ = items;
    has_empty_ = std::ranges::any_of(items, [](const Item& item) { return item.box.empty(); });
    nodes_.emplace_back();
    grow(0, {0, items.size()}, bounds_of<Scalar>(items), levels);
    return std::move(nodes_);
  }

 private:
  struct Range {
    std::size_t begin;
    std::size_t end;
    std::size_t size() const { return end - begin; }
  };
  struct Split {
    double cost = std::numeric_limits<double>::infinity();  ///< Σ area · primitives of the two sides
    std::size_t left_count = 0;
    int axis = 0;
    std::uint32_t bin = 0;  ///< first bin of the right side; 0: divide the order along the axis instead

    /// Of two equally cheap splits the more even one, so that boxes without area do not make a chain.
    bool better_than(const Split& other, std::size_t total) const {
      if (cost != other.cost) return cost < other.cost;
      const auto imbalance = [total](std::size_t left) {
        return left > total - left ? 2 * left - total : total - 2 * left;
      };
      return imbalance(left_count) < imbalance(other.left_count);
    }
  };
  struct Bin {
    Aabb<Scalar> box;
    std::size_t count = 0;
  };
  /// Maps centres to bins along one axis; unusable when the centres coincide there.
  struct BinScale {
    Scalar low = 0;
    Scalar scale = 0;
    std::uint32_t bins = 0;
    bool usable = false;

    std::uint32_t operator()(Scalar center) const {
      return std::min(bins - 1, static_cast<std::uint32_t>((center - low) * scale));
    }
  };

  static std::uint32_t median_levels(std::size_t count) {
    return static_cast<std::uint32_t>(std::bit_width(count - 1));
  }

  std::span<Item> of(Range range) const { return items_.subspan(range.begin, range.size()); }

  void grow(std::size_t slot, Range range, const Aabb<Scalar>& box, std::uint32_t levels);
  std::optional<std::size_t> divide(Range range, const Aabb<Scalar>& box, std::uint32_t levels);
  std::size_t divide_at_median(Range range);
  std::size_t divide_at(Range range, const Split& split);
  std::size_t divide_off_empty(Range range);
  Split best_split(Range range, const Aabb<Scalar>& centers) const;
  void try_bins(int axis, std::span<const Item> items, const BinScale& scale, Split& best) const;
  void try_sweep(int axis, std::span<const Item> items, Split& best) const;
  BinScale bin_scale(const Aabb<Scalar>& centers, int axis) const;

  SahSettings settings_;
  std::span<Item> items_;
  std::vector<Node> nodes_;
  bool has_empty_ = false;
};

template <std::floating_point Scalar>
void SahBuilder<Scalar>::grow(std::size_t slot, Range range, const Aabb<Scalar>& box, std::uint32_t levels) {
  const std::optional<std::size_t> middle = divide(range, box, levels);
  if (!middle) {
    std::ranges::sort(of(range), {}, &Item::index);
    nodes_[slot] = {box, static_cast<std::uint32_t>(range.begin), static_cast<std::uint32_t>(range.size())};
    return;
  }
  Range larger{range.begin, *middle};
  Range smaller{*middle, range.end};
  Aabb<Scalar> larger_box = bounds_of<Scalar>(of(larger));
  Aabb<Scalar> smaller_box = bounds_of<Scalar>(of(smaller));
  if (larger_box.half_area() < smaller_box.half_area()) {
    std::swap(larger, smaller);
    std::swap(larger_box, smaller_box);
  }
  const std::size_t pair = nodes_.size();
  nodes_.resize(pair + 2);
  nodes_[slot] = {box, static_cast<std::uint32_t>(pair), 0};
  grow(pair, larger, larger_box, levels - 1);
  grow(pair + 1, smaller, smaller_box, levels - 1);
}

/// The position where the range is divided after reordering, or nothing when it becomes a leaf.
template <std::floating_point Scalar>
std::optional<std::size_t> SahBuilder<Scalar>::divide(Range range, const Aabb<Scalar>& box, std::uint32_t levels) {
  const bool fits_leaf = range.size() <= settings_.leaf_limit;
  if (range.size() == 1) return std::nullopt;
  // Any split leaves at most size − 1 on one side; medians must still fit in the levels that remain then.
  if (levels - 1 <= median_levels(range.size())) {
    return fits_leaf ? std::nullopt : std::optional(divide_at_median(range));
  }
  if (has_empty_) {
    has_empty_ = false;
    const std::size_t middle = divide_off_empty(range);
    if (middle != range.begin && middle != range.end) return middle;
  }
  const Split split = best_split(range, center_bounds_of<Scalar>(of(range)));
  if (split.left_count == 0) {
    return range.size() <= settings_.leaf_maximum ? std::nullopt : std::optional(divide_at_median(range));
  }
  const double area = box.half_area();
  const double split_cost = settings_.traversal_cost * area + settings_.intersection_cost * split.cost;
  const double leaf_cost = settings_.intersection_cost * static_cast<double>(range.size()) * area;
  if (fits_leaf && split_cost >= leaf_cost) return std::nullopt;
  return divide_at(range, split);
}

template <std::floating_point Scalar>
std::size_t SahBuilder<Scalar>::divide_at_median(Range range) {
  const Vector3<Scalar> extent = center_bounds_of<Scalar>(of(range)).extent();
  Split split;
  split.left_count = range.size() / 2;
  split.axis = extent.y > extent.x ? 1 : 0;
  if (extent.z > extent[split.axis]) split.axis = 2;
  return divide_at(range, split);
}

template <std::floating_point Scalar>
std::size_t SahBuilder<Scalar>::divide_at(Range range, const Split& split) {
  const std::span<Item> items = of(range);
  if (split.bin == 0) {
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(split.left_count);
    std::nth_element(items.begin(), middle, items.end(),
                     [&](const Item& a, const Item& b) { return a.before(b, split.axis); });
  } else {
    const BinScale scale = bin_scale(center_bounds_of<Scalar>(items), split.axis);
    std::partition(items.begin(), items.end(),
                   [&](const Item& item) { return scale(item.center[split.axis]) < split.bin; });
  }
  return range.begin + split.left_count;
}

/// Empty boxes are never hit; together, beside the others, they cost nothing and spoil no split.
template <std::floating_point Scalar>
std::size_t SahBuilder<Scalar>::divide_off_empty(Range range) {
  const std::span<Item> items = of(range);
  const auto middle = std::partition(items.begin(), items.end(), [](const Item& item) { return !item.box.empty(); });
  return range.begin + static_cast<std::size_t>(middle - items.begin());
}

template <std::floating_point Scalar>
typename SahBuilder<Scalar>::BinScale SahBuilder<Scalar>::bin_scale(const Aabb<Scalar>& centers, int axis) const {
  const Scalar scale = static_cast<Scalar>(settings_.bins) / (centers.max[axis] - centers.min[axis]);
  // Infinite for an extent that is zero or denormal, zero for one that overflows: neither can be binned.
  return {centers.min[axis], scale, settings_.bins, std::isfinite(scale) && scale > 0};
}

template <std::floating_point Scalar>
typename SahBuilder<Scalar>::Split SahBuilder<Scalar>::best_split(Range range, const Aabb<Scalar>& centers) const {
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    const BinScale scale = bin_scale(centers, axis);
    if (!scale.usable) continue;
    if (range.size() <= settings_.sweep_limit) {
      try_sweep(axis, of(range), best);
    } else {
      try_bins(axis, of(range), scale, best);
    }
  }
  return best;
}

template <std::floating_point Scalar>
void SahBuilder<Scalar>::try_bins(int axis, std::span<const Item> items, const BinScale& scale, Split& best) const {
  std::array<Bin, 64> bins;
  for (const Item& item : items) {
    Bin& bin = bins[scale(item.center[axis])];
    bin.box.extend(item.box);
    ++bin.count;
  }
  std::array<double, 64> right_cost{};
  Bin right;
  for (std::uint32_t bin = scale.bins - 1; bin > 0; --bin) {
    right.box.extend(bins[bin].box);
    right.count += bins[bin].count;
    right_cost[bin] = static_cast<double>(right.box.half_area()) * static_cast<double>(right.count);
  }
  Bin left;
  for (std::uint32_t bin = 1; bin < scale.bins; ++bin) {
    left.box.extend(bins[bin - 1].box);
    left.count += bins[bin - 1].count;
    if (left.count == 0 || left.count == items.size()) continue;
    const double left_cost = static_cast<double>(left.box.half_area()) * static_cast<double>(left.count);
    const Split split{left_cost + right_cost[bin], left.count, axis, bin};
    if (split.better_than(best, items.size())) best = split;
  }
}

template <std::floating_point Scalar>
void SahBuilder<Scalar>::try_sweep(int axis, std::span<const Item> items, Split& best) const {
  std::array<const Item*, 64> sorted;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(items.size());
  std::ranges::transform(items, sorted.begin(), [](const Item& item) { return &item; });
  std::sort(sorted.begin(), end, [axis](const Item* a, const Item* b) { return a->before(*b, axis); });
  std::array<double, 64> right_cost{};
  Aabb<Scalar> right;
  for (std::size_t count = 1; count < items.size(); ++count) {
    right.extend(sorted[items.size() - count]->box);
    right_cost[items.size() - count] = static_cast<double>(right.half_area()) * static_cast<double>(count);
  }
  Aabb<Scalar> left;
  for (std::size_t count = 1; count < items.size(); ++count) {
    left.extend(sorted[count - 1]->box);
    const double left_cost = static_cast<double>(left.half_area()) * static_cast<double>(count);
    const Split split{left_cost + right_cost[count], count, axis, 0};
    if (split.better_than(best, items.size())) best = split;
  }
}

}  // namespace dcem
