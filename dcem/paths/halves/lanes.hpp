#pragma once
/// Gates for several points at once: where ways cross a facet, and where they meet an edge.
///
/// All in single precision around an origin in the middle of the scene. Each result carries how far it may be off; what
/// a gate refuses cannot be, and what it lets pass the solver decides.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/edge_clusters.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/lane_edge.hpp"
#include "dcem/paths/halves/lane_points.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// Points that a gate has found, how far they may be off, and the lanes that it lets pass.
struct LaneGate {
  LanePoints points;
  Float8 beside_m;
  std::uint32_t lanes;
};

}  // namespace DCEM_ISA

/// All facets and edges of a scene in single precision.
class LaneScene {
 public:
  LaneScene(const Scene& scene, const FacetOutlines& outlines) : origin_m_(outlines.middle_m()) {
    planes_.resize(scene.facets().size());
    first_.assign(1, 0);
    first_.reserve(scene.facets().size() + 1);
    for (std::uint32_t index = 0; index < scene.facets().size(); ++index) {
      first_.push_back(first_.back() + static_cast<std::uint32_t>(outlines.sides(FacetId(index)).size()));
    }
    sides_.resize(first_.back());
    edges_.resize(scene.wedges().size());
    for (std::uint32_t index = 0; index < scene.facets().size(); ++index) place(scene, outlines, FacetId(index));
    for (std::uint32_t index = 0; index < edges_.size(); ++index) place(scene, WedgeId(index));
  }

  /// Follows bodies that have moved, come or gone; the outlines have already.
  void update(const Scene& scene, const FacetOutlines& outlines, std::span<const BodyId> moved) {
    for (const BodyId body : moved) {
      if (body.value == 0) continue;  // the scenery stands
      const bool last = body.value + 1 == scene.bodies().size();
      const auto first_wedge = scene.world().first(body).wedge;
      const auto last_wedge =
          last ? static_cast<std::uint32_t>(edges_.size()) : scene.world().first(BodyId(body.value + 1)).wedge;
      const FacetOutlines::BodyFacets& facets = outlines.bodies()[body.value - 1];
      for (std::uint32_t index = 0; index < facets.count; ++index)
        place(scene, outlines, FacetId(facets.first + index));
      for (std::uint32_t index = first_wedge; index < last_wedge; ++index) place(scene, WedgeId(index));
    }
  }

  const Vec3& origin_m() const { return origin_m_; }
  /// How far the scene reaches from the origin.
  double reach_m() const { return reach_m_; }
  const HalfSpace& plane(FacetId facet) const { return planes_[facet.value]; }
  std::span<const HalfSpace> sides(FacetId facet) const {
    return std::span(sides_).subspan(first_[facet.value], first_[facet.value + 1] - first_[facet.value]);
  }
  const LaneEdge& edge(WedgeId edge) const { return edges_[edge.value]; }

  /// How far a distance from a plane, or along an edge, may be off where no number is larger than `reach_m`: of four
  /// numbers and their sums, each rounded to 6e-8.
  static float error_m(double reach_m) { return static_cast<float>(4e-7 * reach_m); }

  /// Where straight ways cross a facet, on it or beside it by less than the result may be off. `error_m` holds for both
  /// ends.
  LaneGate cross(FacetId facet, const LanePoints& from, const LanePoints& to, const Float8& error_m,
                 std::uint32_t lanes) const;
  /// The straight ways that cross a convex part of a plane for sure, not closer to its sides and to their ends than
  /// `room_m`.
  static LaneGate inside(const HalfSpace& plane, std::span<const HalfSpace> sides, const LanePoints& from,
                         const LanePoints& to, const Float8& room_m, std::uint32_t lanes);
  /// Where the shortest ways over an edge to the end that sees `part` of it meet that part. Ways from the interior are
  /// refused.
  LaneGate meet(const EdgePart& part, const LanePoints& from, float error_m, std::uint32_t lanes) const;

 private:
  static constexpr float beside_m = 1e-3F;  ///< points this far beside a facet or an edge are left to the solver

