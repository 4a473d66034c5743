#pragma once
/// Bodies of cone.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/cone.hpp"

namespace dcem {

DCEM_INLINE std::vector<EightBoxes> ConeClusters::in_eights(const std::vector<Aabb<double>>& boxes) {
  std::vector<EightBoxes> eights((boxes.size() + simd_lanes - 1) / simd_lanes);
  for (std::size_t at = 0; at < boxes.size(); ++at) set(eights[at / simd_lanes], at % simd_lanes, boxes[at]);
  return eights;
}

DCEM_INLINE std::vector<Aabb<double>> ConeClusters::around_eights(const std::vector<Aabb<double>>& boxes) {
  std::vector<Aabb<double>> around((boxes.size() + simd_lanes - 1) / simd_lanes);
  for (std::size_t at = 0; at < boxes.size(); ++at) around[at / simd_lanes].extend(boxes[at]);
  return around;
}

DCEM_INLINE void ConeClusters::arrange(std::span<std::uint32_t> items, const std::vector<Vec3>& centre) {
  if (items.empty()) return;
  if (items.size() <= simd_lanes) {
    items_.insert(items_.end(), items.begin(), items.end());
    items_.resize((items_.size() + simd_lanes - 1) / simd_lanes * simd_lanes, nothing);
    return;
  }
  Aabb<double> box;
  for (const std::uint32_t item : items) box.extend(centre[item]);
  const Vec3 size = box.extent();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t group = std::size_t{simd_lanes} * simd_lanes;
  const std::size_t unit = items.size() > group ? group : simd_lanes;
  const std::size_t first = std::max<std::size_t>(1, (items.size() + unit - 1) / unit / 2) * unit;
  const auto middle = items.begin() + static_cast<std::ptrdiff_t>(first);
  std::nth_element(items.begin(), middle, items.end(), [&](std::uint32_t one, std::uint32_t other) {
    const double a = centre[one][axis], b = centre[other][axis];
    return a != b ? a < b : one < other;
  });
  arrange(items.first(first), centre);
  arrange(items.subspan(first), centre);
}

}  // namespace dcem
