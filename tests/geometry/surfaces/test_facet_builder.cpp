#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"

namespace test_facet_builder {

using namespace dcem;

namespace {

void add_triangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c,
                  const std::string& material = "wall") {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), {a, b, c});
  mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, material)});
}

void append(TriangleMesh& mesh, const TriangleMesh& other, const Vec3& offset_m = Vec3(0.0)) {
  for (const auto& triangle : other.triangles) {
    const auto corner = [&](std::size_t index) { return offset_m + other.vertices_m[triangle.vertices[index]]; };
    add_triangle(mesh, corner(0), corner(1), corner(2), other.material_names[triangle.material]);
  }
}

template <typename Value>
void shuffle(std::vector<Value>& values, RandomStream& random) {
  for (std::size_t last = values.size(); last > 1; --last) std::swap(values[last - 1], values[random.next() % last]);
}

/// The same surface as another file would write it: triangles, vertices, corners, winding and materials in any order.
TriangleMesh rewritten(const TriangleMesh& mesh, RandomStream& random) {
  TriangleMesh other;
  std::vector<std::uint32_t> vertex_order(mesh.vertices_m.size()), new_vertex(mesh.vertices_m.size());
  std::iota(vertex_order.begin(), vertex_order.end(), 0U);
  shuffle(vertex_order, random);
  for (std::uint32_t index = 0; index < vertex_order.size(); ++index) {
    new_vertex[vertex_order[index]] = index;
    other.vertices_m.push_back(mesh.vertices_m[vertex_order[index]]);
  }
  other.material_names = mesh.material_names;
  shuffle(other.material_names, random);
  for (TriangleMesh::Triangle triangle : mesh.triangles) {
    for (std::uint32_t& vertex : triangle.vertices) vertex = new_vertex[vertex];
    std::swap(triangle.vertices[random.next() % 3], triangle.vertices[random.next() % 3]);
    std::rotate(triangle.vertices.begin(), triangle.vertices.begin() + random.next() % 3, triangle.vertices.end());
    triangle.material = material_index(other, mesh.material_names[triangle.material]);
    other.triangles.push_back(triangle);
  }
  shuffle(other.triangles, random);
  return other;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

std::vector<Vec3> planes(const SurfaceMesh& mesh) {
  std::vector<Vec3> vectors;
  for (const Facet& facet : mesh.facets) vectors.insert(vectors.end(), {facet.plane.point_m, facet.plane.normal});
  return vectors;
}

bool same_layout(const Facet& a, const Facet& b) {
  return a.material == b.material && a.first_triangle == b.first_triangle && a.triangle_count == b.triangle_count &&
         a.first_hull_point == b.first_hull_point && a.hull_point_count == b.hull_point_count;
}

bool same_report(const SurfaceReport& a, const SurfaceReport& b) {
  const auto counts = [](const SurfaceReport& report) {
    return std::array{report.vertices_read,          report.vertices_welded,    report.triangles_read,
                      report.triangles_without_area, report.triangles_repeated, report.open_edges,
                      report.crowded_edges,          report.uneven_sets,        report.closed_shells,
                      report.standing_shells};
  };
  return counts(a) == counts(b);
}

void check_identical(const SurfaceMesh& a, const SurfaceMesh& b) {
  CHECK(a.material_names == b.material_names);
  CHECK(same_bits(a.vertices_m, b.vertices_m));
  CHECK(a.triangles == b.triangles);
  CHECK(a.facet_of_triangle == b.facet_of_triangle);
  CHECK(a.shell_of_triangle == b.shell_of_triangle);
  CHECK(same_bits(planes(a), planes(b)));
  CHECK(std::equal(a.facets.begin(), a.facets.end(), b.facets.begin(), b.facets.end(), same_layout));
  CHECK(same_bits(a.hull_points_m, b.hull_points_m));
  CHECK(same_report(a.report, b.report));
}

/// Two triangles over the edge from (0,0,0) to (0,1,0). The second is folded up so that its corner, `reach_m` away,
/// rises by `rise_m` above the plane of the first, whose own corner is `first_reach_m` away.
TriangleMesh fold(double first_reach_m, double reach_m, double rise_m) {
  TriangleMesh mesh;
  const Vec3 low(0, 0, 0), high(0, 1, 0);
  add_triangle(mesh, low, high, Vec3(-first_reach_m, 0.4, 0));
  add_triangle(mesh, low, high, Vec3(std::sqrt(reach_m * reach_m - rise_m * rise_m), 0.6, rise_m));
  return mesh;
}

std::size_t facet_count(const TriangleMesh& mesh, const SurfaceSettings& settings = {}) {
  return build_surface_mesh(mesh, settings).facets.size();
}

double area_m2(const SurfaceMesh& mesh, const Facet& facet) {
  double sum = 0.0;
  for (std::uint32_t index = facet.first_triangle; index < facet.first_triangle + facet.triangle_count; ++index) {
    const auto& v = mesh.triangles[index];
    sum += 0.5 * glm::length(glm::cross(mesh.vertices_m[v[1]] - mesh.vertices_m[v[0]],
                                        mesh.vertices_m[v[2]] - mesh.vertices_m[v[0]]));
  }
  return sum;
}

/// The unit cube, each face cut in its own way into `cells` × `cells` cells and each cell along either diagonal.
TriangleMesh cut_cube(int cells, RandomStream& random) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int level = 0; level < 2; ++level) {
      const auto at = [&](int i, int j) {
        Vec3 point(0.0);
        point[axis] = level;
        point[(axis + 1) % 3] = static_cast<double>(i) / cells;
        point[(axis + 2) % 3] = static_cast<double>(j) / cells;
        return point;
      };
      for (int cell = 0; cell < cells * cells; ++cell) {
        const int i = cell % cells, j = cell / cells;
        const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
        if (random.next() % 2 == 0) {
          add_triangle(mesh, a, b, c);
          add_triangle(mesh, d, a, c);
        } else {
          add_triangle(mesh, b, a, d);
          add_triangle(mesh, b, c, d);
        }
      }
    }
  }
  return mesh;
}

