/// The order in which paths are reported.
#include "dcem/paths/path.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_path {

using namespace dcem;
using namespace dcem::test;

namespace {

Interaction touch(InteractionKind kind, std::size_t facet, const Vec3& point_m) {
  return {kind, FacetId(facet), point_m};
}

constexpr InteractionKind R = InteractionKind::reflection, T = InteractionKind::transmission;

}  // namespace

TEST_CASE("paths are reported by length, then kinds, then points") {
  const std::vector<Path> in_order{{{}, 1.0},
                                   {{touch(R, 9, Vec3(0, 0, 0))}, 1.0},
                                   {{touch(R, 1, Vec3(0, 0, 1))}, 1.0},
                                   {{touch(R, 0, Vec3(0, 1, -5))}, 1.0},
                                   {{touch(R, 0, Vec3(0, 1, -5)), touch(T, 0, Vec3(0, 0, 0))}, 1.0},
                                   {{touch(R, 0, Vec3(0, 1, -5)), touch(T, 0, Vec3(0, 0, 1))}, 1.0},
                                   {{touch(T, 0, Vec3(-7, 0, 0))}, 1.0},
                                   {{}, 1.0000000000000002}};
  for (std::size_t a = 0; a < in_order.size(); ++a) {
    for (std::size_t b = 0; b < in_order.size(); ++b) CHECK(reported_before(in_order[a], in_order[b]) == (a < b));
  }
}

TEST_CASE("the order is strict and total enough to sort random paths alike from any order") {
  Draw draw(1);
  std::vector<Path> paths;
  for (int index = 0; index < 300; ++index) {
    Path path;
    path.length_m = static_cast<double>(draw.below(3));
    for (std::size_t count = draw.below(3); count > 0; --count) {
      const Vec3 point_m(static_cast<double>(draw.below(3)), static_cast<double>(draw.below(3)), index);
      path.interactions.push_back(touch(draw.below(2) == 0 ? R : T, draw.below(5), point_m));
    }
    paths.push_back(path);
  }
  for (const Path& a : paths) {
    CHECK_FALSE(reported_before(a, a));
    for (const Path& b : paths) CHECK_FALSE((reported_before(a, b) && reported_before(b, a)));
  }
  std::vector<Path> backwards(paths.rbegin(), paths.rend());
  std::sort(paths.begin(), paths.end(), reported_before);
  std::sort(backwards.begin(), backwards.end(), reported_before);
  for (std::size_t index = 0; index < paths.size(); ++index) {
    CHECK(paths[index].length_m == backwards[index].length_m);
    CHECK(kinds(paths[index]) == kinds(backwards[index]));
  }
}

TEST_CASE("two paths are the same when kinds and facets are, whatever their points") {
  const Path one{{touch(R, 1, Vec3(0.0)), touch(T, 2, Vec3(0.0))}, 1.0};
  const Path moved{{touch(R, 1, Vec3(9.0)), touch(T, 2, Vec3(0.0))}, 2.0};
  const Path other{{touch(R, 1, Vec3(0.0)), touch(R, 2, Vec3(0.0))}, 1.0};
  const Path longer{{touch(R, 1, Vec3(0.0)), touch(T, 2, Vec3(0.0)), touch(T, 3, Vec3(0.0))}, 1.0};
  CHECK(same_sequence(one, moved));
  CHECK_FALSE(same_sequence(one, other));
  CHECK_FALSE(same_sequence(one, longer));
  CHECK_FALSE(same_sequence(longer, one));
  CHECK_FALSE(same_sequence(one, {}));
  CHECK(same_sequence({}, {}));
  CHECK(kinds(longer) == "RTT");
  CHECK(kinds(Path{}).empty());
}

}  // namespace test_path
