#pragma once
/// Threads that wait for loops. Each iteration of a loop writes only its own slot of a result array, so the outcome
/// does not depend on the number of threads or on which thread took which index.
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <type_traits>
#include <vector>

#include "dcem/core/work_times.hpp"

namespace dcem {

/// Number of threads to use: `requested`, or all hardware threads when it is 0.
inline unsigned resolve_thread_count(unsigned requested) {
  return requested != 0 ? requested : std::max(1U, std::thread::hardware_concurrency());
}

/// The calling thread and others, which are started when they are first needed and end with the pool. Where the system
/// gives no more threads, those that are there do the work.
class ThreadPool {
 public:
  /// `threads`: how many work on a loop, the caller included; 0: as many as the machine has.
  explicit ThreadPool(unsigned threads = 0) : size_(resolve_thread_count(threads)) {}
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned size() const { return size_; }

  /// Calls `body(index, worker)` for index = 0 … count−1; `worker` in 0 … size()−1 names the calling thread, for
  /// scratch space. The first exception of any iteration stops the loop and is thrown here. Loops of several threads
  /// take turns; a loop within a loop runs on the thread that asks for it. `work_times` of the calling thread has what
  /// they took; a loop of one iteration, or within a loop, is like any other code.
  template <typename Body>
  void for_each(std::size_t count, Body&& body);
  /// `body(index)` for each index, in blocks: for iterations so quick that a few are not worth waking anybody.
  template <typename Body>
  void for_each_quick(std::size_t count, Body&& body);

 private:
  struct Loop {
    std::size_t count;
    void* body;
    void (*call)(void* body, std::size_t index, unsigned worker);
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure{};
    std::mutex mutex{};  ///< of what stands below and above it
    detail::LoopTimes all{}, of_caller{};

    void work(unsigned worker);
    void note(const detail::LoopTimes& times, unsigned worker);
  };

  void start(unsigned workers);
  void run(Loop& loop, unsigned workers);
  void share(Loop& loop, unsigned workers);
  void wait_for_loops(unsigned worker, std::uint64_t begun);

  static inline thread_local bool is_within_loop_ = false;

  unsigned size_;
  std::mutex turn_;  ///< one loop at a time
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> threads_;
  Loop* loop_ = nullptr;
  unsigned workers_ = 0;        ///< that take part in the loop, the caller among them
  unsigned still_working_ = 0;  ///< of the threads of this pool
  std::uint64_t loops_begun_ = 0;
  bool ends_ = false;
};

/// The same loop on threads that live as long as it does.
template <typename Body>
void parallel_for(std::size_t count, unsigned threads, Body&& body) {
  ThreadPool(threads).for_each(count, body);
}

// ---------------------------------------------------------------------------------------------------------------------

template <typename Body>
void ThreadPool::for_each(std::size_t count, Body&& body) {
  const auto workers = static_cast<unsigned>(std::min<std::size_t>(size_, count));
  if (count <= 1 || is_within_loop_) {
    for (std::size_t index = 0; index < count; ++index) body(index, 0U);
    return;
  }
  using Called = std::remove_reference_t<Body>;
  Loop loop{count, const_cast<void*>(static_cast<const void*>(&body)),
            [](void* called, std::size_t index, unsigned worker) { (*static_cast<Called*>(called))(index, worker); }};
  run(loop, workers);
}

template <typename Body>
void ThreadPool::for_each_quick(std::size_t count, Body&& body) {
  constexpr std::size_t block = 64;
  for_each((count + block - 1) / block, [&](std::size_t number, unsigned) {
    for (std::size_t index = number * block; index < std::min(count, (number + 1) * block); ++index) body(index);
  });
}

inline void ThreadPool::Loop::work(unsigned worker) {
  is_within_loop_ = true;
  detail::LoopWatch watch;
  try {
    for (std::size_t index = next++; index < count; index = next++) {
      call(body, index, worker);
      watch.lap();
    }
  } catch (...) {
    const std::lock_guard lock(mutex);
    if (!failure) failure = std::current_exception();
    next = count;
  }
  note(watch.times(), worker);
  is_within_loop_ = false;
}

inline void ThreadPool::Loop::note(const detail::LoopTimes& times, unsigned worker) {
  const std::lock_guard lock(mutex);
  all.busy_s += times.busy_s;
  all.longest_task_s = std::max(all.longest_task_s, times.longest_task_s);
  if (worker == 0) of_caller = times;
}

inline void ThreadPool::run(Loop& loop, unsigned workers) {
  workers == 1 ? loop.work(0) : share(loop, workers);
  detail::asked_work.add(loop.of_caller, loop.all);
  if (loop.failure) std::rethrow_exception(loop.failure);
}

inline void ThreadPool::share(Loop& loop, unsigned workers) {
  const std::lock_guard turn(turn_);
  start(workers);
  {
    const std::lock_guard lock(mutex_);
    loop_ = &loop;
    workers_ = workers;
    still_working_ = static_cast<unsigned>(threads_.size());
    ++loops_begun_;
  }
  wake_.notify_all();
  loop.work(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [&] { return still_working_ == 0; });
}

inline void ThreadPool::start(unsigned workers) {
  try {
    while (threads_.size() + 1 < workers) {
      const auto worker = static_cast<unsigned>(threads_.size() + 1);
      threads_.emplace_back([this, worker, begun = loops_begun_] { wait_for_loops(worker, begun); });
    }
  } catch (const std::system_error&) {
    // The system gives no more threads: those that are there, and this one, do the work.
  }
}

inline void ThreadPool::wait_for_loops(unsigned worker, std::uint64_t begun) {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return ends_ || loops_begun_ != begun; });
    if (ends_) return;
    begun = loops_begun_;
    Loop& loop = *loop_;
    if (worker < workers_) {
      lock.unlock();
      loop.work(worker);
      lock.lock();
    }
    if (--still_working_ == 0) done_.notify_one();
  }
}

inline ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

}  // namespace dcem
