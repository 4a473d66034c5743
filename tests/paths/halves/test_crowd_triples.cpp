/// Three interactions: receivers that look together find what each of them finds by trying every sequence.
#include "dcem/paths/halves/crowd_triples.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/halves/crowds.hpp"
#include "tests/paths/halves/small_street.hpp"

namespace test_crowd_triples {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("a crowd finds every path of three interactions of each of its points, and the same bits") {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_street(draw));
    const LinkEnd from = traced.end(draw.inside(Vec3(-8, -3, 0.3), Vec3(8, 3, 9)));
    const Asked asked{static_cast<int>(draw.below(3)), 3, 1, 3};
    const std::vector<Vec3> points_m = some_crowd(draw, 6.0, Vec3(-8, -3, 0.3), Vec3(8, 3, 9));
    CAPTURE(seed);
    found += check_crowd(traced, from, points_m, asked, draw.below(2) == 0 ? 256 : 64);
  }
  MESSAGE(found << " paths");
  CHECK(found > 5'000);
}

}  // namespace test_crowd_triples
