#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/pose.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/geometry/surfaces/wedge_builder.hpp"
#include "dcem/io/obj_reader.hpp"
#include "tests/support/shared_data.hpp"

namespace test_wedge_builder {

using namespace dcem;

namespace {

void add_triangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c,
                  const std::string& material = "wall") {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), {a, b, c});
  mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, material)});
}

void append(TriangleMesh& mesh, const TriangleMesh& other, const Vec3& offset_m) {
  for (const auto& triangle : other.triangles) {
    const auto corner = [&](std::size_t index) { return offset_m + other.vertices_m[triangle.vertices[index]]; };
    add_triangle(mesh, corner(0), corner(1), corner(2), other.material_names[triangle.material]);
  }
}

/// A parallelogram cut into cells, each along either diagonal.
void add_cut(TriangleMesh& mesh, const Vec3& origin_m, const Vec3& first_m, const Vec3& second_m, int columns, int rows,
             RandomStream& random, const std::string& material = "wall") {
  const auto at = [&](int i, int j) {
    return origin_m + first_m * (static_cast<double>(i) / columns) + second_m * (static_cast<double>(j) / rows);
  };
  for (int cell = 0; cell < columns * rows; ++cell) {
    const int i = cell % columns, j = cell / columns;
    const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
    const bool other = random.next() % 2 == 0;
    add_triangle(mesh, a, b, other ? d : c, material);
    add_triangle(mesh, other ? b : a, c, d, material);
  }
}

/// Side walls over an outline, each cut in `pieces` along the edges that it shares with its neighbours.
void add_walls(TriangleMesh& mesh, const std::vector<Vec2>& outline_m, double height_m, int pieces,
               RandomStream& random) {
  for (std::size_t index = 0; index < outline_m.size(); ++index) {
    const Vec2 from_m = outline_m[index], to_m = outline_m[(index + 1) % outline_m.size()];
    add_cut(mesh, Vec3(from_m, 0), Vec3(to_m - from_m, 0), Vec3(0, 0, height_m), 1, pieces, random);
  }
}

template <typename Value>
void shuffle(std::vector<Value>& values, RandomStream& random) {
  for (std::size_t last = values.size(); last > 1; --last) std::swap(values[last - 1], values[random.next() % last]);
}

/// The same surface as another file would write it: triangles, vertices, corners, winding and materials in any order.
TriangleMesh rewritten(const TriangleMesh& mesh, RandomStream& random) {
  TriangleMesh other;
  std::vector<std::uint32_t> order(mesh.vertices_m.size()), new_vertex(mesh.vertices_m.size());
  std::iota(order.begin(), order.end(), 0U);
  shuffle(order, random);
  for (std::uint32_t index = 0; index < order.size(); ++index) {
    new_vertex[order[index]] = index;
    other.vertices_m.push_back(mesh.vertices_m[order[index]]);
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

TriangleMesh rounded(TriangleMesh mesh, double step_m) {
  for (Vec3& vertex_m : mesh.vertices_m) vertex_m = glm::round(vertex_m / step_m) * step_m;
  return mesh;
}

TriangleMesh placed(TriangleMesh mesh, const Pose& pose) {
  for (Vec3& vertex_m : mesh.vertices_m) vertex_m = pose.position_m + rotation_matrix(pose) * vertex_m;
  return mesh;
}

std::vector<Wedge> wedges_of(const TriangleMesh& mesh) {
  return build_surface_mesh(mesh).wedges;
}

std::size_t free_count(const std::vector<Wedge>& wedges) {
  return static_cast<std::size_t>(std::count_if(wedges.begin(), wedges.end(), is_free));
}

double angle_deg(const Wedge& wedge) {
  return radians_to_degrees(wedge.exterior_angle_rad);
}

double total_length_m(const std::vector<Wedge>& wedges) {
  return std::accumulate(wedges.begin(), wedges.end(), 0.0,
                         [](double sum_m, const Wedge& wedge) { return sum_m + edge_length_m(wedge); });
}

bool same_bits(const std::vector<Wedge>& a, const std::vector<Wedge>& b) {
  static_assert(sizeof(Wedge) == 4 * sizeof(Vec3) + 2 * sizeof(std::uint32_t) + 2 * sizeof(double), "no gaps");
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Wedge)) == 0);
}

/// The only wedge between these two points, in either direction, to within 1e-9 m.
const Wedge& wedge_between(const std::vector<Wedge>& wedges, const Vec3& one_m, const Vec3& other_m) {
  const auto here = [&](const Wedge& wedge) {
    return std::min(glm::distance(wedge.start_m, one_m) + glm::distance(wedge.end_m, other_m),
                    glm::distance(wedge.start_m, other_m) + glm::distance(wedge.end_m, one_m)) < 2e-9;
  };
  REQUIRE(std::count_if(wedges.begin(), wedges.end(), here) == 1);
  return *std::find_if(wedges.begin(), wedges.end(), here);
}

