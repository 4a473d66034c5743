#pragma once
/// Every sequence of at most two elements that may carry a path between two ends that are somewhere in their places,
/// wherever bodies are that have moved no farther than what the places are for.
///
/// As `HalfJoiner` joins two points: of two mirrors the image in one is in the cone of the other, and an edge is in the
/// cone of the mirror over which it is lit. Gates are left to who asks.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/pair_gates.hpp"
#include "dcem/paths/lifetime/vague_place.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

class VagueJoiner {
 public:
  VagueJoiner(const Scene& scene, const FacetOutlines& outlines, const JoinOrders& orders, const IgnoredBodies& ignored)
      : scene_(scene), outlines_(outlines), orders_(orders), ignored_(ignored) {}

  /// Calls `visit(sequence)`, from the receiver outwards; some more than once.
  template <typename Visit>
  void for_each(const VaguePlace& receiver, const VaguePlace& transmitter, Visit&& visit) {
    visit_one({}, visit);
    if (orders_.interactions < 1) return;
    const SeenLayer &near = receiver.place().scenery(), &far = transmitter.place().scenery();
    singles(near, far, visit);
    singles(receiver.bodies(), transmitter.bodies(), visit);
    if (orders_.interactions < 2) return;
    if (orders_.reflections >= 2) mirror_pairs(receiver, transmitter, visit);
    const bool mixed = orders_.reflections >= 1 && orders_.diffractions >= 1;
    if (mixed) lit_edges(receiver, transmitter, false, visit);
    if (mixed) lit_edges(transmitter, receiver, true, visit);
    with_bodies(receiver, transmitter, false, visit);
    with_bodies(transmitter, receiver, true, visit);
    both_of_bodies(receiver.bodies(), transmitter.bodies(), visit);
  }

 private:
  bool is_there(BodyId body) const { return ignored_[0] != body && ignored_[1] != body; }
  BodyId body_of(FacetId facet) const { return scene_.facet(facet).body; }
  BodyId body_of(WedgeId edge) const { return scene_.wedge(edge).body; }
  template <typename Element>
  bool is_there(Element element) const {
    return is_there(body_of(element));
  }

  template <typename Visit>
  void visit_one(std::initializer_list<SequenceElement> elements, Visit& visit) {
    sequence_.assign(elements.begin(), elements.end());
    visit(std::as_const(sequence_));
  }
  /// `turned`: the first element is next to the transmitter.
  template <typename Visit>
  void visit_pair(SequenceElement own, SequenceElement other, bool turned, Visit& visit) {
    visit_one({turned ? other : own, turned ? own : other}, visit);
  }

  template <typename Element, typename Visit>
  void in_both(const std::vector<Element>& one, const std::vector<Element>& other, Visit& visit) {
    for (const Element element : one) {
      if (is_there(element) && std::ranges::binary_search(other, element)) visit_one({element}, visit);
    }
  }
  template <typename Visit>
  void singles(const SeenLayer& one, const SeenLayer& other, Visit& visit) {
    if (orders_.reflections >= 1) in_both(one.mirrors, other.mirrors, visit);
    if (orders_.diffractions >= 1) in_both(one.edges, other.edges, visit);
  }

  template <typename Visit>
  void mirror_pairs(const VaguePlace& receiver, const VaguePlace& transmitter, Visit& visit) {
    const auto radius_m = static_cast<float>(receiver.place().radius_m());
    for (const PlaceMirror& near : receiver.place().mirrors()) {
      const Vec3 image = near.image_m - outlines_.middle_m();
      const float room_m = radius_m + 1e-6F * static_cast<float>(glm::length(image));
      transmitter.images().for_each_item_in(near.cone, [&](std::uint32_t at) {
        const PlaceMirror& far = transmitter.place().mirrors()[at];
        if (far.facet != near.facet && may_hold(far.cone, image, room_m)) visit_one({near.facet, far.facet}, visit);
      });
    }
  }
  /// Edges that one end may see, lit over mirrors of the other.
  template <typename Visit>
  void lit_edges(const VaguePlace& over, const VaguePlace& beside, bool turned, Visit& visit) {
    for (const PlaceMirror& mirror : over.place().mirrors()) {
      beside.edges().for_each_item_in(mirror.cone, [&](std::uint32_t at) {
        visit_pair(mirror.facet, beside.place().scenery().edges[at], turned, visit);
      });
    }
  }

  /// An element of the scenery next to one end and one of a body next to the other.
  template <typename Visit>
  void with_bodies(const VaguePlace& own, const VaguePlace& other, bool turned, Visit& visit) {
    const SeenLayer& bodies = other.bodies();
    const bool mixed = orders_.reflections >= 1 && orders_.diffractions >= 1;
    for (const PlaceMirror& mirror : own.place().mirrors()) {
      const auto may_light = [&](const Aabb<double>& box) { return is_in(mirror.cone, inflated(box, own.moved_m())); };
      for (const FacetId facet : bodies.mirrors) {
        if (orders_.reflections < 2) break;
        if (is_there(facet) && may_light(outlines_.of(facet).box)) visit_pair(mirror.facet, facet, turned, visit);
      }
      for (const WedgeId edge : bodies.edges) {
        if (mixed && is_there(edge) && may_light(box_of(edge))) visit_pair(mirror.facet, edge, turned, visit);
      }
    }
    for (const WedgeId edge : own.place().scenery().edges) {
      for (const FacetId facet : bodies.mirrors) {
        if (mixed && is_there(facet)) visit_pair(edge, facet, turned, visit);
      }
    }
  }
  template <typename Visit>
  void both_of_bodies(const SeenLayer& near, const SeenLayer& far, Visit& visit) {
    for (const FacetId one : near.mirrors) {
      if (!is_there(one)) continue;
      for (const FacetId other : far.mirrors) {
        if (orders_.reflections >= 2 && one != other && is_there(other)) visit_one({one, other}, visit);
      }
    }
    if (orders_.reflections < 1 || orders_.diffractions < 1) return;
    mixed_of_bodies(near, far, false, visit);
    mixed_of_bodies(far, near, true, visit);
  }
  template <typename Visit>
  void mixed_of_bodies(const SeenLayer& own, const SeenLayer& other, bool turned, Visit& visit) {
    for (const FacetId mirror : own.mirrors) {
      for (const WedgeId edge : other.edges) {
        if (is_there(mirror) && is_there(edge)) visit_pair(mirror, edge, turned, visit);
      }
    }
  }

  Aabb<double> box_of(WedgeId id) const {
    Aabb<double> box;
    box.extend(scene_.wedge(id).edge.start_m);
    box.extend(scene_.wedge(id).edge.end_m);
    return box;
  }
  bool is_in(std::span<const HalfSpace> cone, const Aabb<double>& box) const {
    const Vec3 middle = box.center() - outlines_.middle_m(), half = 0.5 * box.extent();
    return std::all_of(cone.begin(), cone.end(), [&](const HalfSpace& side) {
      const double reach = side.x * middle.x + side.y * middle.y + side.z * middle.z + std::abs(side.x) * half.x +
                           std::abs(side.y) * half.y + std::abs(side.z) * half.z;
      return reach + 1e-6 * glm::length(middle) >= side.offset;
    });
  }

  const Scene& scene_;
  const FacetOutlines& outlines_;
  JoinOrders orders_;
  IgnoredBodies ignored_;
  Sequence sequence_;
};

}  // namespace dcem
