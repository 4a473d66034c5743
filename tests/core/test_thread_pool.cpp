#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "dcem/core/thread_pool.hpp"

namespace test_thread_pool {

using namespace dcem;

TEST_CASE("every index is called exactly once, by a worker that exists") {
  for (const unsigned threads : {0U, 1U, 2U, 3U, 8U}) {
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{5000}}) {
      std::vector<std::atomic<int>> calls(count);
      std::atomic<unsigned> highest_worker{0};
      parallel_for(count, threads, [&](std::size_t index, unsigned worker) {
        ++calls[index];
        unsigned highest = highest_worker;
        while (worker > highest && !highest_worker.compare_exchange_weak(highest, worker)) {
        }
      });
      CAPTURE(threads);
      CAPTURE(count);
      CHECK(highest_worker < resolve_thread_count(threads));
      for (const auto& times : calls) CHECK_UNARY(times == 1);
    }
  }
}

TEST_CASE("scratch space per worker is never shared by two threads at a time") {
  std::vector<std::atomic<int>> busy(4);
  std::atomic<bool> shared{false};
  parallel_for(20'000, 4, [&](std::size_t, unsigned worker) {
    if (++busy.at(worker) != 1) shared = true;
    --busy[worker];
  });
  CHECK_FALSE(shared);
}

TEST_CASE("an exception keeps its type and its text, and stops the loop") {
  for (const unsigned threads : {1U, 4U}) {
    std::atomic<int> calls{0};
    CHECK_THROWS_WITH_AS(parallel_for(1'000'000, threads,
                                      [&](std::size_t index, unsigned) {
                                        ++calls;
                                        if (index == 10) throw std::out_of_range("index ten");
                                        if (index > 10) std::this_thread::sleep_for(std::chrono::microseconds(50));
                                      }),
                         "index ten", std::out_of_range);
    CHECK(calls >= 11);
    CHECK(calls < 1'000'000);  // the rest was not done
  }
}

TEST_CASE("of many exceptions one comes out, after all threads have ended") {
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::atomic<int> inside{0};
    CHECK_THROWS_AS(parallel_for(64, 8,
                                 [&](std::size_t, unsigned) {
                                   ++inside;
                                   std::this_thread::yield();
                                   --inside;
                                   throw std::runtime_error("each fails");
                                 }),
                    std::runtime_error);
    CHECK(inside == 0);
  }
}

TEST_CASE("exceptions that are no std::exception pass too") {
  CHECK_THROWS_AS(parallel_for(8, 2, [](std::size_t, unsigned) { throw 42; }), int);
}

TEST_CASE("the body is used, not copied") {
  struct Body {
    std::unique_ptr<std::atomic<int>> sum = std::make_unique<std::atomic<int>>(0);
    void operator()(std::size_t index, unsigned) { *sum += static_cast<int>(index); }
  } body;
  parallel_for(101, 3, body);
  CHECK(*body.sum == 5050);
}

TEST_CASE("0 threads are all threads of the machine, and at least one") {
  CHECK(resolve_thread_count(0) >= 1);
  CHECK(resolve_thread_count(7) == 7);
}

TEST_CASE("one pool does many loops of all lengths, each of them whole") {
  ThreadPool pool(3);
  for (std::size_t count = 0; count < 300; ++count) {
    std::vector<std::atomic<int>> calls(count);
    pool.for_each(count, [&](std::size_t index, unsigned worker) {
      ++calls[index];
      REQUIRE(worker < pool.size());
    });
    for (const auto& times : calls) REQUIRE(times == 1);
  }
}

TEST_CASE("all threads are woken for a loop that has use for them: each by one that was woken before") {
  for (const unsigned threads : {2U, 3U, 4U, 7U, 16U, 33U}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::atomic<unsigned> there{0};
      std::vector<char> came(threads);  // each iteration ends when all have begun
      pool.for_each(threads, [&](std::size_t index, unsigned) {
        ++there;
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (there < threads && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
        came[index] = there >= threads ? 1 : 0;
      });
      CAPTURE(threads);
      REQUIRE(came == std::vector<char>(threads, 1));
    }
  }
}

TEST_CASE("quick iterations, too, are done once each") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    for (const std::size_t count : {0U, 1U, 63U, 64U, 65U, 128U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      pool.for_each_quick(count, [&](std::size_t index) { ++calls[index]; });
      for (const auto& times : calls) REQUIRE(times == 1);
    }
  }
}

