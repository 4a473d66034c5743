#pragma once
/// Work that goes on beside the calling thread, one piece after the other.
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "dcem/core/work_times.hpp"

namespace dcem {

/// A thread, started when it is first needed, that does one piece of work at a time. Without threads, and where the
/// system gives none, the calling thread does the work at once.
class Beside {
 public:
  explicit Beside(bool has_thread) : has_thread_(has_thread) {}
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  /// Waits for the work at hand; its exception is lost.
  ~Beside();

  /// Waits for the work before, then begins with this. What it holds is given up by the thread that does it. Throws
  /// what the work before has thrown.
  void start(std::function<void()> work);
  /// Waits until all is done. Throws what the work has thrown. `work_times` of the calling thread then has it.
  void wait();

 private:
  bool has_thread();
  void go_on();

  bool has_thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> work_;
  bool is_busy_ = false;
  std::exception_ptr failure_;
  double busy_s_ = 0.0;  ///< since somebody has waited
  bool ends_ = false;
  std::thread thread_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline Beside::~Beside() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

inline bool Beside::has_thread() {
  if (!has_thread_ || thread_.joinable()) return has_thread_;
  try {
    thread_ = std::thread([this] { go_on(); });
  } catch (const std::system_error&) {
    has_thread_ = false;
  }
  return has_thread_;
}

inline void Beside::start(std::function<void()> work) {
  wait();
  if (!has_thread()) return work();
  {
    const std::lock_guard lock(mutex_);
    work_ = std::move(work);
    is_busy_ = true;
  }
  changed_.notify_all();
}

inline void Beside::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !is_busy_; });
  detail::asked_work.add_beside(std::exchange(busy_s_, 0.0));
  if (failure_) std::rethrow_exception(std::exchange(failure_, {}));
}

inline void Beside::go_on() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ends_ || is_busy_; });
    if (!is_busy_) return;
    std::function<void()> work = std::exchange(work_, {});
    std::exception_ptr failure;
    lock.unlock();
    const double begun_s = thread_time_s();
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    work = {};
    const double busy_s = thread_time_s() - begun_s;
    lock.lock();
    failure_ = failure;
    busy_s_ += busy_s;
    is_busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace dcem
