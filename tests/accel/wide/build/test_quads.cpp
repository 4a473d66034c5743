#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "dcem/accel/wide/build/quads.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_quads {

using namespace dcem;
using dcem_test::WideMesh;

namespace {

std::vector<Quad> quads_of(const WideMesh& mesh, double flatness = 1e-3) {
  std::vector<Quad> quads;
  const TriangleView view = mesh.view();
  detail::QuadBuilder(view, flatness).append(0, static_cast<std::uint32_t>(mesh.triangles.size()), quads);
  return quads;
}

std::size_t pair_count(const std::vector<Quad>& quads) {
  return static_cast<std::size_t>(std::ranges::count_if(quads, [](const Quad& quad) { return quad.is_pair(); }));
}

/// Everything a list of quads promises of the mesh it was made from.
void check_promises(const WideMesh& mesh, const std::vector<Quad>& quads, double flatness) {
  std::vector<int> times(mesh.triangles.size(), 0);
  for (const Quad& quad : quads) {
    REQUIRE(!quad.is_none());
    for (const std::uint32_t triangle : quad.triangles()) ++times[triangle];
    // a, b, c are the first triangle's corners in its own order, from some corner on.
    const std::array<std::uint32_t, 3>& own = mesh.triangles[quad.triangle[0]];
    for (std::size_t corner = 0; corner < 3; ++corner)
      REQUIRE(quad.corner[(quad.begin[0] + corner) % 3] == own[corner]);
    REQUIRE(quad.first_vertex(0) == own[0]);
    if (!quad.is_pair()) continue;
    REQUIRE(quad.first_vertex(1) == mesh.triangles[quad.triangle[1]][0]);
    // The second triangle is c, a, d in some order.
    std::multiset<std::uint32_t> second(mesh.triangles[quad.triangle[1]].begin(),
                                        mesh.triangles[quad.triangle[1]].end());
    const auto& [a, b, c, d] = quad.corner;
    REQUIRE(second == std::multiset<std::uint32_t>{a, c, d});
    REQUIRE(a != c);
    const std::array<Vec3, 4> at{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]};
    // Flat: the height of d over the plane of the others, from the volume they span.
    const Vec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
    REQUIRE(glm::length(normal) > 0.0);
    const double height = std::abs(glm::dot(normal, at[3] - at[0])) / glm::length(normal);
    REQUIRE(height <= flatness * glm::distance(at[0], at[2]) * (1 + 1e-12));
    // Convex: seen along the normal, the two diagonals cross within both.
    const Vec3 x = glm::normalize(at[2] - at[0]), y = glm::normalize(glm::cross(normal, x));
    const double b_side = glm::dot(y, at[1] - at[0]), d_side = glm::dot(y, at[3] - at[0]);
    REQUIRE(b_side * d_side < 0.0);
    const double share = b_side / (b_side - d_side);
    const double crossing = glm::dot(x, at[1] + share * (at[3] - at[1]) - at[0]) / glm::distance(at[0], at[2]);
    REQUIRE(crossing > 0.0);
    REQUIRE(crossing < 1.0);
  }
  REQUIRE(std::ranges::all_of(times, [](int count) { return count == 1; }));
}

}  // namespace

TEST_CASE("pairs share an edge, are flat and convex; every triangle is in one quad") {
  std::uint64_t seed = 0;
  for (const double flatness : {1e-3, 1e-6, 0.1}) {
    for (const WideMesh& mesh : {dcem_test::boxes_mesh(40, ++seed), dcem_test::ball(Vec3(1), 2.0, 9),
                                 dcem_test::dirty_mesh(60, ++seed), dcem_test::bent_ground(12, 0.3 * flatness, ++seed),
                                 dcem_test::bent_ground(12, 3 * flatness, ++seed), dcem_test::soup(50, ++seed)}) {
      check_promises(mesh, quads_of(mesh, flatness), flatness);
    }
  }
}

TEST_CASE("a box is six quadrilaterals; a soup has no pairs; a negative limit makes none") {
  const WideMesh box = dcem_test::box_mesh(Vec3(0), Vec3(1, 2, 3));
  CHECK(quads_of(box).size() == 6);
  CHECK(pair_count(quads_of(box)) == 6);
  CHECK(pair_count(quads_of(dcem_test::soup(100, 1))) == 0);
  CHECK(pair_count(quads_of(box, -1.0)) == 0);
  check_promises(box, quads_of(box, -1.0), 0.0);
}