/// What every user of a wedge relies on. The frame is exact to a few roundings; the ends are as exact as their
/// coordinates, so a short edge far from the origin has a direction of its own of fewer digits. `off_face_m`: how far
/// the ends may lie from the planes of the faces.
void check_frames(const SurfaceMesh& mesh, double off_face_m) {
  for (const Wedge& wedge : mesh.wedges) {
    const Plane& face_0 = mesh.facets.at(wedge.facets[0]).plane;
    CHECK_UNARY(std::abs(glm::length(wedge.tangent) - 1.0) < 1e-14);
    CHECK_UNARY(std::abs(glm::length(wedge.normal) - 1.0) < 1e-14);
    CHECK_UNARY(std::abs(glm::dot(wedge.tangent, wedge.normal)) < 1e-14);
    CHECK_UNARY(glm::distance(edge_direction(wedge) * edge_length_m(wedge), wedge.end_m - wedge.start_m) < 1e-11);
    CHECK_UNARY(std::abs(glm::dot(wedge.tangent, face_0.normal)) < 1e-14);
    CHECK_UNARY(edge_length_m(wedge) > 0.0);
    for (const Vec3& end_m : {wedge.start_m, wedge.end_m}) {
      CHECK_UNARY(std::abs(signed_distance_m(face_0, end_m)) <= off_face_m);
    }
    CHECK_UNARY(is_free(wedge) == (wedge.facets[1] == no_facet));
    if (is_free(wedge)) {
      CHECK_UNARY(wedge.exterior_angle_rad == 2.0 * pi);
      continue;
    }
    CHECK_UNARY(wedge.facets[0] < wedge.facets[1]);
    CHECK_UNARY(wedge.exterior_angle_rad > pi + degrees_to_radians(0.1));
    CHECK_UNARY(wedge.exterior_angle_rad <= 2.0 * pi);
    const Plane& face_n = mesh.facets.at(wedge.facets[1]).plane;
    for (const Vec3& end_m : {wedge.start_m, wedge.end_m}) {
      CHECK_UNARY(std::abs(signed_distance_m(face_n, end_m)) <= off_face_m);
    }
    const Vec3 in_face_n =
        std::cos(wedge.exterior_angle_rad) * wedge.tangent + std::sin(wedge.exterior_angle_rad) * wedge.normal;
    CHECK_UNARY(std::abs(glm::dot(in_face_n, face_n.normal)) < 1e-13);
  }
}

constexpr double rounding_m = 1e-12;  // of coordinates up to a kilometre

/// A roof of two slopes over a ridge along y, both cut.
TriangleMesh gable(double half_width_m, double rise_m, double length_m, int pieces, RandomStream& random) {
  TriangleMesh mesh;
  const Vec3 ridge_m(0, 0, rise_m), along_m(0, length_m, 0);
  add_cut(mesh, ridge_m, along_m, Vec3(-half_width_m, 0, -rise_m), pieces, 3, random);
  add_cut(mesh, ridge_m, along_m, Vec3(half_width_m, 0, -rise_m), pieces, 2, random);
  return mesh;
}

/// Everything at once: houses with cut walls, walls side by side, ripples of rounding, materials, seams, open rims.
TriangleMesh messy_town(RandomStream& random) {
  TriangleMesh mesh;
  for (int house = 0; house < 8; ++house) {
    TriangleMesh walls;
    const double turn_rad = 6.0 * random.uniform();
    std::vector<Vec2> outline_m;
    for (const Vec2 corner_m : {Vec2(0, 0), Vec2(9, 0), Vec2(9, 5), Vec2(4, 5), Vec2(4, 8), Vec2(0, 8)}) {
      outline_m.emplace_back(corner_m.x * std::cos(turn_rad) - corner_m.y * std::sin(turn_rad),
                             corner_m.x * std::sin(turn_rad) + corner_m.y * std::cos(turn_rad));
    }
    add_walls(walls, outline_m, 7.3, 1 + house, random);
    append(mesh, rounded(walls, 1e-4), Vec3(25 * house, 0, 0));
  }
  append(mesh, make_box(Vec3(5, 5, 5), "brick"), Vec3(0, 50, 0));
  append(mesh, make_box(Vec3(5, 5, 5), "glass"), Vec3(5, 50, 0));
  append(mesh, rounded(placed(gable(4.0, 0.2, 12.0, 7, random), {Vec3(0), 0.3, 0.1, 0.2}), 1e-4), Vec3(0, 80, 0));
  append(mesh, gable(4.0, 3.0, 12.0, 4, random), Vec3(30, 80, 0));
  return mesh;
}

}  // namespace

TEST_CASE("a box has twelve edges of 270 degrees, however its faces were cut") {
  RandomStream random(50);
  const Vec3 size_m(4, 3, 2);
  for (int pieces = 1; pieces <= 6; ++pieces) {
    TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 first_m(0.0), second_m(0.0), third_m(0.0);
      first_m[(axis + 1) % 3] = size_m[(axis + 1) % 3];
      second_m[(axis + 2) % 3] = size_m[(axis + 2) % 3];
      third_m[axis] = size_m[axis];
      add_cut(mesh, Vec3(0.0), first_m, second_m, pieces, pieces, random);
      add_cut(mesh, third_m, first_m, second_m, pieces, pieces, random);
    }
    const SurfaceMesh surface = build_surface_mesh(mesh);
    REQUIRE(surface.wedges.size() == 12);
    CHECK(surface.report.wedges == 12);
    CHECK(surface.report.free_edges == 0);
    check_frames(surface, rounding_m);
    CHECK(total_length_m(surface.wedges) == doctest::Approx(4 * (4 + 3 + 2)).epsilon(1e-14));
    for (const Wedge& wedge : surface.wedges) {
      CHECK(angle_deg(wedge) == doctest::Approx(270).epsilon(1e-14));
      CHECK(wedge.stray_m < rounding_m);
      const Vec3 out = 0.5 * (wedge.start_m + wedge.end_m) - 0.5 * size_m;  // away from the middle of the box
      CHECK(in_exterior(wedge, out));
      CHECK_FALSE(in_exterior(wedge, -out));
      CHECK(azimuth_rad(wedge, out - 2.0 * glm::dot(out, wedge.tangent) * wedge.tangent) > 0.0);
      CHECK(glm::dot(wedge.normal, out) > 0.0);
      CHECK(glm::dot(wedge.tangent, out) < 0.0);
    }
  }
}

