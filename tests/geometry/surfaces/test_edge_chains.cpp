#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/geometry/surfaces/edge_chains.hpp"

namespace test_edge_chains {

using namespace dcem;

namespace {

EdgePiece piece(std::uint32_t a, std::uint32_t b) {
  return {{0, no_facet}, a, b, {}};
}

/// A polyline through all vertices in their order.
EdgeChain chain_through(const std::vector<Vec3>& vertices_m) {
  EdgeChain chain{{0}, {}};
  for (std::uint32_t index = 1; index < vertices_m.size(); ++index) {
    chain.vertices.push_back(index);
    chain.pieces.push_back(piece(index - 1, index));
  }
  return chain;
}

std::vector<std::size_t> corners(const std::vector<Vec3>& vertices_m, double tolerance_m) {
  return chain_corners(chain_through(vertices_m), vertices_m, tolerance_m);
}

using Places = std::vector<std::size_t>;

}  // namespace

TEST_CASE("pieces are the sides of one triangle, and those of two triangles of two facets, rims last") {
  // Facet 0 is two triangles over the side 1-2; facet 1 meets it at 0-1; three facets meet at 2-3.
  SurfaceMesh mesh;
  mesh.vertices_m.resize(7);
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {0, 1, 4}, {2, 3, 5}, {2, 3, 6}};
  mesh.facet_of_triangle = {0, 0, 1, 2, 3};
  const EdgePieces pieces = edge_pieces(mesh);
  REQUIRE(pieces.size() == 1 + 2 + 2 + 2 + 2);
  CHECK(pieces[0].facets == std::array<std::uint32_t, 2>{0, 1});
  CHECK(pieces[0].a == 0);
  CHECK(pieces[0].b == 1);
  CHECK(pieces[0].opposite == std::array<std::uint32_t, 2>{2, 4});
  const std::vector<std::array<std::uint32_t, 4>> rims{
      // facet, two vertices, the corner opposite
      {0, 0, 2, 1}, {0, 1, 3, 2}, {1, 0, 4, 1}, {1, 1, 4, 0}, {2, 2, 5, 3}, {2, 3, 5, 2}, {3, 2, 6, 3}, {3, 3, 6, 2}};
  for (std::size_t index = 0; index < rims.size(); ++index) {
    const EdgePiece& rim = pieces[index + 1];
    CHECK(rim.is_free());
    CHECK(std::array<std::uint32_t, 4>{rim.facets[0], rim.a, rim.b, rim.opposite[0]} == rims[index]);
  }
}

TEST_CASE("a chain runs from its smaller end over every piece, whatever their order") {
  const std::vector<Vec3> vertices_m(9);
  const EdgePieces pieces{piece(4, 7), piece(2, 7), piece(1, 4), piece(2, 3)};
  const EdgeChain chain = edge_chain(pieces, vertices_m);
  CHECK(chain.vertices == std::vector<std::uint32_t>{1, 4, 7, 2, 3});
  REQUIRE(chain.pieces.size() == 4);
  for (std::size_t index = 0; index < 4; ++index) {
    const auto [low, high] = std::minmax(chain.vertices[index], chain.vertices[index + 1]);
    CHECK(chain.pieces[index].a == low);
    CHECK(chain.pieces[index].b == high);
  }
}

TEST_CASE("a closed chain starts at a corner and comes back to it") {
  // A square whose left side has a vertex in its middle, the smallest of all by its index.
  const std::vector<Vec3> vertices_m{{0, 1, 0}, {0, 0, 0}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}};
  const EdgePieces pieces{piece(0, 1), piece(0, 2), piece(1, 3), piece(2, 4), piece(3, 4)};
  const EdgeChain chain = edge_chain(pieces, vertices_m);
  CHECK(chain.vertices == std::vector<std::uint32_t>{3, 1, 0, 2, 4, 3});
  CHECK(chain_corners(chain, vertices_m, 1e-4) == Places{0, 1, 3, 4, 5});
}

TEST_CASE("a chain is cut where it bends by more than the tolerance, and nowhere else") {
  CHECK(corners({{0, 0, 0}, {1, 0, 0}}, 0.1) == Places{0, 1});
  CHECK(corners({{0, 0, 0}, {1, 0.09, 0}, {2, 0, 0}}, 0.1) == Places{0, 2});
  CHECK(corners({{0, 0, 0}, {1, 0.11, 0}, {2, 0, 0}}, 0.1) == Places{0, 1, 2});
  CHECK(corners({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}}, 0.1) == Places{0, 2, 4});
  CHECK(corners({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}, 0.1) == Places{0, 1, 2});  // back the way it came
}

TEST_CASE("a side parallel to the first chord is not cut at the vertex that happens to stand out") {
  CHECK(corners({{0, 0, 0}, {0, 2, 0}, {1, 2.05, 0}, {2, 2, 0}, {2, 0, 0}}, 0.1) == Places{0, 1, 3, 4});
  CHECK(corners({{0, 0, 0}, {10, 4, 0}, {15, 4.05, 0}, {20, 4, 0}, {30, 0, 0}}, 0.1) == Places{0, 1, 3, 4});
}

TEST_CASE("a staircase of fifty thousand steps is cut at each: a search over all pairs would not come back in time") {
  std::vector<Vec3> vertices_m;
  Places expected;
  for (int step = 0; step < 50'000; ++step) {
    vertices_m.insert(vertices_m.end(), {Vec3(step, step, 0), Vec3(step + 0.5, step, 0), Vec3(step + 1, step, 0)});
    expected.insert(expected.end(), {vertices_m.size() - 3, vertices_m.size() - 1});
  }
  CHECK(corners(vertices_m, 1e-4) == expected);
}

}  // namespace test_edge_chains
