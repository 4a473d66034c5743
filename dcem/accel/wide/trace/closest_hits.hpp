#pragma once
/// Closest hits of many rays: dense neighbours from one point go together, others from one point one by one, and rays
/// from many points as a stream.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/packet.hpp"
#include "dcem/accel/wide/trace/queries.hpp"
#include "dcem/accel/wide/trace/stream.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Rays that follow one another, have one origin and point close to where the first of them does. A packet pays where
/// its rays are dense: those of a sphere of 20,000 are, those of a sphere of 2,000 go faster alone.
class PacketRun {
 public:
  static constexpr std::size_t least = 8;  ///< fewer are faster one by one

  /// How many of the first queries may go as one packet.
  static std::size_t length(std::span<const RayQuery> queries) {
    const Ray<double>& first = queries.front().ray;
    if (first.t_min != 0.0) return 1;
    const double ahead_squared = glm::dot(first.direction, first.direction);
    const std::size_t most = std::min(queries.size(), RayPacket::capacity);
    std::size_t count = 1;
    for (; count < most; ++count) {
      const Ray<double>& ray = queries[count].ray;
      if (ray.origin != first.origin || ray.t_min != 0.0) break;
      const double along = glm::dot(first.direction, ray.direction);
      const double least_squared = count < least ? least_dense_cosine_squared : least_cosine_squared;
      if (!(along > 0.0 && along * along >= least_squared * ahead_squared * glm::dot(ray.direction, ray.direction))) {
        break;
      }
    }
    return count;
  }

 private:
  static constexpr double least_dense_cosine_squared = 0.99;  ///< of the first ones: 6 degrees
  static constexpr double least_cosine_squared = 0.92;        ///< wider packets test more boxes that few rays meet
};

/// How many of the first queries have each an origin of its own: what one of them needs the one before it has not
/// fetched, and a stream hides the waiting even where the outer caches hold the tree.
inline std::size_t unlike_neighbours(std::span<const RayQuery> queries) {
  std::size_t count = 1;
  while (count < queries.size() && queries[count].ray.origin != queries[count - 1].ray.origin) ++count;
  return count;
}

inline void closest_hits(const WideArrays& tree, std::span<const RayQuery> queries,
                         std::span<std::optional<TriangleHit>> hits, TraversalCounters& counters) {
  if (tree.nodes.empty()) {
    std::ranges::fill(hits, std::nullopt);
    return;
  }
  std::size_t first_alone = 0, next = 0;
  const auto trace_alone = [&] {
    while (first_alone < next) {
      const auto rest = queries.subspan(first_alone, next - first_alone);
      const std::size_t count = unlike_neighbours(rest);
      if (count >= ClosestStream::least) {
        ClosestStream(tree, rest.first(count), hits.subspan(first_alone, count), counters).run();
        first_alone += count;
        continue;
      }
      const std::size_t end = first_alone + std::max<std::size_t>(count, 1);
      for (; first_alone < end; ++first_alone) {
        const RayQuery& query = queries[first_alone];
        hits[first_alone] = count > 1 ? closest_hit(tree, query.ray, query.filter, counters)
                                      : closest_hit_of_one<true>(tree, query.ray, query.filter, counters);
      }
    }
  };
  while (next < queries.size()) {
    const std::size_t count = PacketRun::length(queries.subspan(next));
    if (count < PacketRun::least) {
      next += count;
      continue;
    }
    RayPacket packet(tree, queries.subspan(next, count), hits.subspan(next, count), counters);
    if (packet.prepare()) {
      trace_alone();
      packet.trace();
      first_alone = next + count;
    }
    next += count;
  }
  trace_alone();
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
