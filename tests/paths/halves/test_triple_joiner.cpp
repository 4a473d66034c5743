/// Three interactions: joined halves find what trying every sequence finds.
#include "dcem/paths/halves/triple_joiner.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/paths/halves/small_town.hpp"

using namespace dcem;
using namespace dcem::test;

namespace {

/// So small that every sequence of three elements can be tried: a ground, houses beside a street, sheets, and a car.
Scene small_street(Draw& draw) {
  TriangleMesh mesh;
  if (draw.below(4) != 0) add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  for (const double side : {-1.0, 1.0}) {
    const double near_m = side * draw.between(3, 5), far_m = side * draw.between(6, 9), low_m = draw.between(-8, 0);
    add_box_faces(mesh, Vec3(low_m, std::min(near_m, far_m), draw.below(2) == 0 ? 0.0 : 0.01),
                  Vec3(low_m + draw.between(4, 12), std::max(near_m, far_m), draw.between(2, 8)), "metal");
  }
  const std::size_t sheets = draw.below(3);
  for (std::size_t sheet = 0; sheet < sheets; ++sheet) {
    const double turn = draw.between(-pi, pi);
    add_sheet(mesh, draw.inside(Vec3(-8, -8, 2), Vec3(8, 8, 4)),
              draw.between(1, 6) * Vec3(std::cos(turn), std::sin(turn), 0), Vec3(0, 0, 2),
              draw.below(2) == 0 ? "glass" : "wall");
  }
  Scene scene = scene_of(mesh);
  TriangleMesh car;
  add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), "metal");
  scene.add_object("one", car,
                   LinearMotion{{draw.inside(Vec3(-8, -3, 0.02), Vec3(8, 3, 0.05)), draw.between(-pi, pi), 0, 0}});
  return scene;
}

/// How many paths there are of each kind, from the receiver: three mirrors, an edge last, in the middle, first.
struct Kinds {
  std::array<std::size_t, 4> count{};

  void add(const std::vector<Path>& paths) {
    for (const Path& path : paths) {
      std::vector<InteractionKind> kinds;
      for (const Interaction& interaction : path.interactions) {
        if (interaction.kind != InteractionKind::transmission) kinds.push_back(interaction.kind);
      }
      if (kinds.size() != 3) continue;
      const auto edge = std::ranges::find(kinds, InteractionKind::diffraction);
      ++count[edge == kinds.end() ? 0 : static_cast<std::size_t>(edge - kinds.begin()) + 1];
    }
  }
  std::size_t least() const { return *std::ranges::min_element(count); }
};

}  // namespace

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
