#pragma once
/// Builds a binary tree over boxes by the surface-area heuristic (SAH).
#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/binary/build_item.hpp"
#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/accel/binary/sah_splitter.hpp"
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

  explicit SahBuilder(const SahSettings& settings) : settings_(settings), splitter_(settings) {
    require_valid_settings(settings);
  }

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

  static std::uint32_t median_levels(std::size_t count) {
    return static_cast<std::uint32_t>(std::bit_width(count - 1));
  }

  std::span<Item> of(Range range) const { return items_.subspan(range.begin, range.size()); }

  void grow(std::size_t slot, Range range, const Aabb<Scalar>& box, std::uint32_t levels);
  std::optional<std::size_t> divide(Range range, const Aabb<Scalar>& box, std::uint32_t levels);
  std::size_t divide_at_median(Range range);
  std::size_t divide_at(Range range, const SahSplit& split);
  std::size_t divide_off_empty(Range range);

  SahSettings settings_;
  SahSplitter<Scalar> splitter_;
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
  const SahSplit split = splitter_.best(of(range), center_bounds_of<Scalar>(of(range)));
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
  SahSplit split;
  split.left_count = range.size() / 2;
  split.axis = extent.y > extent.x ? 1 : 0;
  if (extent.z > extent[split.axis]) split.axis = 2;
  return divide_at(range, split);
}

template <std::floating_point Scalar>
std::size_t SahBuilder<Scalar>::divide_at(Range range, const SahSplit& split) {
  const std::span<Item> items = of(range);
  if (split.bin == 0) {
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(split.left_count);
    std::nth_element(items.begin(), middle, items.end(),
                     [&](const Item& a, const Item& b) { return a.before(b, split.axis); });
  } else {
    const auto scale = splitter_.bin_scale(center_bounds_of<Scalar>(items), split.axis);
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

}  // namespace dcem