/// A strip of `steps` quads of 1 m height around a cylinder.
TriangleMesh bent_strip(int steps, double step_deg, double radius_m) {
  TriangleMesh mesh;
  const auto at = [&](int step, double z) {
    const double angle_rad = degrees_to_radians(step * step_deg);
    return Vec3(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), z);
  };
  for (int step = 0; step < steps; ++step) {
    add_quad(mesh, {at(step, 0), at(step + 1, 0), at(step + 1, 1), at(step, 1)}, "wall");
  }
  return mesh;
}

/// Everything that goes wrong in a town at once.
TriangleMesh messy_town(RandomStream& random) {
  TriangleMesh mesh;
  for (int house = 0; house < 12; ++house) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    append(mesh, make_box(Vec3(3 + 9 * x, 4 + 7 * y, 2 + 20 * z), house % 2 == 0 ? "brick" : "concrete"),
           Vec3(20 * (house % 4), 15 * (house / 4), 0) + Vec3(x, y, 0));
  }
  append(mesh, make_box(Vec3(5, 5, 5), "brick"), Vec3(100, 0, 0));  // side by side: crowded edges
  append(mesh, make_box(Vec3(5, 5, 5), "glass"), Vec3(105, 0, 0));
  append(mesh, make_box(Vec3(5, 5, 5), "adobe"), Vec3(105, 5, 0));
  append(mesh, cut_cube(3, random), Vec3(-10, 0, 0));
  const std::size_t clean = mesh.triangles.size();
  for (std::size_t index = 0; index < clean; index += 5) {  // again, jittered, of another material
    const auto vertices = mesh.triangles[index].vertices;
    const auto corner = [&](std::size_t k) {
      const double dx = random.uniform() - 0.5, dy = random.uniform() - 0.5;
      return mesh.vertices_m[vertices[k]] + 1e-5 * Vec3(dx, dy, 0);
    };
    add_triangle(mesh, corner(0), corner(1), corner(2), index % 2 == 0 ? "zinc" : "adobe");
    add_triangle(mesh, corner(0), corner(0), corner(1));
    add_triangle(mesh, corner(0), corner(1), 0.5 * (corner(0) + corner(1)));
  }
  append(mesh, bent_strip(120, 0.05, 10.0), Vec3(0, -50, 0));
  append(mesh, make_box(Vec3(8, 6, 9), "brick"), Vec3(0, -100, 0));
  append(mesh, make_box(Vec3(8, 6, 9), "brick"), Vec3(0.3, -120, 0));
  return mesh;
}

}  // namespace

