#pragma once
/// A crowd and a transmitter: how far numbers may be off, and what becomes of a sequence that the gates let pass.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/fetch.hpp"
#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/crowd.hpp"
#include "dcem/paths/halves/leg_hints.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// An element of a sequence, and where ways to the points of a pack meet it.
struct CrowdStop {
  SequenceElement element;
  const LaneGate& at;
};

template <typename Index>
class CrowdGates {
 public:
  CrowdGates(const SceneTracer<Index>& tracer, const FacetOutlines& outlines, const LaneScene& lanes,
             const Crowd& crowd, const BeamLists& mast, Blockers& blockers, SolverCounters& counters)
      : scene_(tracer.scene()),
        outlines_(outlines),
        lanes_(lanes),
        crowd_(crowd),
        mast_(mast),
        hints_(tracer, outlines, lanes, {mast.ignored_body(), std::nullopt}, blockers, counters),
        reach_m_(glm::length(mast.position_m()) + crowd.radius_m() + glm::length(middle())) {
    for (std::size_t pack = 0; pack < crowd.packs(); ++pack) packs_.push_back(crowd.pack(pack));
  }

  const Scene& scene() const { return scene_; }
  const FacetOutlines& outlines() const { return outlines_; }
  const LaneScene& lanes() const { return lanes_; }
  const Crowd& crowd() const { return crowd_; }
  const BeamLists& mast() const { return mast_; }
  /// A mirror that is soon asked about: first the facet, and, when it has come, what belongs to it.
  [[gnu::always_inline]] void fetch(FacetId facet) const {
    dcem::fetch(scene_.facet(facet));
    dcem::fetch(outlines_.of(facet));
    dcem::fetch(lanes_.plane(facet));
    mast_.fetch(facet);
  }
  [[gnu::always_inline]] void fetch_more(FacetId facet) const {
    dcem::fetch(outlines_.sides(facet));
    dcem::fetch(lanes_.sides(facet));
  }
  /// The points of the crowd, eight at a time.
  std::span<const LanePoints> packs() const { return packs_; }
  /// The middle of the crowd, from the origin of the numbers in single precision.
  Vec3 middle() const { return crowd_.sight().position_m() - lanes_.origin_m(); }
  /// How far points of the crowd, or their images, may be from that of the middle.
  float radius_m() const { return static_cast<float>(crowd_.radius_m() + 1e-2); }
  /// How far distances may be off where numbers are as large as those of both ends, and `more_m`.
  float error_with(double more_m) const { return LaneScene::error_m(reach_m_ + more_m); }

  /// The lanes of the points of a pack that may be on one side (1 or −1) of a mirror.
  std::uint32_t lanes_beside(std::size_t pack, FacetId facet, double side) const {
    return lanes_beside(packs_[pack], crowd_.lanes_of(pack), facet, side, error_with(lanes_.reach_m()));
  }
  /// The same of points that may be off by `error_m`.
  std::uint32_t lanes_beside(const LanePoints& points, std::uint32_t lanes, FacetId facet, double side,
                             float error_m) const {
    const HalfSpace& plane = lanes_.plane(facet);
    const Float8 height = dot(points, plane.x, plane.y, plane.z) - plane.offset;
    const Mask8 away = side > 0.0 ? height < Float8(-error_m) : -height < Float8(-error_m);
    return lanes & ~away.bits();
  }

  /// Calls `visit(sequence, point)` for a sequence, from the receivers outwards, and the points of a pack to which it
  /// may carry a path: outer points are looked up at the end that must see them, and legs between elements are tried on
  /// what stopped others like them, then on the scene. The outer edge of a transmitter is not looked up: of edges it
  /// lists the parts that show.
  template <std::size_t count, typename Visit>
  void offer(std::size_t pack, const std::array<CrowdStop, count>& stops, std::uint32_t lanes, Visit&& visit) {
    for (std::size_t at = count; at-- > 1 && lanes != 0;) {
      lanes =
          hints_.not_stopped_between(stops[at].element, stops[at].at, stops[at - 1].element, stops[at - 1].at, lanes);
    }
    if (lanes == 0) return;
    lanes = not_hidden(crowd_.sight(), stops.front(), lanes);
    if (!stops.back().element.is_edge()) lanes = not_hidden(mast_.half().sight(), stops.back(), lanes);
    for (std::size_t at = count; at-- > 1 && lanes != 0;) {
      lanes = hints_.free_between(stops[at].element, stops[at].at, stops[at - 1].element, stops[at - 1].at, lanes);
    }
    if (count > 1 && lanes != 0)
      lanes = hints_.free_after(stops.front().element, stops.front().at, packs_[pack], lanes);
    if (lanes == 0) return;
    sequence_.clear();
    for (const CrowdStop& stop : stops) sequence_.push_back(stop.element);
    for (; lanes != 0; lanes &= lanes - 1) {
      visit(std::as_const(sequence_), pack * simd_lanes + static_cast<std::size_t>(std::countr_zero(lanes)));
    }
  }

 private:
  double nearer(const Sight& sight, SequenceElement element) const {
    return element.is_edge() ? sight.nearer_on(scene_, outlines_, element.edge())
                             : sight.nearer_on(scene_, outlines_, element.mirror());
  }

  /// The lanes whose point is not hidden for sure from an end that must see it.
  std::uint32_t not_hidden(const Sight& sight, const CrowdStop& stop, std::uint32_t lanes) const {
    if (lanes == 0) return 0;
    constexpr float too_vague_m = 0.1F;
    std::array<std::array<float, simd_lanes>, 3> place;
    std::array<float, simd_lanes> beside_m;
    stop.at.points.x.store(place[0]);
    stop.at.points.y.store(place[1]);
    stop.at.points.z.store(place[2]);
    stop.at.beside_m.store(beside_m);
    const double factor = nearer(sight, stop.element);
    std::array<std::optional<ViewMap::PointPixels>, simd_lanes> pixels;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      if (!(beside_m[lane] < too_vague_m)) continue;
      const Vec3 point_m = lanes_.origin_m() + Vec3(place[0][lane], place[1][lane], place[2][lane]);
      pixels[lane] = sight.map().pixels_of_point(point_m, factor, Vec3(beside_m[lane]));
      if (pixels[lane]) sight.map().fetch_pixels(*pixels[lane]);
    }
    std::uint32_t seen = 0;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const auto& of = pixels[static_cast<std::size_t>(std::countr_zero(left))];
      if (!of || !sight.map().hides(*of)) seen |= left & -left;
    }
    return seen;
  }

  const Scene& scene_;
  const FacetOutlines& outlines_;
  const LaneScene& lanes_;
  const Crowd& crowd_;
  const BeamLists& mast_;
  LegHints<Index> hints_;
  double reach_m_;  ///< no number that says where both ends are is larger
  std::vector<LanePoints> packs_;
  Sequence sequence_;
};

}  // namespace dcem