TEST_CASE("flat within the limit, and not beyond it") {
  for (const double height : {0.9e-3, 1.1e-3}) {
    WideMesh mesh;
    for (const Vec3& vertex : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -0.9, 2 * height)}) {
      mesh.add_vertex(vertex);
    }
    mesh.add(0, 1, 2);
    mesh.add(2, 3, 0);
    // The shared edge is 2 m long.
    CHECK(pair_count(quads_of(mesh)) == (height < 1e-3 ? 1U : 0U));
  }
}

TEST_CASE("concave and overlapping neighbours stay apart") {
  const auto pairs_with = [](const Vec3& fourth) {
    WideMesh mesh;
    for (const Vec3& vertex : {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(1, 2, 0), fourth}) mesh.add_vertex(vertex);
    mesh.add(0, 1, 2);
    mesh.add(1, 0, 3);
    return pair_count(quads_of(mesh));
  };
  CHECK(pairs_with(Vec3(2, -2, 0)) == 1);
  CHECK(pairs_with(Vec3(-3, -2, 0)) == 0);  // reflex at the first vertex
  CHECK(pairs_with(Vec3(8, -1, 0)) == 0);   // reflex at the second
  CHECK(pairs_with(Vec3(1, 1, 0)) == 0);    // on the same side of the edge
  CHECK(pairs_with(Vec3(1, 2, 0)) == 0);    // the same triangle again
  CHECK(pairs_with(Vec3(3, 2, 0)) == 0);    // as high on the same side: the areas cancel to the bit
  CHECK(pairs_with(Vec3(2, 0, 0)) == 0);    // no area
}

TEST_CASE("winding, vertex numbers and what stands elsewhere in the mesh do not change the pairs") {
  const WideMesh mesh = dcem_test::bent_ground(9, 1e-4, 7);
  const auto pairs_of = [](const WideMesh& given, std::uint32_t first, std::uint32_t last) {
    std::vector<Quad> quads;
    const TriangleView view = given.view();
    detail::QuadBuilder(view, 1e-3).append(first, last, quads);
    std::set<std::set<std::uint32_t>> pairs;
    for (const Quad& quad : quads) {
      if (quad.is_pair()) pairs.insert({quad.triangle[0] - first, quad.triangle[1] - first});
    }
    return pairs;
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const auto expected = pairs_of(mesh, 0, count);
  REQUIRE(expected.size() > 60);
  RandomStream random(8);
  WideMesh turned = mesh;
  for (auto& [a, b, c] : turned.triangles) {
    if (random.uniform() < 0.5) std::swap(a, b);
    if (random.uniform() < 0.5) std::swap(b, c);
  }
  CHECK(pairs_of(turned, 0, count) == expected);
  WideMesh renumbered = mesh;
  std::ranges::reverse(renumbered.vertices);
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (auto& corners : renumbered.triangles) {
    for (std::uint32_t& corner : corners) corner = last - corner;
  }
  CHECK(pairs_of(renumbered, 0, count) == expected);
  WideMesh later = dcem_test::soup(13, 9);
  later.append(mesh);
  CHECK(pairs_of(later, 13, 13 + count) == expected);
}

TEST_CASE("an object is paired within itself only") {
  WideMesh mesh;
  for (const Vec3& vertex : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) mesh.add_vertex(vertex);
  mesh.add(0, 1, 2);
  mesh.add(0, 2, 3);
  std::vector<Quad> quads;
  const TriangleView view = mesh.view();
  detail::QuadBuilder pairing(view, 1e-3);
  pairing.append(0, 1, quads);
  pairing.append(1, 2, quads);
  CHECK(quads.size() == 2);
  check_promises(mesh, quads, 1e-3);
}

TEST_CASE("a ray that is steep to one half of a pair goes through the other half the same way, by 1e-3 at least") {
  for (const double bend_rad : {1e-5, 1e-4, 1e-3, 1e-2, 0.1}) {
    TrianglePlane level, bent;
    level.normal = Vec3(0, 0, 1);
    bent.normal = Vec3(0, -std::sin(bend_rad), std::cos(bend_rad));
    const Vec3 difference = bent.normal - level.normal;
    level.least_slope_squared = TrianglePlane::least_slope_squared_of(glm::dot(difference, difference));
    const double least = std::sqrt(static_cast<double>(level.least_slope_squared));
    for (const double slope : {-1.0001 * least, 1.0001 * least}) {
      for (const double across : {-1.0, 1.0}) {  // down the bend and up
        const Ray<double> ray{Vec3(0), Vec3(0, across * std::sqrt(1.0 - slope * slope), slope)};
        REQUIRE(level.is_steep(ray));
        CHECK(bent.slope(ray) * slope > 0.0);
        CHECK(std::abs(bent.slope(ray)) > 1e-3);
      }
    }
  }
}

}  // namespace test_quads
