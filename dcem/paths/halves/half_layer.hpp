#pragma once
/// The mirrors and edges that an end may see, its images, and the cones behind them: of the scenery, or of what moves.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/edge_clusters.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

struct HalfLayer : SeenLayer {
  std::vector<Vec3> images_m;  ///< of the end, one in each mirror
  ConeList cones;              ///< what each image may see

  /// Lays out what stands in `mirrors` and `edges` for an end. `pairs`: for sequences of two elements, too.
  void lay_out(const Scene& scene, const Vec3& end_m, const Vec3& origin_m, bool pairs) {
    if (!pairs) return find_images(scene, end_m);
    lay_out_images(scene, end_m, origin_m);
    lay_out_edges(scene, end_m, origin_m);
  }
  /// The images alone.
  void find_images(const Scene& scene, const Vec3& end_m) {
    images_m.clear();
    for (const FacetId id : mirrors) images_m.push_back(mirrored(scene.facet(id).plane, end_m));
  }
  void lay_out_images(const Scene& scene, const Vec3& end_m, const Vec3& origin_m);
  void lay_out_edges(const Scene& scene, const Vec3& end_m, const Vec3& origin_m);
  /// The end has moved, and sees the same edges.
  void see_edges_from(const Vec3& end_m) { edge_clusters_.see_from(end_m - origin_m_); }

  /// Calls `visit(mirror)` for the mirrors whose image of the end may lie in a cone, and may see through the mirror a
  /// point or what is within `radius_m` of it.
  template <typename Visit>
  void for_each_image_in(std::span<const HalfSpace> cone, const Vec3& point_m, float radius_m, Visit&& visit) const;
  /// Calls `visit(edge)` for the edges of which the point that diffracts between the end and `apex_m` may lie in a
  /// cone.
  template <typename Visit>
  void for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const;

 private:
  Vec3 origin_m_{0.0};  ///< of the numbers in single precision
  ConeClusters image_clusters_;
  EdgeClusters edge_clusters_;
  std::vector<EightImages> eight_images_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline void HalfLayer::lay_out_images(const Scene& scene, const Vec3& end_m, const Vec3& origin_m) {
  origin_m_ = origin_m;
  find_images(scene, end_m);
  cones.clear();
  for (std::size_t mirror = 0; mirror < mirrors.size(); ++mirror) {
    const WorldFacet& facet = scene.facet(mirrors[mirror]);
    cones.add(origin_m_, images_m[mirror], facet.plane, scene.hull_m(facet));
  }
  image_clusters_.build(images_m.size(), [&](std::uint32_t mirror) {
    return Aabb<double>{images_m[mirror] - origin_m_, images_m[mirror] - origin_m_};
  });
  const std::span<const std::uint32_t> items = image_clusters_.items();
  eight_images_.assign(items.size() / simd_lanes, {});
  constexpr float everywhere = -1e30F;
  for (std::size_t at = 0; at < items.size(); ++at) {
    EightImages& eight = eight_images_[at / simd_lanes];
    const std::size_t lane = at % simd_lanes;
    for (auto& plane : eight.planes) plane[3][lane] = everywhere;
    if (items[at] == ConeClusters::nothing) continue;
    const Vec3 image = images_m[items[at]] - origin_m_;
    for (int axis = 0; axis < 3; ++axis) {
      eight.place[static_cast<std::size_t>(axis)][lane] = static_cast<float>(image[axis]);
    }
    const std::span<const HalfSpace> cone = cones[items[at]];
    for (std::size_t side = 0; side < std::min(EightImages::plane_count, cone.size()); ++side) {
      eight.planes[side][0][lane] = cone[side].x;
      eight.planes[side][1][lane] = cone[side].y;
      eight.planes[side][2][lane] = cone[side].z;
      eight.planes[side][3][lane] = cone[side].offset;
    }
  }
}

inline void HalfLayer::lay_out_edges(const Scene& scene, const Vec3& end_m, const Vec3& origin_m) {
  origin_m_ = origin_m;
  std::vector<EdgePart> parts;
  for (std::uint32_t edge = 0; edge < edges.size(); ++edge) {
    parts.push_back(whole_edge(edge, scene.wedge(edges[edge]).edge, end_m));
  }
  edge_clusters_.build(parts, origin_m_,
                       [&](const EdgePart& part) -> const Wedge& { return scene.wedge(edges[part.edge]).edge; });
}

template <typename Visit>
void HalfLayer::for_each_image_in(std::span<const HalfSpace> cone, const Vec3& point_m, float radius_m,
                                  Visit&& visit) const {
  const Vec3 point = point_m - origin_m_;
  const ConeTarget target{static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z),
                          1e-6F * static_cast<float>(glm::length(point)), radius_m};
  const auto visit_eight = [&](std::size_t first, std::uint32_t lanes) {
    image_clusters_.for_each_of(first, lanes, visit);
  };
  detail::cone_kernels().images(image_clusters_.tree(), eight_images_, cone, target, told_to(visit_eight));
}

template <typename Visit>
void HalfLayer::for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const {
  edge_clusters_.for_each_in(cone, apex_m - origin_m_, 0.0F, visit);
}

}  // namespace dcem
