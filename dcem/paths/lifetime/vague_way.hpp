#pragma once
/// The way over at most two elements between ends that are known to within some distance: where its points may be, and
/// along which lines its legs run.
///
/// A leg beside a mirror is a stretch of the straight line from what is before the mirror to the image of what is after
/// it. While ends move by d that line moves by no more, though its point on the mirror runs d / sin(grazing) along it.
#include <array>
#include <cstddef>
#include <optional>

#include "dcem/paths/lifetime/vague_line.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

/// A mirror next to a leg: the leg is on the side of its plane on which the signed distance has this sign.
struct LegMirror {
  FacetId facet;
  double side = 1.0;
};

/// A leg: it begins within `start` of its line, and ends within `end`. At an end there is a mirror, or an edge, or,
/// with neither, a device.
struct VagueStretch {
  VagueLine line;
  Share start{0.0, 0.0}, end{1.0, 1.0};
  std::array<std::optional<LegMirror>, 2> mirrors{};
  std::array<std::optional<WedgeId>, 2> edges{};

  Share widest() const { return {start.low, end.high}; }
};

/// Where a line crosses the plane of a mirror.
struct MirrorGate {
  FacetId facet;
  VagueLine line;
  Share part;
  bool sides_are_sure = false;  ///< both neighbours are surely on one side of the plane, and off it

  VaguePoint point() const {
    const Segment there = line.segment(part);
    return {0.5 * (there.from_m + there.to_m), 0.5 * glm::distance(there.from_m, there.to_m) + line.most_moved_m(part)};
  }
};

/// Where a line, unfolded around an edge, crosses the edge: x along the edge, y the distance across, negative before
/// it.
struct EdgeGate {
  WedgeId edge;
  VagueLine unfolded;
  Share part;
  std::array<VaguePoint, 2> neighbours;         ///< an end, or its image in the mirror between
  std::array<double, 2> shares_left{1.0, 1.0};  ///< of the way to the neighbour, the least that the leg at the edge has
  Share place_m;                                ///< along the edge
};

/// Counted from the transmitter.
struct VagueWay {
  std::array<VagueStretch, 3> legs{};
  std::size_t leg_count = 0;
  std::array<MirrorGate, 2> mirrors{};
  std::size_t mirror_count = 0;
  std::optional<EdgeGate> edge;
  VaguePoint first, last;  ///< its points next to the transmitter and next to the receiver
};

/// Works out the ways of sequences; false where a sequence surely has none.
class WayAim {
 public:
  WayAim(const VagueScene& vague, const Vec3& transmitter_m, const Vec3& receiver_m)
      : vague_(vague), transmitter_(vague.end(transmitter_m)), receiver_(vague.end(receiver_m)) {}

  /// At most two elements, at most one of them an edge.
  bool aim(const Sequence& sequence, VagueWay& way) const {
    way.leg_count = way.mirror_count = 0;
    way.edge.reset();
    if (sequence.empty()) {
      add_leg(way, {{transmitter_, receiver_}});
      return true;
    }
    const SequenceElement near = sequence.front(), far = sequence.back();
    if (sequence.size() == 1) return near.is_edge() ? over_edge(near.edge(), way) : over_mirror(near.mirror(), way);
    if (far.is_edge()) return over_mirror_and_edge(near.mirror(), far.edge(), true, way);
    if (near.is_edge()) return over_mirror_and_edge(far.mirror(), near.edge(), false, way);
    return over_mirrors(far.mirror(), near.mirror(), way);
  }

 private:
  const WorldFacet& facet(FacetId id) const { return vague_.scene().facet(id); }
  static void add_leg(VagueWay& way, const VagueStretch& leg) { way.legs[way.leg_count++] = leg; }

