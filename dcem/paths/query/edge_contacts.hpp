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
#include <functional>
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
  std::optional<double> near_place(double inner_m, double outer_m) const {
    for (const double end_m : {0.0, length_m_}) {
      if (distance_m(end_m) <= inner_m) return end_m;
    }
    double low_m = 0.0, high_m = length_m_;
    while (high_m - low_m > least_width * length_m_) {
      const double third_m = (high_m - low_m) / 3.0, one_m = low_m + third_m, other_m = high_m - third_m;
      const double at_one_m = distance_m(one_m), at_other_m = distance_m(other_m);
      if (std::min(at_one_m, at_other_m) <= inner_m) return at_one_m <= at_other_m ? one_m : other_m;
      (at_one_m < at_other_m ? high_m : low_m) = at_one_m < at_other_m ? other_m : one_m;
      if (std::min(at_one_m, at_other_m) - (high_m - low_m) > outer_m) return std::nullopt;
    }
    return 0.5 * (low_m + high_m);
  }

  /// What is no farther than `radius_m`, less what halving leaves open; `place_m` is no farther.
  Stretch within(double place_m, double radius_m) const {
    return {rim(place_m, 0.0, radius_m).inside_m, rim(place_m, length_m_, radius_m).inside_m};
  }
  /// The same, more what halving leaves open. Where `place_m` is the nearest there is it may be farther.
  Stretch around(double place_m, double radius_m) const {
    const double slack_m = least_width * length_m_;
    return {rim(place_m, 0.0, radius_m).outside_m - slack_m, rim(place_m, length_m_, radius_m).outside_m + slack_m};
  }

 private:
  static constexpr double least_width = 1e-7;  ///< of an edge's length
  static constexpr int most_halvings = 24;     ///< as fine
  static constexpr double least_m = 0.05;      ///< shorter stretches are not worth it

  struct Rim {
    double inside_m, outside_m;
  };

  /// Between a place and an end of the edge, where the distance passes a radius.
  Rim rim(double place_m, double end_m, double radius_m) const {
    if (distance_m(end_m) <= radius_m) return {end_m, end_m};
    Rim rim{place_m, end_m};
    const double beside_m = end_m > place_m ? std::min(place_m + least_m, end_m) : std::max(place_m - least_m, end_m);
    if (distance_m(beside_m) > radius_m) return {place_m, beside_m};
    for (int step = 0; step < most_halvings; ++step) {
      const double middle_m = 0.5 * (rim.inside_m + rim.outside_m);
      (distance_m(middle_m) <= radius_m ? rim.inside_m : rim.outside_m) = middle_m;
    }
    return rim;
  }

  Vec3 start_m_, direction_;
  double length_m_;
  TriangleCorners corners_;
};

/// What all stretches together leave known of an edge.
inline EdgeContact contact_of(double length_m, std::vector<Stretch>& touched, std::vector<Stretch>& near) {
  const double guard_m = 1e-6 * (1.0 + length_m);  // more than single precision takes off
  EdgeContact contact;
  double to_m = 0.0, from_m = length_m;
  std::ranges::sort(touched, {}, &Stretch::from_m);
  for (const Stretch& one : touched) {
    if (one.from_m <= to_m) to_m = std::max(to_m, one.to_m);
  }
  if (to_m >= length_m) return all_along_touched();
  std::ranges::sort(touched, std::greater{}, &Stretch::to_m);
  for (const Stretch& one : touched) {
    if (one.to_m >= from_m) from_m = std::min(from_m, one.from_m);
  }
  if (to_m > 0.0) contact.touched_to_m = static_cast<float>(to_m - guard_m);
  if (from_m < length_m) contact.touched_from_m = static_cast<float>(from_m + guard_m);
  std::ranges::sort(near, {}, &Stretch::from_m);
  near.push_back({length_m + guard_m, length_m + guard_m});
  double free_from_m = -guard_m, widest_m = 0.0;
  for (const Stretch& one : near) {
    if (one.from_m - free_from_m > widest_m) {
      widest_m = one.from_m - free_from_m;
      contact.free_from_m = static_cast<float>(free_from_m + guard_m);
      contact.free_to_m = static_cast<float>(one.from_m - guard_m);
    }
    free_from_m = std::max(free_from_m, one.to_m);
  }
  return contact;
}

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
