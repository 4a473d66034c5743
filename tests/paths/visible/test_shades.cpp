/// Which shades are in a cone of directions, against a loop over all of them.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "tests/paths/visible/visible_trial.hpp"
#include "tests/support/all_tests.hpp"

namespace test_shades {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("shades: none is missed whose patch a direction of the cone meets, near enough") {
  std::size_t met = 0, found_in_all = 0, asked = 0, wide = 0;
  for (std::uint64_t seed = 1; seed <= all_or(400U, 50U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TriangleMesh mesh;
    const std::size_t patches = 1 + draw.below(150);
    // Around the end, or in clusters some way off, which are seen within narrow cones.
    std::vector<Vec3> middles_m{Vec3(0.0)};
    if (draw.below(2) == 0) middles_m = {100.0 * draw.direction(), 50.0 * draw.direction()};
    for (std::size_t patch = 0; patch < patches; ++patch) {
      const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
      // Some are so large and near that they fill half of all directions.
      const double size_m = draw.below(10) == 0 ? 40.0 : draw.magnitude(0.05, 3);
      add_sheet(mesh, middles_m[draw.below(middles_m.size())] + draw.inside(Vec3(-20), Vec3(20)), size_m * u,
                draw.between(0.1, 1) * size_m * v, "rough");
    }
    TracedScene<> world(rough_scene_of(mesh));
    const LinkEnd end = world.end(draw.inside(Vec3(-5), Vec3(5)));
    std::vector<FacetId> all;
    for (std::uint32_t id = 0; id < world.scene.facets().size(); ++id) all.emplace_back(id);
    const Shades shades(world.scene, FacetOutlines(world.scene), end, all);
    REQUIRE(shades.size() > 0);
    std::vector<std::uint32_t> found;
    for (int question = 0; question < 60; ++question) {
      // Cones of a triangle, as surfaces ask, from slim ones to such as are all directions.
      std::array<Vec3, 3> corners_m;
      const Vec3 middle_m =
          end.position_m + draw.magnitude(0.1, 40) * draw.direction() + middles_m[draw.below(middles_m.size())];
      const double size_m = draw.magnitude(1e-3, 60);
      for (Vec3& corner_m : corners_m) corner_m = middle_m + size_m * draw.direction();
      const DirectionCone cone = DirectionCone::around(end.position_m, corners_m);
      wide += cone.is_all;
      const double farthest_m = draw.magnitude(0.5, 200);
      shades.find(cone, farthest_m, found);
      CHECK(std::set<std::uint32_t>(found.begin(), found.end()).size() == found.size());
      ++asked;
      found_in_all += found.size();
      for (std::uint32_t index = 0; index < shades.size(); ++index) {
        const std::span<const Vec3> patch_m = shades.corners_m(shades[index]);
        bool is_met = false;
        for (int ray = 0; ray < 12 && !is_met; ++ray) {
          // A point of the patch: is it in the cone, and near enough? Its corners are points, too.
          const Vec3 point_m = ray < 4 ? patch_m[static_cast<std::size_t>(ray) % patch_m.size()]
                                       : point_of({patch_m[0], patch_m[1], patch_m[2]}, draw);
          const Vec3 way_m = point_m - end.position_m;
          const bool is_in = cone.is_all || glm::dot(cone.axis, way_m) >= cone.cosine * glm::length(way_m);
          is_met = is_in && glm::length(way_m) <= farthest_m;
        }
        // And the corners that asked are directions of the cone.
        for (const Vec3& corner_m : corners_m) {
          const Ray<double> ray{end.position_m, glm::normalize(corner_m - end.position_m)};
          const std::optional<double> t = WatertightRay(ray).intersect({patch_m[0], patch_m[1], patch_m[2]});
          is_met = is_met || (t && *t > 0.0 && *t <= farthest_m);
        }
        if (!is_met) continue;
        ++met;
        CHECK(std::ranges::find(found, index) != found.end());
      }
    }
  }
  MESSAGE(met << " met, " << found_in_all << " found in " << asked << " questions, " << wide << " of all directions");
  CHECK(met > 5'000);
  CHECK(wide > 100);
  CHECK(wide < asked / 2);
}

TEST_CASE("shades: slim cones find few of many, and the widest comes first") {
  TriangleMesh mesh;
  Draw draw(5);
  for (int patch = 0; patch < 400; ++patch) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, 20.0 * draw.direction(), draw.between(0.5, 2) * u, draw.between(0.5, 2) * v, "rough");
  }
  TracedScene<> world(rough_scene_of(mesh));
  std::vector<FacetId> all;
  for (std::uint32_t id = 0; id < world.scene.facets().size(); ++id) all.emplace_back(id);
  const LinkEnd end = world.end(Vec3(0.0));
  const Shades shades(world.scene, FacetOutlines(world.scene), end, all);
  REQUIRE(shades.size() == 400);
  std::vector<std::uint32_t> found;
  std::size_t sum = 0;
  for (int question = 0; question < 100; ++question) {
    const Vec3 middle_m = 30.0 * draw.direction();
    const std::array<Vec3, 2> points_m{middle_m, middle_m + draw.direction()};
    shades.find(DirectionCone::around(end.position_m, points_m), 50.0, found);
    sum += found.size();
    const auto cosine = [&](std::uint32_t index) {
      return DirectionCone::around(end.position_m, shades.corners_m(shades[index])).cosine;
    };
    // Cosines are compared in single precision.
    for (std::size_t index = 1; index < found.size(); ++index) {
      CHECK(cosine(found[index - 1]) <= cosine(found[index]) + 1e-6);
    }
    shades.find(DirectionCone::around(end.position_m, points_m), 15.0, found);
    CHECK(found.empty());  // nothing is nearer than 17 m
  }
  CHECK(sum > 50);
  CHECK(sum < 100 * 40);
  shades.find({}, 40.0, found);
  CHECK(found.size() == 400);
}

}  // namespace test_shades