TEST_CASE("the order of triangles, vertices, corners, winding and materials changes no bit of an edge") {
  RandomStream random(51);
  const TriangleMesh mesh = messy_town(random);
  const SurfaceMesh expected = build_surface_mesh(mesh);
  CHECK(expected.report.wedges > 50);
  CHECK(expected.report.free_edges > 50);
  CHECK(expected.report.crowded_edges > 0);
  check_frames(expected, 5e-3);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const SurfaceMesh again = build_surface_mesh(rewritten(mesh, random));
    CHECK(same_bits(again.wedges, expected.wedges));
    CHECK(again.report.wedges == expected.report.wedges);
    CHECK(again.report.free_edges == expected.report.free_edges);
  }
}

TEST_CASE("edges between facets come first, each kind by facets and then by place") {
  RandomStream random(52);
  const std::vector<Wedge> wedges = wedges_of(messy_town(random));
  for (std::size_t index = 1; index < wedges.size(); ++index) {
    const Wedge &a = wedges[index - 1], &b = wedges[index];
    if (is_free(a) != is_free(b)) {
      CHECK_FALSE(is_free(a));
    } else if (a.facets != b.facets) {
      CHECK(a.facets < b.facets);
    } else {
      CHECK_FALSE(lexicographic_less(b.start_m, a.start_m));
    }
  }
}

TEST_CASE("an L-shaped prism has eighteen edges; the inner corner's exterior is inside the prism") {
  RandomStream random(53);
  const std::vector<Vec2> outline_m{{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 5}, {0, 5}};
  TriangleMesh mesh;
  add_walls(mesh, outline_m, 3.0, 1, random);
  for (const double z_m : {0.0, 3.0}) {  // floor and roof: three rectangles that meet at shared corners
    add_quad(mesh, {Vec3(0, 0, z_m), Vec3(2, 0, z_m), Vec3(2, 2, z_m), Vec3(0, 2, z_m)}, "wall");
    add_triangle(mesh, Vec3(2, 0, z_m), Vec3(6, 0, z_m), Vec3(6, 2, z_m));
    add_triangle(mesh, Vec3(2, 0, z_m), Vec3(6, 2, z_m), Vec3(2, 2, z_m));
    add_quad(mesh, {Vec3(0, 2, z_m), Vec3(2, 2, z_m), Vec3(2, 5, z_m), Vec3(0, 5, z_m)}, "wall");
  }
  // The rectangles end where the walls of the long sides do not: (2, 0) and (0, 2) are no corners of those walls, so
  // two walls are given a corner there.
  TriangleMesh clean;
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto& v = mesh.triangles[index].vertices;
    const Vec3 &a = mesh.vertices_m[v[0]], &b = mesh.vertices_m[v[1]], &c = mesh.vertices_m[v[2]];
    const bool south = a.y == 0 && b.y == 0 && c.y == 0, west = a.x == 0 && b.x == 0 && c.x == 0;
    if (!south && !west) add_triangle(clean, a, b, c);
  }
  for (const auto& [from_m, to_m] : {std::pair{Vec3(0, 0, 0), Vec3(2, 0, 0)},
                                     {Vec3(2, 0, 0), Vec3(6, 0, 0)},
                                     {Vec3(0, 0, 0), Vec3(0, 2, 0)},
                                     {Vec3(0, 2, 0), Vec3(0, 5, 0)}}) {
    add_quad(clean, {from_m, to_m, to_m + Vec3(0, 0, 3), from_m + Vec3(0, 0, 3)}, "wall");
  }
  const SurfaceMesh surface = build_surface_mesh(clean);
  REQUIRE(surface.facets.size() == 8);
  REQUIRE(surface.wedges.size() == 18);  // six upright, six at the foot, six at the roof
  CHECK(surface.report.free_edges == 0);
  check_frames(surface, rounding_m);
  for (const Wedge& wedge : surface.wedges) CHECK(angle_deg(wedge) == doctest::Approx(270).epsilon(1e-14));
  const Wedge& inner = wedge_between(surface.wedges, Vec3(2, 2, 0), Vec3(2, 2, 3));
  CHECK(in_exterior(inner, Vec3(-1, -1, 0)));      // into the prism
  CHECK_FALSE(in_exterior(inner, Vec3(1, 1, 0)));  // the yard
  const Wedge& outer = wedge_between(surface.wedges, Vec3(6, 0, 0), Vec3(6, 0, 3));
  CHECK(in_exterior(outer, Vec3(1, -1, 0)));
  CHECK_FALSE(in_exterior(outer, Vec3(-1, 1, 0)));  // the prism
}

TEST_CASE("a regular tetrahedron has six edges of 360 degrees less arccos(1/3)") {
  const std::vector<Vec3> corners_m{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  TriangleMesh mesh;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    add_triangle(mesh, corners_m[(left_out + 1) % 4], corners_m[(left_out + 2) % 4], corners_m[(left_out + 3) % 4]);
  }
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(surface.wedges.size() == 6);
  check_frames(surface, rounding_m);
  for (const Wedge& wedge : surface.wedges) {
    CHECK(wedge.exterior_angle_rad == doctest::Approx(2.0 * pi - std::acos(1.0 / 3.0)).epsilon(1e-14));
    CHECK(edge_length_m(wedge) == doctest::Approx(std::sqrt(8.0)).epsilon(1e-14));
    CHECK(in_exterior(wedge, 0.5 * (wedge.start_m + wedge.end_m)));  // the middle is the origin
  }
}

TEST_CASE("the rims of an open box are free edges") {
  TriangleMesh mesh = make_box(Vec3(4, 2, 1), "wall");
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the lid
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.wedges == 8);
  CHECK(surface.report.free_edges == 4);
  check_frames(surface, rounding_m);
  const Wedge& rim = wedge_between(surface.wedges, Vec3(-2, -1, 1), Vec3(2, -1, 1));
  CHECK(is_free(rim));
  CHECK(rim.exterior_angle_rad == 2.0 * pi);
  CHECK(glm::distance(rim.tangent, Vec3(0, 0, -1)) < 1e-15);  // down, into the wall
  CHECK(std::abs(std::abs(rim.normal.y) - 1.0) < 1e-15);
}

