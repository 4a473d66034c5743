#pragma once
/// Bodies of half_pairs.hpp.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
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

  std::span<const EdgeHalf> halves() const { return halves_; }

  /// Calls `visit(half)` for those that the way from another half, or from its image in a mirror, may lead on to.
  template <typename Visit>
  void for_each_from(const NearHalf& near, const MirrorWindow* window, PairCounters& counters, Visit&& visit) const;

 private:
  struct Pack {
    Aabb<double> box;
    HalfPack lanes;
  };
  struct Group {
    Aabb<double> box;
    std::size_t first, last;  ///< packs
  };

  Vec3 origin_m_;
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

inline HalfGroups::HalfGroups(std::vector<EdgeHalf> halves, const Vec3& origin_m)
    : origin_m_(origin_m), halves_(std::move(halves)) {
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
void HalfGroups::for_each_from(const NearHalf& near, const MirrorWindow* window, PairCounters& counters,
                               Visit&& visit) const {
  for (const Group& group : groups_) {
    ++counters.boxes_asked;
    if (!near.may_meet(group.box)) continue;
    for (std::size_t pack = group.first; pack < group.last; ++pack) {
      ++counters.boxes_asked;
      if (!near.may_meet(packs_[pack].box)) continue;
      ++counters.packs_asked;
      for (std::uint32_t left = packs_[pack].lanes.meeting(near, window, origin_m_); left != 0; left &= left - 1) {
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
        halves[mirrors.size()].push_back({reached.id, edge, mirrors, image_m, reached.in_view});
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

/// A half as it looks in a mirror. Its ends change places, because tangent, normal and direction stay right-handed.
inline EdgeHalf half_in_mirror(const EdgeHalf& half, const Plane& plane) {
  const auto turned = [&](const Vec3& direction) {
    return direction - 2.0 * glm::dot(direction, plane.normal) * plane.normal;
  };
  EdgeHalf image = half;
  image.edge.start_m = mirrored(plane, half.edge.end_m);
  image.edge.end_m = mirrored(plane, half.edge.start_m);
  image.edge.tangent = turned(half.edge.tangent);
  image.edge.normal = turned(half.edge.normal);
  image.image_m = mirrored(plane, half.image_m);
  return image;
}

inline MirrorWindow window_of(const Scene& scene, FacetId id) {
  const WorldFacet& facet = scene.facet(id);
  return {facet.plane, inflated(scene.hull_box(facet), 1e-2)};
}

/// Joins the halves of two ends over two edges.
class PairJoiner {
 public:
  PairJoiner(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver, const ReachingEnd& transmitter,
             SequenceList& chains, PairCounters& counters)
      : scene_(scene), limits_(limits), origin_m_(receiver.position_m), chains_(chains), counters_(counters) {
    std::vector<std::vector<EdgeHalf>> near = halves_of(scene, receiver, limits);
    std::vector<std::vector<EdgeHalf>> far = halves_of(scene, transmitter, limits);
    reach_m_ = 2.0 * (reach_of(near, origin_m_) + reach_of(far, origin_m_));  // in mirrors, too
    for (std::vector<EdgeHalf>& of : near) near_.emplace_back(std::move(of), origin_m_);
    for (std::vector<EdgeHalf>& of : far) far_.emplace_back(std::move(of), origin_m_);
  }

  void join() {
    for_each_two(0, [&](const HalfGroups& near, const HalfGroups& far) { join_directly(near, far); });
    if (limits_.max_reflections == 0) return;
    for_each_two(1, [&](const HalfGroups& near, const HalfGroups& far) {
      join_over_mirrors<false>(near, far);
      join_over_mirrors<true>(far, near);
    });
  }

 private:
  /// Calls `visit(near, far)` for halves whose mirrors leave room for some between the edges.
  template <typename Visit>
  void for_each_two(std::size_t between, Visit&& visit) const {
    for (std::size_t mirrors = 0; mirrors < near_.size(); ++mirrors) {
      for (std::size_t more = 0; more < far_.size() && mirrors + more + between < near_.size(); ++more) {
        visit(near_[mirrors], far_[more]);
      }
    }
  }

  void join_directly(const HalfGroups& near, const HalfGroups& far) {
    for (const EdgeHalf& half : near.halves()) {
      far.for_each_from({half, origin_m_, reach_m_}, nullptr, counters_, [&](const EdgeHalf& other) {
        if (other.id != half.id) add(half, {}, other);
      });
    }
  }

  /// Over the mirrors that the edges of `from` see; `turned`: `from` is the transmitter's, and what the receiver's
  /// edges see, too, has been joined.
  template <bool turned>
  void join_over_mirrors(const HalfGroups& from, const HalfGroups& to) {
    for (const EdgeHalf& half : from.halves()) {
      for (const FacetId mirror : half.in_view) {
        const MirrorWindow window = window_of(scene_, mirror);
        const EdgeHalf image = half_in_mirror(half, window.plane);
        to.for_each_from({image, origin_m_, reach_m_}, &window, counters_, [&](const EdgeHalf& other) {
          const SequenceElement between = mirror;
          if constexpr (!turned) return add(half, {&between, 1}, other);
          if (!std::binary_search(other.in_view.begin(), other.in_view.end(), mirror)) add(other, {&between, 1}, half);
        });
      }
    }
  }

  void add(const EdgeHalf& near, std::span<const SequenceElement> between, const EdgeHalf& far) {
    chain_.assign(near.mirrors.begin(), near.mirrors.end());
    chain_.emplace_back(near.id);
    chain_.insert(chain_.end(), between.begin(), between.end());
    chain_.emplace_back(far.id);
    chain_.insert(chain_.end(), far.mirrors.rbegin(), far.mirrors.rend());
    chains_.add(chain_);
  }

  const Scene& scene_;
  ChainLimits limits_;
  Vec3 origin_m_;
  double reach_m_ = 0.0;
  std::vector<HalfGroups> near_, far_;  ///< by how many mirrors there are
  SequenceList& chains_;
  PairCounters& counters_;
  Sequence chain_;
};

}  // namespace detail

DCEM_INLINE void join_edge_pairs(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver,
                                 const ReachingEnd& transmitter, SequenceList& chains, PairCounters& counters) {
  if (limits.max_diffractions < 2 || limits.max_interactions < 2) return;
  detail::PairJoiner(scene, limits, receiver, transmitter, chains, counters).join();
}

}  // namespace dcem
