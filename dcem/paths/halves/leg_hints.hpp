#pragma once
/// What stopped a leg a moment ago is tried first on the legs beside it.
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/lanes.hpp"
#include "dcem/paths/query/scene_tracer.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/path_solver.hpp"

namespace dcem {

/// What stopped a leg last, by place in a table. Holds memory: one per thread.
class Blockers {
 public:
  static constexpr std::uint32_t nothing = 0xffffffffU;

  /// Forgets all of them. Of a table that has its size already it clears what was noted alone.
  void forget(std::size_t size) {
    for (const std::uint32_t place : noted_) triangles_[place] = nothing;
    noted_.clear();
    triangles_.resize(size, nothing);
  }
  std::uint32_t operator[](std::size_t place) const { return triangles_[place]; }
  void note(std::size_t place, std::uint32_t triangle) {
    if (triangles_[place] == nothing) noted_.push_back(static_cast<std::uint32_t>(place));
    triangles_[place] = triangle;
  }

 private:
  std::vector<std::uint32_t> triangles_, noted_;
};

/// Drops legs that are blocked for sure. Changes no result: the solver would refuse the same paths, one by one.
template <typename Index>
class LegHints {
 public:
  LegHints(const SceneTracer<Index>& tracer, const FacetOutlines& outlines, const LaneScene& lanes,
           const IgnoredBodies& ignored, Blockers& blockers, SolverCounters& counters)
      : tracer_(tracer),
        outlines_(outlines),
        lanes_(lanes),
        ignored_(ignored),
        counters_(counters),
        blockers_(blockers) {
    blockers_.forget(2 * (scene().facets().size() + scene().wedges().size()));
  }

  /// Of legs from points on `first` to points on `last`, in the order from the transmitter, those that may be free.
  std::uint32_t free_between(SequenceElement first, const LaneGate& at_first, SequenceElement last,
                             const LaneGate& at_last, std::uint32_t lanes) {
    const Legs legs{at_first.points, at_last.points, at_first.beside_m + at_last.beside_m, {first, last}, 2};
    return open_lanes(legs, place_of(first, 0), lanes);
  }
  /// The same of legs from points on `last` to receivers.
  std::uint32_t free_after(SequenceElement last, const LaneGate& at_last, const LanePoints& receivers,
                           std::uint32_t lanes) {
    const Legs legs{at_last.points, receivers, at_last.beside_m, {last, last}, 1};
    return open_lanes(legs, place_of(last, 1), lanes);
  }

  /// Drops legs from points on `first` to points on `last` that what stopped others like them stops, too.
  std::uint32_t not_stopped_between(SequenceElement first, const LaneGate& at_first, SequenceElement last,
                                    const LaneGate& at_last, std::uint32_t lanes) {
    const std::uint32_t hint = blockers_[place_of(first, 0)];
    if (hint == nothing) return lanes;
    const Legs legs{at_first.points, at_last.points, at_first.beside_m + at_last.beside_m, {first, last}, 2};
    return lanes & ~stopped(legs, hint, lanes);
  }

 private:
  static constexpr std::uint32_t nothing = Blockers::nothing;

  struct Legs {
    const LanePoints &from, &to;
    Float8 beside_m;
    std::array<SequenceElement, 2> ends;
    std::size_t end_count;
  };

  const Scene& scene() const { return tracer_.scene(); }
  std::size_t place_of(SequenceElement element, std::size_t kind) const {
    const std::size_t number =
        element.is_edge() ? scene().facets().size() + element.edge().value : element.mirror().value;
    return 2 * number + kind;
  }
  std::array<FacetId, 2> facets_of(SequenceElement element) const {
    return element.is_edge() ? scene().wedge(element.edge()).facets : std::array{element.mirror(), element.mirror()};
  }

  std::uint32_t open_lanes(const Legs& legs, std::size_t place, std::uint32_t lanes) {
    if (blockers_[place] != nothing) lanes &= ~stopped(legs, blockers_[place], lanes);
    std::uint32_t open = 0;
    while (lanes != 0) {
      const std::uint32_t lane = lanes & -lanes;
      lanes ^= lane;
      const std::uint32_t blocker = blocker_of(legs, static_cast<std::size_t>(std::countr_zero(lane)));
      // Beside a free leg most are free: to ask for each takes longer than it spares the solver.
      if (blocker == nothing) return open | lane | lanes;
      const std::uint32_t dead = stopped(legs, blocker, lanes | lane);
      if (dead != 0) blockers_.note(place, blocker);
      if ((dead & lane) == 0) open |= lane;
      lanes &= ~dead;
    }
    return open;
  }

