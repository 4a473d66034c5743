#pragma once
/// Several receivers joined with one transmitter at once: what `HalfJoiner` does for one, with the receivers as lanes.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/paths/halves/crowd_gates.hpp"
#include "dcem/paths/halves/edge_pairs.hpp"
#include "dcem/paths/halves/half_joiner.hpp"

namespace dcem {

template <typename Index>
class CrowdJoiner {
 public:
  CrowdJoiner(CrowdGates<Index>& gates, const JoinOrders& orders)
      : gates_(gates),
        scene_(gates.scene()),
        lanes_(gates.lanes()),
        orders_(orders),
        pairs_(scene_, gates.outlines()) {}

  /// Calls `visit(sequence, point)`, the sequence from the receiver outwards, for every sequence of one or two mirrors
  /// and edges that a path from the transmitter to a point of the crowd may take.
  template <typename Visit>
  void for_each_sequence(Visit&& visit) {
    const bool mirrors = orders_.reflections >= 1 && orders_.interactions >= 1;
    const bool edges = orders_.diffractions >= 1 && orders_.interactions >= 1;
    const bool pairs = orders_.diffractions >= 2 && orders_.interactions >= 2;
    if (pairs) pairs_.aim(mast().half().position_m(), mast().parts());
    for (const SeenLayer& layer : crowd().layers()) {
      if (pairs) edge_pairs(layer, visit);
      if (mirrors) single_mirrors(layer, visit);
      if (edges) single_edges(layer, visit);
      if (orders_.interactions < 2) continue;
      if (mirrors) over_mirrors(layer, edges, visit);
      if (mirrors && edges) over_edges(layer, visit);
    }
  }

 private:
  const Crowd& crowd() const { return gates_.crowd(); }
  const BeamLists& mast() const { return gates_.mast(); }

  template <typename Visit>
  void single_mirrors(const SeenLayer& layer, Visit& visit) {
    for (const FacetId facet : layer.mirrors) {
      const std::uint32_t mirror = mast().mirror_of(facet);
      if (mirror == BeamLists::nothing) continue;
      const Vec3& image_m = mast().mirrors()[mirror].image_m;
      const LanePoints image(image_m);
      const Float8 error_m(gates_.error_with(glm::length(image_m)));
      for (std::size_t pack = 0; pack < gates_.packs().size(); ++pack) {
        const LaneGate at = lanes_.cross(facet, image, gates_.packs()[pack], error_m, crowd().lanes_of(pack));
        if (at.lanes != 0) gates_.offer(pack, std::array{CrowdStop{facet, at}}, at.lanes, visit);
      }
    }
  }

  template <typename Visit>
  void single_edges(const SeenLayer& layer, Visit& visit) {
    const float error_m = gates_.error_with(lanes_.reach_m());
    for (const WedgeId edge : layer.edges) {
      mast().for_each_part_of(edge, [&](const EdgePart& part) {
        for (std::size_t pack = 0; pack < gates_.packs().size(); ++pack) {
          const LaneGate at = lanes_.meet(part, gates_.packs()[pack], error_m, crowd().lanes_of(pack));
          if (at.lanes != 0) gates_.offer(pack, std::array{CrowdStop{edge, at}}, at.lanes, visit);
        }
      });
    }
  }

  /// The receivers' last point is on a mirror, the one before it on a mirror or an edge.
  template <typename Visit>
  void over_mirrors(const SeenLayer& layer, bool edges, Visit& visit) {
    constexpr std::size_t ahead = 12, soon = 6;
    for (std::size_t at = 0; at < layer.mirrors.size(); ++at) {
      if (at + ahead < layer.mirrors.size()) gates_.fetch(layer.mirrors[at + ahead]);
      if (at + soon < layer.mirrors.size()) gates_.fetch_more(layer.mirrors[at + soon]);
      const FacetId facet = layer.mirrors[at];
      if (!mast().lights(facet)) continue;
      const Plane& plane = scene_.facet(facet).plane;
      images_.clear();
      for (std::size_t pack = 0; pack < gates_.packs().size(); ++pack) images_.push_back(crowd().images(pack, plane));
      const Vec3 image_m = mirrored(plane, crowd().sight().position_m()) - lanes_.origin_m();
      for (const double side : {1.0, -1.0}) {
        if (!crowd().cone(gates_.outlines(), facet, plane, side, cone_)) continue;
        beside_.clear();
        for (std::size_t pack = 0; pack < gates_.packs().size(); ++pack) {
          beside_.push_back(gates_.lanes_beside(pack, facet, side));
        }
        if (orders_.reflections >= 2) mirror_pairs(facet, image_m, visit);
        if (edges) edges_before_mirror(facet, image_m, visit);
      }
    }
  }

