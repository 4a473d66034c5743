#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/world/world_geometry.hpp"

using namespace dcem;

namespace {

BodyState at(const Vec3& position_m, double yaw_rad = 0.0) {
  return {true, {{position_m, yaw_rad, 0.0, 0.0}, {}}};
}

SurfaceMesh box(const Vec3& size_m) {
  return build_surface_mesh(make_box(size_m, "wall"));
}

}  // namespace

TEST_CASE("bodies are appended one after the other, each with its own first vertex, triangle, facet and hull point") {
  WorldGeometry world;
  CHECK(world.body_count() == 0);
  const SurfaceMesh one = box(Vec3(1)), two = box(Vec3(2));
  const std::vector<SurfaceMaterial> opaque{{MaterialId(4U), false}}, clear{{MaterialId(9U), true}};
  world.append(one, opaque, at(Vec3(0)));
  world.append(two, clear, at(Vec3(10, 0, 0)));
  CHECK(world.body_count() == 2);
  const WorldGeometry::First first = world.first(BodyId(1U));
  CHECK(first.vertex == 8);
  CHECK(first.triangle == 12);
  CHECK(first.facet == 6);
  CHECK(first.hull_point == 24);
  for (std::uint32_t index = 0; index < 12; ++index) {
    const WorldFacet& facet = world.facets()[index];
    CHECK(facet.body == BodyId(index / 6));
    CHECK(facet.material == MaterialId(index < 6 ? 4U : 9U));
    CHECK(facet.transmits == (index >= 6));
    CHECK(world.hull_m(facet).size() == 4);
    for (const Vec3& corner : world.hull_m(facet)) CHECK(std::abs(signed_distance_m(facet.plane, corner)) < 1e-14);
  }
  for (std::uint32_t triangle = 0; triangle < 24; ++triangle) {
    for (const std::uint32_t vertex : world.triangles()[triangle]) CHECK((vertex >= 8) == (triangle >= 12));
    CHECK((world.facet_of_triangle(triangle).value >= 6) == (triangle >= 12));
    CHECK(world.shell_of_triangle(triangle) == 1);
  }
}

TEST_CASE("body 0 stands: a pose does not move it, only its presence counts") {
  WorldGeometry world;
  const SurfaceMesh mesh = box(Vec3(1));
  world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(100, 0, 0)));
  CHECK(world.vertices_m()[0] == mesh.vertices_m[0]);
  BodyState away = at(Vec3(100, 0, 0));
  away.present = false;
  world.place(BodyId(0U), mesh, away);
  CHECK(world.vertices_m()[0] == mesh.vertices_m[0]);
  for (const Aabb<double>& one : world.triangle_boxes()) CHECK(one.empty());
}

TEST_CASE("placing one body leaves the others' bits alone") {
  WorldGeometry world;
  const SurfaceMesh mesh = box(Vec3(1));
  for (int body = 0; body < 3; ++body) world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(5 * body, 0, 0)));
  const std::vector<Vec3> before(world.vertices_m().begin(), world.vertices_m().end());
  const std::vector<Aabb<double>> boxes(world.triangle_boxes().begin(), world.triangle_boxes().end());
  world.place(BodyId(1U), mesh, at(Vec3(7, 7, 7), 0.5));
  for (std::size_t vertex = 0; vertex < before.size(); ++vertex) {
    CHECK((world.vertices_m()[vertex] == before[vertex]) == (vertex < 8 || vertex >= 16));
  }
  for (std::size_t triangle = 0; triangle < boxes.size(); ++triangle) {
    CHECK((world.triangle_boxes()[triangle] == boxes[triangle]) == (triangle < 12 || triangle >= 24));
  }
  world.place(BodyId(1U), mesh, at(Vec3(5, 0, 0)));
  for (std::size_t vertex = 0; vertex < before.size(); ++vertex) CHECK(world.vertices_m()[vertex] == before[vertex]);
}

TEST_CASE("a cleared world is empty and numbers bodies from 0 again") {
  WorldGeometry world;
  const SurfaceMesh mesh = box(Vec3(1));
  world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(0)));
  world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(3)));
  world.clear();
  CHECK(world.body_count() == 0);
  CHECK(world.facets().empty());
  CHECK(world.triangle_boxes().empty());
  world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(0)));
  CHECK(world.facets()[0].body == BodyId(0U));
  CHECK(world.first(BodyId(0U)).vertex == 0);
}
