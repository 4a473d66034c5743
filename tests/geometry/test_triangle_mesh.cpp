#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "dcem/geometry/triangle_mesh.hpp"

namespace test_triangle_mesh {

using namespace dcem;

namespace {

const Vec3& corner(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle, std::size_t index) {
  return mesh.vertices_m[triangle.vertices[index]];
}

}  // namespace

TEST_CASE("a material name has one index") {
  TriangleMesh mesh;
  CHECK(material_index(mesh, "wall") == 0);
  CHECK(material_index(mesh, "glass") == 1);
  CHECK(material_index(mesh, "wall") == 0);
  CHECK(mesh.material_names == std::vector<std::string>{"wall", "glass"});
}

TEST_CASE("a quadrilateral becomes two triangles that cover it and wind alike") {
  TriangleMesh mesh;
  material_index(mesh, "other");
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 3, 0), Vec3(0, 3, 0)}, "wall");
  add_quad(mesh, {Vec3(0, 0, 1), Vec3(4, 0, 1), Vec3(4, 3, 1), Vec3(0, 3, 1)}, "wall");
  REQUIRE(mesh.triangles.size() == 4);
  for (std::size_t quad = 0; quad < 2; ++quad) {
    Vec3 area(0.0);
    for (std::size_t index = 2 * quad; index < 2 * quad + 2; ++index) {
      const auto& triangle = mesh.triangles[index];
      CHECK(triangle.material == 1);
      CHECK(corner(mesh, triangle, 0).z == static_cast<double>(quad));
      const Vec3 part = 0.5 * glm::cross(corner(mesh, triangle, 1) - corner(mesh, triangle, 0),
                                         corner(mesh, triangle, 2) - corner(mesh, triangle, 0));
      CHECK(part.z == 6.0);
      area += part;
    }
    CHECK(area == Vec3(0, 0, 12));
  }
}

TEST_CASE("a box stands on z = 0 over the origin, is closed, and looks outwards") {
  const TriangleMesh box = make_box(Vec3(12.0, 2.5, 3.2), "metal");
  REQUIRE(box.triangles.size() == 12);
  double six_volumes = 0.0;
  std::map<std::array<double, 6>, int> directed_edges;
  for (const auto& triangle : box.triangles) {
    const Vec3 a = corner(box, triangle, 0), b = corner(box, triangle, 1), c = corner(box, triangle, 2);
    six_volumes += glm::dot(a, glm::cross(b, c));
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      ++directed_edges[{from.x, from.y, from.z, to.x, to.y, to.z}];
    }
    for (const Vec3& point : {a, b, c}) {
      CHECK(std::abs(point.x) == 6.0);
      CHECK(std::abs(point.y) == 1.25);
      CHECK((point.z == 0.0 || point.z == 3.2));
    }
  }
  // The divergence theorem: the signed volume is positive where all normals look outwards.
  CHECK(six_volumes / 6.0 == doctest::Approx(12.0 * 2.5 * 3.2).epsilon(1e-14));
  CHECK(directed_edges.size() == 36);  // each edge once each way: closed and wound consistently
  for (const auto& [edge, count] : directed_edges) {
    CHECK(count == 1);
    CHECK(directed_edges.count({edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]}) == 1);
  }
  CHECK(box.material_names == std::vector<std::string>{"metal"});
}

}  // namespace test_triangle_mesh
