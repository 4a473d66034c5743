#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/geometry/surfaces/mesh_edges.hpp"

namespace test_mesh_edges {

using namespace dcem;

namespace {

struct Examined {
  CleanMesh mesh;
  EnclosingShells shells;
};

Examined examine(const TriangleMesh& mesh) {
  const SurfaceSettings settings;
  Examined result{clean_mesh(mesh, settings), {}};
  result.shells = enclosing_shells(result.mesh, MeshEdges(result.mesh), settings.weld_tolerance_m);
  return result;
}

/// A box without the faces whose middle `left_out` accepts.
template <typename LeftOut>
TriangleMesh box_without(LeftOut&& left_out) {
  TriangleMesh box = make_box(Vec3(4, 6, 3), "wall");
  std::erase_if(box.triangles, [&](const TriangleMesh::Triangle& triangle) {
    Vec3 low(1e9), high(-1e9);
    for (const std::uint32_t vertex : triangle.vertices) {
      low = glm::min(low, box.vertices_m[vertex]);
      high = glm::max(high, box.vertices_m[vertex]);
    }
    return left_out(0.5 * (low + high));
  });
  return box;
}

TriangleMesh sheet(double z_m) {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-5, -5, z_m), Vec3(5, -5, z_m), Vec3(5, 5, z_m), Vec3(-5, 5, z_m)}, "sheet");
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other, const Vec3& offset_m) {
  for (TriangleMesh::Triangle triangle : other.triangles) {
    for (std::uint32_t& vertex : triangle.vertices) {
      mesh.vertices_m.push_back(other.vertices_m[vertex] + offset_m);
      vertex = static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
    }
    triangle.material = material_index(mesh, other.material_names[triangle.material]);
    mesh.triangles.push_back(triangle);
  }
}

}  // namespace

TEST_CASE("every side of every triangle stands at one place, places in order, triangles in order") {
  const CleanMesh mesh = clean_mesh(make_box(Vec3(1), "wall"), {});
  std::vector<MeshEdge> seen;
  std::size_t places = 0;
  MeshEdges(mesh).for_each_place([&](auto first, auto last) {
    ++places;
    CHECK(last - first == 2);  // a closed surface
    for (auto edge = first; edge != last; ++edge) {
      CHECK(edge->a < edge->b);
      CHECK(edge->same_place(*first));
      seen.push_back(*edge);
    }
  });
  CHECK(places == 18);  // 12 edges and 6 diagonals
  CHECK(seen.size() == 36);
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
}

TEST_CASE("a mesh without triangles has no places") {
  MeshEdges(CleanMesh{}).for_each_place([](auto, auto) { FAIL("a place"); });
  CHECK(enclosing_shells({}, MeshEdges(CleanMesh{}), 1e-4).closed == 0);
}

TEST_CASE("a closed box encloses; without its floor it stands; without a wall or its roof it does neither") {
  Examined box = examine(box_without([](const Vec3&) { return false; }));
  CHECK(box.shells.closed == 1);
  CHECK(box.shells.standing == 0);
  box = examine(box_without([](const Vec3& middle) { return middle.z == 0.0; }));
  CHECK(box.shells.closed == 0);
  CHECK(box.shells.standing == 1);
  CHECK(std::count(box.shells.shell_of_triangle.begin(), box.shells.shell_of_triangle.end(), 1U) == 10);
  box = examine(box_without([](const Vec3& middle) { return middle.z == 3.0; }));
  CHECK(box.shells.closed == 0);
  CHECK(box.shells.standing == 0);
  CHECK(std::count(box.shells.shell_of_triangle.begin(), box.shells.shell_of_triangle.end(), 0U) == 10);
  box = examine(box_without([](const Vec3& middle) { return middle.x == 2.0; }));
  CHECK(box.shells.closed == 0);
  CHECK(box.shells.standing == 0);
}

TEST_CASE("a level sheet encloses nothing at any height: it is no house without walls") {
  for (const double z_m : {0.0, 5.0, -3.0}) {
    const Examined ground = examine(sheet(z_m));
    CHECK(ground.shells.closed == 0);
    CHECK(ground.shells.standing == 0);
    CHECK(std::count(ground.shells.shell_of_triangle.begin(), ground.shells.shell_of_triangle.end(), 0U) == 2);
  }
}

TEST_CASE("each shell is judged by its own foot") {
  TriangleMesh mesh = box_without([](const Vec3& middle) { return middle.z == 0.0; });
  append(mesh, box_without([](const Vec3& middle) { return middle.z == 0.0; }), Vec3(20, 0, 100));
  append(mesh, box_without([](const Vec3& middle) { return middle.z == 3.0; }), Vec3(40, 0, -50));
  append(mesh, make_box(Vec3(1), "wall"), Vec3(60, 0, 7));
  const Examined town = examine(mesh);
  CHECK(town.shells.standing == 2);
  CHECK(town.shells.closed == 1);
  std::vector<std::uint32_t> numbers = town.shells.shell_of_triangle;
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  CHECK(numbers == std::vector<std::uint32_t>{0, 1, 2, 3});
}

TEST_CASE("a foot may be uneven by the tolerance, not by more") {
  for (const double lift_m : {0.9e-4, 1.1e-4}) {
    TriangleMesh mesh = box_without([](const Vec3& middle) { return middle.z == 0.0; });
    for (Vec3& vertex : mesh.vertices_m) {
      if (vertex.z == 0.0 && vertex.x > 0.0) vertex.z = lift_m;
    }
    CHECK(examine(mesh).shells.standing == (lift_m < 1e-4 ? 1 : 0));
  }
}

TEST_CASE("a crowded edge lets a shell leak") {
  TriangleMesh mesh = make_box(Vec3(4, 6, 3), "wall");
  add_quad(mesh, {Vec3(2, -3, 0), Vec3(2, 3, 0), Vec3(9, 3, 0), Vec3(9, -3, 0)}, "wall");  // a sheet at its foot
  const Examined box = examine(mesh);
  CHECK(box.shells.closed == 0);
  CHECK(box.shells.standing == 0);
}

}  // namespace test_mesh_edges
