#include <doctest/doctest.h>

#include <cstddef>
#include <stdexcept>
#include <thread>

#include "dcem/core/thread_pool.hpp"
#include "dcem/core/work_times.hpp"

namespace test_work_times {

using namespace dcem;

TEST_CASE("what a thread has done only grows, loops included") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    WorkTimes before = work_times();
    for (int repeat = 0; repeat < 20; ++repeat) {
      pool.for_each(100, [](std::size_t, unsigned) {});
      const WorkTimes now = work_times(), more = now - before;
      CHECK(more.parallel_s >= 0.0);
      CHECK(more.longest_tasks_s >= 0.0);
      CHECK(now.serial_s >= 0.0);
      CHECK(more.beside_s == 0.0);
      before = now;
    }
  }
}

TEST_CASE("a loop of one iteration is no loop, and a loop within one is part of it") {
  ThreadPool pool(3), other(2);
  const WorkTimes before = work_times();
  pool.for_each(0, [](std::size_t, unsigned) {});
  pool.for_each(1, [](std::size_t, unsigned) {});
  pool.for_each_quick(64, [](std::size_t) {});
  CHECK(work_times().parallel_s == before.parallel_s);
  CHECK(work_times().longest_tasks_s == before.longest_tasks_s);
  pool.for_each(2, [&](std::size_t, unsigned) {
    const double within_s = work_times().parallel_s;
    other.for_each(10, [](std::size_t, unsigned) {});
    CHECK(work_times().parallel_s == within_s);
  });
}

TEST_CASE("each thread has what it has asked for itself") {
  const WorkTimes before = work_times();
  std::thread([] { ThreadPool(2).for_each(1000, [](std::size_t, unsigned) {}); }).join();
  CHECK(work_times().parallel_s == before.parallel_s);
}

TEST_CASE("a loop that throws counts, too") {
  for (const unsigned threads : {1U, 3U}) {
    ThreadPool pool(threads);
    const WorkTimes before = work_times();
    CHECK_THROWS_AS(pool.for_each(10, [](std::size_t, unsigned) { throw std::runtime_error("fails"); }),
                    std::runtime_error);
    CHECK(work_times().parallel_s >= before.parallel_s);
  }
}

namespace {

/// Keeps the processor busy for so long.
void work_for(double time_s) {
  for (const double begun_s = thread_time_s(); thread_time_s() - begun_s < time_s;) {
  }
}

}  // namespace

TEST_CASE("the iterations of all loops are counted, those of loops within loops, too") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    const WorkTimes before = work_times();
    pool.for_each(4, [&](std::size_t index, unsigned) {
      for (std::size_t loop = 0; loop < index; ++loop) pool.for_each(10, [](std::size_t, unsigned) {});
      pool.for_each(1, [](std::size_t, unsigned) {});
    });
    CHECK((work_times() - before).tasks == 4 + 6 * 10);
  }
}

TEST_CASE("an iteration is no longer than the longest one of a loop within it, whoever helps") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    const WorkTimes before = work_times();
    pool.for_each(2, [&](std::size_t index, unsigned) {
      if (index == 1) pool.for_each(40, [](std::size_t, unsigned) { work_for(1e-3); });
    });
    const WorkTimes spent = work_times() - before;
    CHECK(spent.parallel_s >= 40e-3);
    CHECK(spent.longest_tasks_s >= 0.9e-3);
    CHECK(spent.longest_tasks_s < 0.5 * spent.parallel_s);
  }
}

TEST_CASE("what the calling thread does for others while it waits is no serial work") {
  ThreadPool pool(2);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const WorkTimes before = work_times();
    pool.for_each(2, [&](std::size_t, unsigned worker) {
      if (worker == 0) return work_for(1e-4);
      pool.for_each(20, [](std::size_t, unsigned) { work_for(5e-4); });
    });
    const WorkTimes spent = work_times() - before;
    CHECK(spent.serial_s < 0.5 * spent.parallel_s + 2e-3);
  }
}

}  // namespace test_work_times
