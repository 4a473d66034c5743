/// What is counted before a search is what the search then makes.
#include "dcem/paths/discover/chain_count.hpp"

#include <doctest/doctest.h>

#include <set>
#include <vector>

namespace test_chain_count {

using namespace dcem;

namespace {

/// Edges of some numbers, each over no mirror and over one to three facets.
EdgeReach reach_of(const std::vector<std::uint32_t>& edges, std::uint32_t first_facet) {
  EdgeReach reach;
  for (const std::uint32_t edge : edges) {
    Sequence mirrors;
    for (std::uint32_t length = 0; length <= edge % 4; ++length) {
      reach.add(mirrors, WedgeId(edge));
      mirrors.emplace_back(FacetId(first_facet + length));
    }
  }
  return reach;
}

double made(ReachedEdges near, ReachedEdges far, ChainLimits limits) {
  const Scene empty;
  double count = 0.0;
  ChainJoiner(empty, limits).for_each_chain(near, far, [&](const Sequence&) { ++count; });
  return count;
}

}  // namespace

TEST_CASE("chains are counted exactly where both ends reach different edges") {
  EdgeReach near = reach_of({0, 1, 2, 3, 5}, 100), far = reach_of({10, 11, 13, 14}, 200);
  for (std::size_t reflections = 0; reflections <= 6; ++reflections) {
    const ChainLimits limits{reflections, 2, reflections + 2};
    const std::vector<double> counted = count_chains(near.edges(), far.edges(), limits);
    REQUIRE(counted.size() == reflections + 3);
    for (std::size_t most = 0; most < counted.size(); ++most) {
      CHECK(counted[most] == made(near.edges(), far.edges(), {reflections, 2, most}));
    }
  }
}

TEST_CASE("at one edge chains are counted exactly, and an edge twice in a row is counted along") {
  EdgeReach near = reach_of({1, 2, 3, 7}, 100), far = reach_of({2, 3, 4, 7}, 200);
  const auto counted = [&](std::size_t diffractions) {
    return count_chains(near.edges(), far.edges(), {3, diffractions, 3 + diffractions}).back();
  };
  CHECK(counted(1) == made(near.edges(), far.edges(), {3, 1, 4}));
  CHECK(counted(0) == 0.0);
  const double three = made(near.edges(), far.edges(), {3, 3, 6});
  CHECK(counted(3) >= three);
  CHECK(counted(3) < 2.0 * three);
}

}  // namespace test_chain_count
