#pragma once
/// The rims of facets, holes included: what a point on a facet has to pass before it is off it.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
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
  explicit FacetRims(const Scene& scene) {
    std::vector<RimSide> own;
    for (const WorldFacet& facet : scene.facets()) {
      own.clear();
      for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
        const auto& corners = scene.triangles()[facet.first_triangle + index];
        for (std::size_t side = 0; side < 3; ++side) {
          const auto [low, high] = std::minmax(corners[side], corners[(side + 1) % 3]);
          own.push_back({low, high});
        }
      }
      keep_single(own);
      sides_.insert(sides_.end(), own.begin(), own.end());
      ends_.push_back(sides_.size());
    }
  }

  std::span<const RimSide> of(FacetId facet) const {
    const std::size_t first = facet.value == 0 ? 0 : ends_[facet.value - 1];
    return std::span(sides_).subspan(first, ends_[facet.value] - first);
  }
  static Segment segment(const Scene& scene, const RimSide& side) {
    return {scene.vertices_m()[side.from], scene.vertices_m()[side.to]};
  }

 private:
  static void keep_single(std::vector<RimSide>& sides) {
    std::ranges::sort(sides, {}, [](const RimSide& side) { return std::pair(side.from, side.to); });
    const auto same = [](const RimSide& one, const RimSide& other) {
      return one.from == other.from && one.to == other.to;
    };
    std::size_t kept = 0;
    for (std::size_t first = 0; first < sides.size();) {
      std::size_t next = first + 1;
      while (next < sides.size() && same(sides[first], sides[next])) ++next;
      if (next == first + 1) sides[kept++] = sides[first];
      first = next;
    }
    sides.resize(kept);
  }

  std::vector<RimSide> sides_;
  std::vector<std::size_t> ends_;
};

}  // namespace dcem
