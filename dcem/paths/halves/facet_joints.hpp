#pragma once
/// Façades that meet along a vertical line, with the same numbers: nothing passes between them.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dcem/scene/scene.hpp"

namespace dcem {

/// A side of a facet's hull, from the corner of this number to the next, on which another one lies.
struct FacetJoint {
  FacetId other;
  std::uint32_t own_side, other_side;
};

/// Which facets of a scenery meet so.
class FacetJoints {
 public:
  /// `takes(facet)`: those that hide what their hull does. Where very many meet on one line, none of them is noted.
  void find(const Scene& scene, std::uint32_t facets, const std::function<bool(FacetId)>& takes);

  std::span<const FacetJoint> of(FacetId facet) const {
    if (facet.value + std::size_t{1} >= first_.size()) return {};
    return std::span(joints_).subspan(first_[facet.value], first_[facet.value + 1] - first_[facet.value]);
  }

 private:
  /// A vertical side of a hull.
  struct Side {
    double x_m, y_m, low_m, high_m;
    std::uint32_t facet, side;

    bool is_on_line_of(const Side& beside) const { return x_m == beside.x_m && y_m == beside.y_m; }
  };
  static constexpr double least_length_m = 0.1, close_m = 2.5e-3;
  static constexpr std::size_t most_on_line = 64;  ///< a fan of thousands would have millions of pairs

  /// Whether all corners of a facet that lie at a side's line lie on it.
  static bool is_straight(const Scene& scene, const WorldFacet& facet, const Side& side);
  /// Corners of hulls are rounded: the numbers are those of the mesh.
  static Vec3 nearest_corner_m(const Scene& scene, const WorldFacet& facet, const Vec3& point_m);
  static void add_sides(const Scene& scene, std::uint32_t facet, std::vector<Side>& sides);

  std::vector<std::size_t> first_;
  std::vector<FacetJoint> joints_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/facet_joints_bodies.hpp"
#endif