  /// A triangle of something opaque that stands in a leg, or `nothing`.
  std::uint32_t blocker_of(const Legs& legs, std::size_t lane) {
    const auto point = [&](const LanePoints& points) {
      return lanes_.origin_m() + Vec3(points.x[lane], points.y[lane], points.z[lane]);
    };
    const Vec3 from_m = point(legs.from), to_m = point(legs.to);
    if (!(glm::distance(from_m, to_m) > in_plane_guard_m)) return nothing;
    const std::array<FacetId, 2> start = facets_of(legs.ends[0]), end = facets_of(legs.ends[1]);
    std::uint32_t blocker = nothing;
    ++counters_.legs;
    tracer_.any_triangle_between(
        from_m, to_m, LegEnd{start, {}}, legs.end_count == 2 ? LegEnd{end, {}} : LegEnd{}, ignored_,
        [&](std::uint32_t triangle) {
          if (scene().facet(scene().facet_of_triangle(triangle)).transmits) return false;
          blocker = triangle;
          return true;
        },
        counters_.traversal);
    return blocker;
  }

  /// The legs that the facet of a triangle stops for sure: it is none of those that legs ignore, and they cross it well
  /// inside. Of a facet with holes or dents it is the triangle alone.
  std::uint32_t stopped(const Legs& legs, std::uint32_t triangle, std::uint32_t lanes) const {
    const FacetId id = scene().facet_of_triangle(triangle);
    const WorldFacet& facet = scene().facet(id);
    const float clear_m = static_cast<float>(2e-3 + 2.0 * outlines_.of(id).lift_m);
    const bool whole = outlines_.of(id).fills_hull;
    const std::array<HalfSpace, 3> rim = whole ? std::array<HalfSpace, 3>{} : rim_of(triangle, facet.plane.normal);
    const LaneGate crossing = LaneScene::inside(lanes_.plane(id), whole ? lanes_.sides(id) : std::span(rim), legs.from,
                                                legs.to, legs.beside_m + clear_m, lanes);
    std::uint32_t sure = crossing.lanes;
    for (std::size_t end = 0; end < legs.end_count && sure != 0; ++end) {
      for (const FacetId own : facets_of(legs.ends[end])) {
        if (own == id) return 0;
        const HalfSpace& plane = lanes_.plane(own);
        constexpr double along_cosine = 0.98;  // what lies along a mirror does not stop legs to it
        if (std::abs(glm::dot(facet.plane.normal, scene().facet(own).plane.normal)) < along_cosine) continue;
        const Float8 apart = simd::absolute(dot(crossing.points, plane.x, plane.y, plane.z) - plane.offset);
        sure &= (crossing.beside_m + 0.05F < apart).bits();
      }
    }
    return sure;
  }

  /// The sides of a triangle in the plane of its facet.
  std::array<HalfSpace, 3> rim_of(std::uint32_t triangle, const Vec3& normal) const {
    const std::array<Vec3, 3> corners_m = scene().corners_m(triangle);
    const Vec3 centre_m = (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0;
    std::array<HalfSpace, 3> rim;
    for (std::size_t side = 0; side < 3; ++side) {
      const Vec3 &from = corners_m[side], across = glm::cross(normal, corners_m[(side + 1) % 3] - from);
      const double length = glm::length(across);
      // Of a sliver nothing is well inside.
      const Vec3 inward =
          length > 1e-6 ? (glm::dot(across, centre_m - from) < 0.0 ? -across : across) / length : Vec3(0);
      const double offset_m = length > 1e-6 ? glm::dot(inward, from - lanes_.origin_m()) : 1e30;
      rim[side] = {static_cast<float>(inward.x), static_cast<float>(inward.y), static_cast<float>(inward.z),
                   static_cast<float>(offset_m)};
    }
    return rim;
  }

  const SceneTracer<Index>& tracer_;
  const FacetOutlines& outlines_;
  const LaneScene& lanes_;
  IgnoredBodies ignored_;
  SolverCounters& counters_;
  Blockers& blockers_;  ///< by element, for the leg before it and for the one after it
};

}  // namespace dcem
