#pragma once
/// A way that a device in a place may take to an end that stands.
#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/geometry/plane.hpp"
#include "dcem/paths/memory/way_reach.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// How far the points of a way move, from the receiver outwards.
using WayReach = std::array<Drift, 3>;

/// A way over some elements, from the receiver outwards.
struct CandidateWay {
  Sequence elements;
  std::array<Vec3, 3> points_m;
  Vec3 apex_m;  ///< the transmitter, or its image in the mirror next to it: the points follow from it
};

/// How far along each axis a point moves that stays on an element.
inline Vec3 spread_over(const Scene& scene, SequenceElement element, const Drift& drift) {
  if (drift.is_none()) return Vec3(0.0);
  return element.is_edge() ? spread_on(scene.wedge(element.edge()).edge, drift.most_m())
                           : spread_in(scene.facet(element.mirror()).plane, drift.most_m());
}

/// The drift of a point of an edge, while the other end of a way from one that stands moves.
inline Drift drift_on(const Wedge& edge, const Vec3& standing_m, const Vec3& moving_m, const Drift& moving) {
  const double reach_m = edge_reach_m(edge, standing_m, moving_m, moving.most_m());
  return std::isfinite(reach_m) ? Drift(reach_m, edge_direction(edge), 0.0) : Drift(reach_m);
}

/// How far the points of a way over one or two elements move while the receiver does.
inline WayReach way_reach(const Scene& scene, const Vec3& receiver_m, const CandidateWay& way, const Drift& receiver) {
  if (receiver.is_none()) return {};
  const SequenceElement near = way.elements[0];
  const auto plane_of = [&](SequenceElement element) -> const Plane& { return scene.facet(element.mirror()).plane; };
  const auto crossing = [&](SequenceElement mirror, const Vec3& from_m, const Drift& from, const Vec3& to_m,
                            const Drift& to) {
    return Drift(crossing_reach_m(plane_of(mirror), from_m, from, to_m, to));
  };
  if (near.is_edge()) {
    const Drift on_edge = drift_on(scene.wedge(near.edge()).edge, way.apex_m, receiver_m, receiver);
    if (way.elements.size() == 1) return {on_edge};
    return {on_edge, crossing(way.elements[1], way.apex_m, Drift(), way.points_m[0], on_edge)};
  }
  if (way.elements.size() == 1) return {crossing(near, way.apex_m, Drift(), receiver_m, receiver)};
  const Vec3 image_m = mirrored(plane_of(near), receiver_m);
  const Drift image = receiver.in(plane_of(near));
  const SequenceElement far = way.elements[1];
  if (far.is_edge()) {
    const Drift on_edge = drift_on(scene.wedge(far.edge()).edge, way.apex_m, image_m, image);
    return {crossing(near, way.points_m[1], on_edge, image_m, image), on_edge};
  }
  // Both points are on one straight way to the image: that stands at its other end.
  const Drift on_far = crossing(far, way.apex_m, Drift(), image_m, image);
  const double near_m = std::min(crossing_reach_m(plane_of(near), way.points_m[1], on_far, image_m, image),
                                 crossing_reach_m(plane_of(near), way.apex_m, Drift(), image_m, image));
  return {Drift(near_m), on_far};
}

}  // namespace dcem
