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
#include "dcem/scene/scene.hpp"

namespace dcem {

struct HalfLayer {
  std::vector<FacetId> mirrors;  ///< ascending
  std::vector<WedgeId> edges;    ///< ascending
  std::vector<Vec3> images_m;    ///< of the end, one in each mirror
  ConeList cones;                ///< what each image may see

  void clear() {
    mirrors.clear();
    edges.clear();
    images_m.clear();
    cones.clear();
  }
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
  /// Eight edges: start, direction, length, the place along it nearest to the end, and how far that is.
  struct EdgeLanes {
    std::array<Lanes, 3> start{}, direction{};
    Lanes length{}, place{}, distance{};
  };

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
  ConeClusters image_clusters_, edge_clusters_;
  std::vector<std::array<Lanes, 3>> image_lanes_;
  std::vector<EdgeLanes> edge_lanes_;
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
  edge_clusters_.build(edges.size(), [&](std::uint32_t edge) {
    const Wedge& wedge = scene.wedge(edges[edge]).edge;
    Aabb<double> box;
    box.extend(wedge.start_m - origin_m_);
    box.extend(wedge.end_m - origin_m_);
    return box;
  });
  const std::span<const std::uint32_t> items = edge_clusters_.items();
  edge_lanes_.assign(items.size() / simd_lanes, {});
  for (std::size_t place = 0; place < items.size(); ++place) {
    EdgeLanes& lanes = edge_lanes_[place / simd_lanes];
    const std::size_t lane = place % simd_lanes;
    lanes.length[lane] = -1e30F;
    if (items[place] == ConeClusters::nothing) continue;
    const Wedge& wedge = scene.wedge(edges[items[place]]).edge;
    const Vec3 direction = edge_direction(wedge), start = wedge.start_m - origin_m_;
    const double nearest_m = glm::dot(end_m - wedge.start_m, direction);
    for (int axis = 0; axis < 3; ++axis) {
      lanes.start[static_cast<std::size_t>(axis)][lane] = static_cast<float>(start[axis]);
      lanes.direction[static_cast<std::size_t>(axis)][lane] = static_cast<float>(direction[axis]);
    }
    lanes.length[lane] = static_cast<float>(edge_length_m(wedge));
    lanes.place[lane] = static_cast<float>(nearest_m);
    lanes.distance[lane] = static_cast<float>(glm::distance(end_m, wedge.start_m + nearest_m * direction));
  }
}

template <typename Visit>
void HalfLayer::for_each_image_in(std::span<const HalfSpace> cone, Visit&& visit) const {
  image_clusters_.for_each_in(cone, [&](std::size_t first) {
    const std::array<Lanes, 3>& lanes = image_lanes_[first / simd_lanes];
    const Float8 x(lanes[0]), y(lanes[1]), z(lanes[2]);
    visit_lanes(image_clusters_, first, inside(cone, x, y, z, 0xffU), visit);
  });
}

/// The place of the point: see `detail::place_between`.
template <typename Visit>
void HalfLayer::for_each_edge_in(std::span<const HalfSpace> cone, const Vec3& apex_m, Visit&& visit) const {
  const Vec3 apex = apex_m - origin_m_;
  const Float8 ax(static_cast<float>(apex.x)), ay(static_cast<float>(apex.y)), az(static_cast<float>(apex.z));
  const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(apex));  // of a place, in single precision
  edge_clusters_.for_each_in(cone, [&](std::size_t first) {
    const EdgeLanes& lanes = edge_lanes_[first / simd_lanes];
    const Float8 sx(lanes.start[0]), sy(lanes.start[1]), sz(lanes.start[2]);
    const Float8 ex(lanes.direction[0]), ey(lanes.direction[1]), ez(lanes.direction[2]);
    const Float8 own_place(lanes.place), own_distance(lanes.distance);
    const Float8 dx = ax - sx, dy = ay - sy, dz = az - sz;
    const Float8 place = dx * ex + dy * ey + dz * ez;
    const Float8 x = dx - place * ex, y = dy - place * ey, z = dz - place * ez;
    const Float8 distance = simd::square_root(x * x + y * y + z * z);
    const Float8 point = own_place + (place - own_place) * (own_distance / (own_distance + distance));
    // Asked for so that NaN, of an end and an image on the edge's line, is inside.
    const std::uint32_t outside =
        (point < Float8(-slack_m)).bits() | (Float8(lanes.length) + Float8(slack_m) < point).bits();
    const std::uint32_t left = ~outside & 0xffU;
    visit_lanes(edge_clusters_, first, inside(cone, sx + point * ex, sy + point * ey, sz + point * ez, left), visit);
  });
}

}  // namespace dcem
