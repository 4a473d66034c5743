#pragma once
/// The mirrors and edges that an end may see, its images, and the cones behind them: of the scenery, or of what moves.
#include <algorithm>
#include <array>
#include <bit>
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

  /// Lays out what stands in `mirrors` and `edges` for an end.
  void lay_out(const Scene& scene, const Vec3& end_m, const Vec3& origin_m) {
    lay_out_images(scene, end_m, origin_m);
    lay_out_edges(scene, end_m, origin_m);
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
  using Lanes = std::array<float, simd_lanes>;
  /// Eight images, and what each of them sees through its mirror: as many half spaces as a mirror of four sides has.
  struct ImageLanes {
    static constexpr std::size_t plane_count = 5;
    std::array<Lanes, 3> place{};
    std::array<std::array<Lanes, 4>, plane_count> planes{};
  };

  Vec3 origin_m_{0.0};  ///< of the numbers in single precision
  ConeClusters image_clusters_;
  EdgeClusters edge_clusters_;
  std::vector<ImageLanes> image_lanes_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline void HalfLayer::lay_out_images(const Scene& scene, const Vec3& end_m, const Vec3& origin_m) {
  origin_m_ = origin_m;
  images_m.clear();
  cones.clear();
  for (const FacetId id : mirrors) {
    const WorldFacet& facet = scene.facet(id);
    images_m.push_back(mirrored(facet.plane, end_m));
    cones.add(origin_m_, images_m.back(), facet.plane, scene.hull_m(facet));
  }
  image_clusters_.build(images_m.size(), [&](std::uint32_t mirror) {
    return Aabb<double>{images_m[mirror] - origin_m_, images_m[mirror] - origin_m_};
  });
  const std::span<const std::uint32_t> items = image_clusters_.items();
  image_lanes_.assign(items.size() / simd_lanes, {});
  constexpr float everywhere = -1e30F;
  for (std::size_t at = 0; at < items.size(); ++at) {
    ImageLanes& eight = image_lanes_[at / simd_lanes];
    const std::size_t lane = at % simd_lanes;
    for (auto& plane : eight.planes) plane[3][lane] = everywhere;
    if (items[at] == ConeClusters::nothing) continue;
    const Vec3 image = images_m[items[at]] - origin_m_;
    for (int axis = 0; axis < 3; ++axis) {
      eight.place[static_cast<std::size_t>(axis)][lane] = static_cast<float>(image[axis]);
    }
    const std::span<const HalfSpace> cone = cones[items[at]];
    for (std::size_t side = 0; side < std::min(ImageLanes::plane_count, cone.size()); ++side) {
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
  const auto px = static_cast<float>(point.x), py = static_cast<float>(point.y), pz = static_cast<float>(point.z);
  const float room_m = radius_m + 1e-6F * static_cast<float>(glm::length(point));
  image_clusters_.for_each_in(cone, [&](std::size_t first) {
    const ImageLanes& eight = image_lanes_[first / simd_lanes];
    const Float8 x(eight.place[0]), y(eight.place[1]), z(eight.place[2]);
    const Float8 error_m = Float8(1e-6F) * (simd::absolute(x) + simd::absolute(y) + simd::absolute(z));
    std::uint32_t left = 0xffU;
    for (const HalfSpace& plane : cone) {
      left &= ~(x * plane.x + y * plane.y + z * plane.z + error_m < Float8(plane.offset)).bits();
      if (left == 0) return;
    }
    for (const auto& plane : eight.planes) {
      const Float8 inside = Float8(plane[0]) * px + Float8(plane[1]) * py + Float8(plane[2]) * pz + room_m;
      left &= ~(inside < Float8(plane[3])).bits();
      if (left == 0) return;
    }
    for (; left != 0; left &= left - 1) {
      const std::uint32_t item = image_clusters_.items()[first + static_cast<std::size_t>(std::countr_zero(left))];
      if (item != ConeClusters::nothing) visit(item);
    }
  });
}

template <typename Visit>
void HalfLayer::for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const {
  edge_clusters_.for_each_in(cone, apex_m - origin_m_, 0.0F, visit);
}

}  // namespace dcem