  template <typename Visit>
  void mirror_pairs(FacetId last, const Vec3& image_m, Visit& visit) {
    mast().for_each_mirror_before(last, cone_, [&](std::uint32_t mirror) {
      const BeamMirror& first = mast().mirrors()[mirror];
      if (!may_hold(first.cone, image_m, gates_.radius_m())) return;
      const LanePoints apex(first.image_m);
      const Float8 error_m(gates_.error_with(glm::length(first.image_m) + glm::length(image_m)));
      for (std::size_t pack = 0; pack < images_.size(); ++pack) {
        const LaneGate at_first = lanes_.cross(first.facet, apex, images_[pack], error_m, beside_[pack]);
        if (at_first.lanes == 0) continue;
        const LaneGate at_last =
            lanes_.cross(last, at_first.points, images_[pack], error_m + at_first.beside_m, at_first.lanes);
        if (at_last.lanes == 0) continue;
        gates_.offer(pack, std::array{CrowdStop{last, at_last}, CrowdStop{first.facet, at_first}}, at_last.lanes,
                     visit);
      }
    });
  }

  template <typename Visit>
  void edges_before_mirror(FacetId last, const Vec3& image_m, Visit& visit) {
    const float error_m = gates_.error_with(glm::length(image_m) + lanes_.reach_m());
    mast().for_each_part_before(last, cone_, image_m, gates_.radius_m(), [&](const EdgePart& part) {
      const WedgeId first(part.edge);
      for (std::size_t pack = 0; pack < images_.size(); ++pack) {
        const LaneGate at_first = lanes_.meet(part, images_[pack], error_m, beside_[pack]);
        if (at_first.lanes == 0) continue;
        const LaneGate at_last =
            lanes_.cross(last, at_first.points, images_[pack], Float8(error_m) + at_first.beside_m, at_first.lanes);
        if (at_last.lanes == 0) continue;
        const WorldWedge& wedge = scene_.wedge(first);
        if (wedge.facets[0] == last || wedge.facets[1] == last) return;  // that is in the wedge's own terms
        gates_.offer(pack, std::array{CrowdStop{last, at_last}, CrowdStop{first, at_first}}, at_last.lanes, visit);
      }
    });
  }

  /// The receivers' last point is on an edge, the one before it on a mirror.
  template <typename Visit>
  void over_edges(const SeenLayer& layer, Visit& visit) {
    const Vec3 middle = gates_.middle();
    for (const WedgeId last : layer.edges) {
      mast().for_each_lit_part(last, middle, gates_.radius_m(), [&](const EdgePart& part, std::uint32_t mirror) {
        const BeamMirror& first = mast().mirrors()[mirror];
        const LanePoints apex(first.image_m);
        const float error_m = gates_.error_with(glm::length(first.image_m) + lanes_.reach_m());
        for (std::size_t pack = 0; pack < gates_.packs().size(); ++pack) {
          const LaneGate at_last = lanes_.meet(part, gates_.packs()[pack], error_m, crowd().lanes_of(pack));
          if (at_last.lanes == 0) continue;
          const LaneGate at_first =
              lanes_.cross(first.facet, apex, at_last.points, Float8(error_m) + at_last.beside_m, at_last.lanes);
          if (at_first.lanes == 0) continue;
          gates_.offer(pack, std::array{CrowdStop{last, at_last}, CrowdStop{first.facet, at_first}}, at_first.lanes,
                       visit);
        }
      });
    }
  }

  /// Each point by itself: what takes time are pairs that no other point has.
  template <typename Visit>
  void edge_pairs(const SeenLayer& layer, Visit& visit) {
    const Sight& sight = crowd().sight();
    for (std::size_t point = 0; point < crowd().points_m().size(); ++point) {
      pairs_.for_each(crowd().points_m()[point], layer.edges, [&](const EdgePair& pair) {
        if (sight.map().hides(pair.near_m, sight.nearer_on(scene_, gates_.outlines(), pair.near))) return;
        sequence_.assign({pair.near, pair.far});
        visit(std::as_const(sequence_), point);
      });
    }
  }

  CrowdGates<Index>& gates_;
  const Scene& scene_;
  const LaneScene& lanes_;
  JoinOrders orders_;
  std::vector<LanePoints> images_;
  std::vector<std::uint32_t> beside_;  ///< the lanes of each pack on the side of the mirror that is looked at
  std::vector<HalfSpace> cone_;
  EdgePairs pairs_;
  Sequence sequence_;
};

}  // namespace dcem
