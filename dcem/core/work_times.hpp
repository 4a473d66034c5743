#pragma once
/// How much of its work a thread has done alone, and how much in loops that it shared with others: what more threads
/// could still make faster, and what they could not.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>

namespace dcem {

/// Work of one thread and of all that helped it, since it began.
struct WorkTimes {
  double serial_s = 0.0;         ///< processor time of the thread outside of loops
  double parallel_s = 0.0;       ///< processor time of all threads within its loops
  double beside_s = 0.0;         ///< processor time of threads that read and wrote beside it
  double longest_tasks_s = 0.0;  ///< processor time of the longest iteration of each loop: no loop ends before it

  std::uint64_t tasks = 0;  ///< iterations of its loops, and of loops within them: into so many parts work fell

  friend WorkTimes operator-(const WorkTimes& one, const WorkTimes& other) {
    return {one.serial_s - other.serial_s, one.parallel_s - other.parallel_s, one.beside_s - other.beside_s,
            one.longest_tasks_s - other.longest_tasks_s, one.tasks - other.tasks};
  }
};

/// Processor time of the calling thread; wall-clock time where the system does not tell it.
inline double thread_time_s() {
#if defined(CLOCK_THREAD_CPUTIME_ID)
  timespec now{};
  if (::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) == 0) {
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
#endif
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

namespace detail {

/// What one thread did of a loop.
struct LoopTimes {
  double busy_s = 0.0;
  double longest_task_s = 0.0;
  double of_others_s = 0.0;  ///< of others that helped with loops within its iterations
  std::uint64_t tasks = 0;   ///< iterations of this loop and of those within it
};

/// What a thread has asked others to do.
struct AskedWork {
  double own_s = 0.0, all_s = 0.0, beside_s = 0.0, longest_tasks_s = 0.0;
  std::uint64_t tasks = 0;

  /// `own`: what the thread itself did, `all`: what it did with the others.
  void add(const LoopTimes& own, const LoopTimes& all) {
    own_s += own.busy_s;
    all_s += all.busy_s;
    longest_tasks_s += all.longest_task_s;
    tasks += all.tasks;
  }
  void add_beside(double busy_s) { beside_s += busy_s; }
};
inline thread_local AskedWork asked_work;

/// Measures one thread at a loop, from its construction to `finish`. An iteration costs one look at the time of day,
/// which is cheap; one that is long enough to pay for it is told by processor time. A loop within an iteration takes
/// the iteration as long as its own longest one, for others may do the rest; what they did is work of the outer loop.
class LoopWatch {
 public:
  /// An iteration has ended.
  void lap() {
    constexpr std::chrono::microseconds long_enough(200);
    const auto now = std::chrono::steady_clock::now();
    double task_s = std::chrono::duration<double>(now - lap_).count();
    if (now - lap_ >= long_enough) {
      const double busy_s = thread_time_s() - start_s_;
      task_s = std::min(task_s, busy_s - told_s_);
      told_s_ = busy_s;
    }
    const AskedWork& asked = asked_work;
    task_s += (asked.longest_tasks_s - told_work_.longest_tasks_s) - (asked.own_s - told_work_.own_s);
    told_work_ = asked;
    longest_s_ = std::max(longest_s_, task_s);
    lap_ = now;
    ++tasks_;
  }
  /// What the thread has done, and what others have done within it. Loops within this one are from here on a part of
  /// it.
  LoopTimes finish() {
    AskedWork& asked = asked_work;
    const double of_others_s = (asked.all_s - begun_.all_s) - (asked.own_s - begun_.own_s);
    const std::uint64_t tasks = tasks_ + (asked.tasks - begun_.tasks);
    begun_.beside_s = asked.beside_s;
    asked = begun_;
    return {thread_time_s() - start_s_, longest_s_, of_others_s, tasks};
  }

 private:
  double start_s_ = thread_time_s();
  double told_s_ = 0.0;  ///< up to the end of the last long iteration
  double longest_s_ = 0.0;
  std::uint64_t tasks_ = 0;
  AskedWork begun_ = asked_work, told_work_ = begun_;
  std::chrono::steady_clock::time_point lap_ = std::chrono::steady_clock::now();
};

}  // namespace detail

/// Of the calling thread, between loops.
inline WorkTimes work_times() {
  const detail::AskedWork& asked = detail::asked_work;
  return {thread_time_s() - asked.own_s, asked.all_s, asked.beside_s, asked.longest_tasks_s, asked.tasks};
}

}  // namespace dcem