TEST_CASE("a cube has six facets however its faces were cut, and each is one square") {
  RandomStream random(30);
  for (int cells = 1; cells <= 5; ++cells) {
    const SurfaceMesh mesh = build_surface_mesh(cut_cube(cells, random));
    REQUIRE(mesh.facets.size() == 6);
    CHECK(mesh.report.uneven_sets == 0);
    for (const Facet& facet : mesh.facets) {
      CHECK(facet.triangle_count == static_cast<std::uint32_t>(2 * cells * cells));
      CHECK(area_m2(mesh, facet) == doctest::Approx(1.0).epsilon(1e-14));
      CHECK(facet.hull_point_count == 4);
      // Whole numbers and fractions of one: a plane's normal and level are right to a few roundings.
      const Vec3 size = glm::abs(facet.plane.normal);
      CHECK(std::max({size.x, size.y, size.z}) == doctest::Approx(1.0).epsilon(1e-15));
      const double level = std::abs(signed_distance_m(facet.plane, Vec3(0.5)));
      CHECK(level == doctest::Approx(0.5).epsilon(1e-14));
      CHECK(glm::distance(facet.plane.point_m, Vec3(0.5)) == doctest::Approx(0.5).epsilon(1e-14));  // the face's centre
    }
  }
}

TEST_CASE("the order of triangles, vertices, corners, winding and materials changes no bit") {
  RandomStream random(31);
  const TriangleMesh mesh = messy_town(random);
  const SurfaceMesh expected = build_surface_mesh(mesh);
  CHECK(expected.report.triangles_repeated > 20);  // the town is messy indeed
  CHECK(expected.report.triangles_without_area > 20);
  CHECK(expected.report.crowded_edges > 0);
  CHECK(expected.report.open_edges > 0);
  CHECK(expected.report.uneven_sets == 1);
  CHECK(expected.report.closed_shells == 2);
  for (int repeat = 0; repeat < 20; ++repeat) check_identical(build_surface_mesh(rewritten(mesh, random)), expected);
}

TEST_CASE("a file that writes -0 for some of its zeros changes no bit with its order either") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0.0, 0, 0), Vec3(4, 0, 0), Vec3(4, 3, 0));
  add_triangle(mesh, Vec3(-0.0, -0.0, 0), Vec3(0, 3, -0.0), Vec3(4, 3, 0));
  const SurfaceMesh expected = build_surface_mesh(mesh);
  CHECK(expected.facets.size() == 1);
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  check_identical(build_surface_mesh(mesh), expected);
}

TEST_CASE("normals that differ by 0.09 degrees join, by 0.11 degrees do not") {
  for (const bool reversed : {false, true}) {
    const auto folded = [&](double angle_deg) {
      // 0.3 m away a fold of 0.11° rises by 0.58 mm: the corner alone would pass.
      TriangleMesh mesh = fold(0.3, 0.3, 0.3 * std::sin(degrees_to_radians(angle_deg)));
      if (reversed) std::swap(mesh.triangles[0].vertices[0], mesh.triangles[0].vertices[1]);
      return mesh;
    };
    CHECK(facet_count(folded(0.0)) == 1);
    CHECK(facet_count(folded(0.09)) == 1);
    CHECK(facet_count(folded(0.0999)) == 1);
    CHECK(facet_count(folded(0.1001)) == 2);
    CHECK(facet_count(folded(0.11)) == 2);
    CHECK(facet_count(folded(-0.09)) == 1);
    CHECK(facet_count(folded(-0.11)) == 2);
  }
}

