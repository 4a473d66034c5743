/// Joined halves find what trying every sequence finds: two searches that share the solver alone.
#include "dcem/paths/halves/half_joiner.hpp"

#include <doctest/doctest.h>

#include <utility>
#include <vector>

#include "tests/paths/halves/small_town.hpp"

namespace test_half_joiner {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("joined halves find every path of two interactions, and the same bits") {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    for (int link = 0; link < 4; ++link) {
      const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
      const Asked asked{static_cast<int>(draw.below(3))};
      CAPTURE(seed);
      CAPTURE(link);
      found += check_joined(traced, from, to, asked, draw.below(2) == 0 ? 256 : 64);
    }
  }
  MESSAGE(found << " paths");
  CHECK(found > 2'000);
}

TEST_CASE("every bound on reflections, diffractions and interactions is kept") {
  for (const Asked& asked : {Asked{1, 0, 0, 0}, Asked{0, 1, 0, 1}, Asked{0, 0, 1, 1}, Asked{2, 2, 0, 2},
                             Asked{0, 2, 1, 1}, Asked{1, 1, 1, 2}}) {
    Draw draw(7);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
    check_joined(traced, from, to, asked);
  }
}

TEST_CASE("an end that touches a wall, the ground or a car sees past it") {
  std::size_t found = 0;
  for (std::uint64_t seed = 1000; seed < 1060; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const auto on_surface = [&] {
      const auto triangle = static_cast<std::uint32_t>(draw.below(traced.scene.triangles().size()));
      const auto corners_m = traced.scene.corners_m(triangle);
      const double u = draw.between(0.1, 0.5), v = draw.between(0.1, 0.4);
      const Vec3 normal = traced.scene.facet(traced.scene.facet_of_triangle(triangle)).plane.normal;
      return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]) +
             draw.between(-1.5e-4, 1.5e-4) * normal;
    };
    const LinkEnd from = traced.end(on_surface()), to = traced.end(on_surface());
    CAPTURE(seed);
    found += check_joined(traced, from, to, {1});
  }
  CHECK(found > 50);
}

TEST_CASE("the body that a device rides on is not there for it") {
  std::size_t found = 0;
  for (std::uint64_t seed = 2000; seed < 2040; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const BodyId car = *traced.scene.find_body("one");
    const Vec3 place_m = traced.scene.body_state(car).placement.pose.position_m + Vec3(0, 0, draw.between(0.2, 1.6));
    const LinkEnd from = somewhere(traced, draw), to = traced.end(place_m, car);
    CAPTURE(seed);
    found += check_joined(traced, from, to, {}) + check_joined(traced, to, from, {});
  }
  CHECK(found > 100);
}

TEST_CASE("patches on top of each other, tilted by dirt, hide nothing from rays that graze them") {
  std::size_t found = 0;
  for (std::uint64_t seed = 3000; seed < 3060; ++seed) {
    Draw draw(seed);
    TriangleMesh mesh;
    add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
    for (int patch = 0; patch < 6; ++patch) {  // within the weld tolerance of the ground, or just above it
      const Vec3 tilt(1, 0, draw.between(-3e-6, 3e-6));
      add_sheet(mesh, Vec3(draw.between(-20, 20), draw.between(-20, 20), draw.between(-2e-4, 2e-4)),
                draw.between(1, 8) * tilt, Vec3(0, draw.between(1, 8), 0), draw.below(2) == 0 ? "metal" : "opaque");
    }
    add_box_faces(mesh, Vec3(3, 3, 0), Vec3(8, 8, 6), "metal");
    TracedScene<> traced(scene_of(mesh));
    const auto low = [&] { return traced.end(draw.inside(Vec3(-25, -25, 0.001), Vec3(25, 25, 0.4))); };
    const LinkEnd from = low(), to = low();
    CAPTURE(seed);
    found += check_joined(traced, from, to, {});
  }
  CHECK(found > 60);
}

TEST_CASE("a half that is kept while bodies move is the half made anew") {
  Draw draw(5);
  TracedScene<> traced(small_town(draw));
  FacetOutlines outlines(traced.scene);
  KeptHalf kept;
  const LinkEnd end = somewhere(traced, draw);
  for (int step = 0; step < 6; ++step) {
    Frame frame = traced.scene.frame_at(0.0, static_cast<std::size_t>(step));
    for (std::size_t body = 1; body < frame.bodies.size(); ++body) {
      frame.bodies[body].present = draw.below(4) != 0;
      frame.bodies[body].placement.pose.position_m = draw.inside(Vec3(-20, -20, 0), Vec3(20, 20, 0.1));
    }
    const ChangeSet changes = traced.scene.apply(frame);
    outlines.update(traced.scene, changes.moved);
    kept.update(traced.scene, outlines, end, {});
    PathHalf fresh;
    const FacetOutlines now(traced.scene);
    fresh.find_scenery(traced.scene, now, end, {});
    fresh.find_bodies(traced.scene, now, {});
    for (std::size_t layer = 0; layer < 2; ++layer) {
      CHECK(kept.half().layers()[layer].mirrors == fresh.layers()[layer].mirrors);
      CHECK(kept.half().layers()[layer].edges == fresh.layers()[layer].edges);
    }
  }
}

TEST_CASE("from the plane of a sheet its rim is seen, though the sheet is not") {
  CHECK(check_grid_links(4000, 4120, {}) > 500);
}

TEST_CASE("what two triangles of a facet, one on the other, leave open is seen through") {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, -5, 0}, {0, 5, 0}, {0, 5, 10}, {0, -5, 10}};
  const std::uint32_t metal = material_index(mesh, "metal");
  mesh.triangles = {{{0, 1, 2}, metal}, {{0, 1, 3}, metal}};  // as large as their hull, the top quarter of it open
  add_sheet(mesh, Vec3(40, 0, 10), Vec3(0, 30, 0), Vec3(0, 0, 10), "metal");
  TracedScene<> traced(scene_of(mesh));
  REQUIRE(traced.scene.facets().size() == 2);
  CHECK_FALSE(FacetOutlines(traced.scene).of(FacetId(0)).fills_hull);
  std::size_t found = 0;
  for (const double height_m : {3.0, 5.0, 7.0, 9.0}) {
    const LinkEnd from = traced.end(Vec3(-20, 0, 8.5)), to = traced.end(Vec3(20, 0.3, height_m));
    found += check_joined(traced, from, to, {0, 1, 1, 2});
  }
  CHECK(found > 4);
}

}  // namespace test_half_joiner
