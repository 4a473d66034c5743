#pragma once
/// Whether a device, or where it may get to, has a path over three elements of a pool: whether the points
/// of the way, which follow from the images of both ends, lie on what they must, and whether the ends see those next to
/// them.
///
/// What `TripleJoiner` asks of one point, with room for how far each point of the way moves while the device does
/// (way_reach.hpp). The solver decides.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/memory/candidate_way.hpp"
#include "dcem/paths/memory/triple_pool.hpp"

namespace dcem {

/// Of a link in one frame. What it is made from must stay.
class TripleWays {
 public:
  /// Of a receiver in a place, which looks as the place does, and a transmitter with its lists.
  TripleWays(const JoinGates& gates, const FacetOutlines& outlines, const Vec3& receiver_m, const Sight& place,
             const BeamLists& reached)
      : gates_(gates), outlines_(outlines), place_(place), transmitter_(reached.half()), receiver_m_(receiver_m) {}

  /// Whether surely no path over them leads to the receiver, wherever it has moved to. Those with the same first
  /// element should be asked for one after the other.
  bool refuses(const Triple& triple, const Drift& receiver) {
    is_hidden_ = false;
    return !work_out(triple, receiver) || hides(triple);
  }
  /// Works out the points; false where one surely is not on what it must be. What is not refused for where the receiver
  /// is now is not for more.
  bool work_out(const Triple& triple, const Drift& receiver);
  /// Whether what was refused last was because an end does not see a point.
  bool is_hidden() const { return is_hidden_; }

  /// Of what was asked for or worked out last, and not refused: the points, from the receiver outwards, unless one is
  /// not known …
  bool has_points() const {
    return std::all_of(points_.begin(), points_.end(), [](const Point& point) { return point.drift.is_known(); });
  }
  std::array<Vec3, 3> points_m() const { return {points_[0].at_m, points_[1].at_m, points_[2].at_m}; }
  /// … and how far each of them may move.
  WayReach reach() const { return {points_[0].drift, points_[1].drift, points_[2].drift}; }

 private:
  struct Point {
    Vec3 at_m{0.0};
    Drift drift;

    bool stands() const { return drift.is_none(); }
    Point in(const Plane& mirror) const { return {mirrored(mirror, at_m), drift.in(mirror)}; }
  };

  const Scene& scene() const { return gates_.scene(); }
  const Plane& plane(FacetId facet) const { return scene().facet(facet).plane; }
  Point image_in(FacetId far) const { return {mirrored(plane(far), transmitter_.position_m()), Drift()}; }
  void take_near(FacetId near) {
    if (near_ == near) return;
    near_ = near;
    near_image_m_ = mirrored(plane(near), receiver_m_);
  }

  bool over_middle_edge(FacetId near, WedgeId middle, FacetId far, const Point& image) {
    const Point far_image = image_in(far);
    return meet(middle, far_image, image, 1) && cross(near, image, points_[1], 0) &&
           faces(middle, points_[0], points_[1]) && cross(far, far_image, points_[1], 2) &&
           faces(middle, points_[2], points_[1]);
  }
  bool first_over_edge(WedgeId near, FacetId middle, FacetId far, const Point& receiver) {
    const Point far_image = image_in(far), twice{mirrored(plane(middle), far_image.at_m), Drift()};
    return meet(near, twice, receiver, 0) && cross(middle, twice, points_[0], 1) &&
           faces(near, points_[1], points_[0]) && cross(far, far_image, points_[1], 2, points_[0], middle);
  }

