#pragma once
/// A loop whose iterations run on several threads. Each iteration writes only its own slot of a result array, so the
/// outcome does not depend on the number of threads or on which thread took which index.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace dcem {

/// Number of threads to use: `requested`, or all hardware threads when it is 0.
inline unsigned resolve_thread_count(unsigned requested) {
  return requested != 0 ? requested : std::max(1U, std::thread::hardware_concurrency());
}

/// Calls `body(index, worker)` for index = 0 … count−1; `worker` in 0 … threads−1 names the calling thread, for scratch
/// space. The first exception of any iteration stops the loop and is thrown here.
template <typename Body>
void parallel_for(std::size_t count, unsigned threads, Body&& body) {
  const auto workers = static_cast<unsigned>(std::min<std::size_t>(resolve_thread_count(threads), count));
  if (workers <= 1) {
    for (std::size_t index = 0; index < count; ++index) body(index, 0U);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&](unsigned worker) {
    try {
      for (std::size_t index = next++; index < count; index = next++) body(index, worker);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> pool;
  try {
    for (unsigned worker = 1; worker < workers; ++worker) pool.emplace_back(work, worker);
  } catch (const std::system_error&) {
    // The system gives no more threads: those that are there, and this one, do the work.
  }
  work(0);
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace dcem
