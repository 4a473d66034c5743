#pragma once
/// How a `WideBvh` answers; included by wide_tree.hpp.
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

namespace detail {

/// Adds what a query spent to the caller's counters, when there are any.
class SpentCounters {
 public:
  explicit SpentCounters(TraversalCounters* sum) : sum_(sum) {}
  ~SpentCounters() {
    if (sum_ != nullptr) *sum_ += spent;
  }
  SpentCounters(const SpentCounters&) = delete;
  SpentCounters& operator=(const SpentCounters&) = delete;

  TraversalCounters spent;

 private:
  TraversalCounters* sum_;
};

}  // namespace detail

inline Aabb<double> WideBvh::in_world(const Aabb<float>& box) const {
  if (box.empty()) return {};
  Aabb<double> result;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(box.min[axis]), high = static_cast<double>(box.max[axis]);
    const double origin = arrays_.origin_m[axis];
    // The sum is rounded once, by less than this.
    result.min[axis] = origin + low - (std::abs(origin) + std::abs(low)) * 0x1p-51;
    result.max[axis] = origin + high + (std::abs(origin) + std::abs(high)) * 0x1p-51;
  }
  return result;
}

template <typename Considers>
std::optional<TriangleHit> WideBvh::closest_hit(const Ray<double>& ray, Considers&& considers,
                                                TraversalCounters* counters) const {
  // Counted where the caller wants it: a sum that is added at the end would be read before it is all written.
  TraversalCounters unwanted;
  TraversalCounters& spent = counters != nullptr ? *counters : unwanted;
  if (primitive_count() == 0) return std::nullopt;
  const WideRay wide(ray, arrays_.origin_m, arrays_.extent_m);
  if (!wide.usable()) return closest_of_all(ray, considers, spent);
  return closest_among(ray, wide, considers, spent);
}

/// The walk collects what may be the closest_hit, and a sure hit shortens it at once; double precision looks at what is
/// left at the end, which is one quad as a rule.
template <typename Considers>
std::optional<TriangleHit> WideBvh::closest_among(const Ray<double>& ray, const WideRay& wide, Considers& considers,
                                                  TraversalCounters& counters) const {
  detail::WideCandidates candidates;
  float limit = WideRay::padded(ray.t_max);
  std::optional<TriangleHit> best;
  const auto look_at = [&](const detail::WideCandidates::Candidate& candidate) {
    ++counters.primitives_tested;
    offer(candidate.quad, ray, candidate.known, best);
  };
  const auto take = [&](std::uint32_t leaf_index, std::uint32_t met, const Hits& hits, float& walk_limit) {
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      const std::uint32_t quad = leaf_index * simd_lanes + lane;
      if (hits.first[lane] > limit) continue;
      if (!is_considered(quad, considers)) continue;
      const bool certain = has(hits.certain, lane);
      // The plane's t may lie beyond what is asked for by a rounding: then it shortens nothing.
      if (certain && static_cast<double>(hits.last[lane]) < ray.t_max) limit = std::min(limit, hits.last[lane]);
      const detail::WideCandidates::Candidate candidate{quad, hits.first[lane], hits.known(lane)};
      // Looked at when the walk is over; where nothing is known of the side, the first one is as good as the other.
      __builtin_prefetch(&arrays_.planes[quad].side[candidate.known == Known::second ? 1 : 0]);
      if (!candidates.add(candidate, limit)) look_at(candidate);
    }
    walk_limit = limit;
  };
  detail::walk_wide_closest(view(), wide, limit, take, counters);
  for (const detail::WideCandidates::Candidate& candidate : candidates.held()) {
    if (!(candidate.first > limit)) look_at(candidate);
  }
  return best;
}

/// For rays that single precision does not follow.
template <typename Considers>
std::optional<TriangleHit> WideBvh::closest_of_all(const Ray<double>& ray, Considers& considers,
                                                   TraversalCounters& counters) const {
  std::optional<TriangleHit> best;
  if (!has_direction(ray)) return best;
  for_each_present_quad([&](std::uint32_t quad) {
    ++counters.primitives_tested;
    if (is_considered(quad, considers)) offer(quad, ray, Known::nothing, best);
    return false;
  });
  return best;
}

