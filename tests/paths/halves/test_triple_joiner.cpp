/// Three interactions: joined halves find what trying every sequence finds.
#include "dcem/paths/halves/triple_joiner.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/halves/small_street.hpp"

namespace test_triple_joiner {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("joined halves find every path of three interactions, and the same bits") {
  Kinds found;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_street(draw));
    const LinkEnd from = traced.end(draw.inside(Vec3(-8, -3, 0.3), Vec3(8, 3, 9)));
    const LinkEnd to = traced.end(draw.inside(Vec3(-8, -3, 0.3), Vec3(8, 3, 9)));
    const Asked asked{static_cast<int>(draw.below(3)), 3, 1, 3};
    CAPTURE(seed);
    const std::vector<Path> expected = all_sequences(traced, from, to, asked);
    CHECK(same_paths(joined(traced, from, to, asked, draw.below(2) == 0 ? 256 : 64), expected));
    found.add(expected);
  }
  MESSAGE(found.count[0] << " RRR, " << found.count[1] << " DRR, " << found.count[2] << " RDR, " << found.count[3]
                         << " RRD");
  CHECK(found.least() > 100);
}

}  // namespace test_triple_joiner
