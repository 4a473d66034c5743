#pragma once
/// Bodies of half_pairs.hpp.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/half_packs.hpp"
#include "dcem/paths/discover/half_pairs.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

namespace detail {

/// Most halves whose edges share a box, and most packs of eight that do.
inline constexpr std::size_t packs_per_group = 8;

/// Halves of one end with the same number of mirrors, in groups with the boxes around their edges.
class HalfGroups {
 public:
  HalfGroups(std::vector<EdgeHalf> halves, const Vec3& origin_m);

  /// Calls `visit(half)` for those that the way from another half may lead on to.
  template <typename Visit>
  void for_each_from(const NearHalf& near, PairCounters& counters, Visit&& visit) const;

 private:
  struct Pack {
    Aabb<double> box;
    HalfPack lanes;
  };
  struct Group {
    Aabb<double> box;
    std::size_t first, last;  ///< packs
  };

  std::vector<EdgeHalf> halves_;
  std::vector<Pack> packs_;
  std::vector<Group> groups_;
};

inline Aabb<double> box_of(const Wedge& edge) {
  Aabb<double> box;
  box.extend(edge.start_m);
  box.extend(edge.end_m);
  return box;
}

/// Cuts points into runs of neighbours: each run is halved across the longer side of the box around it, down to one
/// pack.
inline void sort_neighbours(std::span<EdgeHalf> halves) {
  if (halves.size() <= simd_lanes) return;
  Aabb<double> box;
  for (const EdgeHalf& half : halves) box.extend(half.edge.start_m + half.edge.end_m);
  const Vec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t packs = (halves.size() + simd_lanes - 1) / simd_lanes, middle = packs / 2 * simd_lanes;
  const auto key = [&](const EdgeHalf& half) {
    return std::tuple(half.edge.start_m[axis] + half.edge.end_m[axis], half.id.value);
  };
  std::nth_element(halves.begin(), halves.begin() + static_cast<std::ptrdiff_t>(middle), halves.end(),
                   [&](const EdgeHalf& one, const EdgeHalf& other) { return key(one) < key(other); });
  sort_neighbours(halves.first(middle));
  sort_neighbours(halves.subspan(middle));
}

inline HalfGroups::HalfGroups(std::vector<EdgeHalf> halves, const Vec3& origin_m) : halves_(std::move(halves)) {
  sort_neighbours(halves_);
  for (std::size_t first = 0; first < halves_.size(); first += simd_lanes) {
    const auto held =
        std::span<const EdgeHalf>(halves_).subspan(first, std::min<std::size_t>(simd_lanes, halves_.size() - first));
    Aabb<double> box;
    for (const EdgeHalf& half : held) box.extend(box_of(half.edge));
    if (packs_.size() % packs_per_group == 0) groups_.push_back({{}, packs_.size(), packs_.size()});
    packs_.push_back({box, HalfPack(held, origin_m)});
    groups_.back().box.extend(box);
    groups_.back().last = packs_.size();
  }
}

template <typename Visit>
void HalfGroups::for_each_from(const NearHalf& near, PairCounters& counters, Visit&& visit) const {
  for (const Group& group : groups_) {
    ++counters.boxes_asked;
    if (!near.may_meet(group.box)) continue;
    for (std::size_t pack = group.first; pack < group.last; ++pack) {
      ++counters.boxes_asked;
      if (!near.may_meet(packs_[pack].box)) continue;
      ++counters.packs_asked;
      for (std::uint32_t left = packs_[pack].lanes.meeting(near); left != 0; left &= left - 1) {
        visit(halves_[pack * simd_lanes + static_cast<std::size_t>(std::countr_zero(left))]);
      }
    }
  }
}

/// The image of an end in mirrors that count from it.
inline Vec3 image_of(const Scene& scene, const Vec3& end_m, std::span<const SequenceElement> mirrors) {
  Vec3 image_m = end_m;
  for (const SequenceElement mirror : mirrors) image_m = mirrored(scene.facet(mirror.mirror()).plane, image_m);
  return image_m;
}

/// The halves of an end, by how many mirrors they have, without those whose edge has its interior towards its image.
inline std::vector<std::vector<EdgeHalf>> halves_of(const Scene& scene, const ReachingEnd& end,
                                                    const ChainLimits& limits) {
  const std::size_t left = limits.max_interactions < 2 ? 0 : limits.max_interactions - 2;
  std::vector<std::vector<EdgeHalf>> halves(std::min(limits.max_reflections, left) + 1);
  for (const EdgeReach::Edge& reached : end.edges) {
    const Wedge& edge = scene.wedge(reached.id).edge;
    for (const std::span<const SequenceElement> mirrors : reached.mirrors) {
      if (mirrors.size() >= halves.size()) continue;
      const Vec3 image_m = image_of(scene, end.position_m, mirrors);
      if (may_face(edge, image_m - edge.start_m))
        halves[mirrors.size()].push_back({reached.id, edge, mirrors, image_m});
    }
  }
  return halves;
}

/// No coordinate of some halves, counted from the origin, is larger.
inline double reach_of(std::span<const std::vector<EdgeHalf>> halves, const Vec3& origin_m) {
  double reach_m = 0.0;
  for (const std::vector<EdgeHalf>& of : halves) {
    for (const EdgeHalf& half : of) {
      for (const Vec3& point_m : {half.image_m, half.edge.start_m, half.edge.end_m}) {
        reach_m = std::max(reach_m, glm::distance(point_m, origin_m));
      }
    }
  }
  return reach_m;
}

}  // namespace detail

DCEM_INLINE void join_edge_pairs(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver,
                                 const ReachingEnd& transmitter, SequenceList& chains, PairCounters& counters) {
  if (limits.max_diffractions < 2 || limits.max_interactions < 2) return;
  const Vec3 origin_m = receiver.position_m;
  std::vector<std::vector<EdgeHalf>> far = detail::halves_of(scene, transmitter, limits);
  const std::vector<std::vector<EdgeHalf>> near = detail::halves_of(scene, receiver, limits);
  const double reach_m = detail::reach_of(near, origin_m) + detail::reach_of(far, origin_m);
  std::vector<detail::HalfGroups> groups;
  for (std::vector<EdgeHalf>& of : far) groups.emplace_back(std::move(of), origin_m);
  Sequence chain;
  for (std::size_t mirrors = 0; mirrors < near.size(); ++mirrors) {
    for (const EdgeHalf& half : near[mirrors]) {
      const NearHalf from(half, origin_m, reach_m);
      for (std::size_t more = 0; more < groups.size() && mirrors + more < near.size(); ++more) {
        groups[more].for_each_from(from, counters, [&](const EdgeHalf& other) {
          if (other.id == half.id) return;
          chain.assign(half.mirrors.begin(), half.mirrors.end());
          chain.emplace_back(half.id);
          chain.emplace_back(other.id);
          chain.insert(chain.end(), other.mirrors.rbegin(), other.mirrors.rend());
          chains.add(chain);
        });
      }
    }
  }
}

}  // namespace dcem
