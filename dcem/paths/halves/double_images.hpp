#pragma once
/// The images of an end in two mirrors, the second of which is given.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/cone_items.hpp"

namespace dcem {

/// Holds scratch memory: one per thread. Scene and lanes must stay.
class DoubleImages {
 public:
  DoubleImages(const Scene& scene, const LaneScene& lanes) : scene_(scene), lanes_(lanes) {}

  /// Calls `visit(mirror, image_m)` for each of the mirrors in a table of an end's lists, over which it lights
  /// `middle`, and its image in both, that may see some of the boxes through `middle`.
  template <typename Visit>
  void for_each(const BeamLists& end, const BeamTable& table, FacetId middle, std::span<const CentredBox> boxes,
                Visit&& visit) {
    const WorldFacet& facet = scene_.facet(middle);
    table.for_each_mirror_before(middle, outline_of(facet), boxes, [&](std::uint32_t place) {
      const BeamMirror& mirror = end.mirrors()[place];
      visit(mirror, mirrored(facet.plane, mirror.image_m + lanes_.origin_m()));
    });
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
  /// A mirror as a window, until that is asked for again.
  WindowOutline outline_of(const WorldFacet& facet) {
    const std::span<const Vec3> corners_m = scene_.hull_m(facet);
    const Plane& plane = facet.plane;
    const auto numbers = [](const Vec3& of) {
      return std::array{static_cast<float>(of.x), static_cast<float>(of.y), static_cast<float>(of.z)};
    };
    sides_.clear();
    Vec3 around(0.0);
    for (std::size_t index = 0; index < corners_m.size(); ++index) {
      const Vec3 &from_m = corners_m[index], &to_m = corners_m[(index + 1) % corners_m.size()];
      sides_.push_back({numbers(from_m - lanes_.origin_m()), numbers(to_m - from_m)});
      around += glm::cross(from_m - corners_m[0], to_m - corners_m[0]);
    }
    const auto [x, y, z] = numbers(plane.normal);
    const auto offset = static_cast<float>(glm::dot(plane.normal, plane.point_m - lanes_.origin_m()));
    return {{x, y, z, offset}, glm::dot(around, plane.normal) < 0.0 ? -1.0F : 1.0F, sides_};
  }

  const Scene& scene_;
  const LaneScene& lanes_;
  ConeList window_;
  std::vector<HalfSpace> cone_;
  std::vector<WindowSide> sides_;
};

}  // namespace dcem
