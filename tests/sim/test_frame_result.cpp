/// Work adds up, counter by counter.
#include "dcem/sim/frame_result.hpp"

#include <doctest/doctest.h>

using namespace dcem;

TEST_CASE("each counter is added to itself") {
  WorkCounters sum{1, 2, 3, 4, 5, 6, 7};
  sum += WorkCounters{10, 200, 3000, 40'000, 500'000, 6'000'000, 70'000'000};
  CHECK(sum.rays == 11);
  CHECK(sum.legs == 202);
  CHECK(sum.sequences_proposed == 3003);
  CHECK(sum.sequences_solved == 40'004);
  CHECK(sum.paths == 500'005);
  CHECK(sum.nodes_visited == 6'000'006);
  CHECK(sum.primitives_tested == 70'000'007);
}
