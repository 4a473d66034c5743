#pragma once
/// What the rays of a packet have met so far.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>

#include "dcem/accel/wide/trace/candidates.hpp"
#include "dcem/accel/wide/trace/packet_quads.hpp"
#include "dcem/accel/wide/trace/packet_rays.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// For each ray the nearest quad that it surely meets, in rows; and in a list of its own, as for a ray that goes alone,
/// what may be nearer than that: a quad as near to within rounding, one that it may meet, one that its filter must be
/// asked about. Few rays have such a list. `Source`: see packet_source.hpp.
template <typename Source>
class PacketHits {
 public:
  PacketHits(const WideArrays& tree, const Source& source, TraversalCounters& counters)
      : tree_(tree), counters_(counters), source_(source) {}

  [[gnu::always_inline]] void begin(const Source& source) {
    source_ = source;
    for (std::size_t ray = 0; ray < PacketRays::capacity; ray += simd_lanes) {
      PacketRays::put(first_, ray, Float8(nowhere));
    }
    others_ = 0;
    side_ = {};
  }

  /// Takes over what eight rays have of a quad, and lowers their limits. Returns whether it did. Of rays that are not
  /// in `met` only sure hits: one that lies beyond a limit, or t_max, stands for nothing that is nearer, and `decide`
  /// does not take it.
  [[gnu::always_inline]] bool take(std::uint32_t quad, std::uint32_t met, const RowHits& hits, std::size_t first_ray,
                                   PacketRays& rays) {
    const Mask8 nearest = hits.certain & (hits.first > Float8::load(&rays.sure_from[first_ray])) &
                          (hits.last < Float8::load(&rays.sure_to[first_ray])) &
                          (hits.last < Float8::load(&first_[first_ray]));
    const std::uint32_t replaced = nearest.bits();
    // Without asking first whether any is replaced: one mostly is. Its planes are looked at when the walk is over.
    for (const TrianglePlane& plane : tree_.planes[quad].side) __builtin_prefetch(&plane);
    replace(quad, nearest, replaced, hits, first_ray);
    const Float8 limit = Float8::load(&rays.limit[first_ray]);
    PacketRays::put(rays.limit, first_ray, simd::minimum(simd::select(nearest, hits.last, limit), limit));
    const std::uint32_t rest = met & ~replaced;
    return (rest != 0 && add_others(quad, rest, hits, first_ray, rays)) || replaced != 0;
  }

  /// The hit when the walk is over, `no_hit` where there is none.
  [[gnu::always_inline]] TriangleHit decide(std::uint32_t index, float limit) {
    if ((others_ >> index & 1U) != 0) return decide_among(index, limit);
    if (!is_held(index)) return no_hit;
    const ClosestCandidates::Candidate nearest = held(index);
    const TrianglePlane& plane = likely_plane(tree_, nearest.quad, nearest.certainty);
    const auto& ray = source_.ray(index);
    // As seldom as a list: what goes there is out of line already.
    if (!is_told_by(plane, nearest.certainty, ray)) return decide_among(index, limit);
    ++counters_.primitives_tested;
    const double t = plane.t_of(ray);
    return is_in_range(t, ray) ? TriangleHit{t, plane.triangle} : no_hit;
  }

 private:
  static constexpr float nowhere = std::numeric_limits<float>::infinity();

  bool is_held(std::uint32_t ray) const { return first_[ray] < nowhere; }
  /// The quad is surely met.
  ClosestCandidates::Candidate held(std::uint32_t ray) const {
    const auto certainty = static_cast<QuadCertainty>(1 + (side_[0] >> ray & 1U) + 2 * (side_[1] >> ray & 1U));
    return {std::bit_cast<std::uint32_t>(quad_[ray]), first_[ray], certainty};
  }

  [[gnu::always_inline]] void replace(std::uint32_t quad, const Mask8& which, RayMask bits, const RowHits& hits,
                                      std::size_t first_ray) {
    const auto write = [&](PacketRays::Numbers & row, const Float8& numbers) __attribute__((always_inline)) {
      PacketRays::put(row, first_ray, simd::select(which, numbers, Float8::load(&row[first_ray])));
    };
    write(first_, hits.first);
    write(quad_, Float8(std::bit_cast<float>(quad)));
    for (std::size_t at = 0; at < side_.size(); ++at) {
      side_[at] = (side_[at] & ~(bits << first_ray)) | ((hits.side[at] & bits) << first_ray);
    }
  }

  [[gnu::noinline]] bool add_others(std::uint32_t quad, std::uint32_t which, const RowHits& hits, std::size_t first_ray,
                                    PacketRays& rays) {
    bool is_changed = false;
    for (; which != 0; which &= which - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(which));
      const std::size_t ray = first_ray + lane;
      if (ray >= source_.size() || source_.filter(ray).ignores(tree_.leaves[quad / simd_lanes].object)) continue;
      const float before = rays.limit[ray];
      list(ray).offer({quad, hits.first[lane], hits.certainty(lane)}, hits.last[lane], tree_, source_.ray(ray),
                      source_.filter(ray), rays.limit[ray], counters_);
      is_changed = is_changed || rays.limit[ray] != before;
    }
    return is_changed;
  }

  [[gnu::noinline]] TriangleHit decide_among(std::uint32_t index, float limit) {
    const Ray<double>& ray = source_.ray(index);
    ClosestCandidates& all = list(index);
    if (is_held(index)) all.add(held(index), tree_, ray, limit, counters_);
    return all.decide(tree_, ray, limit, counters_);
  }

  /// Made when it is first asked for: to make all would cost more than a walk.
  ClosestCandidates& list(std::size_t ray) {
    auto* const place = reinterpret_cast<ClosestCandidates*>(lists_[ray].data());
    if ((others_ >> ray & 1U) != 0) return *std::launder(place);
    others_ |= RayMask{1} << ray;
    return *new (place) ClosestCandidates();
  }

  const WideArrays& tree_;
  TraversalCounters& counters_;
  Source source_;
  alignas(32) PacketRays::Numbers first_, quad_;  ///< infinite where nothing is held; the bits of its number
  std::array<RayMask, 2> side_;                   ///< as RowHits::side
  RayMask others_;                                ///< rays with a list
  alignas(ClosestCandidates) std::array<std::array<std::byte, sizeof(ClosestCandidates)>, PacketRays::capacity> lists_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
