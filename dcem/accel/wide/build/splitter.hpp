#pragma once
/// Where to divide a list of items in two: the surface-area heuristic over bins, or over all places where there are
/// few.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/accel/wide/build/item.hpp"
#include "dcem/core/lane_keys.hpp"
#include "dcem/core/simd.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// The same as one number in eight: the lower bounds, and the upper ones below zero, so that all are minima.
struct BinBox {
  Float8 bounds = std::numeric_limits<float>::infinity();

  BinBox() = default;
  explicit BinBox(const WideItem& item) : bounds(item.low, -item.high) {}
  void extend(const BinBox& other) { bounds = simd::minimum(bounds, other.bounds); }
  /// Meaningless where it is empty.
  float half_area() const { return half_area_of(-bounds.last_four() - bounds.first_four()); }
};

}  // namespace DCEM_ISA

}  // namespace detail

/// Divides lists of items.
class WideSplitter {
 public:
  static constexpr std::uint32_t bins = 16;
  static constexpr std::size_t sweep_limit = 8;   ///< so few items are divided at the best of all places
  static constexpr std::size_t size_limit = 512;  ///< from so many items on they are divided by size, too
  /// What a division by size is said to cost of what it does: what it sets apart would be in the way of all later ones.
  static constexpr float size_favour = 0.9F;

  /// Reorders the items. Returns how many of them go to the left: where Σ surface · weight is least. `centres`: around
  /// twice their centres. `spare`: as many places.
  static std::size_t divide(std::span<WideItem> items, std::span<WideItem> spare, const detail::FloatBox& centres) {
    if (items.size() == 2) return 1;
    const Float4 extent = centres.high - centres.low;
    if (items.size() <= sweep_limit) return sweep(items, centres.low);
    // Slightly less than the number of bins: the largest centre falls into the last one. An axis on which all centres
    // are the same, or all but, has one bin and no split.
    const Float4 bins_per_m = (Float4{} + (static_cast<float>(bins) * 0.9999F)) / extent;
    const Float4 scale = bins_per_m < std::numeric_limits<float>::infinity() ? bins_per_m : Float4{};
    const Float4 low = centres.low;
    const Choice choice = best_choice(items, low, scale);
    if (choice.axis < 0) return halve(items, extent);
    return partition(items, spare, [&](const WideItem& item) {
      return bin_of(item, low, scale)[choice.axis] < static_cast<std::int32_t>(choice.place);
    });
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

 private:
  struct Choice {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;
    std::uint32_t place = 0;  ///< first bin, or item, of the right side
  };

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
  /// What shares a leaf with nothing is an object, and takes a leaf of its own at least.
  static std::uint32_t count_of(const WideItem& item) { return item.kind == WideItem::no_kind ? simd_lanes : 1; }

  static Choice best_choice(std::span<const WideItem> items, const Float4& low, const Float4& scale) {
    const std::size_t axes = items.size() < size_limit ? 3 : 4;
    std::array<std::array<detail::BinBox, bins>, 4> boxes;
    std::array<std::array<std::uint32_t, bins>, 4> counts{};
    for (const WideItem& item : items) {
      const detail::BinBox box(item);
      const Int4 bin = bin_of(item, low, scale);
      for (std::size_t axis = 0; axis < axes; ++axis) {
        const auto slot = static_cast<std::size_t>(bin[static_cast<int>(axis)]);
        boxes[axis][slot].extend(box);
        counts[axis][slot] += count_of(item);
      }
    }
    Choice best;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const int which = static_cast<int>(axis);
      if (scale[which] > 0.0F) try_axis(boxes[axis], counts[axis], which, axis == 3 ? size_favour : 1.0F, best);
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
      try_axis(std::span(boxes).first(items.size()), std::span(counts).first(items.size()), axis, 1.0F, best);
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
      // Keys have the order of numbers from zero on; a zero with a sign, and what rounding takes below, would come
      // last.
      const Float4 centre = items[item].twice_centre() - low;
      for (int axis = 0; axis < 3; ++axis) {
        places[static_cast<std::size_t>(axis)][item] = centre[axis] > 0.0F ? centre[axis] : 0.0F;
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) ranks[axis] = LaneKeys(Float8(places[axis])).ranks();
  }

  /// What tracing so many items takes, up to a factor: they come in leaves of eight, so that a split that fills them is
  /// worth more. (Whole leaves alone: large quads end up in leaves with small ones. Powers below 1: lopsided trees.)
  static float weight_of(std::uint32_t count) {
    const std::uint32_t leaves = (count + simd_lanes - 1) / simd_lanes;
    return static_cast<float>(count) + 5.0F * static_cast<float>(leaves);
  }

  /// Divides before each of the places, none of them or some empty.
  static void try_axis(std::span<const detail::BinBox> boxes, std::span<const std::uint32_t> counts, int axis,
                       float favour, Choice& best) {
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
      const float cost = favour * (box.half_area() * weight_of(count) + right_cost[place]);
      if (cost < best.cost) best = {cost, axis, static_cast<std::uint32_t>(place)};
    }
  }
};

}  // namespace dcem
