#pragma once
/// Where the surface-area heuristic divides boxes in two for the least cost: at one of the bounds between bins of
/// their centres, or, of a few, at any place of their order.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/accel/binary/build_item.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/geometry/aabb.hpp"

namespace dcem {

/// Boxes divided in two.
struct SahSplit {
  double cost = std::numeric_limits<double>::infinity();  ///< Σ area · primitives of the two sides
  std::size_t left_count = 0;
  int axis = 0;
  std::uint32_t bin = 0;  ///< first bin of the right side; 0: divide the order along the axis instead

  /// Of two equally cheap splits the more even one, so that boxes without area do not make a chain.
  bool better_than(const SahSplit& other, std::size_t total) const {
    if (cost != other.cost) return cost < other.cost;
    const auto imbalance = [total](std::size_t left) {
      return left > total - left ? 2 * left - total : total - 2 * left;
    };
    return imbalance(left_count) < imbalance(other.left_count);
  }
};

/// Bins or, up to `SahSettings::sweep_limit` boxes, every split.
template <std::floating_point Scalar>
class SahSplitter {
 public:
  using Item = BuildItem<Scalar>;

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

  explicit SahSplitter(const SahSettings& settings) : settings_(settings) {}

  /// Of splits along all axes the cheapest; `left_count` 0: the centres coincide. `centers`: the box around them.
  SahSplit best(std::span<const Item> items, const Aabb<Scalar>& centers) const;
  BinScale bin_scale(const Aabb<Scalar>& centers, int axis) const;

 private:
  struct Bin {
    Aabb<Scalar> box;
    std::size_t count = 0;
  };

  void try_bins(int axis, std::span<const Item> items, const BinScale& scale, SahSplit& best) const;
  void try_sweep(int axis, std::span<const Item> items, SahSplit& best) const;

  SahSettings settings_;
};

template <std::floating_point Scalar>
typename SahSplitter<Scalar>::BinScale SahSplitter<Scalar>::bin_scale(const Aabb<Scalar>& centers, int axis) const {
  const Scalar scale = static_cast<Scalar>(settings_.bins) / (centers.max[axis] - centers.min[axis]);
  // Infinite for an extent that is zero or denormal, zero for one that overflows: neither can be binned.
  return {centers.min[axis], scale, settings_.bins, std::isfinite(scale) && scale > 0};
}

template <std::floating_point Scalar>
SahSplit SahSplitter<Scalar>::best(std::span<const Item> items, const Aabb<Scalar>& centers) const {
  SahSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    const BinScale scale = bin_scale(centers, axis);
    if (!scale.usable) continue;
    if (items.size() <= settings_.sweep_limit) {
      try_sweep(axis, items, best);
    } else {
      try_bins(axis, items, scale, best);
    }
  }
  return best;
}

template <std::floating_point Scalar>
void SahSplitter<Scalar>::try_bins(int axis, std::span<const Item> items, const BinScale& scale, SahSplit& best) const {
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
    const SahSplit split{left_cost + right_cost[bin], left.count, axis, bin};
    if (split.better_than(best, items.size())) best = split;
  }
}

template <std::floating_point Scalar>
void SahSplitter<Scalar>::try_sweep(int axis, std::span<const Item> items, SahSplit& best) const {
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
    const SahSplit split{left_cost + right_cost[count], count, axis, 0};
    if (split.better_than(best, items.size())) best = split;
  }
}

}  // namespace dcem