TEST_CASE("an open sheet has one free edge per side, however it was cut, and each hole its own") {
  RandomStream random(54);
  TriangleMesh mesh;
  add_cut(mesh, Vec3(0, 0, 0), Vec3(5, 0, 1), Vec3(0, 3, 0.5), 9, 7, random);
  CHECK(free_count(wedges_of(mesh)) == 4);
  CHECK(wedges_of(mesh).size() == 4);
  CHECK(total_length_m(wedges_of(mesh)) == doctest::Approx(2 * std::sqrt(26.0) + 2 * std::sqrt(9.25)).epsilon(1e-14));
  mesh.triangles.erase(mesh.triangles.begin() + 2 * (9 * 3 + 4),
                       mesh.triangles.begin() + 2 * (9 * 3 + 6));  // two cells
  CHECK(free_count(wedges_of(mesh)) == 8);
  // A notch that reaches the rim splits that side in two: 3 + 2 sides of its own and one more piece of rim.
  TriangleMesh notched;
  add_cut(notched, Vec3(0.0), Vec3(4, 0, 0), Vec3(0, 4, 0), 4, 4, random);
  notched.triangles.erase(notched.triangles.begin() + 2,
                          notched.triangles.begin() + 6);  // the middle of the lowest row
  CHECK(free_count(wedges_of(notched)) == 8);
}

TEST_CASE("two boxes that share a wall: the shared rim has three facets and diffracts nowhere") {
  TriangleMesh mesh = make_box(Vec3(2, 2, 2), "brick");
  append(mesh, make_box(Vec3(2, 2, 2), "glass"), Vec3(2, 0, 0));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.triangles_repeated == 2);
  CHECK(surface.report.crowded_edges == 4);
  CHECK(surface.report.wedges ==
        16);  // eight around each far wall and along x; the four of the shared wall are crowded
  CHECK(surface.report.free_edges == 0);
  for (const Wedge& wedge : surface.wedges) {
    CHECK_FALSE((std::abs(wedge.start_m.x - 1) < 1e-9 && std::abs(wedge.end_m.x - 1) < 1e-9));
  }
}

TEST_CASE("three facets at an edge make no wedge") {
  TriangleMesh mesh;
  const Vec3 low(0, 0, 0), high(0, 0, 2);
  add_triangle(mesh, low, high, Vec3(1, 0, 1));
  add_triangle(mesh, low, high, Vec3(-1, 1, 1));
  CHECK(build_surface_mesh(mesh).report.wedges == 1);
  add_triangle(mesh, low, high, Vec3(-1, -1, 1));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.wedges == 0);
  CHECK(surface.report.free_edges == 6);
}

TEST_CASE("a wall that ends on the middle of another is no wedge, whether they share vertices or not") {
  TriangleMesh
      mesh;  // x = 0 carries a wall whose middle line is vertices, y = 0 ends there: two facets, three triangles
  add_quad(mesh, {Vec3(0, -1, 0), Vec3(0, 0, 0), Vec3(0, 0, 2), Vec3(0, -1, 2)}, "wall");
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 1, 2), Vec3(0, 0, 2)}, "wall");
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 2), Vec3(0, 0, 2)}, "wall");
  const SurfaceMesh shared = build_surface_mesh(mesh);
  CHECK(shared.report.wedges == 0);
  CHECK(shared.report.free_edges == 4 + 3);
}

TEST_CASE("at a T-junction nothing is shared: both rims are free edges") {
  TriangleMesh mesh;
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0));
  add_triangle(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, -1));  // 90 degrees down, in two triangles
  add_triangle(mesh, Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, -1));
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.report.wedges == 0);
  CHECK(surface.report.free_edges == 3 + 3);
  double along_x_m = 0.0;
  for (const Wedge& wedge : surface.wedges) {
    if (std::abs(edge_direction(wedge).x) > 0.999) along_x_m += edge_length_m(wedge);
  }
  CHECK(along_x_m == doctest::Approx(4.0).epsilon(1e-14));
}

TEST_CASE("flat seams are no edges: two materials in a plane, and folds up to 0.1 degrees") {
  const auto folded = [](double fold_deg, const std::string& material) {
    TriangleMesh mesh;
    const double fold_rad = degrees_to_radians(fold_deg);
    add_quad(mesh, {Vec3(0, 0, 0), Vec3(-2, 0, 0), Vec3(-2, 5, 0), Vec3(0, 5, 0)}, "brick");
    const Vec3 across(3 * std::cos(fold_rad), 0, -3 * std::sin(fold_rad));
    add_quad(mesh, {Vec3(0, 0, 0), across, across + Vec3(0, 5, 0), Vec3(0, 5, 0)}, material);
    return build_surface_mesh(mesh);
  };
  CHECK(folded(0.0, "glass").facets.size() == 2);
  CHECK(folded(0.0, "glass").report.wedges == 0);
  CHECK(folded(0.09, "glass").report.wedges == 0);
  CHECK(folded(0.11, "glass").report.wedges == 1);
  CHECK(folded(0.11, "brick").report.wedges == 1);
  CHECK(folded(0.0, "glass").report.free_edges == 6);
  for (const double fold_deg : {0.2, 5.0, 9.9, 10.1, 45.0, 90.0, 135.0, 169.9, 170.1, 179.0}) {
    for (const double side : {1.0, -1.0}) {
      const SurfaceMesh surface = folded(side * fold_deg, "glass");
      REQUIRE(surface.report.wedges == 1);
      check_frames(surface, rounding_m);
      CHECK(angle_deg(surface.wedges.front()) == doctest::Approx(180 + fold_deg).epsilon(1e-12));
      CHECK(edge_length_m(surface.wedges.front()) == doctest::Approx(5).epsilon(1e-12));
      CHECK(in_exterior(surface.wedges.front(), Vec3(0, 0, side)));
      const double fold_rad = degrees_to_radians(side * fold_deg);
      CHECK_FALSE(in_exterior(surface.wedges.front(), Vec3(std::cos(fold_rad) - 1, 0, -std::sin(fold_rad))));  // inside
    }
  }
  const SurfaceMesh shut = folded(180.0, "glass");  // one on top of the other
  REQUIRE(shut.report.wedges == 1);
  CHECK(angle_deg(shut.wedges.front()) == doctest::Approx(360).epsilon(1e-12));
}

