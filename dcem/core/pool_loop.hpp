#pragma once
/// One loop of a thread pool: its iterations are taken by whoever works on it.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <utility>

#include "dcem/core/work_times.hpp"

namespace dcem::detail {

/// Where a thread is that works on a loop.
struct LoopPlace {
  const void* pool = nullptr;  ///< none: in no loop
  unsigned worker = 0;         ///< what the pool calls the thread
};
inline thread_local LoopPlace loop_place;

struct PoolLoop {
  std::size_t count;
  void* body;
  void (*call)(void* body, std::size_t index, unsigned worker);
  unsigned owner = 0;    ///< the worker that asks for it
  unsigned helpers = 0;  ///< that are within a loop within a loop, its owner aside; the pool counts them
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure{};
  std::mutex mutex{};  ///< of what stands above and below it
  LoopTimes all{}, of_owner{};

  /// Does iterations until none is left; returns how long. An exception of one stops the loop.
  LoopTimes work(const LoopPlace& place);

 private:
  void note(const LoopTimes& times, unsigned worker);
};

// ---------------------------------------------------------------------------------------------------------------------

inline LoopTimes PoolLoop::work(const LoopPlace& place) {
  const LoopPlace before = std::exchange(loop_place, place);
  LoopWatch watch;
  try {
    for (std::size_t index = next++; index < count; index = next++) {
      call(body, index, place.worker);
      watch.lap();
    }
  } catch (...) {
    const std::lock_guard lock(mutex);
    if (!failure) failure = std::current_exception();
    next = count;
  }
  const LoopTimes times = watch.finish();
  note(times, place.worker);
  loop_place = before;
  return times;
}

inline void PoolLoop::note(const LoopTimes& times, unsigned worker) {
  const std::lock_guard lock(mutex);
  all.busy_s += times.busy_s + times.of_others_s;
  all.longest_task_s = std::max(all.longest_task_s, times.longest_task_s);
  all.tasks += times.tasks;
  if (worker == owner) of_owner = times;
}

}  // namespace dcem::detail