TEST_CASE("an opposite corner 0.9 mm out of plane joins, 1.1 mm does not, whichever of the two strays") {
  // 1 m away, 1.1 mm are 0.063°: the angle alone would pass.
  CHECK(facet_count(fold(1.0, 1.0, 0.9e-3)) == 1);
  CHECK(facet_count(fold(1.0, 1.0, 1.1e-3)) == 2);
  CHECK(facet_count(fold(0.1, 1.0, 1.1e-3)) == 2);        // the second strays from the first
  CHECK(facet_count(fold(1.0, 0.1, 0.1 * 1.1e-3)) == 2);  // the first from the second
  CHECK(facet_count(fold(0.1, 1.0, 0.9e-3)) == 1);
  CHECK(facet_count(fold(1.0, 0.1, 0.1 * 0.9e-3)) == 1);
  SurfaceSettings strict;
  strict.planarity_tolerance_m = 1e-4;
  CHECK(facet_count(fold(1.0, 1.0, 0.9e-3), strict) == 2);
  CHECK(facet_count(fold(1.0, 1.0, 0.9e-4), strict) == 1);
}

TEST_CASE("triangles of different materials never join") {
  TriangleMesh mesh = fold(1.0, 1.0, 0.0);
  CHECK(facet_count(mesh) == 1);
  mesh.triangles[1].material = material_index(mesh, "glass");
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.facets.size() == 2);
  CHECK(surface.material_names == std::vector<std::string>{"glass", "wall"});
  CHECK(surface.facets[0].material != surface.facets[1].material);
  CHECK(surface.report.open_edges == 4);  // the edge is shared all the same
}

TEST_CASE("one name under two indices is one material") {
  TriangleMesh mesh = fold(1.0, 1.0, 0.0);
  mesh.material_names = {"wall", "wall"};
  mesh.triangles[1].material = 1;
  CHECK(facet_count(mesh) == 1);
}

TEST_CASE("a T-junction is no shared edge") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, -1, 0));
  add_triangle(mesh, Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(1, -1, 0));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.facets.size() == 2);
  CHECK(surface.report.open_edges == 7);
  CHECK(surface.report.crowded_edges == 0);
}

TEST_CASE("touching at one corner joins nothing") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0));
  CHECK(facet_count(mesh) == 2);
}

TEST_CASE("edges meet through welded vertices: 0.09 mm apart is shared, 0.11 mm is not") {
  for (const double gap_m : {0.9e-4, 1.1e-4}) {
    TriangleMesh mesh;
    add_triangle(mesh, Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0.5, 0));
    add_triangle(mesh, Vec3(gap_m, 0, 0), Vec3(gap_m, 1, 0), Vec3(1, 0.5, 0));
    const SurfaceMesh surface = build_surface_mesh(mesh);
    CHECK(surface.facets.size() == (gap_m < 1e-4 ? 1 : 2));
    CHECK(surface.report.vertices_welded == (gap_m < 1e-4 ? 2 : 0));
    CHECK(surface.report.open_edges == (gap_m < 1e-4 ? 4 : 6));
  }
}

TEST_CASE("of repeated triangles the material whose name comes first stays") {
  for (const bool reversed : {false, true}) {
    TriangleMesh mesh;
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), near(1e-5, 0, 0);
    add_triangle(mesh, a, b, c, "metal");
    add_triangle(mesh, c + near, b, a, "brick");  // other winding, welded corners
    add_triangle(mesh, b, a + near, c, "wood");
    add_triangle(mesh, b, a, c, "brick");
    if (reversed) std::reverse(mesh.triangles.begin(), mesh.triangles.end());
    const SurfaceMesh surface = build_surface_mesh(mesh);
    REQUIRE(surface.facets.size() == 1);
    CHECK(surface.material_names[surface.facets[0].material] == "brick");
    CHECK(surface.report.triangles_repeated == 3);
    CHECK(surface.triangles.size() == 1);
    CHECK(surface.report.open_edges == 3);
    CHECK(surface.report.crowded_edges == 0);
  }
}

TEST_CASE("triangles without area are dropped and counted: points, collinear corners, and what welding closes") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0));
  add_triangle(mesh, Vec3(5), Vec3(5), Vec3(5));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0, 0));
  add_triangle(mesh, Vec3(9, 0, 0), Vec3(9.00005, 0, 0), Vec3(9, 1, 0));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.triangles_without_area == 3);
  CHECK(surface.triangles.size() == 1);
  CHECK(surface.report.open_edges == 3);
}

