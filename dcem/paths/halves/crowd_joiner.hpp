#pragma once
/// Several receivers joined with one transmitter at once: what `HalfJoiner` does for one, with the receivers as lanes.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/crowd.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/leg_hints.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

template <typename Index>
class CrowdJoiner {
 public:
  CrowdJoiner(const SceneTracer<Index>& tracer, const FacetOutlines& outlines, const LaneScene& lanes,
              const HalfJoiner::Orders& orders, SolverCounters& counters)
      : tracer_(tracer),
        scene_(tracer.scene()),
        outlines_(outlines),
        lanes_(lanes),
        orders_(orders),
        counters_(counters) {}

  /// Calls `visit(sequence, point)`, the sequence from the receiver outwards, for every sequence of one or two mirrors
  /// and edges that a path from the transmitter to a point of the crowd may take.
  template <typename Visit>
  void for_each_sequence(const Crowd& crowd, const BeamLists& mast, Visit&& visit) {
    const bool mirrors = orders_.reflections >= 1 && orders_.interactions >= 1;
    const bool edges = orders_.diffractions >= 1 && orders_.interactions >= 1;
    packs_.clear();
    for (std::size_t pack = 0; pack < crowd.packs(); ++pack) packs_.push_back(crowd.pack(pack));
    const double reach_m = glm::length(mast.position_m()) + crowd.radius_m() +
                           glm::distance(crowd.sight().position_m(), lanes_.origin_m());
    const Ends ends{crowd, mast, reach_m};
    LegHints<Index> hints(tracer_, outlines_, lanes_, {mast.ignored_body(), std::nullopt}, counters_);
    hints_ = &hints;
    for (const SeenLayer& layer : crowd.layers()) {
      if (mirrors) single_mirrors(ends, layer, visit);
      if (edges) single_edges(ends, layer, visit);
      if (orders_.interactions < 2) continue;
      if (mirrors) over_mirrors(ends, layer, edges, visit);
      if (mirrors && edges) over_edges(ends, layer, visit);
    }
  }

 private:
  struct Ends {
    const Crowd& crowd;
    const BeamLists& mast;
    double reach_m;  ///< no number that says where they are is larger
  };

  template <typename Element>
  double nearer(const Sight& sight, Element element) const {
    return sight.nearer_on(scene_, outlines_, element);
  }
  static bool hides(const ViewMap& map, const Vec3& origin_m, const std::array<std::array<float, simd_lanes>, 4>& at,
                    std::size_t lane, double nearer) {
    if (!(at[3][lane] < 0.1F)) return false;
    return map.hides(origin_m + Vec3(at[0][lane], at[1][lane], at[2][lane]), nearer, at[3][lane]);
  }
  static std::array<std::array<float, simd_lanes>, 4> unpacked(const LaneGate& gate) {
    std::array<std::array<float, simd_lanes>, 4> numbers;
    gate.points.x.store(numbers[0]);
    gate.points.y.store(numbers[1]);
    gate.points.z.store(numbers[2]);
    gate.beside_m.store(numbers[3]);
    return numbers;
  }