TEST_CASE("a pool goes on after an exception") {
  ThreadPool pool(4);
  for (int repeat = 0; repeat < 20; ++repeat) {
    CHECK_THROWS_AS(pool.for_each(100, [](std::size_t, unsigned) { throw std::runtime_error("fails"); }),
                    std::runtime_error);
    std::atomic<int> sum{0};
    pool.for_each(100, [&](std::size_t index, unsigned) { sum += static_cast<int>(index); });
    CHECK(sum == 4950);
  }
}

TEST_CASE("a loop within a loop of the same pool ends, and so do loops that several threads ask for at once") {
  ThreadPool pool(3);
  std::atomic<int> calls{0};
  pool.for_each(7, [&](std::size_t, unsigned) { pool.for_each(11, [&](std::size_t, unsigned) { ++calls; }); });
  CHECK(calls == 77);
  calls = 0;
  std::vector<std::thread> askers;
  for (int asker = 0; asker < 4; ++asker) {
    askers.emplace_back([&] {
      for (int loop = 0; loop < 50; ++loop) pool.for_each(13, [&](std::size_t, unsigned) { ++calls; });
    });
  }
  for (std::thread& asker : askers) asker.join();
  CHECK(calls == 4 * 50 * 13);
}

namespace {

/// Waits until so many have come here; whether they have, within a minute.
bool all_meet(std::atomic<int>& here, int expected) {
  ++here;
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (here < expected && std::chrono::steady_clock::now() < until) std::this_thread::yield();
  return here >= expected;
}

}  // namespace

TEST_CASE("threads that have nothing else to do help with a loop within a loop, whoever asks for it") {
  for (const std::size_t asker : {std::size_t{0}, std::size_t{1}}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      ThreadPool pool(2);
      std::atomic<int> outside{0}, inside{0};
      std::atomic<bool> helped{true};
      pool.for_each(2, [&](std::size_t, unsigned worker) {
        if (!all_meet(outside, 2)) helped = false;  // each thread has one
        if (worker != asker) return;
        pool.for_each(2, [&](std::size_t, unsigned) {
          if (!all_meet(inside, 2)) helped = false;  // no thread alone gets past it
        });
      });
      CHECK(helped);
    }
  }
}

TEST_CASE("a loop within a loop gets more threads than the outer one has iterations for") {
  ThreadPool pool(4);
  std::atomic<int> inside{0};
  std::atomic<bool> helped{true};
  pool.for_each(2, [&](std::size_t index, unsigned) {
    if (index == 0) return;
    pool.for_each(4, [&](std::size_t, unsigned) {
      if (!all_meet(inside, 4)) helped = false;
    });
  });
  CHECK(helped);
}

TEST_CASE("loops within loops within loops are done once each, by workers that are one thread each") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::vector<std::atomic<int>> calls(7 * 5 * 11);
      std::vector<std::atomic<std::size_t>> thread_of(threads);
      std::atomic<bool> is_one_thread{true};
      const auto note = [&](unsigned worker) {
        const std::size_t own = std::hash<std::thread::id>()(std::this_thread::get_id()) | 1U;
        std::size_t before = 0;
        if (!thread_of.at(worker).compare_exchange_strong(before, own) && before != own) is_one_thread = false;
      };
      pool.for_each(7, [&](std::size_t one, unsigned worker) {
        note(worker);
        pool.for_each(5, [&](std::size_t two, unsigned within) {
          note(within);
          pool.for_each(11, [&](std::size_t three, unsigned innermost) {
            note(innermost);
            ++calls[(one * 5 + two) * 11 + three];
          });
        });
        pool.for_each(1, [&](std::size_t, unsigned alone) { is_one_thread = is_one_thread && alone == worker; });
      });
      for (const auto& times : calls) REQUIRE(times == 1);
      CHECK(is_one_thread);
    }
  }
}

TEST_CASE("an exception of a loop within a loop comes out of both") {
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::atomic<int> caught{0};
      const auto within = [&](std::size_t) {
        try {
          pool.for_each(9, [](std::size_t index, unsigned) {
            if (index == 4) throw std::out_of_range("index four");
          });
        } catch (const std::out_of_range&) {
          ++caught;
          throw;
        }
      };
      CHECK_THROWS_WITH_AS(pool.for_each(3, [&](std::size_t index, unsigned) { within(index); }), "index four",
                           std::out_of_range);
      CHECK(caught >= 1);
    }
  }
}

}  // namespace test_thread_pool
