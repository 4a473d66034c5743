#pragma once
/// Two halves joined: every sequence of at most two mirrors and edges that a path between two ends may take.
///
/// With R₁ the image of the receiver in its mirror and T₂ that of the transmitter in its own, both points of a path
/// over two mirrors lie on the straight line from R₁ to T₂: so T₂ is in the cone of R₁ through the receiver's mirror.
/// Over a mirror and an edge the point on the edge is in that cone, and follows from the image and the other end in
/// closed form. Over two edges: edge_pairs.hpp. What is left is looked up in both maps, each point at the end that must
/// see it. The solver decides.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/edge_pairs.hpp"
#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

class HalfJoiner {
 public:
  /// The most of each, and of both together.
  struct Orders {
    int reflections = 2, diffractions = 1, interactions = 2;
  };

  HalfJoiner(const Scene& scene, const FacetOutlines& outlines, const Orders& orders)
      : gates_(scene, outlines), orders_(orders), pairs_(scene, outlines) {}

  /// Calls `visit(sequence)`, from the receiver outwards, for each; seldom twice for one. With what the transmitter
  /// reaches, where that is known, ways over its mirrors need not be looked for.
  template <typename Visit>
  void for_each_sequence(const PathHalf& receiver, const PathHalf& transmitter, Visit&& visit,
                         const BeamLists* reached = nullptr) {
    sequence_.clear();
    visit(std::as_const(sequence_));
    const bool mirrors = orders_.reflections >= 1 && orders_.interactions >= 1;
    const bool edges = orders_.diffractions >= 1 && orders_.interactions >= 1;
    for (std::size_t layer = 0; layer < receiver.layers().size(); ++layer) {  // a facet is in the same one for both
      const Side own{receiver, receiver.layers()[layer]}, other{transmitter, transmitter.layers()[layer]};
      if (mirrors) single_mirrors(own, other, visit);
      if (edges) single_edges(own, other, visit);
    }
    if (orders_.interactions < 2) return;
    if (orders_.diffractions >= 2) edge_pairs(receiver, transmitter, reached, visit);
    for (std::size_t own = 0; own < receiver.layers().size(); ++own) {
      const Side near{receiver, receiver.layers()[own]};
      const bool listed = reached != nullptr && (own == 0 || reached->has_bodies());
      if (listed && orders_.reflections >= 2) listed_mirror_pairs(near, *reached, visit);
      if (listed && mirrors && edges) {
        listed_edges(near, *reached, visit);
        mirrors_to_parts(near, *reached, visit);
      }
      for (std::size_t other = 0; other < transmitter.layers().size(); ++other) {
        const Side far{transmitter, transmitter.layers()[other]};
        const bool is_done = listed && (other == 0 || reached->has_bodies());
        if (!is_done && orders_.reflections >= 2) mirror_pairs(near, far, visit);
        if (!is_done && mirrors && edges) {
          mirror_and_edge(near, far, false, visit);
          mirror_and_edge(far, near, true, visit);
        }
      }
    }
  }

 private:
  /// One end, and what it may see of the scenery or of what moves.
  struct Side {
    const PathHalf& half;
    const HalfLayer& layer;
  };

  /// The point of a path that is next to an end.
  struct End {
    const PathHalf& half;
    SequenceElement element;
    const Vec3& point_m;
  };

  template <typename Visit>
  void propose(SequenceElement near, SequenceElement far, Visit& visit) {
    sequence_.assign(1, near);
    sequence_.push_back(far);
    visit(std::as_const(sequence_));
  }

  template <typename Visit>
  void offer(const End& receiver, const End& transmitter, bool single, Visit& visit) {
    if (gates_.hides(receiver.half, receiver.element, receiver.point_m)) return;
    if (gates_.hides(transmitter.half, transmitter.element, transmitter.point_m)) return;
    if (single) {
      sequence_.assign(1, receiver.element);
      visit(std::as_const(sequence_));
    } else {
      propose(receiver.element, transmitter.element, visit);
    }
  }

