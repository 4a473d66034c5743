#pragma once
/// Two diffractions: pairs of edges, one that the receiver sees and one that the transmitter sees, over which the
/// shortest way between the two may lead.
///
/// For a point q on the transmitter's edge the point on the receiver's follows in closed form, and the slope of the
/// length, cos(in) − cos(out) at q, grows along the edge (paths/solve/wedge_method.hpp). So the sign of the slope at
/// two places says whether its zero lies between them. That is asked for eight edges at once in single precision, each
/// number with how far it may be off, and halves the stretch a few times; then the receiver's point is known well
/// enough to say whether it misses its edge. What is left is settled as the solver settles it.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/edge_clusters.hpp"
#include "dcem/paths/halves/lanes.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/solve/wedge_method.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// A pair of edges, and where the shortest way meets them.
struct EdgePair {
  WedgeId near, far;  ///< that of the receiver, that of the transmitter
  Vec3 near_m, far_m;
};

/// Holds scratch memory: one per thread. The scene must stay.
class EdgePairs {
 public:
  EdgePairs(const Scene& scene, const FacetOutlines& outlines) : scene_(scene), origin_m_(outlines.middle_m()) {}

  /// Takes what a transmitter sees of edges; `edge` of a part is the number of a wedge.
  void aim(const Vec3& transmitter_m, std::span<const EdgePart> parts);

  /// Calls `visit(pair)` for pairs with one of the edges that a receiver sees; seldom twice for one.
  template <typename Visit>
  void for_each(const Vec3& receiver_m, std::span<const WedgeId> near, Visit&& visit) const {
    for (const WedgeId edge : near) {
      const Near from = near_edge(edge, receiver_m);
      for (std::size_t pack = 0; pack < packs_.size(); ++pack) {
        for (std::uint32_t left = may_join(from, packs_[pack]); left != 0; left &= left - 1) {
          const WedgeId far(edges_[pack * simd_lanes + static_cast<std::size_t>(std::countr_zero(left))]);
          EdgePair pair{edge, far, {}, {}};
          if (far != edge && settle(receiver_m, pair)) visit(pair);
        }
      }
    }
  }

 private:
  static constexpr float beside_m = 2e-3F;  ///< a part is taken to be longer by this at both ends
  static constexpr int halvings = 5;

  /// Parts of eight edges that the transmitter sees.
  struct Pack {
    LanePoints first, last;  ///< their ends
    LanePoints along;        ///< unit vectors
    Float8 length_m;
    std::uint32_t lanes;
  };

  /// An edge that the receiver sees, in single precision.
  struct Near {
    LaneEdge edge;
    float place_m, distance_m, length_m;  ///< of the receiver along and from it; of the edge
    float error_m;                        ///< how far coordinates may be off
  };

  Near near_edge(WedgeId id, const Vec3& receiver_m) const;
  LaneSlope look_from(const Near& near, const LanePoints& point, const LanePoints& along) const {
    return {
        near.edge, near.place_m, near.distance_m, near.error_m, point, along, LanePoints(transmitter_m_ - origin_m_)};
  }
  std::uint32_t may_join(const Near& near, const Pack& far) const;
  bool settle(const Vec3& receiver_m, EdgePair& pair) const;

  const Scene& scene_;
  Vec3 origin_m_;  ///< of the numbers in single precision
  Vec3 transmitter_m_{0.0};
  std::vector<Pack> packs_;
  std::vector<std::uint32_t> edges_;  ///< by pack and lane
  float far_reach_m_ = 0.0F;          ///< no coordinate of the transmitter and of its edges is larger
};

// ---------------------------------------------------------------------------------------------------------------------