TEST_CASE("a thin triangle with area stays, and its normal is a number, also 10 km out") {
  for (const Vec3& at : {Vec3(0.0), Vec3(1e4, -1e4, 1e4)}) {
    TriangleMesh mesh;
    add_triangle(mesh, at, at + Vec3(100, 0, 0), at + Vec3(50, 2e-4, 0));
    const SurfaceMesh surface = build_surface_mesh(mesh);
    REQUIRE(surface.facets.size() == 1);
    // Steps of 1.8e-12 m in a height of 2e-4 m.
    CHECK(std::abs(surface.facets[0].plane.normal.z) == doctest::Approx(1.0).epsilon(1e-14));
  }
}

TEST_CASE("an empty mesh, or one without a good triangle, is an empty surface") {
  CHECK(build_surface_mesh({}).facets.empty());
  TriangleMesh mesh;
  mesh.vertices_m = {Vec3(1), Vec3(2)};  // no triangle uses them
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.vertices_read == 2);
  CHECK(surface.report.vertices_welded == 0);
  CHECK(surface.vertices_m.empty());
}

TEST_CASE("vertices that no triangle uses weld nothing together") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1.6e-4, 0, 0), Vec3(0, 1, 0));
  mesh.vertices_m.emplace_back(0.8e-4, 0, 0);  // would be the middle of a chain
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.triangles.size() == 1);
  CHECK(surface.report.vertices_read == 4);
  CHECK(surface.report.vertices_welded == 0);
}

TEST_CASE("a strip that bends slowly is one facet up to five tolerances, its triangles beyond") {
  // Radius 10 m, steps of 0.05°: neighbours are coplanar. Over 3° the sagitta is 10(1 − cos 1.5°) = 3.4 mm: within 5 mm
  // of any sensible mean plane. Over 6° it is 13.7 mm, and no plane is within 5 mm of a band 13.7 mm deep.
  const SurfaceMesh shallow = build_surface_mesh(bent_strip(60, 0.05, 10.0));
  CHECK(shallow.facets.size() == 1);
  CHECK(shallow.report.uneven_sets == 0);
  const SurfaceMesh deep = build_surface_mesh(bent_strip(120, 0.05, 10.0));
  CHECK(deep.facets.size() == 240);
  CHECK(deep.report.uneven_sets == 1);
  for (const Facet& facet : deep.facets) CHECK(facet.triangle_count == 1);
  SurfaceSettings loose;
  loose.planarity_tolerance_m = 3e-3;  // 15 mm
  CHECK(facet_count(bent_strip(120, 0.05, 10.0), loose) == 1);
  // A whole cylinder that closes on itself.
  const SurfaceMesh cylinder = build_surface_mesh(bent_strip(7200, 0.05, 10.0));
  CHECK(cylinder.facets.size() == 14'400);
  CHECK(cylinder.report.uneven_sets == 1);
  CHECK(cylinder.report.open_edges == 14'400);
}

TEST_CASE("a facet's plane is the area-weighted mean: small ripples of a large wall hardly tilt it") {
  TriangleMesh mesh;
  const double slope = 1e-4;  // over 9 m it rises by 0.9 mm
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(9, 1, 0), Vec3(0, 1, 0)}, "wall");
  add_quad(mesh, {Vec3(9, 0, 0), Vec3(9.5, 0, 0.5 * slope), Vec3(9.5, 1, 0.5 * slope), Vec3(9, 1, 0)}, "wall");
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(surface.facets.size() == 1);
  const Plane& plane = surface.facets[0].plane;
  // Areas 9 and 0.5·√(1 + slope²); normals (0,0,1) and (−slope,0,1)/√(1 + slope²).
  const double length = std::sqrt(1 + slope * slope);
  const Vec3 expected = glm::normalize(9.0 * Vec3(0, 0, 1) + 0.5 * length * Vec3(-slope, 0, 1) / length);
  CHECK(std::abs(glm::dot(plane.normal, expected)) == doctest::Approx(1.0).epsilon(1e-15));
  CHECK(glm::length(glm::cross(plane.normal, expected)) < 1e-14);
  const double total = 9.0 + 0.5 * length;
  const Vec3 centre = (9.0 * Vec3(4.5, 0.5, 0) + 0.5 * length * Vec3(9.25, 0.5, 0.25 * slope)) / total;
  CHECK(glm::distance(plane.point_m, centre) < 1e-14);
}

