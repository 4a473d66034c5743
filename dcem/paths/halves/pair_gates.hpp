#pragma once
/// One or two mirrors and edges, one next to each end of a path: whether the points of a path over them lie on them,
/// and whether both ends may see theirs. Cheapest first.
#include <cmath>
#include <span>
#include <utility>

#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/halves/join_orders.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Calls `visit(sequence)`, the sequence from the receiver outwards, for what passes.
class PairGates {
 public:
  /// Paths longer than `longest_m` need not pass.
  PairGates(const Scene& scene, const FacetOutlines& outlines, double longest_m)
      : gates_(scene, outlines), longest_m_(longest_m + rounding_m), is_bounded_(std::isfinite(longest_m)) {}

  const Scene& scene() const { return gates_.scene(); }
  const JoinGates& gates() const { return gates_; }

  template <typename Visit>
  void direct(Visit& visit) {
    sequence_.clear();
    visit(std::as_const(sequence_));
  }

  /// One mirror; the image is that of the receiver.
  template <typename Visit>
  void mirror(const PathHalf& receiver, const PathHalf& transmitter, FacetId facet, const Vec3& image_m, Visit& visit) {
    if (is_too_long(image_m, transmitter.position_m())) return;
    const auto point_m = gates_.crossing(facet, image_m, transmitter.position_m());
    if (point_m) single(receiver, transmitter, facet, *point_m, visit);
  }
  /// One edge.
  template <typename Visit>
  void edge(const PathHalf& receiver, const PathHalf& transmitter, WedgeId edge, Visit& visit) {
    const auto point_m = gates_.edge_point(edge, receiver.position_m(), transmitter.position_m());
    if (!point_m || is_too_long(receiver.position_m(), *point_m, transmitter.position_m())) return;
    single(receiver, transmitter, edge, *point_m, visit);
  }

  /// One mirror of each end, and the images in them.
  template <typename Visit>
  void mirrors(const PathHalf& receiver, FacetId near, const Vec3& near_image_m, const PathHalf& transmitter,
               FacetId far, const Vec3& far_image_m, Visit& visit) {
    if (near == far || is_too_long(near_image_m, far_image_m)) return;
    const auto far_m = gates_.crossing(far, far_image_m, near_image_m);
    if (!far_m) return;
    const auto near_m = gates_.crossing(near, near_image_m, *far_m);
    if (near_m) pair(receiver, near, *near_m, transmitter, far, *far_m, visit);
  }

  /// A mirror of `over`, and the image in it; an edge of `beside`. `turned`: `over` is the transmitter.
  template <typename Visit>
  void mirror_to_edge(const PathHalf& over, FacetId facet, const Vec3& image_m, const PathHalf& beside, WedgeId edge,
                      bool turned, Visit& visit) {
    const WorldWedge& wedge = scene().wedge(edge);
    if (wedge.facets[0] == facet || wedge.facets[1] == facet) return;  // that is in the wedge's own terms
    const auto edge_m = gates_.edge_point(edge, beside.position_m(), image_m);
    if (!edge_m || is_too_long(beside.position_m(), *edge_m, image_m)) return;
    // Most edges that an image sees are hidden from the end that the path comes to.
    if (gates_.hides(beside, edge, *edge_m)) return;
    const auto mirror_m = gates_.crossing(facet, image_m, *edge_m);
    if (!mirror_m || gates_.hides(over, facet, *mirror_m) || !may_face(wedge.edge, *mirror_m - *edge_m)) return;
    propose(turned ? SequenceElement(edge) : SequenceElement(facet),
            turned ? SequenceElement(facet) : SequenceElement(edge), visit);
  }

  /// A point next to each end.
  template <typename Visit>
  void pair(const PathHalf& receiver, SequenceElement near, const Vec3& near_m, const PathHalf& transmitter,
            SequenceElement far, const Vec3& far_m, Visit& visit) {
    if (!gates_.hides(receiver, near, near_m) && !gates_.hides(transmitter, far, far_m)) propose(near, far, visit);
  }

 private:
  /// What images and points on edges may be off by, far above rounding.
  static constexpr double rounding_m = 0.01;

  bool is_too_long(const Vec3& from_m, const Vec3& to_m) const {
    return is_bounded_ && glm::distance(from_m, to_m) > longest_m_;
  }
  bool is_too_long(const Vec3& from_m, const Vec3& over_m, const Vec3& to_m) const {
    return is_bounded_ && glm::distance(from_m, over_m) + glm::distance(over_m, to_m) > longest_m_;
  }

  template <typename Visit>
  void single(const PathHalf& receiver, const PathHalf& transmitter, SequenceElement element, const Vec3& point_m,
              Visit& visit) {
    if (gates_.hides(receiver, element, point_m) || gates_.hides(transmitter, element, point_m)) return;
    sequence_.assign(1, element);
    visit(std::as_const(sequence_));
  }

  template <typename Visit>
  void propose(SequenceElement near, SequenceElement far, Visit& visit) {
    sequence_.assign(1, near);
    sequence_.push_back(far);
    visit(std::as_const(sequence_));
  }

  JoinGates gates_;
  double longest_m_;
  bool is_bounded_;
  Sequence sequence_;
};

}  // namespace dcem
