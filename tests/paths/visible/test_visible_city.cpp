/// In a real city, dirty as found: a point of a facade is in a visible part if and only if rays from both ends reach
/// it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "tests/paths/visible/visible_trial.hpp"
#include "tests/support/all_tests.hpp"
#include "tests/support/shared_data.hpp"

namespace test_visible_city {

using namespace dcem;
using namespace dcem::test;

namespace {

/// All of it rough; of sheets, where any are asked for, what is of wood, of brick and of marble.
Scene munich(bool has_sheets) {
  const TriangleMesh mesh = io::read_obj(shared_path("scenes/munich.obj")).mesh;
  Scene scene;
  for (const std::string& name : mesh.material_names) {
    const bool is_sheet = has_sheets && (name == "wood" || name == "brick" || name == "marble");
    scene.add_material({name, ConstantReflection{0.6, is_sheet ? std::optional(10.0) : std::nullopt}, 0.0, {0.4}});
  }
  scene.set_scenery(mesh);
  return scene;
}

const Vec3 mast_m(-14.77, 118.92, 25);

/// A place near another that touches nothing.
LinkEnd place_near(TracedScene<>& world, const Vec3& place_m, Draw& draw) {
  while (true) {
    const LinkEnd end = world.end(place_m + draw.inside(Vec3(-1, -1, 0), Vec3(1, 1, 0.2)));
    if (world.tracer.facets_near(end.position_m, 0.3, {}, world.counters).empty()) return end;
  }
}

void say(const Tally& tally) {
  MESSAGE(tally.visible << " visible, " << tally.through << " of them through sheets, " << tally.hidden << " hidden, "
                        << tally.doubtful << " doubtful, " << tally.narrow << " narrow, " << tally.at_tolerance
                        << " at the tolerance, " << tally.halvings << " halvings");
}

/// Coordinates in the file have four digits, so that what should end on a wall is up to 0.05 mm off it, and the rim of
/// its shadow as much farther away as the wall is seen at a slant.
double margin_m(const Plane& plane, const LinkEnd& end, const Vec3& point_m) {
  return 2e-3 + 5e-5 * glm::distance(end.position_m, point_m) / std::abs(signed_distance_m(plane, end.position_m));
}

Tally judge_links(TracedScene<>& world, const LinkEnd& mast, int max_transmissions, std::size_t points) {
  Draw draw(3);
  Tally tally;
  for (const Vec3& street_m : {Vec3(67, 40, 1.5), Vec3(-13, 120, 1.5), Vec3(27, 280, 1.5)}) {
    CAPTURE(street_m.x);
    LinkView view(world, mast, place_near(world, street_m, draw), max_transmissions);
    PointJudge judge(view, tally);
    // Triangles that are asked for parts, and those that rays may reach and nobody asks.
    std::vector<std::uint32_t> asked, others;
    for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
      const FacetId facet = world.scene.facet_of_triangle(triangle);
      CHECK(may_scatter(world.scene, view.from, view.to, facet) == view.traces(facet));
      if (view.asks(facet)) {
        asked.push_back(triangle);
      } else if (view.traces(facet)) {
        others.push_back(triangle);
      }
    }
    const auto judge_point = [&](std::uint32_t triangle, std::span<const SeenPiece> pieces) {
      const Plane& plane = world.scene.facet(world.scene.facet_of_triangle(triangle)).plane;
      const Vec3 point_m = point_of(world.scene.corners_m(triangle), draw);
      judge.judge(triangle, pieces, point_m,
                  std::max(margin_m(plane, view.from, point_m), margin_m(plane, view.to, point_m)));
    };
    const std::size_t each = 1 + points / std::max<std::size_t>(1, asked.size());
    for (const std::uint32_t triangle : asked) {
      const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
      for (std::size_t index = 0; index < each; ++index) judge_point(triangle, pieces);
    }
    for (std::size_t index = 0; index < points / 4; ++index) judge_point(others[draw.below(others.size())], {});
    tally.halvings += view.halvings;
  }
  return tally;
}

}  // namespace

TEST_CASE("visible city: in Munich a point is in a part if and only if rays from the mast and the street reach it") {
  DCEM_NEEDS_SHARED();
  TracedScene<> world(munich(false));
  const Tally tally = judge_links(world, world.end(mast_m), 0, all_or(200'000U, 20'000U));
  say(tally);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow + tally.at_tolerance <= 2);
  CHECK(tally.visible > 5'000);
  CHECK(tally.hidden > 50'000);
  CHECK(tally.doubtful < tally.hidden / 20);
}

TEST_CASE("visible city: through walls that are sheets it is the same, and so are the sheets") {
  DCEM_NEEDS_SHARED();
  TracedScene<> world(munich(true));
  const Tally tally = judge_links(world, world.end(mast_m), 2, all_or(100'000U, 5'000U));
  say(tally);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow + tally.at_tolerance <= 2);
  CHECK(tally.visible > 2'500);
  CHECK(tally.hidden > 10'000);
  CHECK(tally.through > 1'500);
}

TEST_CASE("visible city: from a facade that an end is mounted on it is the same") {
  DCEM_NEEDS_SHARED();
  TracedScene<> world(munich(false));
  Draw draw(5);
  Tally tally;
  for (int link = 0; link < all_or(40, 4); ++link) {
    CAPTURE(link);
    // On a point of a triangle of some size in the middle of the city, or within the tolerance of it.
    Vec3 place_m(0.0);
    while (true) {
      const auto triangle = static_cast<std::uint32_t>(draw.below(world.scene.triangles().size()));
      const TriangleCorners corners_m = world.scene.corners_m(triangle);
      place_m = point_of(corners_m, draw) + draw.between(0, 9e-5) * draw.direction();
      if (area_of_m2(corners_m) > 4.0 && std::max(std::abs(place_m.x), std::abs(place_m.y)) < 300.0) break;
    }
    const LinkEnd mounted = world.end(place_m);
    REQUIRE(!mounted.mounted_on.empty());
    const Tally of_link = judge_links(world, mounted, 0, all_or(20'000U, 4'000U));
    tally.visible += of_link.visible;
    tally.hidden += of_link.hidden;
    CHECK(of_link.wrong == 0);
  }
  say(tally);
  CHECK(tally.visible > 1'000);
  CHECK(tally.hidden > 10'000);
}

}  // namespace test_visible_city
