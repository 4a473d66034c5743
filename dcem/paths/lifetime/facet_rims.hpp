#pragma once
/// The rims of facets, holes included: what a point on a facet has to pass before it is off it.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/geometry/segment_distance.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// A side of a triangle that no other triangle of its facet has.
struct RimSide {
  std::uint32_t from = 0, to = 0;  ///< vertices of the scene
};

class FacetRims {
 public:
  explicit FacetRims(const Scene& scene);

  std::span<const RimSide> of(FacetId facet) const {
    const std::size_t first = facet.value == 0 ? 0 : ends_[facet.value - 1];
    return std::span(sides_).subspan(first, ends_[facet.value] - first);
  }
  static Segment segment(const Scene& scene, const RimSide& side) {
    return {scene.vertices_m()[side.from], scene.vertices_m()[side.to]};
  }

 private:
  static void keep_single(std::vector<RimSide>& sides);

  std::vector<RimSide> sides_;
  std::vector<std::size_t> ends_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/lifetime/facet_rims_bodies.hpp"
#endif
