#include <doctest/doctest.h>

#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "dcem/core/beside.hpp"

namespace test_beside {

using namespace dcem;

TEST_CASE("pieces of work are done one after the other, in their order, with and without a thread") {
  for (const bool has_thread : {false, true}) {
    std::vector<int> done;
    {
      Beside beside(has_thread);
      beside.wait();  // for nothing
      for (int piece = 0; piece < 200; ++piece) beside.start([&done, piece] { done.push_back(piece); });
      beside.wait();
      CHECK(done.size() == 200);
      beside.start([&] { done.push_back(200); });
    }  // waits, too
    REQUIRE(done.size() == 201);
    for (int piece = 0; piece <= 200; ++piece) CHECK(done[static_cast<std::size_t>(piece)] == piece);
  }
}

TEST_CASE("a thread of its own does it, where it may") {
  std::thread::id doer;
  Beside alone(false), beside(true);
  alone.start([&] { doer = std::this_thread::get_id(); });
  CHECK(doer == std::this_thread::get_id());
  beside.start([&] { doer = std::this_thread::get_id(); });
  beside.wait();
  CHECK(doer != std::this_thread::get_id());
}

TEST_CASE("an exception comes out of the next call, once, and the work after it is not begun") {
  Beside beside(true);
  bool is_begun = false;
  beside.start([] { throw std::out_of_range("the first"); });
  CHECK_THROWS_WITH_AS(beside.start([&] { is_begun = true; }), "the first", std::out_of_range);
  beside.wait();
  CHECK_FALSE(is_begun);
  beside.start([] { throw std::out_of_range("the second"); });
  CHECK_THROWS_WITH_AS(beside.wait(), "the second", std::out_of_range);
  beside.wait();
  beside.start([&] { is_begun = true; });
  beside.wait();
  CHECK(is_begun);
  beside.start([] { throw std::out_of_range("nobody asks"); });
  Beside alone(false);
  CHECK_THROWS_WITH_AS(alone.start([] { throw std::out_of_range("at once"); }), "at once", std::out_of_range);
}

TEST_CASE("what the work holds is given up when it is done") {
  Beside beside(true);
  auto held = std::make_shared<int>(7);
  beside.start([copy = held] {});
  beside.wait();
  CHECK(held.use_count() == 1);
}

}  // namespace test_beside
