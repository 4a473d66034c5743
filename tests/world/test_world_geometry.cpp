#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/world/world_geometry.hpp"

namespace test_world_geometry {

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

TEST_CASE("the rim of a sheet is listed once at its facet, an edge of a box once at each of its two") {
  TriangleMesh quad;
  add_quad(quad, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 2), Vec3(0, 0, 2)}, "wall");
  WorldGeometry world;
  world.append(build_surface_mesh(quad), std::vector<SurfaceMaterial>(1), at(Vec3(0)));
  world.append(box(Vec3(1)), std::vector<SurfaceMaterial>(1), at(Vec3(5, 0, 0)));
  REQUIRE(world.wedges().size() == 4 + 12);
  std::vector<int> times(world.wedges().size(), 0);
  for (std::uint32_t facet = 0; facet < world.facets().size(); ++facet) {
    CHECK(world.wedges_of_facet(FacetId(facet)).size() == 4);
    for (const WedgeId wedge : world.wedges_of_facet(FacetId(facet))) ++times[wedge.value];
  }
  for (std::size_t wedge = 0; wedge < times.size(); ++wedge) CHECK(times[wedge] == (wedge < 4 ? 1 : 2));
}

TEST_CASE("the edges of a body turn with it: their ends, and the frame from which azimuths count") {
  WorldGeometry world;
  const SurfaceMesh mesh = box(Vec3(2, 3, 1));
  world.append(mesh, std::vector<SurfaceMaterial>(1), at(Vec3(0)));
  const Pose pose{Vec3(3, -4, 5), 0.7, -0.4, 1.1};
  world.append(mesh, std::vector<SurfaceMaterial>(1), {true, {pose, {}}});
  const Mat3 rotation = rotation_matrix(pose);
  REQUIRE(world.wedges().size() == 2 * mesh.wedges.size());
  for (std::size_t index = 0; index < mesh.wedges.size(); ++index) {
    const Wedge &local = mesh.wedges[index], &edge = world.wedges()[mesh.wedges.size() + index].edge;
    // Coordinates below ten metres: a few of their roundings.
    CHECK(glm::distance(edge.start_m, pose.position_m + rotation * local.start_m) < 1e-14);
    CHECK(glm::distance(edge.end_m, pose.position_m + rotation * local.end_m) < 1e-14);
    CHECK(glm::distance(edge.tangent, rotation * local.tangent) < 1e-15);
    CHECK(glm::distance(edge.normal, rotation * local.normal) < 1e-15);
    CHECK(glm::distance(edge_length_m(edge) * edge_direction(edge), edge.end_m - edge.start_m) < 1e-14);
  }
}

}  // namespace test_world_geometry
