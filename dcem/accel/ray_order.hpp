#pragma once
/// The order in which many rays are best traced.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/radix_sort.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Sorts rays by where they begin and where they go, so that what one of them has brought into the caches the next one
/// finds there.
///
/// Key: the cell of the origin in a grid over all origins, in Morton order, 12 halvings of what is longest at that
/// point, at most 6 of one axis; within a cell the direction's octant. Where all rays begin in one point, 6 bits
/// an axis of the direction. The memory is kept from call to call.
class RayOrder {
 public:
  /// Positions of all rays, in the order in which they should be traced: the same for the same rays, those with equal
  /// keys in the order given. Rays with numbers that are not finite come somewhere. Valid until the next call.
  std::span<const std::uint32_t> sort(std::span<const Ray<double>> rays) {
    place_grid(rays);
    keys_.entries.resize(rays.size());
    for (std::uint32_t index = 0; index < rays.size(); ++index) keys_.entries[index] = {key(rays[index]), index};
    keys_.sort(key_bits_);
    order_.resize(rays.size());
    for (std::size_t index = 0; index < rays.size(); ++index) order_[index] = keys_.entries[index].index;
    return order_;
  }

 private:
  static constexpr std::uint32_t cell_bits = 12, axis_bits = 6;

  void place_grid(std::span<const Ray<double>> rays) {
    Aabb<double> box;
    for (const Ray<double>& ray : rays) {
      if (is_finite(ray.origin)) box.extend(ray.origin);
    }
    low_ = box.empty() ? Vec3(0.0) : box.min;
    Vec3 cell = box.empty() ? Vec3(0.0) : box.extent();
    const bool is_point = !(std::max({cell.x, cell.y, cell.z}) > 0.0);
    direction_bits_ = is_point ? axis_bits : 1;
    std::array<std::uint32_t, 3> bits{};
    std::array<std::array<std::uint32_t, axis_bits>, 3> weight{};
    for (std::uint32_t next = cell_bits; next-- > 0 && std::max({cell.x, cell.y, cell.z}) > 0.0;) {
      int axis = cell.y > cell.x ? 1 : 0;
      if (cell.z > cell[axis]) axis = 2;
      const auto slot = static_cast<std::size_t>(axis);
      weight[slot][bits[slot]++] = 1U << next;
      cell[axis] = bits[slot] == axis_bits ? 0.0 : 0.5 * cell[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) fill_cells(axis, bits[axis], weight[axis], box);
    key_bits_ = 3 * direction_bits_ + (is_point ? 0 : cell_bits);
  }

  /// Which bits of the key a cell number along one axis sets.
  void fill_cells(std::size_t axis, std::uint32_t bits, const std::array<std::uint32_t, axis_bits>& weight,
                  const Aabb<double>& box) {
    const std::uint32_t count = 1U << bits;
    const double extent = box.empty() ? 0.0 : box.extent()[static_cast<int>(axis)];
    scale_[static_cast<int>(axis)] = extent > 0.0 ? count / extent : 0.0;
    cells_[axis].assign(count, 0);
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      for (std::uint32_t bit = 0; bit < bits; ++bit) {
        if ((cell >> (bits - 1 - bit) & 1U) != 0) cells_[axis][cell] |= weight[bit] << (3 * direction_bits_);
      }
    }
  }

  std::uint32_t key(const Ray<double>& ray) const {
    const Vec3 at = (ray.origin - low_) * scale_;
    std::uint32_t result = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result |= cells_[axis][number(at[static_cast<int>(axis)], cells_[axis].size())];
    }
    if (direction_bits_ == 1) {
      return result | (ray.direction.x > 0.0 ? 1U : 0U) | (ray.direction.y > 0.0 ? 2U : 0U) |
             (ray.direction.z > 0.0 ? 4U : 0U);
    }
    const Vec3 size = glm::abs(ray.direction);
    const double longest = std::max({size.x, size.y, size.z});
    const Vec3 towards = (ray.direction / longest + 1.0) * static_cast<double>(1U << (direction_bits_ - 1));
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t depth = number(towards[axis], std::size_t{1} << direction_bits_);
      for (std::uint32_t bit = 0; bit < direction_bits_; ++bit) {
        result |= (depth >> bit & 1U) << (3 * bit + static_cast<std::uint32_t>(axis));
      }
    }
    return result;
  }

  /// The whole number below `value`, from 0 to count − 1; 0 for NaN.
  static std::uint32_t number(double value, std::size_t count) {
    const auto most = static_cast<double>(count - 1);
    return static_cast<std::uint32_t>(value > 0.0 ? std::min(value, most) : 0.0);
  }

  Vec3 low_{0.0}, scale_{0.0};
  std::array<std::vector<std::uint32_t>, 3> cells_;
  std::uint32_t direction_bits_ = 0, key_bits_ = 0;
  KeyOrder keys_;
  std::vector<std::uint32_t> order_;
};

}  // namespace dcem