  HalfSpace half_space(const Vec3& normal, double offset_m) const {
    return {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
            static_cast<float>(offset_m - glm::dot(normal, origin_m_))};
  }
  void place(const Scene& scene, const FacetOutlines& outlines, FacetId id) {
    const WorldFacet& facet = scene.facet(id);
    planes_[id.value] = half_space(facet.plane.normal, glm::dot(facet.plane.normal, facet.plane.point_m));
    std::uint32_t side = first_[id.value];
    for (const HullSide& of : outlines.sides(id)) sides_[side++] = half_space(of.normal, of.offset_m);
    for (const Vec3& corner_m : scene.hull_m(facet)) reach_m_ = std::max(reach_m_, glm::length(corner_m - origin_m_));
  }
  void place(const Scene& scene, WedgeId id) { edges_[id.value] = lane_edge(scene.wedge(id).edge, origin_m_); }

  Vec3 origin_m_;
  double reach_m_ = 1.0;
  std::vector<HalfSpace> planes_, sides_;
  std::vector<std::uint32_t> first_;
  std::vector<LaneEdge> edges_;
};

// ---------------------------------------------------------------------------------------------------------------------

// Lanes are asked for what they are not, so that NaN, of ways along a plane or an edge, passes.

namespace detail {

/// Where straight ways cross a plane, their ends' distances from it known; `error_m` holds for both ends.
inline LaneGate crossings(const LanePoints& from, const LanePoints& to, const Float8& first, const Float8& last,
                          const Float8& error_m, std::uint32_t lanes) {
  const LanePoints way = to - from;
  const Float8 inverse = Float8(1.0F) / (first - last), share = first * inverse;
  const Float8 length = simd::absolute(way.x) + simd::absolute(way.y) + simd::absolute(way.z);
  return {{from.x + share * way.x, from.y + share * way.y, from.z + share * way.z},
          error_m * (Float8(2.0F) + length * simd::absolute(inverse)),
          lanes};
}

}  // namespace detail

inline LaneGate LaneScene::cross(FacetId facet, const LanePoints& from, const LanePoints& to, const Float8& error_m,
                                 std::uint32_t lanes) const {
  const HalfSpace& plane = planes_[facet.value];
  const Float8 first = dot(from, plane.x, plane.y, plane.z) - plane.offset;
  const Float8 last = dot(to, plane.x, plane.y, plane.z) - plane.offset;
  const Mask8 above = (error_m < first) & (error_m < last), below = (first < -error_m) & (last < -error_m);
  lanes &= ~(above | below).bits();
  if (lanes == 0) return {from, Float8(0.0F), lanes};
  LaneGate gate = detail::crossings(from, to, first, last, error_m, lanes);
  const Float8 room = gate.beside_m + beside_m;
  for (const HalfSpace& side : sides(facet)) {
    gate.lanes &= ~(dot(gate.points, side.x, side.y, side.z) + room < Float8(side.offset)).bits();
    if (gate.lanes == 0) break;
  }
  return gate;
}

inline LaneGate LaneScene::inside(const HalfSpace& plane, std::span<const HalfSpace> sides, const LanePoints& from,
                                  const LanePoints& to, const Float8& room_m, std::uint32_t lanes) {
  const Float8 first = dot(from, plane.x, plane.y, plane.z) - plane.offset;
  const Float8 last = dot(to, plane.x, plane.y, plane.z) - plane.offset;
  const Mask8 down = (room_m < first) & (last < -room_m), up = (first < -room_m) & (room_m < last);
  lanes &= (down | up).bits();
  if (lanes == 0) return {from, room_m, lanes};
  LaneGate gate = detail::crossings(from, to, first, last, room_m, lanes);
  for (const HalfSpace& side : sides) {
    gate.lanes &= (Float8(side.offset) + gate.beside_m < dot(gate.points, side.x, side.y, side.z)).bits();
    if (gate.lanes == 0) break;
  }
  return gate;
}

inline LaneGate LaneScene::meet(const EdgePart& part, const LanePoints& from, float error_m,
                                std::uint32_t lanes) const {
  const LaneEdge& edge = edges_[part.edge];
  const LanePoints away = edge.from_start(from);
  LaneGate gate{from, Float8(0.0F), lanes & ~edge.behind(away, error_m)};
  if (gate.lanes == 0) return gate;
  const LaneMeeting meeting(edge, part.place, part.distance, away, error_m);
  const Float8 point = meeting.place_m;
  gate.beside_m = meeting.beside_m;
  const Float8 room = gate.beside_m + beside_m;
  gate.lanes &= ~((point + room < Float8(part.from)) | (Float8(part.to) + room < point)).bits();
  gate.points = {point * edge.direction[0] + edge.start[0], point * edge.direction[1] + edge.start[1],
                 point * edge.direction[2] + edge.start[2]};
  return gate;
}

}  // namespace dcem