  template <typename Visit>
  void single_mirrors(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const FacetId facet = receiver.layer.mirrors[at];
      if (!std::ranges::binary_search(transmitter.layer.mirrors, facet)) continue;
      const auto point_m = gates_.crossing(facet, receiver.layer.images_m[at], transmitter.half.position_m());
      if (point_m) offer({receiver.half, facet, *point_m}, {transmitter.half, facet, *point_m}, true, visit);
    }
  }

  template <typename Visit>
  void single_edges(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (const WedgeId edge : receiver.layer.edges) {
      if (!std::ranges::binary_search(transmitter.layer.edges, edge)) continue;
      const auto point_m = gates_.edge_point(edge, receiver.half.position_m(), transmitter.half.position_m());
      if (point_m) offer({receiver.half, edge, *point_m}, {transmitter.half, edge, *point_m}, true, visit);
    }
  }

  /// One mirror of each end, and the images in them.
  template <typename Visit>
  void mirror_pair(const PathHalf& receiver, FacetId near, const Vec3& near_image_m, const PathHalf& transmitter,
                   FacetId far, const Vec3& far_image_m, Visit& visit) {
    if (near == far) return;
    const auto far_m = gates_.crossing(far, far_image_m, near_image_m);
    if (!far_m) return;
    const auto near_m = gates_.crossing(near, near_image_m, *far_m);
    if (near_m) offer({receiver, near, *near_m}, {transmitter, far, *far_m}, false, visit);
  }

  template <typename Visit>
  void mirror_pairs(const Side& receiver, const Side& transmitter, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const Vec3& image_m = receiver.layer.images_m[at];
      const auto join = [&](std::uint32_t other) {
        mirror_pair(receiver.half, receiver.layer.mirrors[at], image_m, transmitter.half,
                    transmitter.layer.mirrors[other], transmitter.layer.images_m[other], visit);
      };
      constexpr auto beside_m = static_cast<float>(JoinGates::beside_m);
      transmitter.layer.for_each_image_in(receiver.layer.cones[at], image_m, beside_m, join);
    }
  }

  template <typename Visit>
  void listed_mirror_pairs(const Side& receiver, const BeamLists& reached, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const FacetId near = receiver.layer.mirrors[at];
      for (const std::uint32_t place : reached.mirrors_before(near)) {
        const BeamMirror& far = reached.mirrors()[place];
        const float error_m = 1e-6F * static_cast<float>(glm::length(far.image_m));
        if (!may_hold(receiver.layer.cones[at], far.image_m, error_m)) continue;
        mirror_pair(receiver.half, near, receiver.layer.images_m[at], reached.half(), far.facet,
                    far.image_m + reached.origin_m(), visit);
      }
    }
  }

  /// A mirror of `over`, and the image in it; an edge of `beside`. `turned`: `over` is the transmitter.
  template <typename Visit>
  void mirror_to_edge(const PathHalf& over, FacetId facet, const Vec3& image_m, const PathHalf& beside, WedgeId edge,
                      bool turned, Visit& visit) {
    const WorldWedge& wedge = gates_.scene().wedge(edge);
    if (wedge.facets[0] == facet || wedge.facets[1] == facet) return;  // that is in the wedge's own terms
    const auto edge_m = gates_.edge_point(edge, beside.position_m(), image_m);
    if (!edge_m) return;
    // Cheapest first: most edges that an image sees are hidden from the end that the path comes to.
    if (gates_.hides(beside, edge, *edge_m)) return;
    const auto mirror_m = gates_.crossing(facet, image_m, *edge_m);
    if (!mirror_m || gates_.hides(over, facet, *mirror_m) || !may_face(wedge.edge, *mirror_m - *edge_m)) return;
    propose(turned ? SequenceElement(edge) : SequenceElement(facet),
            turned ? SequenceElement(facet) : SequenceElement(edge), visit);
  }

  template <typename Visit>
  void mirror_and_edge(const Side& over, const Side& beside, bool turned, Visit& visit) {
    for (std::size_t at = 0; at < over.layer.mirrors.size(); ++at) {
      const Vec3& image_m = over.layer.images_m[at];
      beside.layer.for_each_edge_in(over.layer.cones[at], image_m, [&](std::uint32_t other) {
        mirror_to_edge(over.half, over.layer.mirrors[at], image_m, beside.half, beside.layer.edges[other], turned,
                       visit);
      });
    }
  }

  /// Edges of which the transmitter sees a part, over the receiver's mirrors.
  template <typename Visit>
  void mirrors_to_parts(const Side& receiver, const BeamLists& reached, Visit& visit) {
    for (std::size_t at = 0; at < receiver.layer.mirrors.size(); ++at) {
      const Vec3& image_m = receiver.layer.images_m[at];
      const auto join = [&](std::uint32_t part) {
        mirror_to_edge(receiver.half, receiver.layer.mirrors[at], image_m, reached.half(),
                       WedgeId(reached.parts()[part].edge), false, visit);
      };
      reached.for_each_part_in(receiver.layer.cones[at], image_m - reached.origin_m(), 0.0F, join);
    }
  }

  /// Edges that the receiver sees, lit over the transmitter's mirrors.
  template <typename Visit>
  void listed_edges(const Side& receiver, const BeamLists& reached, Visit& visit) {
    const Vec3 end = receiver.half.position_m() - reached.origin_m();
    for (const WedgeId edge : receiver.layer.edges) {
      reached.for_each_lit_part(edge, end, 0.0F, [&](const EdgePart&, std::uint32_t place) {
        const BeamMirror& far = reached.mirrors()[place];
        mirror_to_edge(reached.half(), far.facet, far.image_m + reached.origin_m(), receiver.half, edge, true, visit);
      });
    }
  }

  /// An edge of each end.
  template <typename Visit>
  void edge_pairs(const PathHalf& receiver, const PathHalf& transmitter, const BeamLists* reached, Visit& visit) {
    parts_.clear();
    if (reached != nullptr) parts_.assign(reached->parts().begin(), reached->parts().end());
    for (std::size_t layer = 0; layer < transmitter.layers().size(); ++layer) {
      if (reached != nullptr && (layer == 0 || reached->has_bodies())) continue;
      for (const WedgeId edge : transmitter.layers()[layer].edges) {
        parts_.push_back(whole_edge(edge.value, gates_.scene().wedge(edge).edge, transmitter.position_m()));
      }
    }
    pairs_.aim(transmitter.position_m(), parts_);
    for (const HalfLayer& layer : receiver.layers()) {
      pairs_.for_each(receiver.position_m(), layer.edges, [&](const EdgePair& pair) {
        offer({receiver, pair.near, pair.near_m}, {transmitter, pair.far, pair.far_m}, false, visit);
      });
    }
  }

  JoinGates gates_;
  Orders orders_;
  EdgePairs pairs_;
  std::vector<EdgePart> parts_;
  Sequence sequence_;
};

}  // namespace dcem
