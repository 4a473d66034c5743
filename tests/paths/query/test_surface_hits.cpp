/// Rays that leave one place together meet what each of them meets alone, whatever their device is mounted on.
#include "dcem/paths/query/surface_hits.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "dcem/paths/discover/launch_sphere.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_surface_hits {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A street of boxes and a car.
struct Street {
  static Scene scene(BodyId& car) {
    TriangleMesh mesh;
    add_sheet(mesh, Vec3(0, 0, 0), Vec3(60, 0, 0), Vec3(0, 60, 0), "metal");
    for (int house = 0; house < 8; ++house) {
      const Vec3 low_m(12.0 * (house % 4) - 24.0, house < 4 ? 5.0 : -15.0, 0.0);
      add_box_faces(mesh, low_m, low_m + Vec3(10, 10, 6 + house), house % 2 == 0 ? "wall" : "metal");
    }
    Scene result = scene_of(mesh);
    car = result.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), {});
    return result;
  }

  BodyId car{};
  TracedScene<> traced{scene(car)};
};

/// How many of the rays meet something.
std::size_t check_around(TracedScene<>& traced, const LegEnd& start, const Vec3& from_m, const IgnoredBodies& ignored) {
  std::vector<Vec3> directions;
  for (const Vec3& direction : launch_directions(3000)) directions.push_back(direction);
  for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, -1), Vec3(-1, 1, 0)}) directions.push_back(along);
  SurfaceHits together, one_by_one;
  TraversalCounters of_fan, of_rays, counters;
  together.find_around(traced.tracer, from_m, directions, start, ignored, of_fan);
  for (const Vec3& direction : directions) one_by_one.add(traced.scene, {from_m, direction}, start, ignored);
  one_by_one.find(traced.tracer, of_rays);
  CHECK(of_fan == of_rays);
  CHECK(of_fan.nodes_visited > 0);
  REQUIRE(together.size() == directions.size());
  std::size_t count = 0;
  for (std::size_t ray = 0; ray < directions.size(); ++ray) {
    CAPTURE(ray);
    REQUIRE(together.hit(ray) == one_by_one.hit(ray));
    const auto alone = traced.tracer.closest_hit({from_m, directions[ray]}, start, ignored, counters);
    REQUIRE(together.hit(ray).has_value() == alone.has_value());
    if (!alone) continue;
    CHECK(together.hit(ray)->t == alone->t);
    CHECK(traced.scene.facet_of_triangle(together.hit(ray)->triangle) == alone->facet);
    ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("rays from a device in the street, on the ground, on a wall, on a roof's edge and on its car") {
  Street street;
  for (const Vec3& from_m : {Vec3(-5, 0, 2), Vec3(-5, 0, 0), Vec3(-22, 5, 3), Vec3(-24, 5, 6), Vec3(0.3, 0.2, 1.5)}) {
    CAPTURE(from_m.x);
    for (const bool rides : {false, true}) {
      const LinkEnd end = street.traced.end(from_m, rides ? std::optional(street.car) : std::nullopt);
      CHECK(check_around(street.traced, {end.mounted_on, {}}, from_m, {end.ignored_body, std::nullopt}) > 500);
    }
  }
}

TEST_CASE("what lies at the very place is not met, though nothing says that the device is mounted on it") {
  Street street;
  for (const Vec3& from_m : {Vec3(-5, 0, 0), Vec3(-22, 5, 3)}) {
    CHECK(check_around(street.traced, {}, from_m, {}) > 500);
  }
}

TEST_CASE("rays from a point of a facet, and from close before its plane") {
  Street street;
  const Vec3 before_m(-5, 0, 5e-5);
  const Plane& ground = street.traced.scene.facet(street.traced.facet_at(Vec3(-5, 0, 0), "metal")).plane;
  CHECK(check_around(street.traced, {{}, {&ground, nullptr}}, before_m, {}) > 500);
  CHECK(check_around(street.traced, {{}, {nullptr, &ground}}, before_m, {}) > 500);
  const Vec3 at_m(-22, 5, 3);
  const FacetId wall = street.traced.facet_at(at_m, "wall");
  const LegEnd start{{&wall, 1}, {&street.traced.scene.facet(wall).plane, nullptr}};
  CHECK(check_around(street.traced, start, at_m, {}) > 500);
}

}  // namespace test_surface_hits