template <typename Considers>
bool WideBvh::occluded(const Ray<double>& ray, Considers&& considers, TraversalCounters* counters,
                       std::optional<std::uint32_t> first_try) const {
  detail::SpentCounters sum(counters);
  if (primitive_count() == 0) return false;
  const auto leaves = [&](std::uint32_t quad, bool certain) {
    if (!is_considered(quad, considers)) return false;
    ++sum.spent.primitives_tested;
    return certain || hit_on(quad, ray);
  };
  if (first_try && *first_try < primitive_count() && arrays_.is_there[*first_try] != 0 && has_direction(ray) &&
      leaves(arrays_.quad_of_triangle[*first_try], false)) {
    return true;
  }
  const WideRay wide(ray, arrays_.origin_m, arrays_.extent_m);
  if (!wide.usable()) return closest_of_all(ray, considers, sum.spent).has_value();
  const auto take = [&](std::uint32_t leaf_index, std::uint32_t met, const Hits& hits) {
    return detail::any_lane(met, [&](std::uint32_t lane) {
      const bool certain = has(hits.certain, lane) && static_cast<double>(hits.last[lane]) < ray.t_max;
      return leaves(leaf_index * simd_lanes + lane, certain);
    });
  };
  return detail::walk_wide_any(view(), wide, WideRay::padded(ray.t_max), take, sum.spent);
}

template <typename Leaf>
void WideBvh::closest(const Ray<double>& ray, Leaf&& leaf, TraversalCounters* counters) const {
  detail::SpentCounters sum(counters);
  if (primitive_count() == 0) return;
  double t_max = ray.t_max;
  const auto ask = [&](std::uint32_t quad, Known known) {
    for (const TrianglePlane& half : halves_to_ask(quad, known)) {
      ++sum.spent.primitives_tested;
      leaf(half.triangle, t_max);
    }
  };
  const WideRay wide(ray, arrays_.origin_m, arrays_.extent_m);
  if (!wide.usable()) {
    for_each_present_quad([&](std::uint32_t quad) {
      ask(quad, Known::nothing);
      return false;
    });
    return;
  }
  const auto take = [&](std::uint32_t leaf_index, std::uint32_t met, const Hits& hits, float& limit) {
    while (met != 0) {
      auto lane = static_cast<std::uint32_t>(std::countr_zero(met));
      detail::any_lane(met & (met - 1), [&](std::uint32_t other) {
        if (hits.first[other] < hits.first[lane]) lane = other;
        return false;
      });
      met &= ~(1U << lane);
      if (hits.first[lane] > limit) continue;
      ask(leaf_index * simd_lanes + lane, hits.known(lane));
      limit = WideRay::padded(t_max);
    }
  };
  detail::walk_wide_closest(view(), wide, WideRay::padded(t_max), take, sum.spent);
}

template <typename Leaf>
bool WideBvh::any(const Ray<double>& ray, Leaf&& leaf, TraversalCounters* counters) const {
  detail::SpentCounters sum(counters);
  if (primitive_count() == 0) return false;
  const auto ask = [&](std::uint32_t quad, Known known) {
    return std::ranges::any_of(halves_to_ask(quad, known), [&](const TrianglePlane& half) {
      ++sum.spent.primitives_tested;
      return leaf(half.triangle);
    });
  };
  const WideRay wide(ray, arrays_.origin_m, arrays_.extent_m);
  if (!wide.usable()) {
    return for_each_present_quad([&](std::uint32_t quad) { return ask(quad, Known::nothing); });
  }
  const auto take = [&](std::uint32_t leaf_index, std::uint32_t met, const Hits& hits) {
    return detail::any_lane(met,
                            [&](std::uint32_t lane) { return ask(leaf_index * simd_lanes + lane, hits.known(lane)); });
  };
  return detail::walk_wide_any(view(), wide, WideRay::padded(ray.t_max), take, sum.spent);
}

template <typename Keep, typename Leaf>
void WideBvh::visit(Keep&& keep_box, Leaf&& leaf, TraversalCounters* counters) const {
  visit_where([&](const Aabb<float>& box) { return keep_box(in_world(box)); }, keep_box, leaf, counters);
}

template <typename Leaf>
void WideBvh::overlapping(const Aabb<double>& box, Leaf&& leaf, TraversalCounters* counters) const {
  const Aabb<double> region = canonical_box(box);
  // Both rounded outwards: what overlaps in double overlaps in single precision.
  visit_where([rounded = arrays_.rounded_out(region)](const Aabb<float>& held) { return rounded.overlaps(held); },
              [&](const Aabb<double>& held) { return region.overlaps(held); }, leaf, counters);
}

template <typename KeepEntry, typename Keep, typename Leaf>
void WideBvh::visit_where(KeepEntry&& keep_entry, Keep&& keep_box, Leaf& leaf, TraversalCounters* counters) const {
  detail::SpentCounters sum(counters);
  if (primitive_count() == 0) return;
  const auto take = [&](std::uint32_t leaf_index) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      if (!has(arrays_.leaves[leaf_index].lanes, lane)) continue;
      for (const std::uint32_t triangle : arrays_.quads[leaf_index * simd_lanes + lane].triangles()) {
        if (arrays_.is_there[triangle] == 0 || !keep_box(arrays_.box_of(triangle))) continue;
        ++sum.spent.primitives_tested;
        leaf(triangle);
      }
    }
  };
  detail::walk_wide_boxes(view(), keep_entry, take, sum.spent);
}

}  // namespace dcem