TEST_CASE("the ridge of a gable roof of slope 3:4 has 180 + 2 arctan(3/4) degrees") {
  RandomStream random(55);
  const SurfaceMesh surface = build_surface_mesh(gable(4.0, 3.0, 10.0, 5, random));
  CHECK(surface.report.wedges == 1);
  CHECK(surface.report.free_edges == 6);
  check_frames(surface, rounding_m);
  const Wedge& ridge = wedge_between(surface.wedges, Vec3(0, 0, 3), Vec3(0, 10, 3));
  CHECK(ridge.exterior_angle_rad == doctest::Approx(pi + 2.0 * std::atan(0.75)).epsilon(1e-14));
  CHECK(azimuth_rad(ridge, Vec3(0, 0, 1)) == doctest::Approx(ridge.exterior_angle_rad / 2).epsilon(1e-14));
}

TEST_CASE("the azimuth is 0 on face 0, the exterior angle on face n, and grows through the exterior") {
  RandomStream random(56);
  const SurfaceMesh surface = build_surface_mesh(messy_town(random));
  for (const Wedge& wedge : surface.wedges) {
    const Vec3 along = 3.0 * edge_direction(wedge);
    CHECK_UNARY(std::abs(std::sin(azimuth_rad(wedge, wedge.tangent + along))) < 1e-14);
    CHECK_UNARY(std::abs(azimuth_rad(wedge, wedge.normal - along) - pi / 2) < 1e-14);
    for (const double share : {0.1, 0.35, 0.6, 0.999}) {
      const double angle_rad = share * wedge.exterior_angle_rad;
      const Vec3 away = std::cos(angle_rad) * wedge.tangent + std::sin(angle_rad) * wedge.normal;
      CHECK_UNARY(std::abs(azimuth_rad(wedge, 7.0 * away + along) - angle_rad) < 1e-13);
      CHECK_UNARY(in_exterior(wedge, away));
    }
    if (is_free(wedge)) continue;
    // Towards the facet behind face n: the nearest of its hull's corners that lies clear of the edge.
    const Facet& facet = surface.facets[wedge.facets[1]];
    Vec3 away(0.0);
    double best_m = 0.0;
    for (std::uint32_t index = 0; index < facet.hull_point_count; ++index) {
      const Vec3 to = surface.hull_points_m[facet.first_hull_point + index] - wedge.start_m;
      const double clear_m = glm::length(to - glm::dot(to, edge_direction(wedge)) * edge_direction(wedge));
      if (clear_m > best_m) {
        best_m = clear_m;
        away = to;
      }
    }
    // The ends lie within the town's ripples of the faces, the hull exactly on them.
    CHECK_UNARY(std::abs(azimuth_rad(wedge, away) - wedge.exterior_angle_rad) < 2e-3 / best_m + 1e-12);
  }
}

TEST_CASE("walls rounded to 0.1 mm keep one edge per corner, on both mirrors and where it was") {
  RandomStream random(57);
  for (int repeat = 0; repeat < 30; ++repeat) {
    const double length_of_edge_m = 6.0;
    const int pieces = 1 + repeat % 8;
    const double opening_deg = 20.0 + 5.0 * repeat;
    TriangleMesh mesh;
    const double opening_rad = degrees_to_radians(opening_deg);
    const Vec3 up_m(0, 0, length_of_edge_m);
    add_cut(mesh, Vec3(0.0), up_m, Vec3(3, 0, 0), pieces, 2, random);
    add_cut(mesh, Vec3(0.0), up_m, 4.0 * Vec3(std::cos(opening_rad), std::sin(opening_rad), 0), pieces, 3, random);
    const Pose pose{Vec3(100, 200, 3), 6.0 * random.uniform(), 1.0 * random.uniform(), 1.0 * random.uniform()};
    const SurfaceMesh surface = build_surface_mesh(rounded(placed(mesh, pose), 1e-4));
    INFO(repeat);
    REQUIRE(surface.facets.size() == 2);
    REQUIRE(surface.report.wedges == 1);
    check_frames(surface, rounding_m + 1e-4 * 1e-4);
    const Wedge& wedge = surface.wedges.front();
    // A rounded vertex is off by 0.087 mm at most, so is each mean plane near the edge, to first order and with some
    // leverage because the planes tilt about their centres: twice that, and 1/sin of the opening where they cross.
    const double off_m = 2.0 * 2.0 * 0.087e-3 / std::sin(opening_rad);
    CHECK(wedge.stray_m <= off_m);
    const Vec3 foot_m = pose.position_m, top_m = foot_m + rotation_matrix(pose) * up_m;
    CHECK(std::min(glm::distance(wedge.start_m, foot_m), glm::distance(wedge.start_m, top_m)) <= off_m);
    CHECK(std::min(glm::distance(wedge.end_m, foot_m), glm::distance(wedge.end_m, top_m)) <= off_m);
    const double tilt_rad =
        std::asin(glm::length(glm::cross(edge_direction(wedge), (top_m - foot_m) / length_of_edge_m)));
    CHECK(tilt_rad <= 2.0 * off_m / length_of_edge_m);
    // Across the edge the planes tilt by at most two opposite errors over the shallower wall, 3 m.
    CHECK(wedge.exterior_angle_rad == doctest::Approx(2.0 * pi - opening_rad).epsilon(2 * 2 * 0.087e-3 / 3));
    CHECK(surface.report.free_edges == 6);
  }
}

