/// Two diffractions: pairs of edges that two ends see lead over every path that trying every pair finds.
#include "dcem/paths/halves/edge_pairs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "tests/paths/halves/crowds.hpp"
#include "tests/paths/halves/small_town.hpp"

namespace test_edge_pairs {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Of the paths between two ends, those over two edges.
std::size_t twice_diffracted(const std::vector<Path>& paths) {
  return static_cast<std::size_t>(std::ranges::count_if(paths, [](const Path& path) {
    return 2 == std::ranges::count(path.interactions, InteractionKind::diffraction, &Interaction::kind);
  }));
}

}  // namespace

TEST_CASE("joined halves find every path over two edges, and the same bits") {
  std::size_t twice = 0;
  for (std::uint64_t seed = 8000; seed < 8060; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    for (int link = 0; link < 3; ++link) {
      const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
      const Asked asked{static_cast<int>(draw.below(3)), static_cast<int>(draw.below(3)), 2, 2, draw.below(2) == 0};
      CAPTURE(seed);
      CAPTURE(link);
      check_joined(traced, from, to, asked, draw.below(2) == 0 ? 256 : 64);
      twice += twice_diffracted(all_sequences(traced, from, to, asked));
    }
  }
  MESSAGE(twice << " paths over two edges");
  CHECK(twice > 2'000);
}

TEST_CASE("parallel edges, edges that meet, and ends on lines of edges are joined as all others") {
  CHECK(check_grid_links(8100, 8180, {0, 0, 2, 2}) > 1'000);
}

TEST_CASE("from either end there are the same paths over two edges") {
  std::size_t twice = 0;
  for (std::uint64_t seed = 8200; seed < 8240; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
    const std::vector<Path> there = joined(traced, from, to, {0, 0, 2, 2}),
                            back = joined(traced, to, from, {0, 0, 2, 2});
    CAPTURE(seed);
    CHECK(twice_diffracted(there) == twice_diffracted(back));
    twice += twice_diffracted(there);
  }
  CHECK(twice > 300);
}

TEST_CASE("a crowd finds every path over two edges of each of its points") {
  const std::size_t found = check_town_crowds(8300, 8330, [](Draw& draw) {
    return Asked{static_cast<int>(draw.below(3)), static_cast<int>(draw.below(3)), 2, 2};
  });
  CHECK(found > 3'000);
}

TEST_CASE("an end that is far away is joined over two edges as one nearby") {
  std::size_t found = 0;
  for (std::uint64_t seed = 8400; seed < 8430; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = far_away(traced, draw), to = somewhere(traced, draw);
    CAPTURE(seed);
    found += check_joined(traced, from, to, {0, 1, 2, 2}) + check_joined(traced, to, from, {0, 1, 2, 2});
  }
  CHECK(found > 200);
}

}  // namespace test_edge_pairs
