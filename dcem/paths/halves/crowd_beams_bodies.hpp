#pragma once
/// Bodies of crowd_beams.hpp.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/crowd_beams.hpp"

namespace dcem {

DCEM_INLINE void CrowdBeams::look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                       const Crowd& crowd, const HalfSettings& settings) {
  take_mirrors(scene, outlines, lanes, crowd);
  beams_.begin(false);
  for (std::uint32_t place = 0; place < mirrors_.size(); ++place) {
    beams_.look_through(scene, outlines, lanes.origin_m(), settings, mirrors_[place], place, true);
  }
  beams_.lay_out(scene);
}

DCEM_INLINE void CrowdBeams::take_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                          const Crowd& crowd) {
  struct Extent {
    std::size_t first_plane, first_image;
  };
  std::vector<Extent> extents;
  std::vector<HalfSpace> cone;
  std::vector<Vec3> points_m;
  mirrors_.clear();
  planes_.clear();
  images_m_.clear();
  for (const SeenLayer& layer : crowd.layers()) {
    for (const FacetId facet : layer.mirrors) {
      const Plane& plane = scene.facet(facet).plane;
      for (const double side : {1.0, -1.0}) {
        if (!crowd.cone(outlines, facet, plane, side, cone)) continue;
        crowd.points_beside(plane, side, points_m);
        extents.push_back({planes_.size(), images_m_.size()});
        planes_.insert(planes_.end(), cone.begin(), cone.end());
        for (const Vec3& point_m : points_m) images_m_.push_back(mirrored(plane, point_m));
        const Vec3 middle_m = mirrored(plane, crowd.sight().position_m()) - lanes.origin_m();
        mirrors_.push_back({{facet, {}, {}}, side, middle_m});
      }
    }
  }
  extents.push_back({planes_.size(), images_m_.size()});
  for (std::size_t place = 0; place < mirrors_.size(); ++place) {
    const auto [plane, image] = extents[place];
    mirrors_[place].cone = std::span(planes_).subspan(plane, extents[place + 1].first_plane - plane);
    mirrors_[place].images_m = std::span(images_m_).subspan(image, extents[place + 1].first_image - image);
  }
}

}  // namespace dcem