TEST_CASE("a dirty edge between nearly flat facets, and a dirty rim, are one edge each, through welded vertices") {
  RandomStream random(58);
  const double fold_rad = degrees_to_radians(4.0);
  for (int repeat = 0; repeat < 30; ++repeat) {
    TriangleMesh mesh;
    const int pieces = 1 + repeat % 8;
    add_cut(mesh, Vec3(0.0), Vec3(0, 8, 0), Vec3(-3, 0, 0), pieces, 2, random);
    add_cut(mesh, Vec3(0.0), Vec3(0, 8, 0), 3.0 * Vec3(std::cos(fold_rad), 0, std::sin(fold_rad)), pieces, 2, random);
    const Pose pose{Vec3(100, 200, 3), 6.0 * random.uniform(), 1.0 * random.uniform(), 1.0 * random.uniform()};
    const SurfaceMesh surface = build_surface_mesh(rounded(placed(mesh, pose), 1e-4));
    REQUIRE(surface.facets.size() == 2);
    REQUIRE(surface.report.wedges == 1);
    CHECK(surface.report.free_edges == 6);
    for (const Wedge& wedge : surface.wedges) CHECK(wedge.stray_m <= 2e-4);
    const Wedge& wedge = surface.wedges.front();
    const Vec3 foot_m = pose.position_m, top_m = foot_m + rotation_matrix(pose) * Vec3(0, 8, 0);
    CHECK(std::min(glm::distance(wedge.start_m, foot_m), glm::distance(wedge.start_m, top_m)) <= 0.087e-3);
    CHECK(std::min(glm::distance(wedge.end_m, foot_m), glm::distance(wedge.end_m, top_m)) <= 0.087e-3);
    // Each plane tilts by two opposite errors over its 3 m at most: 1.2e-4 rad for both.
    CHECK(wedge.exterior_angle_rad == doctest::Approx(pi + fold_rad).epsilon(1e-4));
  }
}

TEST_CASE("vertices off the line by the weld tolerance do not split a rim, a real bend does") {
  const auto strip = [](double bend_m) {  // the rim along y bends in the middle, within the plane
    TriangleMesh mesh;
    const Vec3 below(0, -2, 0), middle(bend_m, 0, 0), above(0, 2, 0);
    add_quad(mesh, {below, middle, Vec3(-3, 0, 0), Vec3(-3, -2, 0)}, "wall");
    add_quad(mesh, {middle, above, Vec3(-3, 2, 0), Vec3(-3, 0, 0)}, "wall");
    return free_count(wedges_of(mesh));
  };
  CHECK(strip(0.0) == 4);
  CHECK(strip(1.9e-4) == 4);
  CHECK(strip(-1.9e-4) == 4);
  CHECK(strip(2.1e-4) == 5);
  CHECK(strip(-0.01) == 5);
}

TEST_CASE("a rim in the shape of a door is cut at its corners only, ripples in its lintel notwithstanding") {
  TriangleMesh mesh;  // the wall above and beside a door 2 wide and 2 high, in columns of 0.5; the lintel ripples
  const auto lintel_m = [](int column) { return 2.0 + (column % 2 == 0 ? 0.5e-4 : -0.5e-4); };
  for (int column = -6; column < 6; ++column) {
    const double left_m = 0.5 * column, right_m = left_m + 0.5;
    const bool door = column >= -2 && column < 2;
    if (!door) {  // the level of the lintel is a row of vertices beside the door
      add_quad(mesh,
               {Vec3(left_m, 0, 0), Vec3(right_m, 0, 0), Vec3(right_m, 0, lintel_m(column + 1)),
                Vec3(left_m, 0, lintel_m(column))},
               "wall");
    }
    add_quad(mesh,
             {Vec3(left_m, 0, lintel_m(column)), Vec3(right_m, 0, lintel_m(column + 1)), Vec3(right_m, 0, 3),
              Vec3(left_m, 0, 3)},
             "wall");
  }
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.facets.size() == 1);
  CHECK(surface.report.free_edges == 8);  // foot, jamb, lintel, jamb, foot, side, top, side
  CHECK(total_length_m(surface.wedges) == doctest::Approx(2 + 2 + 2 + 2 + 2 + 3 + 6 + 3).epsilon(1e-4));
}

TEST_CASE("a circle's rim is cut wherever it would leave the tolerance") {
  TriangleMesh mesh;
  for (int step = 0; step < 60; ++step) {
    const auto at = [](int index) {
      const double angle_rad = degrees_to_radians(6.0 * index);
      return Vec3(2 * std::cos(angle_rad), 2 * std::sin(angle_rad), 1);
    };
    add_triangle(mesh, Vec3(0, 0, 1), at(step), at((step + 1) % 60));
  }
  const SurfaceMesh surface = build_surface_mesh(mesh);
  CHECK(surface.facets.size() == 1);
  CHECK(surface.report.free_edges == 60);  // each corner stands 11 mm off the chord of its neighbours
}

