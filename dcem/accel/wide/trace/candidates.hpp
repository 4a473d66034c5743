#pragma once
/// The quads of which one may hold the closest hit: collected by a walk in single precision, decided in double at its
/// end.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/trace/exact.hpp"
#include "dcem/accel/wide/trace/ray.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// The closest hit of one ray, as far as it is known.
class ClosestCandidates {
 public:
  /// No initial values: most of the room is never used.
  ClosestCandidates() : count_(0) {}

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
      const std::uint32_t quad = leaf * simd_lanes + lane;
      if (filter.counts != nullptr &&
          !filter.is_sure(static_cast<double>(first[lane]), static_cast<double>(last[lane]))) {
        ask(tree, ray, filter, quad, limit, counters);
        continue;
      }
      // The plane's t may lie beyond what is asked for by a rounding: then it shortens nothing.
      if (hits.is_certain(lane) && static_cast<double>(last[lane]) < ray.t_max) limit = std::min(limit, last[lane]);
      add({quad, first[lane], hits.certainty(lane)}, tree, ray, limit, counters);
    }
  }

  /// The hit, when the walk is over.
  [[gnu::always_inline]] std::optional<TriangleHit> decide(const WideArrays& tree, const Ray<double>& ray, float limit,
                                                           TraversalCounters& counters) {
    for (std::uint32_t index = 0; index < count_; ++index) {
      if (!(held_[index].first > limit)) look_at(held_[index], tree, ray, counters);
    }
    return best_;
  }

 private:
  struct Candidate {
    std::uint32_t quad;
    float first;  ///< the hit is no nearer
    QuadCertainty certainty;
  };

  [[gnu::always_inline]] void add(const Candidate& candidate, const WideArrays& tree, const Ray<double>& ray,
                                  float limit, TraversalCounters& counters) {
    // Looked at when the walk is over; where nothing is known of the side, the first one is as good as the other.
    __builtin_prefetch(&tree.planes[candidate.quad].side[candidate.certainty == QuadCertainty::second ? 1 : 0]);
    if (count_ == held_.size()) drop_beyond(limit);
    if (count_ < held_.size()) {
      held_[count_++] = candidate;
    } else {
      look_at(candidate, tree, ray, counters);
    }
  }

  void drop_beyond(float limit) {
    std::uint32_t kept = 0;
    for (std::uint32_t index = 0; index < count_; ++index) {
      if (!(held_[index].first > limit)) held_[kept++] = held_[index];
    }
    count_ = kept;
  }

  /// Kept out of the walks, which it would slow down although it is seldom called.
  [[gnu::noinline]] void ask(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                             std::uint32_t quad, float& limit, TraversalCounters& counters) {
    ++counters.primitives_tested;
    const std::optional<TriangleHit> hit = quad_hit(tree, quad, ray, filter);
    if (!hit) return;
    take_nearer(*hit, best_);
    limit = std::min(limit, WideRay::padded(best_->t));
  }

  /// Takes over where the ray meets a quad, if that is nearer. The answer is the same whatever is known.
  [[gnu::always_inline]] void look_at(const Candidate& candidate, const WideArrays& tree, const Ray<double>& ray,
                                      TraversalCounters& counters) {
    ++counters.primitives_tested;
    const QuadPlanes& planes = tree.planes[candidate.quad];
    const TrianglePlane& plane = planes.side[candidate.certainty == QuadCertainty::second ? 1 : 0];
    const bool is_known =
        candidate.certainty == QuadCertainty::met ? plane.is_alone() : candidate.certainty != QuadCertainty::undecided;
    if (is_known && plane.is_steep(ray)) {
      const double t = plane.t_of(ray);
      if (is_in_range(t, ray)) take_nearer({t, plane.triangle}, best_);
    } else if (const auto hit = quad_hit(tree, candidate.quad, ray, HitFilter{})) {
      take_nearer(*hit, best_);
    }
  }

  std::array<Candidate, 24> held_;
  std::uint32_t count_;
  std::optional<TriangleHit> best_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
