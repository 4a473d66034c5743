#pragma once
/// Edges that lie on a third facet all along, such as the foot of a house on the ground or the rim of a wall in the
/// corner of a room: no path is diffracted there, wherever its ends are. Found once, they need not be tried for every
/// point of a map.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

namespace detail {

/// Whether triangles, taken together, are within `reach_m` of every point of an edge. The distance from a convex set is
/// convex along the edge, so of two places that are within reach of the same triangle all those between them are, too.
class EdgeEmbedding {
 public:
  EdgeEmbedding(const Scene& scene, const Wedge& edge, std::span<const std::uint32_t> triangles, double reach_m)
      : scene_(scene), edge_(edge), triangles_(triangles), reach_m_(reach_m) {}

  bool is_complete() const {
    double covered = 0.0;
    while (covered < 1.0) {
      double next = covered;
      for (const std::uint32_t triangle : triangles_) {
        if (within(triangle, covered)) next = std::max(next, reach_from(triangle, covered));
      }
      if (!(next > covered + least_step)) return false;
      covered = next;
    }
    return true;
  }

 private:
  static constexpr double least_step = 1e-6;  ///< of the edge's length
  static constexpr int halvings = 30;

  bool within(std::uint32_t triangle, double share) const {
    const Vec3 point_m = edge_.start_m + share * (edge_.end_m - edge_.start_m);
    return distance_to_triangle_m(scene_.corners_m(triangle), point_m) <= reach_m_;
  }

  /// The far end of what the triangle covers from a place that it covers; never beyond it.
  double reach_from(std::uint32_t triangle, double from) const {
    if (within(triangle, 1.0)) return 1.0;
    double inside = from, outside = 1.0;
    for (int step = 0; step < halvings; ++step) {
      const double middle = 0.5 * (inside + outside);
      (within(triangle, middle) ? inside : outside) = middle;
    }
    return inside;
  }

  const Scene& scene_;
  const Wedge& edge_;
  std::span<const std::uint32_t> triangles_;
  double reach_m_;
};

/// Triangles of third facets of an edge's own body within reach of a box.
template <typename Index>
std::vector<std::uint32_t> third_triangles(const Scene& scene, const Index& index, const WorldWedge& wedge,
                                           const Aabb<double>& box) {
  std::vector<std::uint32_t> triangles;
  TraversalCounters counters;
  const auto collect = [&](std::uint32_t triangle) {
    const FacetId facet = scene.facet_of_triangle(triangle);
    const bool own_face = facet == wedge.facets[0] || facet == wedge.facets[1];
    if (!own_face && scene.facet(facet).body == wedge.body) triangles.push_back(triangle);
  };
  index.overlapping(box, collect, &counters);
  return triangles;
}

template <typename Index>
bool is_embedded_all_along(const Scene& scene, const Index& index, const WorldWedge& wedge) {
  const double reach_m = 0.999 * (scene.settings().weld_tolerance_m + wedge.edge.stray_m);
  // Most edges are free in the middle, and touch others at their ends alone.
  const Vec3 middle_m = 0.5 * (wedge.edge.start_m + wedge.edge.end_m);
  if (third_triangles(scene, index, wedge, inflated(Aabb<double>{middle_m, middle_m}, reach_m)).empty()) return false;
  Aabb<double> box{wedge.edge.start_m, wedge.edge.start_m};
  box.extend(wedge.edge.end_m);
  const std::vector<std::uint32_t> triangles = third_triangles(scene, index, wedge, inflated(box, reach_m));
  return EdgeEmbedding(scene, wedge.edge, triangles, reach_m).is_complete();
}

}  // namespace detail

/// For each edge of the scene, whether third facets of its own body touch it all along, in the sense of the contact
/// rule: within the weld tolerance and the edge's own dirt, less a thousandth for rounding. (A link for which the facet
/// does not exist, because a device rides on that body, then has no such edge either.)
template <typename Index>
std::vector<char> embedded_edges(const Scene& scene, const Index& index, ThreadPool& pool) {
  std::vector<char> covered(scene.wedges().size());
  pool.for_each(scene.wedges().size(), [&](std::size_t number, unsigned) {
    const WorldWedge& wedge = scene.wedges()[number];
    covered[number] = wedge.present && detail::is_embedded_all_along(scene, index, wedge) ? 1 : 0;
  });
  return covered;
}

}  // namespace dcem
