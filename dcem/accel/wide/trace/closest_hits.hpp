#pragma once
/// Closest hits of many rays: neighbours from one point go together, others from one point one by one, and rays from
/// many points as a stream.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "dcem/accel/wide/trace/packet.hpp"
#include "dcem/accel/wide/trace/packet_source.hpp"
#include "dcem/accel/wide/trace/queries.hpp"
#include "dcem/accel/wide/trace/stream.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

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
      const std::span<const RayQuery> rest(queries.data() + first_alone, next - first_alone);
      const std::size_t count = unlike_neighbours(rest);
      if (count >= ClosestStream::least) {
        ClosestStream(tree, {rest.data(), count}, {hits.data() + first_alone, count}, counters).run();
        first_alone += count;
        continue;
      }
      const std::size_t end = first_alone + std::max<std::size_t>(count, 1);
      for (; first_alone < end; ++first_alone) {
        const RayQuery& query = queries[first_alone];
        const auto ask = count > 1 ? closest_hit_of_one<false> : closest_hit_of_one<true>;
        ask(tree, query.ray, query.filter, hits[first_alone], counters);
      }
    }
  };
  const QueriesInTurn all(queries);
  RayPacket packet(tree, all, counters);
  while (next < queries.size()) {
    const std::size_t count = packet.gather(all.part(next, queries.size()), hits.subspan(next));
    if (count >= packet.least) {
      trace_alone();
      packet.trace();
      first_alone = next + count;
    }
    next += count;
  }
  trace_alone();
}

inline void closest_hits_of_fan(const WideArrays& tree, const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
                                TraversalCounters& counters) {
  if (tree.nodes.empty()) {
    std::ranges::fill(hits, std::nullopt);
    return;
  }
  const FanInTurn all(fan);
  RayPacket packet(tree, all, counters);
  for (std::size_t next = 0; next < all.size();) {
    const std::size_t count = packet.gather(all.part(next, all.size()), hits.subspan(next));
    if (count >= packet.least) {
      packet.trace();
      next += count;
      continue;
    }
    for (const std::size_t end = next + count; next < end; ++next) {
      closest_hit_of_one<true>(tree, all.ray(next), fan.filter, hits[next], counters);
    }
  }
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
