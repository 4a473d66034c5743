#pragma once
/// The images of an end in two mirrors, the second of which is given.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/window_lanes.hpp"

namespace dcem {

/// Holds scratch memory: one per thread. Scene and lanes must stay.
class DoubleImages {
 public:
  DoubleImages(const Scene& scene, const LaneScene& lanes) : scene_(scene), lanes_(lanes) {}

  /// Calls `visit(mirror, image_m)` for each of some mirrors of an end, over which it lights `middle`, and its image in
  /// both, that may see some of the boxes through `middle`.
  template <typename Visit>
  void for_each(const BeamLists& end, std::span<const std::uint32_t> mirrors, FacetId middle,
                std::span<const ConeClusters::Box> boxes, Visit&& visit) const {
    const WorldFacet& facet = scene_.facet(middle);
    const WindowLanes window(facet.plane, scene_.hull_m(facet), lanes_.origin_m());
    for (std::size_t first = 0; first < mirrors.size(); first += simd_lanes) {
      const std::size_t count = std::min<std::size_t>(simd_lanes, mirrors.size() - first);
      std::array<Vec3, simd_lanes> images_m;
      for (std::size_t lane = 0; lane < count; ++lane) {
        images_m[lane] = mirrored(facet.plane, end.mirrors()[mirrors[first + lane]].image_m + lanes_.origin_m());
      }
      const LanePoints images(std::span<const Vec3>(images_m).first(count), lanes_.origin_m());
      std::uint32_t left = window.seeing(images, boxes, (1U << count) - 1U);
      for (; left != 0; left &= left - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(left));
        visit(end.mirrors()[mirrors[first + lane]], images_m[lane]);
      }
    }
  }

  /// What an image in two mirrors may see: through the second one, and through the first one mirrored in it. Valid
  /// until it is asked for again.
  std::span<const HalfSpace> cone(const BeamMirror& first, FacetId middle, const Vec3& image_m) {
    const WorldFacet& facet = scene_.facet(middle);
    window_.clear();
    window_.add(lanes_.origin_m(), image_m, facet.plane, scene_.hull_m(facet));
    cone_.assign(window_[0].begin(), window_[0].end());
    const double slack_m = 1e-3 + 1e-6 * (glm::length(image_m - lanes_.origin_m()) + lanes_.reach_m());
    add_mirrored(first.cone.first(first.cone.size() - 1), facet.plane, lanes_.origin_m(), slack_m, cone_);
    return cone_;
  }

 private:
  const Scene& scene_;
  const LaneScene& lanes_;
  ConeList window_;
  std::vector<HalfSpace> cone_;
};

}  // namespace dcem