TEST_CASE("crowded edges are counted, and coplanar pairs at them join") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.crowded_edges == 1);
  CHECK(surface.report.open_edges == 6);
  CHECK(surface.facets.size() == 2);
}

TEST_CASE("closed shells are numbered from one; open or crowded ones have number 0") {
  TriangleMesh apart;
  append(apart, make_box(Vec3(2, 2, 2), "wall"));
  append(apart, make_box(Vec3(2, 2, 2), "glass"), Vec3(5, 0, 0));
  append(apart, make_box(Vec3(2, 2, 2), "wall"), Vec3(7, 2, 2));  // touches the second at one corner
  SurfaceMesh surface = build_surface_mesh(apart);
  CHECK(surface.report.closed_shells == 3);
  CHECK(surface.report.open_edges == 0);
  for (std::size_t index = 0; index < surface.triangles.size(); ++index) {
    Vec3 centre(0.0);
    for (const std::uint32_t vertex : surface.triangles[index]) centre += surface.vertices_m[vertex] / 3.0;
    const double along = centre.x + centre.y + centre.z;  // the boxes touch at (6, 1, 2): 9
    CHECK(surface.shell_of_triangle[index] == (centre.x < 2 ? 1 : (along < 9.0 ? 2 : 3)));
  }

  TriangleMesh opened = apart;
  opened.triangles.pop_back();
  surface = build_surface_mesh(opened);
  CHECK(surface.report.closed_shells == 2);
  CHECK(surface.report.open_edges == 3);
  CHECK(std::count(surface.shell_of_triangle.begin(), surface.shell_of_triangle.end(), 0U) == 11);

  TriangleMesh wall_to_wall;  // two boxes that share a wall, corner on corner: its four sides are crowded
  append(wall_to_wall, make_box(Vec3(2, 2, 2), "wall"));
  append(wall_to_wall, make_box(Vec3(2, 2, 2), "wall"), Vec3(2, 0, 0));
  surface = build_surface_mesh(wall_to_wall);
  CHECK(surface.report.crowded_edges >= 4);
  CHECK(surface.report.closed_shells == 0);
  CHECK(std::count(surface.shell_of_triangle.begin(), surface.shell_of_triangle.end(), 0U) ==
        static_cast<std::ptrdiff_t>(surface.triangles.size()));
}

TEST_CASE("a shell may have several materials") {
  TriangleMesh mesh = make_box(Vec3(2, 2, 2), "wall");
  for (std::size_t index = 0; index < 4; ++index) mesh.triangles[index].material = material_index(mesh, "roof");
  CHECK(build_surface_mesh(mesh).report.closed_shells == 1);
}

TEST_CASE("a plane of 130 000 triangles is one facet: a search over all pairs would not come back in time") {
  TriangleMesh mesh;
  const std::uint32_t side = 256;
  mesh.material_names = {"ground"};
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x) mesh.vertices_m.emplace_back(x, y, 0.0);
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      mesh.triangles.push_back({{a, b, c}, 0});
      mesh.triangles.push_back({{b, c, d}, 0});
    }
  }
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(surface.facets.size() == 1);
  CHECK(surface.facets[0].triangle_count == 2 * side * side);
  CHECK(surface.facets[0].hull_point_count == 4);
  CHECK(surface.report.open_edges == 4 * side);
}

TEST_CASE("bad meshes are refused by name: vertices that are no points, indices that lead nowhere") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0));
  const auto check_refused = [](const TriangleMesh& bad, const char* name) {
    try {
      build_surface_mesh(bad);
      FAIL("accepted");
    } catch (const std::invalid_argument& error) {
      CHECK(std::string(error.what()).find(name) != std::string::npos);
    }
  };
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.1e9}) {
    TriangleMesh other = mesh;
    other.vertices_m[2].y = bad;
    check_refused(other, "vertex 2");
  }
  TriangleMesh index = mesh;
  index.triangles[0].vertices[1] = 3;
  check_refused(index, "triangle 0");
  TriangleMesh material = mesh;
  material.triangles[0].material = 1;
  check_refused(material, "triangle 0");
}

}  // namespace test_facet_builder
