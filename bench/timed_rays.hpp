#pragma once
/// Rays that every tree of a benchmark gets, and the loop over them that is timed.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "bench/bench_program.hpp"
#include "dcem/accel/counters.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/geometry/ray.hpp"
#if defined(DCEM_HAS_EMBREE)
#include <xmmintrin.h>
#endif

namespace dcem::bench {

/// The closest single-precision numbers: then trees that count in those get the same rays as the others.
inline Vec3 as_float(const Vec3& point) {
  return {static_cast<double>(static_cast<float>(point.x)), static_cast<double>(static_cast<float>(point.y)),
          static_cast<double>(static_cast<float>(point.z))};
}

/// Calls `work(first, last, counters)` for pieces of a row of questions; the time is that of the calls, milliseconds.
template <typename Work>
double timed_pieces(std::size_t count, unsigned threads, TraversalCounters& counters, Work&& work) {
  const std::size_t piece = threads > 1 ? 2048 : std::max<std::size_t>(count, 1);
  std::vector<TraversalCounters> spent(threads);
  const Stopwatch watch;
  parallel_for((count + piece - 1) / piece, threads, [&](std::size_t index, unsigned worker) {
#if defined(DCEM_HAS_EMBREE)
    if (worker != 0) _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);  // as Embree asks for
#endif
    TraversalCounters sum;
    work(index * piece, std::min((index + 1) * piece, count), sum);
    spent[worker] += sum;
  });
  const double elapsed_ms = watch.elapsed_ms();
  for (const TraversalCounters& sum : spent) counters += sum;
  return elapsed_ms;
}

/// Asks one question of all rays and keeps the answers, `ask(ray, counters)`; the time is that of the loop,
/// milliseconds.
template <typename Answer, typename Ask>
double timed(const std::vector<Ray<double>>& rays, std::vector<Answer>& answers, TraversalCounters& counters,
             unsigned threads, Ask&& ask) {
  return timed_pieces(rays.size(), threads, counters, [&](std::size_t first, std::size_t last, TraversalCounters& sum) {
    for (std::size_t ray = first; ray < last; ++ray) answers[ray] = ask(rays[ray], sum);
  });
}

}  // namespace dcem::bench
