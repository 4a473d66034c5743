#pragma once
/// The quads of which one may hold the closest hit: collected by a walk in single precision, decided in double at its
/// end.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/trace/exact.hpp"
#include "dcem/accel/wide/trace/ray.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// In place of a hit where there is none: hits lie at finite t.
inline constexpr TriangleHit no_hit{std::numeric_limits<double>::infinity()};

/// As take_nearer, number by number: an optional hit as a whole would be read from memory before what is written in
/// pieces has arrived there, which costs as much as a leaf.
[[gnu::always_inline]] inline void take_if_nearer(const TriangleHit& hit, TriangleHit& best) {
  if (hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle)) best = hit;
}
[[gnu::always_inline]] inline void answer(const TriangleHit& hit, std::optional<TriangleHit>& place) {
  if (hit.t < no_hit.t) {
    place.emplace(hit);
  } else {
    place.reset();
  }
}

/// The plane of the triangle of a quad that a ray meets, if that is known; else of the first one.
[[gnu::always_inline]] inline const TrianglePlane& likely_plane(const WideArrays& tree, std::uint32_t quad,
                                                                QuadCertainty certainty) {
  return tree.planes[quad].side[certainty == QuadCertainty::second ? 1 : 0];
}
/// Whether that plane tells where the ray meets the quad: its triangle is the one that is met, and the ray steep
/// enough.
[[gnu::always_inline]] inline bool is_told_by(const TrianglePlane& plane, QuadCertainty certainty,
                                              const Ray<double>& ray) {
  const bool is_known = certainty == QuadCertainty::met ? plane.is_alone() : certainty != QuadCertainty::undecided;
  return is_known && plane.is_steep(ray);
}

/// The nearest hit on a quad that passes a filter.
[[gnu::always_inline]] inline TriangleHit hit_on(const WideArrays& tree, std::uint32_t quad, QuadCertainty certainty,
                                                 const Ray<double>& ray, const HitFilter& filter) {
  const TrianglePlane& plane = likely_plane(tree, quad, certainty);
  if (is_told_by(plane, certainty, ray)) {
    const TriangleHit hit{plane.t_of(ray), plane.triangle};
    return is_in_range(hit.t, ray) && filter.passes(hit) ? hit : no_hit;
  }
  return quad_hit(tree, quad, ray, filter).value_or(no_hit);
}
/// The same, kept out of the walks, which it would slow down although it is seldom called.
[[gnu::noinline]] inline TriangleHit asked_hit_on(const WideArrays& tree, std::uint32_t quad, QuadCertainty certainty,
                                                  const Ray<double>& ray, const HitFilter& filter) {
  return hit_on(tree, quad, certainty, ray, filter);
}

/// The closest hit of one ray, as far as it is known.
class ClosestCandidates {
 public:
  /// No initial values: most of the room is never used.
  ClosestCandidates() : count_(0), best_(no_hit) {}

  /// Takes over what a leaf has of the ray between t_min and `limit`, which a sure hit lowers at once (padded).
  [[gnu::always_inline]] void take(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                                   std::uint32_t leaf, std::uint32_t met, const QuadHits& hits, float& limit,
                                   TraversalCounters& counters) {
    if (filter.ignores(tree.leaves[leaf].object)) return;
    alignas(32) std::array<float, simd_lanes> first, last;
    hits.first.store(first);
    hits.last.store(last);
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      if (first[lane] > limit) continue;
      offer({leaf * simd_lanes + lane, first[lane], hits.certainty(lane)}, last[lane], tree, ray, filter, limit,
            counters);
    }
  }

  /// A quad.
  struct Candidate {
    std::uint32_t quad;
    float first;  ///< the hit is no nearer
    QuadCertainty certainty;
  };

  [[gnu::always_inline]] void offer(const Candidate& candidate, float last, const WideArrays& tree,
                                    const Ray<double>& ray, const HitFilter& filter, float& limit,
                                    TraversalCounters& counters) {
    if (filter.counts != nullptr && !filter.is_sure(static_cast<double>(candidate.first), static_cast<double>(last))) {
      return ask(tree, ray, filter, candidate, limit, counters);
    }
    // The plane's t may lie beyond what is asked for by a rounding: then it shortens nothing.
    const bool is_certain = candidate.certainty != QuadCertainty::undecided;
    if (is_certain && static_cast<double>(last) < ray.t_max) limit = std::min(limit, last);
    add(candidate, tree, ray, limit, counters);
  }

  [[gnu::always_inline]] void add(const Candidate& candidate, const WideArrays& tree, const Ray<double>& ray,
                                  float limit, TraversalCounters& counters) {
    // Looked at when the walk is over; where nothing is known of the side, the first one is as good as the other.
    __builtin_prefetch(&likely_plane(tree, candidate.quad, candidate.certainty));
    if (count_ == held_.size()) drop_beyond(limit);
    if (count_ < held_.size()) {
      held_[count_++] = candidate;
    } else {
      look_at(candidate, tree, ray, best_, counters);
    }
  }

  /// The hit when the walk is over, `no_hit` where there is none.
  [[gnu::always_inline]] TriangleHit decide(const WideArrays& tree, const Ray<double>& ray, float limit,
                                            TraversalCounters& counters) {
    TriangleHit best = best_;
    for (std::uint32_t index = 0; index < count_; ++index) {
      if (!(held_[index].first > limit)) look_at(held_[index], tree, ray, best, counters);
    }
    return best;
  }

 private:
  void drop_beyond(float limit) {
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < count_; ++index) {
      if (!(held_[index].first > limit)) held_[kept++] = held_[index];
    }
    count_ = kept;
  }

  /// Kept out of the walks, which it would slow down although it is seldom called.
  [[gnu::noinline]] void ask(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                             const Candidate& candidate, float& limit, TraversalCounters& counters) {
    ++counters.primitives_tested;
    const TriangleHit hit = hit_on(tree, candidate.quad, candidate.certainty, ray, filter);
    if (!(hit.t < no_hit.t)) return;
    take_if_nearer(hit, best_);
    limit = std::min(limit, WideRay::padded(best_.t));
  }

  /// Takes over where the ray meets a quad, if that is nearer. The answer is the same whatever is known.
  [[gnu::always_inline]] static void look_at(const Candidate& candidate, const WideArrays& tree, const Ray<double>& ray,
                                             TriangleHit& best, TraversalCounters& counters) {
    ++counters.primitives_tested;
    take_if_nearer(hit_on(tree, candidate.quad, candidate.certainty, ray, HitFilter{}), best);
  }

  std::array<Candidate, 24> held_;
  std::uint32_t count_;
  TriangleHit best_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
