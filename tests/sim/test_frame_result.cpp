/// Work adds up, counter by counter.
#include "dcem/sim/frame_result.hpp"

#include <doctest/doctest.h>

namespace test_frame_result {

using namespace dcem;

TEST_CASE("each counter is added to itself") {
  WorkCounters sum{.rays = 1,
                   .legs = 2,
                   .sequences_proposed = 3,
                   .sequences_solved = 4,
                   .paths = 5,
                   .diffuse_tiles = 6,
                   .diffuse_links_unfinished = 7,
                   .diffuse_residual_db = 0.5,
                   .nodes_visited = 8,
                   .primitives_tested = 9};
  sum += WorkCounters{.rays = 10,
                      .legs = 200,
                      .sequences_proposed = 3000,
                      .sequences_solved = 40'000,
                      .paths = 500'000,
                      .diffuse_tiles = 6'000'000,
                      .diffuse_links_unfinished = 70'000'000,
                      .diffuse_residual_db = 0.25,
                      .nodes_visited = 800'000'000,
                      .primitives_tested = 9'000'000'000};
  CHECK(sum.rays == 11);
  CHECK(sum.legs == 202);
  CHECK(sum.sequences_proposed == 3003);
  CHECK(sum.sequences_solved == 40'004);
  CHECK(sum.paths == 500'005);
  CHECK(sum.diffuse_tiles == 6'000'006);
  CHECK(sum.diffuse_links_unfinished == 70'000'007);
  CHECK(sum.diffuse_residual_db == 0.5);  // the largest, not a sum
  CHECK(sum.nodes_visited == 800'000'008);
  CHECK(sum.primitives_tested == 9'000'000'009);
}

}  // namespace test_frame_result