  /// Adds a gate where a line from one neighbour, or its image, to the image of the other, or itself, meets a mirror.
  /// False where the neighbours are surely on two sides of it, or the line passes it by.
  bool add_gate(FacetId mirror, const VagueLine& line, const VaguePoint& before, const VaguePoint& after,
                VagueWay& way) const {
    const WorldFacet& own = facet(mirror);
    const double a_m = signed_distance_m(own.plane, before.at_m), b_m = signed_distance_m(own.plane, after.at_m);
    const double a_moved_m = vague_.seen_moved_m(own.body, before) + lifetime_guard_m;
    const double b_moved_m = vague_.seen_moved_m(own.body, after) + lifetime_guard_m;
    const bool are_off = std::abs(a_m) > a_moved_m && std::abs(b_m) > b_moved_m;
    if (are_off && (a_m > 0.0) != (b_m > 0.0)) return false;
    MirrorGate& gate = way.mirrors[way.mirror_count++];
    gate = {mirror, line, crossing_share(std::abs(a_m), a_moved_m, std::abs(b_m), b_moved_m), are_off};
    const std::span<const Vec3> hull_m = vague_.scene().hull_m(own);
    cut_to_points(line, hull_m, vague_.reach_m(own.body, hull_m), gate.part);
    return gate.part.low <= gate.part.high;
  }
  LegMirror beside(FacetId mirror, const VaguePoint& neighbour) const {
    return {mirror, signed_distance_m(facet(mirror).plane, neighbour.at_m) > 0.0 ? 1.0 : -1.0};
  }

  bool over_mirror(FacetId mirror, VagueWay& way) const {
    const VagueLine onto{transmitter_, vague_.image(mirror, receiver_)};
    const VagueLine from{vague_.image(mirror, transmitter_), receiver_};
    if (!add_gate(mirror, from, transmitter_, receiver_, way)) return false;
    const Share at = way.mirrors[0].part;
    way.first = way.last = way.mirrors[0].point();
    add_leg(way, {onto, {0.0, 0.0}, at, {std::nullopt, beside(mirror, transmitter_)}});
    add_leg(way, {from, at, {1.0, 1.0}, {beside(mirror, receiver_), std::nullopt}});
    return true;
  }

  /// `first` is next to the transmitter. All three lines are the same one, folded.
  bool over_mirrors(FacetId first, FacetId second, VagueWay& way) const {
    const VaguePoint own = vague_.image(first, transmitter_), other = vague_.image(second, receiver_);
    const VagueLine between{own, other};
    if (!add_gate(first, between, transmitter_, other, way)) return false;
    if (!add_gate(second, between, own, receiver_, way)) return false;
    const Share one = way.mirrors[0].part, two = way.mirrors[1].part;
    if (one.low > two.high) return false;
    way.first = way.mirrors[0].point();
    way.last = way.mirrors[1].point();
    add_leg(way,
            {{transmitter_, vague_.image(first, other)}, {0.0, 0.0}, one, {std::nullopt, beside(first, transmitter_)}});
    add_leg(way, {between, one, two, {beside(first, other), beside(second, own)}});
    add_leg(way, {{vague_.image(second, own), receiver_}, two, {1.0, 1.0}, {beside(second, receiver_), std::nullopt}});
    return true;
  }

