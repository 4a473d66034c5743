#pragma once
/// Parts of edges seen from one end, in clusters.
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
    eights_.assign(items.size() / simd_lanes, no_parts());
    for (std::size_t at = 0; at < items.size(); ++at) {
      if (items[at] == ConeClusters::nothing) continue;
      const EdgePart& part = parts[items[at]];
      const Wedge& wedge = wedge_of(part);
      set_part(eights_[at / simd_lanes], at % simd_lanes, part, wedge.start_m - origin_m, edge_direction(wedge));
    }
  }

  /// From now on the parts are those that another end sees, counted from where cones are.
  void see_from(const Vec3& end) {
    for (EightParts& parts : eights_) dcem::see_from(parts, end);
  }

  /// Boxes that hold all parts.
  std::span<const CentredBox> boxes() const { return clusters_.boxes(); }

  /// Calls `visit(part)` for parts on which the point that diffracts between the end and an apex may lie in a cone: as
  /// `parts_met` has it.
  template <bool end_moves = false, typename Visit>
  void for_each_in(std::span<const HalfSpace> cone, const Vec3& apex, float moved_m, Visit&& visit) const {
    const auto visit_eight = [&](std::size_t first, std::uint32_t lanes) {
      clusters_.for_each_of(first, lanes, visit);
    };
    const detail::ConeKernels& kernels = detail::cone_kernels();
    const auto walk = end_moves ? kernels.parts_of_moving_end : kernels.parts;
    walk(clusters_.tree(), eights_, cone, edge_target(apex, moved_m), told_to(visit_eight));
  }

 private:
  ConeClusters clusters_;
  std::vector<EightParts> eights_;
};

}  // namespace dcem