inline void EdgePairs::aim(const Vec3& transmitter_m, std::span<const EdgePart> parts) {
  transmitter_m_ = transmitter_m;
  packs_.clear();
  edges_.clear();
  double reach_m = glm::length(transmitter_m - origin_m_);
  for (std::size_t first = 0; first < parts.size(); first += simd_lanes) {
    const std::size_t count = std::min<std::size_t>(simd_lanes, parts.size() - first);
    std::array<Vec3, simd_lanes> from_m, to_m, along;
    std::array<float, simd_lanes> length_m{};
    for (std::size_t lane = 0; lane < count; ++lane) {
      const EdgePart& part = parts[first + lane];
      const Wedge& edge = scene_.wedge(WedgeId(part.edge)).edge;
      along[lane] = edge_direction(edge);
      from_m[lane] = edge.start_m + (static_cast<double>(part.from) - beside_m) * along[lane];
      to_m[lane] = edge.start_m + (static_cast<double>(part.to) + beside_m) * along[lane];
      length_m[lane] = part.to - part.from + 2.0F * beside_m;
      reach_m = std::max({reach_m, glm::length(from_m[lane] - origin_m_), glm::length(to_m[lane] - origin_m_)});
      edges_.push_back(part.edge);
    }
    const auto held = [&](const std::array<Vec3, simd_lanes>& all) { return std::span<const Vec3>(all).first(count); };
    packs_.push_back({LanePoints(held(from_m), origin_m_), LanePoints(held(to_m), origin_m_),
                      LanePoints(held(along), Vec3(0.0)), Float8(length_m), (1U << count) - 1U});
    edges_.resize(packs_.size() * simd_lanes);
  }
  far_reach_m_ = static_cast<float>(reach_m);
}

inline EdgePairs::Near EdgePairs::near_edge(WedgeId id, const Vec3& receiver_m) const {
  const Wedge& wedge = scene_.wedge(id).edge;
  const EdgePart part = whole_edge(id.value, wedge, receiver_m);
  const double reach_m = glm::length(receiver_m - origin_m_) + glm::length(wedge.start_m - origin_m_) + part.to;
  return {lane_edge(wedge, origin_m_), part.place, part.distance, part.to,
          LaneScene::error_m(reach_m + static_cast<double>(far_reach_m_))};
}

/// The lanes of those edges that the shortest way may meet after the receiver's. Lanes are asked for what they are not,
/// so that NaN, of points in one, passes.
inline std::uint32_t EdgePairs::may_join(const Near& near, const Pack& far) const {
  const LaneEdge& edge = near.edge;
  std::uint32_t lanes = far.lanes & ~(edge.behind(edge.from_start(far.first), near.error_m) &
                                      edge.behind(edge.from_start(far.last), near.error_m));
  if (lanes == 0) return 0;
  const LaneSlope first = look_from(near, far.first, far.along);
  lanes &= ~(first.slope_error < first.slope).bits();
  if (lanes == 0) return 0;
  const LaneSlope last = look_from(near, far.last, far.along);
  lanes &= ~(last.slope < -last.slope_error).bits();
  if (lanes == 0) return 0;
  Float8 low(0.0F), high = far.length_m;
  const auto look_between = [&] {
    const Float8 at = Float8(0.5F) * (low + high);
    return look_from(near,
                     {far.first.x + at * far.along.x, far.first.y + at * far.along.y, far.first.z + at * far.along.z},
                     far.along);
  };
  for (int step = 0; step < halvings; ++step) {
    const LaneSlope here = look_between();
    const Float8 at = Float8(0.5F) * (low + high);
    high = simd::select(here.slope_error < here.slope, at, high);
    low = simd::select(here.slope < -here.slope_error, at, low);
  }
  const LaneMeeting here = look_between().near;
  const Float8 moved_m = Float8(0.5F) * (high - low);  // from where it was asked for
  const Float8 room =
      here.beside_m + beside_m + edge_point_reach_m(Float8(near.distance_m), here.sum_m, here.between_m, moved_m);
  return lanes & ~((here.place_m + room < Float8(0.0F)) | (Float8(near.length_m) + room < here.place_m)).bits();
}

/// Places the points as the solver does, to the last bit; false where it finds none, or where one of the edges is
/// solid towards the other.
inline bool EdgePairs::settle(const Vec3& receiver_m, EdgePair& pair) const {
  const auto line = [&](WedgeId id) {
    const Wedge& edge = scene_.wedge(id).edge;
    return EdgeLine{edge.start_m, glm::normalize(edge.end_m - edge.start_m), edge_length_m(edge)};
  };
  const std::array<EdgeLine, 2> lines{line(pair.far), line(pair.near)};
  EdgePlaces places_m{};
  if (!diffraction_places(transmitter_m_, lines, receiver_m, places_m)) return false;
  pair.far_m = lines[0].at(places_m[0]);
  pair.near_m = lines[1].at(places_m[1]);
  const Vec3 way_m = pair.near_m - pair.far_m;
  return may_face(scene_.wedge(pair.far).edge, way_m) && may_face(scene_.wedge(pair.near).edge, -way_m);
}

}  // namespace dcem