  /// Where a way between two points meets an edge, as a point of the world; false where it surely passes beside it.
  bool add_edge(WedgeId id, const VaguePoint& before, const VaguePoint& after, VagueWay& way, VaguePoint& point) const {
    const WorldWedge& wedge = vague_.scene().wedge(id);
    const Vec3 along = edge_direction(wedge.edge);
    const double length_m = edge_length_m(wedge.edge);
    const auto unfolded = [&](const VaguePoint& end, double side) {
      const Vec3 away_m = end.at_m - wedge.edge.start_m;
      const double place_m = glm::dot(away_m, along);
      return VaguePoint{Vec3(place_m, side * glm::length(away_m - place_m * along), 0.0),
                        vague_.seen_moved_m(wedge.body, end) + lifetime_guard_m};
    };
    EdgeGate& gate = way.edge.emplace();
    gate = {id, {unfolded(before, -1.0), unfolded(after, 1.0)}, {}, {before, after}, {1.0, 1.0}, {}};
    const VaguePoint &one = gate.unfolded.from, &two = gate.unfolded.to;
    gate.part = crossing_share(-one.at_m.y, one.moved_m, two.at_m.y, two.moved_m);
    const double low_m = gate.unfolded.at(gate.part.low).x, high_m = gate.unfolded.at(gate.part.high).x;
    const double room_m = gate.unfolded.most_moved_m(gate.part);
    gate.place_m = {std::max(0.0, std::min(low_m, high_m) - room_m),
                    std::min(length_m, std::max(low_m, high_m) + room_m)};
    if (gate.place_m.low > gate.place_m.high) return false;
    const double half_m = 0.5 * (gate.place_m.high - gate.place_m.low);
    point = {wedge.edge.start_m + (gate.place_m.low + half_m) * along,
             half_m + vague_.reach_m(wedge.body, std::array{wedge.edge.start_m, wedge.edge.end_m})};
    return !passes_beside(gate, length_m);
  }
  /// The point on the edge cannot pass an end of the edge that the line, as it moves, does not touch.
  static bool passes_beside(const EdgeGate& gate, double length_m) {
    const VaguePoint &one = gate.unfolded.from, &two = gate.unfolded.to;
    const double sum_m = two.at_m.y - one.at_m.y;
    if (!(sum_m > lifetime_guard_m)) return false;
    const double place_m = gate.unfolded.at(-one.at_m.y / sum_m).x;
    if (place_m >= 0.0 && place_m <= length_m) return false;
    const Vec3 end_m(place_m < 0.0 ? 0.0 : length_m, 0.0, 0.0);
    return stays_apart(gate.unfolded, gate.part, 0.0,
                       [&](const Segment& part) { return distance_to_segment_m(end_m, part.from_m, part.to_m); });
  }

  bool over_edge(WedgeId edge, VagueWay& way) const {
    VaguePoint point;
    if (!add_edge(edge, transmitter_, receiver_, way, point)) return false;
    way.first = way.last = point;
    VagueStretch onto{{transmitter_, point}}, from{{point, receiver_}};
    onto.edges[1] = from.edges[0] = edge;
    add_leg(way, onto);
    add_leg(way, from);
    return true;
  }

  /// A mirror next to one end and an edge next to the other. `at_receiver`: the mirror is next to the receiver.
  bool over_mirror_and_edge(FacetId mirror, WedgeId edge, bool at_receiver, VagueWay& way) const {
    const VaguePoint &lit = at_receiver ? receiver_ : transmitter_, &other = at_receiver ? transmitter_ : receiver_;
    const VaguePoint image = vague_.image(mirror, lit);
    VaguePoint point;
    if (!add_edge(edge, at_receiver ? other : image, at_receiver ? image : other, way, point)) return false;
    // From here on the way is told from the end that is lit over the mirror.
    const VagueLine beyond{image, point};
    if (!add_gate(mirror, beyond, lit, point, way)) return false;
    const Share at = way.mirrors[0].part;
    way.edge->shares_left[at_receiver ? 1 : 0] = 1.0 - at.high;
    way.first = at_receiver ? point : way.mirrors[0].point();
    way.last = at_receiver ? way.mirrors[0].point() : point;
    VagueStretch first{{lit, vague_.image(mirror, point)}, {0.0, 0.0}, at, {std::nullopt, beside(mirror, lit)}};
    VagueStretch middle{beyond, at, {1.0, 1.0}, {beside(mirror, point), std::nullopt}};
    VagueStretch last{{point, other}};
    middle.edges[1] = last.edges[0] = edge;
    add_leg(way, first);
    add_leg(way, middle);
    add_leg(way, last);
    return true;
  }

  const VagueScene& vague_;
  VaguePoint transmitter_, receiver_;
};

}  // namespace dcem
