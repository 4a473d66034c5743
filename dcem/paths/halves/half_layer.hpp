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
    origin_m_ = origin_m;
    lay_out_images(scene, end_m);
    lay_out_edges(scene, end_m);
  }

  /// Calls `visit(mirror)` for the mirrors whose image of the end may lie in a cone.
  template <typename Visit>
  void for_each_image_in(std::span<const HalfSpace> cone, Visit&& visit) const;
  /// Calls `visit(edge)` for the edges of which the point that diffracts between the end and `apex_m` may lie in a
  /// cone.
  template <typename Visit>
  void for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const;

 private:
  using Lanes = std::array<float, simd_lanes>;

  void lay_out_images(const Scene& scene, const Vec3& end_m);
  void lay_out_edges(const Scene& scene, const Vec3& end_m);
  static std::uint32_t inside(std::span<const HalfSpace> cone, const Float8& x, const Float8& y, const Float8& z,
                              std::uint32_t lanes) {
    for (const HalfSpace& plane : cone) {
      if (lanes == 0) return 0;
      lanes &= (Float8(plane.offset) <= x * plane.x + y * plane.y + z * plane.z).bits();
    }
    return lanes;
  }
  template <typename Visit>
  static void visit_lanes(const ConeClusters& clusters, std::size_t first, std::uint32_t lanes, Visit& visit) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t item = clusters.items()[first + static_cast<std::size_t>(std::countr_zero(lanes))];
      if (item != ConeClusters::nothing) visit(item);
    }
  }

  Vec3 origin_m_{0.0};  ///< of the numbers in single precision
  ConeClusters image_clusters_;
  EdgeClusters edge_clusters_;
  std::vector<std::array<Lanes, 3>> image_lanes_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline void HalfLayer::lay_out_images(const Scene& scene, const Vec3& end_m) {
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
  for (std::size_t place = 0; place < items.size(); ++place) {
    if (items[place] == ConeClusters::nothing) continue;
    const Vec3 image = images_m[items[place]] - origin_m_;
    for (int axis = 0; axis < 3; ++axis) {
      image_lanes_[place / simd_lanes][static_cast<std::size_t>(axis)][place % simd_lanes] =
          static_cast<float>(image[axis]);
    }
  }
}

inline void HalfLayer::lay_out_edges(const Scene& scene, const Vec3& end_m) {
  std::vector<EdgePart> parts;
  for (std::uint32_t edge = 0; edge < edges.size(); ++edge) {
    parts.push_back(whole_edge(edge, scene.wedge(edges[edge]).edge, end_m));
  }
  edge_clusters_.build(parts, origin_m_,
                       [&](const EdgePart& part) -> const Wedge& { return scene.wedge(edges[part.edge]).edge; });
}

template <typename Visit>
void HalfLayer::for_each_image_in(std::span<const HalfSpace> cone, Visit&& visit) const {
  image_clusters_.for_each_in(cone, [&](std::size_t first) {
    const std::array<Lanes, 3>& lanes = image_lanes_[first / simd_lanes];
    const Float8 x(lanes[0]), y(lanes[1]), z(lanes[2]);
    visit_lanes(image_clusters_, first, inside(cone, x, y, z, 0xffU), visit);
  });
}

template <typename Visit>
void HalfLayer::for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const {
  edge_clusters_.for_each_in(cone, apex_m - origin_m_, 0.0F, visit);
}

}  // namespace dcem
