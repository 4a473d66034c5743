/// A device knows the facets it is mounted on: those within the weld tolerance.
#include "dcem/paths/query/link_end.hpp"

#include <doctest/doctest.h>

#include "tests/paths/small_scenes.hpp"

namespace test_link_end {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("mounted means within the weld tolerance of a facet, not of its plane") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 1.0, "glass");
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(0, 1.5, 0), Vec3(0, 0, 1.5), "metal");  // the same plane, larger
  TracedScene<> traced(scene_of(mesh));
  CHECK(traced.end(Vec3(0, 0.3, 0.2)).mounted_on.size() == 2);
  CHECK(traced.end(Vec3(0.9e-4, 0.3, 0.2)).mounted_on.size() == 2);
  CHECK(traced.end(Vec3(-0.9e-4, 1.2, 0.2)).mounted_on.size() == 1);
  CHECK(traced.end(Vec3(1.1e-4, 0.3, 0.2)).mounted_on.empty());
  CHECK(traced.end(Vec3(0, 1.6, 0.2)).mounted_on.empty());
}

TEST_CASE("the body a device rides on is not what it is mounted on") {
  Scene scene = scene_of_materials();
  const BodyId car = scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), {});
  scene.add_object("sign", make_box(Vec3(1, 1, 0.1), "metal"), LinearMotion{{Vec3(0, 0, 1.5)}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const Vec3 roof_m(0.2, 0.1, 1.5);
  const LinkEnd rider = traced.end(roof_m, car), other = traced.end(roof_m);
  CHECK(other.mounted_on.size() == 2);
  REQUIRE(rider.mounted_on.size() == 1);
  CHECK(traced.scene.facet(rider.mounted_on[0]).body != car);
  CHECK(rider.ignored_body == car);
  CHECK(rider.position_m == roof_m);
}

}  // namespace test_link_end
