#pragma once
/// Bodies of edge_meetings.hpp.
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/paths/discover/edge_meetings.hpp"
#include "dcem/paths/halves/may_face.hpp"
#include "dcem/paths/solve/image_method.hpp"
#include "dcem/paths/solve/wedge_method.hpp"

namespace dcem {

namespace detail {

/// Points this far beside an edge are left to the solver, and five times as far beside the box around a mirror. Far
/// above rounding, even of edges of a centimetre seen from a kilometre, thousands of kilometres from the origin.
inline constexpr double beside_meeting_m = 2e-3;

/// Whether a point of its plane is in the box around a facet, or a little beside.
inline bool is_by_facet(const Scene& scene, const WorldFacet& facet, const Vec3& point_m) {
  return inflated(scene.hull_box(facet), 5.0 * beside_meeting_m).contains(point_m);
}

inline bool fits_one_edge(const ChainLimits& limits, std::size_t mirrors) {
  return mirrors <= limits.max_reflections && mirrors + 1 <= limits.max_interactions;
}

}  // namespace detail

DCEM_INLINE void EdgeMeetings::Ways::take(const Scene& scene, const ChainLimits& limits, const Vec3& end_m,
                                          const EdgeReach::Edge& edge) {
  ways_.clear();
  images_m_.clear();
  const Wedge& wedge = scene.wedge(edge.id).edge;
  for (const EdgeReach::Mirrors mirrors : edge.mirrors) {
    if (!detail::fits_one_edge(limits, mirrors.size())) continue;
    const std::size_t first = images_m_.size();
    images_m_.push_back(end_m);
    for (const SequenceElement mirror : mirrors) {
      images_m_.push_back(mirrored(scene.facet(mirror.mirror()).plane, images_m_.back()));
    }
    if (may_face(wedge, images_m_.back() - wedge.start_m)) {
      ways_.push_back({mirrors, first});
    } else {
      images_m_.resize(first);
    }
  }
}

DCEM_INLINE bool EdgeMeetings::Ways::leads_from(const Vec3& point_m, std::size_t way, const Scene& scene) const {
  Vec3 from_m = point_m;
  for (std::size_t left = ways_[way].mirrors.size(); left > 0; --left) {
    const WorldFacet& facet = scene.facet(ways_[way].mirrors[left - 1].mirror());
    const Vec3& to_m = images_m_[ways_[way].first + left];
    const double from = signed_distance_m(facet.plane, from_m), to = signed_distance_m(facet.plane, to_m);
    if (!facet.present || (from > 0.0) == (to > 0.0) || from == to) return false;
    from_m += from / (from - to) * (to_m - from_m);
    if (!detail::is_by_facet(scene, facet, from_m)) return false;
  }
  return true;
}

DCEM_INLINE void EdgeMeetings::join_at(WedgeId id, const Scene& scene, const ChainLimits& limits,
                                       SequenceList& chains) {
  const Wedge& wedge = scene.wedge(id).edge;
  const EdgeLine line{wedge.start_m, edge_direction(wedge), edge_length_m(wedge)};
  for (std::size_t here = 0; here < near_.size(); ++here) {
    for (std::size_t there = 0; there < far_.size(); ++there) {
      if (!detail::fits_one_edge(limits, near_.mirrors(here).size() + far_.mirrors(there).size())) continue;
      const double place_m = detail::place_between(far_.image_m(there), line, near_.image_m(here));
      if (!(place_m >= -detail::beside_meeting_m && place_m <= line.length_m + detail::beside_meeting_m)) continue;
      const Vec3 point_m = line.at(place_m);
      if (!near_.leads_from(point_m, here, scene) || !far_.leads_from(point_m, there, scene)) continue;
      chain_.assign(near_.mirrors(here).begin(), near_.mirrors(here).end());
      chain_.emplace_back(id);
      chain_.insert(chain_.end(), far_.mirrors(there).rbegin(), far_.mirrors(there).rend());
      chains.add(chain_);
    }
  }
}

DCEM_INLINE void EdgeMeetings::join(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver,
                                    const ReachingEnd& transmitter, SequenceList& chains) {
  if (limits.max_diffractions < 1 || limits.max_interactions < 1) return;
  auto other = transmitter.edges.begin();
  for (const EdgeReach::Edge& edge : receiver.edges) {
    while (other != transmitter.edges.end() && other->id < edge.id) ++other;
    if (other == transmitter.edges.end()) return;
    if (other->id != edge.id || !scene.wedge(edge.id).present) continue;
    near_.take(scene, limits, receiver.position_m, edge);
    if (near_.size() == 0) continue;
    far_.take(scene, limits, transmitter.position_m, *other);
    join_at(edge.id, scene, limits, chains);
  }
}

}  // namespace dcem
