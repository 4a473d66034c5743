#include <doctest/doctest.h>

#include "dcem/accel/counters.hpp"

namespace test_counters {

TEST_CASE("counters of several queries add up") {
  dcem::TraversalCounters sum{1, 2};
  sum += {10, 20};
  CHECK(sum == dcem::TraversalCounters{11, 22});
}

}  // namespace test_counters
