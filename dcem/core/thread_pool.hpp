#pragma once
/// Threads that wait for loops. Each iteration of a loop writes only its own slot of a result array, so the outcome
/// does not depend on the number of threads or on which thread took which index.
#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <type_traits>
#include <vector>

#include "dcem/core/pool_loop.hpp"
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
  /// take turns. A loop within a loop of the same pool begins on the thread that asks for it, and those that have
  /// nothing else to do help; of another pool it stays on that thread. `work_times` of the calling thread has what they
  /// took; a loop of one iteration, or of another pool within a loop, is like any other code.
  template <typename Body>
  void for_each(std::size_t count, Body&& body);
  /// `body(index)` for each index, in blocks: for iterations so quick that a few are not worth waking anybody. A block
  /// is to take some ten microseconds: shorter ones cost more than they bring where threads are many.
  template <typename Body>
  void for_each_quick(std::size_t count, Body&& body, std::size_t block = 64);

 private:
  using Loop = detail::PoolLoop;

  void run(Loop& loop);
  void open(Loop& loop);
  void close(Loop& loop);
  void start(std::size_t workers);
  std::size_t take_calls();
  void wake(std::size_t calls);
  detail::LoopTimes help(std::unique_lock<std::mutex>& lock, unsigned worker);
  void wait_for_loops(unsigned worker);
  bool is_within() const { return detail::loop_place.pool == this; }

  unsigned size_;
  std::mutex turn_;  ///< one loop at a time, beside those within it
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> threads_;
  std::vector<Loop*> open_;       ///< that have iterations left, or had when somebody looked
  std::size_t idle_ = 0;          ///< threads that wait for a loop
  std::size_t to_wake_ = 0;       ///< of them, that loops have use for: by those who are woken before
  bool caller_may_help_ = false;  ///< it waits for the others to end the loop that it has asked for
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
  const detail::LoopPlace& place = detail::loop_place;
  const unsigned worker = is_within() ? place.worker : 0;
  if (count <= 1 || (place.pool != nullptr && !is_within())) {
    for (std::size_t index = 0; index < count; ++index) body(index, worker);
    return;
  }
  using Called = std::remove_reference_t<Body>;
  Loop loop{count, const_cast<void*>(static_cast<const void*>(&body)),
            [](void* called, std::size_t index, unsigned by) { (*static_cast<Called*>(called))(index, by); }, worker};
  std::unique_lock turn(turn_, std::defer_lock);
  if (!is_within()) turn.lock();
  run(loop);
}

template <typename Body>
void ThreadPool::for_each_quick(std::size_t count, Body&& body, std::size_t block) {
  for_each((count + block - 1) / block, [&](std::size_t number, unsigned) {
    for (std::size_t index = number * block; index < std::min(count, (number + 1) * block); ++index) body(index);
  });
}

inline void ThreadPool::run(Loop& loop) {
  if (size_ > 1) open(loop);
  loop.work({this, loop.owner});
  if (size_ > 1) close(loop);
  detail::asked_work.add(loop.of_owner, loop.all);
  if (loop.failure) std::rethrow_exception(loop.failure);
}

/// Lets others know of a loop: as many of those that wait as it has use for. To wake one takes some microseconds: with
/// many threads, each of which wakes two more, the caller begins with the loop sooner, and so do most of them.
inline void ThreadPool::open(Loop& loop) {
  const std::size_t wanted = std::min<std::size_t>(size_, loop.count) - 1;
  std::size_t calls = 0;
  {
    const std::lock_guard lock(mutex_);
    start(is_within() ? size_ : wanted + 1);
    if (open_.empty()) to_wake_ = 0;  // what is left was for loops that are over
    open_.push_back(&loop);
    if (caller_may_help_) done_.notify_all();
    to_wake_ += wanted;
    calls = take_calls();
  }
  wake(calls);
}

/// How many threads the calling one is to wake. Under the lock.
inline std::size_t ThreadPool::take_calls() {
  to_wake_ = std::min(to_wake_, idle_);
  const std::size_t calls = std::min<std::size_t>(to_wake_, 2);
  to_wake_ -= calls;
  return calls;
}

inline void ThreadPool::wake(std::size_t calls) {
  for (; calls > 0; --calls) wake_.notify_one();
}

/// Waits until nobody is within a loop any more; who has asked for the outermost one helps with others meanwhile.
inline void ThreadPool::close(Loop& loop) {
  std::unique_lock lock(mutex_);
  std::erase(open_, &loop);
  while (loop.helpers > 0) {
    caller_may_help_ = caller_may_help_ || !is_within();
    done_.wait(lock, [&] { return loop.helpers == 0 || (!is_within() && !open_.empty()); });
    if (loop.helpers > 0) detail::asked_work.own_s += help(lock, loop.owner).busy_s;
  }
  if (!is_within()) caller_may_help_ = false;
}

inline void ThreadPool::start(std::size_t workers) {
  try {
    while (threads_.size() + 1 < workers) {
      const auto worker = static_cast<unsigned>(threads_.size() + 1);
      threads_.emplace_back([this, worker] { wait_for_loops(worker); });
    }
  } catch (const std::system_error&) {
    // The system gives no more threads: those that are there, and this one, do the work.
  }
}

/// Works on the loop that is open for the longest time.
inline detail::LoopTimes ThreadPool::help(std::unique_lock<std::mutex>& lock, unsigned worker) {
  Loop& loop = *open_.front();
  ++loop.helpers;
  const std::size_t calls = loop.next < loop.count ? take_calls() : 0;
  lock.unlock();
  wake(calls);
  const detail::LoopTimes times = loop.work({this, worker});
  lock.lock();
  std::erase(open_, &loop);  // it has no iterations left
  if (--loop.helpers == 0) done_.notify_all();
  return times;
}

inline void ThreadPool::wait_for_loops(unsigned worker) {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [&] { return ends_ || !open_.empty(); });
    --idle_;
    if (ends_) return;
    help(lock, worker);
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
