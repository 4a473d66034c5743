#pragma once
/// Parts of edges seen from one end, in clusters.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/edge_parts.hpp"

namespace dcem {

class EdgeClusters {
 public:
  /// `wedge_of(part)` for a part of `parts`; cones count from `origin_m`.
  template <typename WedgeOf>
  void build(std::span<const EdgePart> parts, const Vec3& origin_m, WedgeOf&& wedge_of) {
    clusters_.build(parts.size(), [&](std::uint32_t part) {
      const Wedge& wedge = wedge_of(parts[part]);
      const Vec3 start = wedge.start_m - origin_m, direction = edge_direction(wedge);
      Aabb<double> box;
      box.extend(start + static_cast<double>(parts[part].from) * direction);
      box.extend(start + static_cast<double>(parts[part].to) * direction);
      return box;
    });
    const std::span<const std::uint32_t> items = clusters_.items();
    lanes_.assign(items.size() / simd_lanes, {});
    for (std::size_t at = 0; at < items.size(); ++at) {
      if (items[at] == ConeClusters::nothing) continue;
      const EdgePart& part = parts[items[at]];
      lanes_[at / simd_lanes].set(at % simd_lanes, part, wedge_of(part), origin_m);
    }
  }

  /// From now on the parts are those that another end sees, counted from where cones are.
  void see_from(const Vec3& end) {
    for (PartLanes& lanes : lanes_) lanes.see_from(end);
  }

  /// Boxes that hold all parts.
  std::span<const ConeClusters::Box> boxes() const { return clusters_.boxes(); }

  /// Calls `visit(part)` for parts on which the point that diffracts between the end and an apex may lie in a cone: as
  /// `PartLanes::meeting` has it.
  template <bool end_moves = false, typename Visit>
  void for_each_in(std::span<const HalfSpace> cone, const Vec3& apex, float moved_m, Visit&& visit) const {
    clusters_.for_each_in(cone, [&](std::size_t first) {
      std::uint32_t left = lanes_[first / simd_lanes].template meeting<end_moves>(cone, apex, moved_m);
      for (; left != 0; left &= left - 1) {
        const std::uint32_t item = clusters_.items()[first + static_cast<std::size_t>(std::countr_zero(left))];
        if (item != ConeClusters::nothing) visit(item);
      }
    });
  }

 private:
  ConeClusters clusters_;
  std::vector<PartLanes> lanes_;
};

}  // namespace dcem
