#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/geometry/surfaces/mesh_cleaning.hpp"

namespace test_mesh_cleaning {

using namespace dcem;

namespace {

void add_triangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const std::string& material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), {a, b, c});
  mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, material)});
}

}  // namespace

TEST_CASE("a clean mesh is sorted throughout, and normals and areas are those of its triangles") {
  TriangleMesh mesh = make_box(Vec3(4, 2, 1), "metal");
  add_triangle(mesh, Vec3(9, 0, 0), Vec3(9, 3, 0), Vec3(9, 0, 4), "brick");
  const CleanMesh clean = clean_mesh(mesh, {});
  CHECK(clean.material_names == std::vector<std::string>{"brick", "metal"});
  CHECK(std::is_sorted(clean.vertices_m.begin(), clean.vertices_m.end(), lexicographic_less));
  CHECK(std::is_sorted(clean.triangles.begin(), clean.triangles.end()));
  REQUIRE(clean.triangles.size() == 13);
  REQUIRE(clean.normals.size() == 13);
  REQUIRE(clean.areas_m2.size() == 13);
  double sum_m2 = 0.0;
  for (std::uint32_t index = 0; index < 13; ++index) {
    const auto& corners = clean.triangles[index].vertices;
    CHECK((corners[0] < corners[1] && corners[1] < corners[2]));
    CHECK(glm::length(clean.normals[index]) == doctest::Approx(1.0).epsilon(1e-15));
    for (std::size_t corner = 1; corner < 3; ++corner) {
      CHECK(glm::dot(clean.normals[index], clean.corner_m(index, corner) - clean.corner_m(index, 0)) == 0.0);
    }
    sum_m2 += clean.areas_m2[index];
  }
  CHECK(sum_m2 == doctest::Approx(2 * (4 * 2 + 2 * 1 + 1 * 4) + 6).epsilon(1e-14));
}

TEST_CASE("a triangle has area where its height over its longest side is a thousandth of the weld tolerance") {
  // 1e-7 m for the default of 1e-4 m.
  for (const double height_m : {0.9e-7, 1.1e-7}) {
    TriangleMesh mesh;
    add_triangle(mesh, Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(5, height_m, 0), "wall");
    const CleanMesh clean = clean_mesh(mesh, {});
    CHECK(clean.triangles.size() == (height_m > 1e-7 ? 1 : 0));
    CHECK(clean.report.triangles_without_area == (height_m > 1e-7 ? 0 : 1));
  }
}

TEST_CASE("with tolerance 0 a triangle needs a height of a millionth of a millionth of its longest side") {
  SurfaceSettings exact;
  exact.weld_tolerance_m = 0.0;
  for (const double height_m : {0.5e-12, 2e-12}) {
    TriangleMesh mesh;
    add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, height_m, 0), "wall");
    CHECK(clean_mesh(mesh, exact).triangles.size() == (height_m > 1e-12 ? 1 : 0));
  }
}

TEST_CASE("welding that closes a triangle leaves no trace of it but a count") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(0.5e-4, 0, 0), Vec3(0, 1, 0), "wall");
  const CleanMesh clean = clean_mesh(mesh, {});
  CHECK(clean.triangles.empty());
  CHECK(clean.report.vertices_welded == 1);
  CHECK(clean.report.triangles_without_area == 1);
  CHECK(clean.report.triangles_repeated == 0);
}

TEST_CASE("of triangles at one place the material whose name comes first stays, not the one listed first") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), "wood");
  add_triangle(mesh, Vec3(0, 1, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), "brick");
  add_triangle(mesh, Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0), "metal");
  const CleanMesh clean = clean_mesh(mesh, {});
  REQUIRE(clean.triangles.size() == 1);
  CHECK(clean.material_names[clean.triangles[0].material] == "brick");
  CHECK(clean.report.triangles_repeated == 2);
}

TEST_CASE("the largest coordinate is 1e9 m from the origin, and what lies there is a number") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(1e9, 0, 0), Vec3(0, 1e9, 0), Vec3(0, 0, -1e9), "wall");
  const CleanMesh clean = clean_mesh(mesh, {});
  REQUIRE(clean.triangles.size() == 1);
  CHECK(is_finite(clean.normals[0]));
  // A regular triangle of side √2·1e9.
  CHECK(clean.areas_m2[0] == doctest::Approx(std::sqrt(3.0) / 2 * 1e18).epsilon(1e-14));
  mesh.vertices_m[0].x = std::nextafter(1e9, 2e9);
  CHECK_THROWS_AS(clean_mesh(mesh, {}), std::invalid_argument);
}

}  // namespace test_mesh_cleaning
