#pragma once
/// A way that a device in a place may take to an end that stands.
#include <array>

#include "dcem/geometry/plane.hpp"
#include "dcem/paths/memory/way_reach.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// How far the points of a way move, from the receiver outwards, metres.
using WayReach = std::array<double, 3>;

/// A way over some elements, from the receiver outwards.
struct CandidateWay {
  Sequence elements;
  std::array<Vec3, 3> points_m;
  Vec3 apex_m;  ///< the transmitter, or its image in the mirror next to it: the points follow from it
};

/// How far the points of a way over one or two elements move while the receiver moves by at most `moved_m`.
inline WayReach way_reach_m(const Scene& scene, const Vec3& receiver_m, const CandidateWay& way, double moved_m) {
  if (moved_m == 0.0) return {};
  const SequenceElement near = way.elements[0];
  const auto plane_of = [&](SequenceElement element) -> const Plane& { return scene.facet(element.mirror()).plane; };
  if (near.is_edge()) {
    const double edge_m = edge_reach_m(scene.wedge(near.edge()).edge, way.apex_m, receiver_m, moved_m);
    if (way.elements.size() == 1) return {edge_m, 0.0, 0.0};
    return {edge_m, crossing_reach_m(plane_of(way.elements[1]), way.apex_m, 0.0, way.points_m[0], edge_m), 0.0};
  }
  if (way.elements.size() == 1) {
    return {crossing_reach_m(plane_of(near), way.apex_m, 0.0, receiver_m, moved_m), 0.0, 0.0};
  }
  const Vec3 image_m = mirrored(plane_of(near), receiver_m);
  const SequenceElement far = way.elements[1];
  if (far.is_edge()) {
    const double edge_m = edge_reach_m(scene.wedge(far.edge()).edge, way.apex_m, image_m, moved_m);
    return {crossing_reach_m(plane_of(near), way.points_m[1], edge_m, image_m, moved_m), edge_m, 0.0};
  }
  const double far_m = crossing_reach_m(plane_of(far), way.apex_m, 0.0, image_m, moved_m);
  return {crossing_reach_m(plane_of(near), way.points_m[1], far_m, image_m, moved_m), far_m, 0.0};
}

}  // namespace dcem
