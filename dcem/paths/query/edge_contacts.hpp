#pragma once
/// Where third facets touch edges: the foot of a house on the ground, the rim of a roof at a higher neighbour, the rim
/// of a wall in the corner of a room. No path is diffracted there, wherever its ends are, and elsewhere nobody need
/// look for third facets. Found once, it need not be asked for every point of a map.
///
/// The distance of a point of a line from a triangle is convex along the line and changes no faster than the place, so
/// what is nearer than some radius is one stretch, whose ends are found by halving. What is nearer than 0.999 of the
/// contact rule's reach is touched for sure, what is farther than 1.001 of it is free for sure; rounding is a millionth
/// of the difference. In between the scene is asked as before.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/solve/edge_rules.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

namespace detail {

/// A stretch of an edge, in metres from its start.
struct Stretch {
  double from_m, to_m;
};

/// A triangle beside an edge.
class TriangleBeside {
 public:
  TriangleBeside(const Wedge& edge, const TriangleCorners& corners)
      : start_m_(edge.start_m), direction_(edge_direction(edge)), length_m_(edge_length_m(edge)), corners_(corners) {}

  double distance_m(double along_m) const { return distance_to_triangle_m(corners_, start_m_ + along_m * direction_); }

  /// A place that is no farther than `inner_m`, or else the nearest there is; none where all are farther than
  /// `outer_m`.
  std::optional<double> near_place(double inner_m, double outer_m) const;
  /// What is no farther than `radius_m`, less what halving leaves open; `place_m` is no farther.
  Stretch within(double place_m, double radius_m) const;
  /// The same, more what halving leaves open. Where `place_m` is the nearest there is it may be farther.
  Stretch around(double place_m, double radius_m) const;

 private:
  static constexpr double least_width = 1e-7;  ///< of an edge's length
  static constexpr int most_halvings = 24;     ///< as fine
  static constexpr double least_m = 0.05;      ///< shorter stretches are not worth it

  struct Rim {
    double inside_m, outside_m;
  };
  /// Between a place and an end of the edge, where the distance passes a radius.
  Rim rim(double place_m, double end_m, double radius_m) const;

  Vec3 start_m_, direction_;
  double length_m_;
  TriangleCorners corners_;
};

/// What all stretches together leave known of an edge. Sorts both.
EdgeContact contact_of(double length_m, std::vector<Stretch>& touched, std::vector<Stretch>& near);

/// Triangles of third facets of an edge's own body in the boxes of its pieces.
template <typename Index>
void third_triangles(const Scene& scene, const Index& index, const WorldWedge& wedge, double reach_m,
                     std::vector<std::uint32_t>& triangles) {
  constexpr double piece_m = 8.0;  // the box of a long edge that runs askew holds half a town
  const Vec3 along_m = wedge.edge.end_m - wedge.edge.start_m;
  const int pieces = std::max(1, static_cast<int>(std::ceil(glm::length(along_m) / piece_m)));
  TraversalCounters counters;
  const auto collect = [&](std::uint32_t triangle) {
    const FacetId facet = scene.facet_of_triangle(triangle);
    const bool own_face = facet == wedge.facets[0] || facet == wedge.facets[1];
    if (!own_face && scene.facet(facet).body == wedge.body) triangles.push_back(triangle);
  };
  triangles.clear();
  for (int piece = 0; piece < pieces; ++piece) {
    Aabb<double> box;
    for (const int end : {piece, piece + 1}) box.extend(wedge.edge.start_m + along_m * (1.0 * end / pieces));
    index.overlapping(inflated(box, reach_m), collect, &counters);
  }
  std::ranges::sort(triangles);
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

/// `triangles` is scratch memory.
template <typename Index>
EdgeContact edge_contact(const Scene& scene, const Index& index, const WorldWedge& wedge,
                         std::vector<std::uint32_t>& triangles) {
  const double reach_m = scene.settings().weld_tolerance_m + wedge.edge.stray_m;
  const double inner_m = 0.999 * reach_m, outer_m = 1.001 * reach_m;
  third_triangles(scene, index, wedge, outer_m, triangles);
  std::vector<Stretch> touched, near;
  for (const std::uint32_t triangle : triangles) {
    const TriangleBeside beside(wedge.edge, scene.corners_m(triangle));
    const std::optional<double> place_m = beside.near_place(inner_m, outer_m);
    if (!place_m) continue;
    near.push_back(beside.around(*place_m, outer_m));
    if (beside.distance_m(*place_m) <= inner_m) touched.push_back(beside.within(*place_m, inner_m));
  }
  EdgeContact contact = contact_of(edge_length_m(wedge.edge), touched, near);
  if (scene.bodies().size() > 1) contact.free_to_m = EdgeContact{}.free_to_m;  // another one may come
  return contact;
}

}  // namespace detail

/// For each edge that diffracts, where third facets of its own body touch it in the sense of the contact rule: within
/// the weld tolerance and the edge's own dirt. (A link for which the facet does not exist, because a device rides on
/// that body, has no such edge either.) Where there are other bodies, nothing is known to be free.
template <typename Index>
std::vector<EdgeContact> edge_contacts(const Scene& scene, const Index& index, const EdgeRules& rules,
                                       ThreadPool& pool) {
  std::vector<EdgeContact> contacts(scene.wedges().size());
  std::vector<std::vector<std::uint32_t>> triangles(pool.size());
  pool.for_each(scene.wedges().size(), [&](std::size_t number, unsigned worker) {
    const WorldWedge& wedge = scene.wedges()[number];
    if (diffracts(wedge, rules)) contacts[number] = detail::edge_contact(scene, index, wedge, triangles[worker]);
  });
  return contacts;
}

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/query/edge_contacts_bodies.hpp"
#endif