TEST_CASE("facets that cross at a vertex are two edges: on its two sides they lie the other way round") {
  // One wall stands on x = 0 from y = -2 to 2. The ground meets it from the left up to y = 0, goes round its far end,
  // and meets it from the right from there on.
  const Vec3 near(0, -2, 0), cross(0, 0, 0), far(0, 2, 0), a(-2, -1, 0), b(-2, 3, 0), c(-0.5, 3, 0), d(0, 5, 0);
  const Vec3 e(0.5, 3, 0), f(2, 3, 0), g(2, 1, 0);
  TriangleMesh mesh;
  for (const auto& [one_m, other_m, third_m] : std::initializer_list<std::array<Vec3, 3>>{{near, cross, a},
                                                                                          {cross, a, b},
                                                                                          {cross, b, c},
                                                                                          {b, c, d},
                                                                                          {c, d, e},
                                                                                          {d, e, f},
                                                                                          {e, f, g},
                                                                                          {e, g, far},
                                                                                          {g, far, cross}}) {
    add_triangle(mesh, one_m, other_m, third_m);
  }
  add_quad(mesh, {Vec3(0, -2, 0), Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, -2, 1)}, "wall");
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(0, 2, 0), Vec3(0, 2, 1), Vec3(0, 0, 1)}, "wall");
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(surface.facets.size() == 2);
  const Wedge& left = wedge_between(surface.wedges, Vec3(0, -2, 0), Vec3(0, 0, 0));
  const Wedge& right = wedge_between(surface.wedges, Vec3(0, 0, 0), Vec3(0, 2, 0));
  CHECK_FALSE(in_exterior(left, Vec3(-1, 0, 1)));
  CHECK(in_exterior(left, Vec3(1, 0, 1)));
  CHECK_FALSE(in_exterior(right, Vec3(1, 0, 1)));
  CHECK(in_exterior(right, Vec3(-1, 0, 1)));
}

TEST_CASE("slivers that rounding tipped over the edge do not turn a face round") {
  // The wall in z = 0 ends in a sliver whose third corner stands 0.05 mm on the wrong side of the edge.
  for (const double tip_m : {0.5e-4, -0.5e-4}) {
    TriangleMesh mesh;
    const Vec3 low(0, 0, 0), middle(tip_m, 5, 0), high(0, 10, 0);
    add_triangle(mesh, low, high, Vec3(-4, 5, 0));
    add_triangle(mesh, low, middle, high);
    add_triangle(mesh, low, middle, Vec3(0, 3, 3));
    add_triangle(mesh, middle, high, Vec3(0, 3, 3));
    const SurfaceMesh surface = build_surface_mesh(mesh);
    REQUIRE(surface.facets.size() == 2);
    REQUIRE(surface.report.wedges == 1);
    CHECK(angle_deg(surface.wedges.front()) == doctest::Approx(270).epsilon(1e-4));
    CHECK(in_exterior(surface.wedges.front(), Vec3(1, 0, 0)));
    CHECK_FALSE(in_exterior(surface.wedges.front(), Vec3(-1, 0, 1)));
  }
}

TEST_CASE("an edge whose vertices are too far off its planes' line goes through the vertices") {
  // Two facets of three triangles each, 12 degrees from flat. The middle of their edge stands `off_m` above the one and
  // below the other: what the mean planes do not follow is off their line by 1/sin 12 degrees = 4.8 times as much.
  const double fold_rad = degrees_to_radians(12.0);
  const Vec3 low(0, -50, 0), high(0, 50, 0), down(std::cos(fold_rad), 0, -std::sin(fold_rad));
  const auto middle = [&](double off_m) {
    return Vec3(-off_m * (1.0 + std::cos(fold_rad)) / std::sin(fold_rad), 0, off_m);
  };
  const auto bent = [&](double off_m) {
    TriangleMesh mesh;
    for (const Vec3& away_m : {Vec3(-30, 0, 0), 30.0 * down}) {
      const Vec3 first_m = away_m - Vec3(0, 25, 0), second_m = away_m + Vec3(0, 25, 0);
      add_triangle(mesh, low, middle(off_m), first_m);
      add_triangle(mesh, middle(off_m), high, second_m);
      add_triangle(mesh, middle(off_m), first_m, second_m);
    }
    SurfaceSettings settings;
    settings.planarity_tolerance_m = 1e-2;  // facets may bend by a centimetre per triangle, edges stray by five
    return build_surface_mesh(mesh, settings);
  };
  const SurfaceMesh slight = bent(3e-3);
  REQUIRE(slight.facets.size() == 2);
  REQUIRE(slight.report.wedges == 1);
  check_frames(slight, 1e-2);
  CHECK(slight.wedges.front().stray_m > 3e-3);  // more than the planarity of the facets: the line is a compromise
  CHECK(slight.wedges.front().stray_m <= 5e-2);
  const SurfaceMesh strong = bent(9.5e-3);
  REQUIRE(strong.facets.size() == 2);
  REQUIRE(strong.report.wedges == 2);
  check_frames(strong, 2e-2);
  CHECK(wedge_between(strong.wedges, low, middle(9.5e-3)).stray_m == 0.0);
  CHECK(wedge_between(strong.wedges, middle(9.5e-3), high).stray_m == 0.0);
}

TEST_CASE("in any pose the edges are the same") {
  RandomStream random(59);
  const TriangleMesh mesh = gable(4.0, 3.0, 10.0, 5, random);
  TriangleMesh scene = mesh;
  append(scene, make_box(Vec3(3, 2, 5), "metal"), Vec3(20, 0, 0));
  const std::vector<Wedge> reference = wedges_of(scene);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Pose pose{Vec3(500 * random.uniform(), 300, -20), 6 * random.uniform(), 3 * random.uniform(),
                    6 * random.uniform()};
    const Mat3 rotation = rotation_matrix(pose);
    const SurfaceMesh surface = build_surface_mesh(placed(scene, pose));
    REQUIRE(surface.wedges.size() == reference.size());
    check_frames(surface, rounding_m);
    for (const Wedge& wedge : reference) {  // facets may be numbered otherwise, so the edge may run the other way
      const Wedge& found = wedge_between(surface.wedges, pose.position_m + rotation * wedge.start_m,
                                         pose.position_m + rotation * wedge.end_m);
      CHECK(found.exterior_angle_rad == doctest::Approx(wedge.exterior_angle_rad).epsilon(1e-12));
      CHECK(is_free(found) == is_free(wedge));
      const Vec3 between = rotation * (std::cos(0.4 * wedge.exterior_angle_rad) * wedge.tangent +
                                       std::sin(0.4 * wedge.exterior_angle_rad) * wedge.normal);
      if (!is_free(wedge)) CHECK(in_exterior(found, between));
    }
  }
}