  /// Where a way crosses a facet; false where it surely does not.
  bool cross(FacetId facet, const Point& from, const Point& to, std::size_t place) {
    return find_crossing(facet, from, to, points_[place]) && is_over(facet, points_[place]);
  }
  /// The same of a way that is mirrored at `to` and goes on to `end`: from `from` a straight way leads to the image of
  /// that, and the point moves no farther than it does on the whole of it. Where `to` is not known that is elsewhere.
  bool cross(FacetId facet, const Point& from, const Point& to, std::size_t place, const Point& end, FacetId mirror) {
    Point& at = points_[place];
    if (!find_crossing(facet, from, to, at)) return false;
    if (!at.stands() && to.drift.is_known() && are_apart(facet, from, to)) {
      const Point image = end.in(plane(mirror));
      if (are_apart(facet, from, image)) at.drift = Drift(std::min(at.drift.most_m(), reach_m(facet, from, image)));
    }
    return is_over(facet, at);
  }
  bool find_crossing(FacetId facet, const Point& from, const Point& to, Point& at) const {
    const Plane& of = plane(facet);
    const double above_m = signed_distance_m(of, from.at_m), below_m = signed_distance_m(of, to.at_m);
    if ((above_m > 0.0) == (below_m > 0.0)) {
      at = {from.at_m, Drift(std::numeric_limits<double>::infinity())};
      return !(std::abs(above_m) > from.drift.off_m(of) && std::abs(below_m) > to.drift.off_m(of));
    }
    at.at_m = from.at_m + above_m / (above_m - below_m) * (to.at_m - from.at_m);
    at.drift = from.stands() && to.stands() ? Drift() : Drift(reach_m(facet, from, to));
    return true;
  }
  double reach_m(FacetId facet, const Point& from, const Point& to) const {
    return crossing_reach_m(plane(facet), from.at_m, from.drift, to.at_m, to.drift);
  }
  bool are_apart(FacetId facet, const Point& one, const Point& other) const {
    return (signed_distance_m(plane(facet), one.at_m) > 0.0) != (signed_distance_m(plane(facet), other.at_m) > 0.0);
  }
  bool is_over(FacetId facet, const Point& point) const {
    return outlines_.is_over(facet, point.at_m, JoinGates::beside_m + point.drift.most_m());
  }
  /// Where a way from an end that stands diffracts at an edge; false where it surely does not.
  bool meet(WedgeId id, const Point& standing, const Point& moving, std::size_t place) {
    const Wedge& edge = scene().wedge(id).edge;
    const EdgeLine line{edge.start_m, edge_direction(edge), edge_length_m(edge)};
    const double along_m = detail::place_between(standing.at_m, line, moving.at_m);
    const bool is_known = std::isfinite(along_m);
    const Drift drift = !is_known         ? Drift(std::numeric_limits<double>::infinity())
                        : moving.stands() ? Drift()
                                          : drift_on(edge, standing.at_m, moving.at_m, moving.drift);
    points_[place] = {is_known ? line.at(along_m) : edge.start_m, drift};
    const double room_m = JoinGates::beside_m + drift.most_m();
    return !is_known || (along_m >= -room_m && along_m <= line.length_m + room_m);
  }
  /// Whether a way from a point of an edge may lead to another one; of points that are not quite known it may.
  bool faces(WedgeId edge, const Point& to, const Point& from) const {
    return !to.stands() || !from.stands() || may_face(scene().wedge(edge).edge, to.at_m - from.at_m);
  }

  bool hides(const Triple& triple) {
    is_hidden_ = hides(place_, triple[0], points_[0]) || hides(transmitter_.sight(), triple[2], points_[2]);
    return is_hidden_;
  }
  bool hides(const Sight& sight, SequenceElement element, const Point& point) const {
    if (!point.drift.is_known()) return false;
    const double nearer = element.is_edge() ? sight.nearer_on(scene(), outlines_, element.edge())
                                            : sight.nearer_on(scene(), outlines_, element.mirror());
    return sight.map().hides(point.at_m, nearer, spread_over(scene(), element, point.drift));
  }

  const JoinGates& gates_;
  const FacetOutlines& outlines_;
  const Sight& place_;
  const PathHalf& transmitter_;
  Vec3 receiver_m_;
  bool is_hidden_ = false;
  std::array<Point, 3> points_;
  std::optional<FacetId> near_;
  Vec3 near_image_m_{0.0};
};

inline bool TripleWays::work_out(const Triple& triple, const Drift& receiver) {
  const auto& [near, middle, far] = triple;
  if (near.is_edge()) return first_over_edge(near.edge(), middle.mirror(), far.mirror(), {receiver_m_, receiver});
  take_near(near.mirror());
  const Point image{near_image_m_, receiver.in(plane(near.mirror()))};
  if (middle.is_edge()) return over_middle_edge(near.mirror(), middle.edge(), far.mirror(), image);
  const Point twice = image.in(plane(middle.mirror()));
  // The end of the straight way from the images: on an edge, or behind the far mirror.
  const Point end = far.is_edge() ? Point{} : image_in(far.mirror());
  const bool meets_far = far.is_edge() ? meet(far.edge(), {transmitter_.position_m(), Drift()}, twice, 2)
                                       : cross(far.mirror(), end, twice, 2);
  return meets_far && cross(middle.mirror(), twice, points_[2], 1) &&
         (!far.is_edge() || faces(far.edge(), points_[1], points_[2])) &&
         cross(near.mirror(), image, points_[1], 0, far.is_edge() ? points_[2] : end, middle.mirror());
}

}  // namespace dcem
