/// The ways of a link over visible parts, against paths that rays find.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/field/diffuse/scatter_ways.hpp"
#include "tests/paths/visible/visible_trial.hpp"

namespace test_scatter_ways {

using namespace dcem;
using namespace dcem::test;

namespace {

/// The area of a polygon by its length.
double width_m(std::span<const Vec3> polygon) {
  double length_m = 0.0;
  for (const Vec3& one : polygon) {
    for (const Vec3& other : polygon) length_m = std::max(length_m, glm::distance(one, other));
  }
  return 0.5 * twice_area_m2(polygon) / length_m;
}

}  // namespace

TEST_CASE(
    "scatter ways: a way lists the points of its sheets in order, on the sheets, and has the lengths of its legs") {
  std::size_t ways_seen = 0, of_two_and_more = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TriangleMesh mesh;
    add_sheet_across_x(mesh, 10.0, 6.0, "rough");
    for (int sheet = 0; sheet < 5; ++sheet) {
      const Vec3 u = glm::normalize(Vec3(draw.between(-1, 1), 1, 0)),
                 v = glm::normalize(Vec3(draw.between(-1, 1), 0, 1));
      add_sheet(mesh, draw.inside(Vec3(1, -4, -4), Vec3(8, 4, 4)), draw.between(1, 5) * u, draw.between(1, 5) * v,
                std::array{"glass", "alpha", "board"}[draw.below(3)]);
    }
    add_box_faces(mesh, Vec3(4, -20, -20), Vec3(5, draw.between(-8, 8), 20), "hedge");
    TracedScene<> world(rough_scene_of(mesh));
    LinkView view(world, world.end(draw.inside(Vec3(-4, -4, -4), Vec3(0, 4, 4))),
                  world.end(draw.inside(Vec3(-4, -4, -4), Vec3(9, 4, 4))), 4);
    ScatterWays ways(world.scene, view.from, view.to);
    for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
      const FacetId facet = world.scene.facet_of_triangle(triangle);
      for (const SeenPiece& piece : view.pieces_of(triangle)) {
        for (std::size_t part = 0; part < piece.parts.size(); ++part) {
          const std::span<const Vec3> corners_m = piece.parts.corners_m(part);
          if (width_m(corners_m) < 1e-2) continue;  // rays may pass beside the points of a sliver
          const std::uint32_t number = ways.number_of(piece.parts, part);
          const auto sheets = sheets_of(piece.parts, part);
          CHECK((number == 1) == (sheets[0].empty() && sheets[1].empty()));
          CHECK(number != 0);
          CHECK(ways.sheets(number).size() == sheets[0].size() + sheets[1].size());
          for (const FacetId sheet : ways.sheets(number))
            CHECK((sheets[0].contains(sheet) || sheets[1].contains(sheet)));
          for (int index = 0; index < 3; ++index) {
            const double share = draw.between(0.1, 0.45);
            const Vec3 point_m = (1.0 - 2.0 * share) * corners_m[0] + share * corners_m[1] + share * corners_m[2];
            if (inside_m(corners_m, point_m) < 1e-3) continue;
            const Path path = ways.listed(ways.over(number, facet, point_m));
            const std::optional<Path> traced = view.traced(facet, point_m);
            REQUIRE(traced);
            REQUIRE(path.interactions.size() == traced->interactions.size());
            for (std::size_t at = 0; at < path.interactions.size(); ++at) {
              const Interaction &one = path.interactions[at], &other = traced->interactions[at];
              CHECK(one.kind == other.kind);
              CHECK(one.facet == other.facet);
              // Legs of some 20 m, and sheets that are met at 0.1° at least.
              CHECK(glm::distance(one.point_m, other.point_m) < 1e-10);
              if (one.kind != InteractionKind::transmission) continue;
              CHECK(std::abs(signed_distance_m(world.scene.facet(one.facet).plane, one.point_m)) < 1e-12);
            }
            CHECK(path.length_m == doctest::Approx(traced->length_m).epsilon(1e-15));
            REQUIRE(path.foliage.size() == traced->foliage.size());
            for (std::size_t leaf = 0; leaf < path.foliage.size(); ++leaf) {
              CHECK(path.foliage[leaf].length_m == traced->foliage[leaf].length_m);
            }
            ++ways_seen;
            of_two_and_more += path.interactions.size() > 2;
          }
        }
      }
    }
    CHECK(ways.sheets(0).empty());
    CHECK(ways.sheets(1).empty());
  }
  MESSAGE(ways_seen << " ways, " << of_two_and_more << " through two sheets and more");
  CHECK(ways_seen > 1'000);
  CHECK(of_two_and_more > 300);
}

}  // namespace test_scatter_ways