TEST_CASE("a mesh without triangles has no edges") {
  CHECK(wedges_of(TriangleMesh{}).empty());
  CHECK(build_wedges(SurfaceMesh{}).empty());
}

// Counts and lengths come from tests/reference/wedge_counts.py, which reads the files by itself, takes angles from
// triple products and lengths from welded vertices.
namespace {

struct ExpectedEdges {
  const char* file;
  std::size_t wedges, from_190_deg, free_edges;
  double length_m, length_from_190_m, free_length_m, stray_m;
};

void check_edges(const ExpectedEdges& expected) {
  INFO(expected.file);
  const SurfaceMesh mesh = build_surface_mesh(io::read_obj(test::shared_path(expected.file)).mesh);
  check_frames(mesh, 5e-3);
  std::vector<Wedge> between, steep, free;
  for (const Wedge& wedge : mesh.wedges) {
    (is_free(wedge) ? free : between).push_back(wedge);
    if (!is_free(wedge) && angle_deg(wedge) >= 190.0) steep.push_back(wedge);
    CHECK_UNARY(wedge.stray_m <= expected.stray_m);
    if (!is_free(wedge) && angle_deg(wedge) >= 190.0 && angle_deg(wedge) <= 350.0) {
      const Plane &face_0 = mesh.facets[wedge.facets[0]].plane, &face_n = mesh.facets[wedge.facets[1]].plane;
      for (const Vec3& end_m : {wedge.start_m, wedge.end_m}) {  // on both mirrors, to rounding
        CHECK_UNARY(std::abs(signed_distance_m(face_0, end_m)) < 1e-11);
        CHECK_UNARY(std::abs(signed_distance_m(face_n, end_m)) < 1e-11);
      }
    }
  }
  CHECK(between.size() == expected.wedges);
  CHECK(steep.size() == expected.from_190_deg);
  CHECK(free.size() == expected.free_edges);
  CHECK(mesh.report.wedges == expected.wedges);
  CHECK(mesh.report.free_edges == expected.free_edges);
  // Each edge moves by less than a millimetre or two: of kilometres, that leaves eight digits.
  CHECK(total_length_m(between) == doctest::Approx(expected.length_m).epsilon(1e-8));
  CHECK(total_length_m(steep) == doctest::Approx(expected.length_from_190_m).epsilon(1e-8));
  CHECK(total_length_m(free) == doctest::Approx(expected.free_length_m).epsilon(1e-8));
}

}  // namespace

TEST_CASE("the edges of Munich are those of an independent script") {
  DCEM_NEEDS_SHARED();
  // The closest angle is 7e-4 degrees off its limit: no count hangs on rounding.
  check_edges({"scenes/munich.obj", 32'796, 20'994, 7'218, 256291.225, 248225.175, 93577.5914, 1.8e-3});
}

TEST_CASE("the edges of Etoile are those of an independent script") {
  DCEM_NEEDS_SHARED();
  check_edges({"scenes/etoile.obj", 9'116, 8'570, 3'894, 109680.899, 106625.098, 27789.6867, 1.5e-3});
}

TEST_CASE("the edges of the small scenes are those of an independent script, and of a count by hand") {
  DCEM_NEEDS_SHARED();
  check_edges({"scenes/box.obj", 12, 12, 0, 100, 100, 0, rounding_m});
  check_edges({"scenes/simple_wedge.obj", 1, 1, 6, 30, 30, 180, rounding_m});
  check_edges({"scenes/floor_wall.obj", 0, 0, 8, 0, 0, 27, rounding_m});
  check_edges({"scenes/simple_street_canyon.obj", 72, 72, 4, 2231.782, 2231.782, 615.0622, rounding_m});
  check_edges({"scenes/simple_street_canyon_with_cars.obj", 216, 216, 4, 2489.45039, 2489.45039, 615.0622, rounding_m});
}

TEST_CASE("the rim of a sheet that touches itself at a point ends there: no free edge goes on across it") {
  // A frame around a hole, whose upper bar has a point that stands on the lower bar at (2, 1).
  TriangleMesh mesh;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    add_quad(mesh, {a, b, c, d}, "x");
  };
  add(Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0));
  add(Vec3(2, 0, 0), Vec3(4, 0, 0), Vec3(4, 1, 0), Vec3(2, 1, 0));
  add(Vec3(4, 0, 0), Vec3(5, 0, 0), Vec3(5, 1, 0), Vec3(4, 1, 0));
  add(Vec3(4, 1, 0), Vec3(5, 1, 0), Vec3(5, 2, 0), Vec3(4, 2, 0));
  add(Vec3(4, 2, 0), Vec3(5, 2, 0), Vec3(5, 3, 0), Vec3(4, 3, 0));
  add(Vec3(3, 2, 0), Vec3(4, 2, 0), Vec3(4, 3, 0), Vec3(3, 3, 0));
  add(Vec3(1, 2, 0), Vec3(3, 2, 0), Vec3(3, 3, 0), Vec3(1, 3, 0));
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), {Vec3(2, 1, 0), Vec3(3, 2, 0), Vec3(1, 2, 0)});
  mesh.triangles.push_back({{first, first + 1, first + 2}, 0});
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(surface.facets.size() == 1);
  int ends = 0;
  for (const Wedge& wedge : surface.wedges) {
    const bool holds_point = distance_to_segment_m(Vec3(2, 1, 0), wedge.start_m, wedge.end_m) < 1e-9;
    const bool ends_there = wedge.start_m == Vec3(2, 1, 0) || wedge.end_m == Vec3(2, 1, 0);
    CHECK(holds_point == ends_there);
    ends += ends_there ? 1 : 0;
  }
  CHECK(ends == 4);
}

}  // namespace test_wedge_builder