  /// Looks up the points of what the gates let pass, each at the end that must see it.
  template <typename Last, typename First, typename Visit>
  void offer(const Ends& ends, std::size_t pack, Last last, const LaneGate& at_last, First first,
             const LaneGate& at_first, bool single, std::uint32_t lanes, Visit& visit) {
    if (!single) lanes = hints_->not_stopped_between(first, at_first, last, at_last, lanes);
    if (lanes == 0) return;
    const auto last_numbers = unpacked(at_last), first_numbers = unpacked(at_first);
    const Sight &own = ends.crowd.sight(), &other = ends.mast.half().sight();
    const double own_nearer = nearer(own, last), other_nearer = nearer(other, first);
    sequence_.assign(1, last);
    if (!single) sequence_.emplace_back(first);
    std::uint32_t seen = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      if (hides(own.map(), lanes_.origin_m(), last_numbers, lane, own_nearer)) continue;
      // Of edges only the parts that show are looked at to begin with.
      constexpr bool is_mirror = std::is_same_v<First, FacetId>;
      if (is_mirror && hides(other.map(), lanes_.origin_m(), first_numbers, lane, other_nearer)) continue;
      seen |= lanes & -lanes;
    }
    if (!single && seen != 0) {
      seen = hints_->free_between(first, at_first, last, at_last, seen);
      if (seen != 0) seen = hints_->free_after(last, at_last, packs_[pack], seen);
    }
    for (; seen != 0; seen &= seen - 1) {
      visit(std::as_const(sequence_), pack * simd_lanes + static_cast<std::size_t>(std::countr_zero(seen)));
    }
  }

  template <typename Visit>
  void single_mirrors(const Ends& ends, const SeenLayer& layer, Visit& visit) {
    for (const FacetId facet : layer.mirrors) {
      const std::uint32_t mirror = ends.mast.mirror_of(facet);
      if (mirror == BeamLists::nothing) continue;
      const Vec3& image_m = ends.mast.mirrors()[mirror].image_m;
      const LanePoints image(image_m);
      const Float8 error_m(error_with(ends, glm::length(image_m)));
      for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
        const LaneGate at = lanes_.cross(facet, image, packs_[pack], error_m, ends.crowd.lanes_of(pack));
        if (at.lanes != 0) offer(ends, pack, facet, at, facet, at, true, at.lanes, visit);
      }
    }
  }

  template <typename Visit>
  void single_edges(const Ends& ends, const SeenLayer& layer, Visit& visit) {
    for (const WedgeId edge : layer.edges) {
      for (const EdgePart& part : ends.mast.parts_of(edge)) {
        for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
          const LaneGate at =
              lanes_.meet(part, packs_[pack], error_with(ends, lanes_.reach_m()), ends.crowd.lanes_of(pack));
          if (at.lanes != 0) offer(ends, pack, edge, at, edge, at, true, at.lanes, visit);
        }
      }
    }
  }

  /// The receivers' last point is on a mirror, the one before it on a mirror or an edge.
  template <typename Visit>
  void over_mirrors(const Ends& ends, const SeenLayer& layer, bool edges, Visit& visit) {
    for (const FacetId facet : layer.mirrors) {
      const Plane& plane = scene_.facet(facet).plane;
      images_.clear();
      for (std::size_t pack = 0; pack < packs_.size(); ++pack) images_.push_back(ends.crowd.images(pack, plane));
      const Vec3 image_m = mirrored(plane, ends.crowd.sight().position_m()) - lanes_.origin_m();
      for (const double side : {1.0, -1.0}) {
        if (!ends.crowd.cone(outlines_, facet, plane, side, cone_)) continue;
        beside_.clear();
        for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
          beside_.push_back(lanes_beside(ends, pack, facet, side));
        }
        if (orders_.reflections >= 2) mirror_pairs(ends, facet, image_m, visit);
        if (edges) edges_before_mirror(ends, facet, image_m, visit);
      }
    }
  }

  /// The lanes of points on one side of a mirror.
  std::uint32_t lanes_beside(const Ends& ends, std::size_t pack, FacetId facet, double side) const {
    const HalfSpace& plane = lanes_.plane(facet);
    const Float8 height = dot(packs_[pack], plane.x, plane.y, plane.z) - plane.offset;
    const Float8 slack(-error_with(ends, lanes_.reach_m()));
    const Mask8 away = side > 0.0 ? height < slack : -height < slack;
    return ends.crowd.lanes_of(pack) & ~away.bits();
  }

  template <typename Visit>
  void mirror_pairs(const Ends& ends, FacetId last, const Vec3& image_m, Visit& visit) {
    const auto radius_m = static_cast<float>(ends.crowd.radius_m() + 1e-2);
    for (const std::uint32_t mirror : ends.mast.mirrors_before(last)) {
      const BeamMirror& first = ends.mast.mirrors()[mirror];
      if (!may_hold(cone_, first.image_m, 1e-6F * static_cast<float>(glm::length(first.image_m))) ||
          !may_hold(first.cone, image_m, radius_m))
        continue;
      const LanePoints apex(first.image_m);
      const Float8 error_m(error_with(ends, glm::length(first.image_m) + glm::length(image_m)));
      for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
        const LaneGate at_first = lanes_.cross(first.facet, apex, images_[pack], error_m, beside_[pack]);
        if (at_first.lanes == 0) continue;
        const LaneGate at_last =
            lanes_.cross(last, at_first.points, images_[pack], error_m + at_first.beside_m, at_first.lanes);
        if (at_last.lanes != 0) offer(ends, pack, last, at_last, first.facet, at_first, false, at_last.lanes, visit);
      }
    }
  }

  template <typename Visit>
  void edges_before_mirror(const Ends& ends, FacetId last, const Vec3& image_m, Visit& visit) {
    const auto radius_m = static_cast<float>(ends.crowd.radius_m() + 1e-2);
    const float error_m = error_with(ends, glm::length(image_m) + lanes_.reach_m());
    ends.mast.for_each_part_in(cone_, image_m, radius_m, [&](std::uint32_t number) {
      const EdgePart& part = ends.mast.parts()[number];
      const WedgeId first(part.edge);
      const WorldWedge& wedge = scene_.wedge(first);
      if (wedge.facets[0] == last || wedge.facets[1] == last) return;  // that is in the wedge's own terms
      for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
        const LaneGate at_first = lanes_.meet(part, images_[pack], error_m, beside_[pack]);
        if (at_first.lanes == 0) continue;
        const LaneGate at_last =
            lanes_.cross(last, at_first.points, images_[pack], Float8(error_m) + at_first.beside_m, at_first.lanes);
        if (at_last.lanes != 0) offer(ends, pack, last, at_last, first, at_first, false, at_last.lanes, visit);
      }
    });
  }

  /// The receivers' last point is on an edge, the one before it on a mirror.
  template <typename Visit>
  void over_edges(const Ends& ends, const SeenLayer& layer, Visit& visit) {
    const auto radius_m = static_cast<float>(ends.crowd.radius_m() + 1e-2);
    const Vec3 middle_m = ends.crowd.sight().position_m() - lanes_.origin_m();
    for (const WedgeId last : layer.edges) {
      ends.mast.for_each_lit_part(last, middle_m, radius_m, [&](const EdgePart& part, std::uint32_t mirror) {
        const BeamMirror& first = ends.mast.mirrors()[mirror];
        const LanePoints apex(first.image_m);
        const float error_m = error_with(ends, glm::length(first.image_m) + lanes_.reach_m());
        for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
          const LaneGate at_last = lanes_.meet(part, packs_[pack], error_m, ends.crowd.lanes_of(pack));
          if (at_last.lanes == 0) continue;
          const LaneGate at_first =
              lanes_.cross(first.facet, apex, at_last.points, Float8(error_m) + at_last.beside_m, at_last.lanes);
          if (at_first.lanes == 0) continue;
          offer(ends, pack, last, at_last, first.facet, at_first, false, at_first.lanes, visit);
        }
      });
    }
  }

  /// How far distances may be off where numbers are as large as those of both ends, and `more_m`.
  static float error_with(const Ends& ends, double more_m) { return LaneScene::error_m(ends.reach_m + more_m); }

  const SceneTracer<Index>& tracer_;
  const Scene& scene_;
  const FacetOutlines& outlines_;
  const LaneScene& lanes_;
  HalfJoiner::Orders orders_;
  SolverCounters& counters_;
  std::vector<LanePoints> packs_, images_;
  std::vector<std::uint32_t> beside_;  ///< the lanes of each pack on the side of the mirror that is looked at
  std::vector<HalfSpace> cone_;
  Sequence sequence_;
  LegHints<Index>* hints_ = nullptr;  ///< while a crowd is joined
};

}  // namespace dcem
