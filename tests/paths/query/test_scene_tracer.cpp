/// What a ray hits, what a leg crosses, and where a facet reflects.
#include "dcem/paths/query/scene_tracer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_scene_tracer {

using namespace dcem;
using namespace dcem::test;

namespace {

/// The sheets on a leg without mirrors, by material name and distance; `blocked` where there is no way.
struct Leg {
  bool free = false;
  std::vector<std::string> sheets;
  std::vector<double> at;
};

template <typename Index>
Leg follow(TracedScene<Index>& traced, const Vec3& from_m, const Vec3& to_m, std::size_t limit,
           const LegEnd& start = {}, const LegEnd& end = {}, const IgnoredBodies& ignored = {}) {
  std::vector<Crossing> crossings;
  Leg leg;
  leg.free = traced.tracer.follow_leg(from_m, to_m, start, end, ignored, limit, crossings, traced.counters);
  if (!leg.free) return leg;
  for (const Crossing& crossing : crossings) {
    leg.sheets.push_back(traced.scene.material(traced.scene.facet(crossing.facet).material).name);
    leg.at.push_back(crossing.t);
  }
  return leg;
}

using Names = std::vector<std::string>;

/// Sheets across the x axis, each a little larger than the one before: no corner is welded to another's.
TriangleMesh sheets_across_x(const std::vector<std::pair<double, std::string>>& sheets) {
  TriangleMesh mesh;
  double half_m = 5.0;
  for (const auto& [x_m, material] : sheets) {
    add_sheet_across_x(mesh, x_m, half_m, material);
    half_m += 0.5;
  }
  return mesh;
}

}  // namespace

TEST_CASE("a leg crosses each sheet once, in order, wherever it meets the sheet") {
  TracedScene<> traced(scene_of(sheets_across_x({{3, "glass"}, {1, "wall"}, {2, "alpha"}})));
  // Inside a triangle; through the diagonal and the centre of the sheets; through their corner.
  for (const auto& [y, z] : {std::pair(0.3, 1.1), {0.0, 0.0}, {1.25, 1.25}, {5.0, 5.0}, {5.0, 1.0}}) {
    const Leg forth = follow(traced, Vec3(0, y, z), Vec3(4, y, z), 3);
    REQUIRE(forth.free);
    CHECK(forth.sheets == Names{"wall", "alpha", "glass"});
    CHECK(forth.at == std::vector<double>{0.25, 0.5, 0.75});
    const Leg back = follow(traced, Vec3(4, y, z), Vec3(0, y, z), 3);
    CHECK(back.sheets == Names{"glass", "alpha", "wall"});
  }
  CHECK(follow(traced, Vec3(0, 6.501, 0), Vec3(4, 6.501, 0), 0).free);  // beside all of them
}

TEST_CASE("more sheets than the limit block, and so does any opaque facet") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "glass"}, {2, "glass"}, {3, "glass"}, {5, "opaque"}})));
  for (std::size_t limit = 0; limit <= 4; ++limit) {
    CHECK(follow(traced, Vec3(0, 1, 0.5), Vec3(4, 1, 0.5), limit).free == (limit >= 3));
    CHECK(follow(traced, Vec3(1.5, 1, 0.5), Vec3(2.5, 1, 0.5), limit).free == (limit >= 1));
    CHECK_FALSE(follow(traced, Vec3(0, 1, 0.5), Vec3(6, 1, 0.5), limit).free);
    CHECK_FALSE(follow(traced, Vec3(4, 1, 0.5), Vec3(6, 1, 0.5), limit).free);
  }
}

TEST_CASE("coplanar sheets at one point count once, with the material whose name comes first") {
  for (const bool swapped : {false, true}) {
    TracedScene<> traced(scene_of(swapped ? sheets_across_x({{1, "glass"}, {1, "alpha"}, {2, "wall"}})
                                          : sheets_across_x({{2, "wall"}, {1, "alpha"}, {1, "glass"}})));
    CHECK(follow(traced, Vec3(0, 1.3, 0.7), Vec3(3, 1.3, 0.7), 2).sheets == Names{"alpha", "wall"});
    CHECK(follow(traced, Vec3(3, 1.3, 0.7), Vec3(0, 1.3, 0.7), 2).sheets == Names{"wall", "alpha"});
    CHECK_FALSE(follow(traced, Vec3(0, 1.3, 0.7), Vec3(3, 1.3, 0.7), 1).free);
  }
  // Half a weld tolerance apart they are one place; five of them apart they are two.
  TracedScene<> close(scene_of(sheets_across_x({{1, "glass"}, {1.00005, "alpha"}})));
  CHECK(follow(close, Vec3(0, 1, 0.5), Vec3(3, 1, 0.5), 2).sheets == Names{"alpha"});
  TracedScene<> apart(scene_of(sheets_across_x({{1, "glass"}, {1.0005, "alpha"}})));
  CHECK(follow(apart, Vec3(0, 1, 0.5), Vec3(3, 1, 0.5), 2).sheets == Names{"glass", "alpha"});
}

TEST_CASE("a stack of sheets, each within the tolerance of the one before, counts once, however thick it is") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "glass"}, {1.00006, "wall"}, {1.00012, "alpha"}})));
  CHECK(follow(traced, Vec3(0, 1, 0.5), Vec3(3, 1, 0.5), 3).sheets == Names{"alpha"});
  CHECK(follow(traced, Vec3(3, 1, 0.5), Vec3(0, 1, 0.5), 3).sheets == Names{"alpha"});
}

TEST_CASE("whether two sheets are one place is measured across them, not along the leg") {
  // Half a tolerance apart across, 2 mm along this leg.
  TracedScene<> traced(scene_of(sheets_across_x({{1, "glass"}, {1.00005, "alpha"}})));
  CHECK(follow(traced, Vec3(0.9, -4, 0.5), Vec3(1.1, 4, 0.7), 2).sheets == Names{"alpha"});
  CHECK(follow(traced, Vec3(1.1, 4, 0.7), Vec3(0.9, -4, 0.5), 2).sheets == Names{"alpha"});
}

TEST_CASE("a hard facet in the plane of a sheet blocks, whatever its name") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "alpha"}, {1, "opaque"}})));
  CHECK_FALSE(follow(traced, Vec3(0, 1, 0.5), Vec3(3, 1, 0.5), 5).free);
}

TEST_CASE("where two sheets meet at an angle both are crossed") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), "glass");
  add_sheet(mesh, Vec3(1, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 0, 1), "alpha");  // both hold the line x = 1, y = 0
  TracedScene<> traced(scene_of(mesh));
  CHECK(follow(traced, Vec3(0, 0, 0.5), Vec3(2, 0, 0.5), 2).sheets == Names{"alpha", "glass"});
}

TEST_CASE("a leg within a sheet's own plane does not cross it") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "glass"}})));
  CHECK(follow(traced, Vec3(1, -9, 0.5), Vec3(1, 9, 0.5), 0).free);
}

TEST_CASE("a leg ignores the facet it starts or ends on and its coplanar duplicate, from one end only") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "opaque"}, {1.00005, "metal"}, {2, "opaque"}})));
  const FacetId own = traced.facet_at(Vec3(1, 1, 0), "opaque");
  const LegEnd on_mirror{{&own, 1}, &traced.scene.facet(own).plane};
  const Vec3 on_m(1, 0.5, 0.2), before_m(0, 0.5, 0.2), between_m(1.5, 0.5, 0.2), behind_m(3, 0.5, 0.2);
  for (const Vec3& other_m : {before_m, between_m}) {
    CHECK_FALSE(follow(traced, on_m, other_m, 0).free);  // by itself the facet is in the way, even at the end
    CHECK(follow(traced, on_m, other_m, 0, on_mirror).free);
    CHECK(follow(traced, other_m, on_m, 0, {}, on_mirror).free);
  }
  CHECK_FALSE(follow(traced, on_m, behind_m, 0, on_mirror).free);
  CHECK_FALSE(follow(traced, behind_m, on_m, 0, {}, on_mirror).free);
  // A device knows its facets by name; it has no plane, so the duplicate 0.05 mm behind still blocks.
  const LegEnd mounted{{&own, 1}, nullptr};
  CHECK(follow(traced, on_m, before_m, 0, mounted).free);
  CHECK_FALSE(follow(traced, on_m, between_m, 0, mounted).free);
}

TEST_CASE("a leg from the mean plane of an uneven facet is not blocked by the facet's own triangles") {
  // One corner is lifted by 0.9 mm: the triangles stray from the mean plane by more than the weld tolerance.
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-5, -5, 0), Vec3(5, -5, 0), Vec3(5, 5, 0), Vec3(-5, 5, 9e-4)}, "opaque");
  TracedScene<> traced(scene_of(mesh));
  REQUIRE(traced.scene.facets().size() == 1);
  const std::array<FacetId, 1> facets{FacetId(0U)};
  const Plane& plane = traced.scene.facet(facets[0]).plane;
  for (double x = -4.75; x < 5.0; x += 0.5) {
    for (double y = -4.75; y < 5.0; y += 0.5) {
      const Vec3 foot_m = Vec3(x, y, 0) - signed_distance_m(plane, Vec3(x, y, 0)) * plane.normal;
      for (const double side_m : {-3.0, 3.0}) {
        CHECK(follow(traced, foot_m, foot_m + side_m * plane.normal, 0, {facets, {&plane, nullptr}}).free);
      }
    }
  }
}

TEST_CASE("a wall one centimetre from the point of reflection blocks") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 50, 0), "opaque");  // the floor
  add_sheet(mesh, Vec3(0.01, 0, 1), Vec3(0, 5, 0), Vec3(0, 0, 1), "metal");  // a wall on it, 1 cm off
  TracedScene<> traced(scene_of(mesh));
  const FacetId floor = traced.facet_at(Vec3(-3, 5, 0), "opaque");
  const LegEnd on_floor{{&floor, 1}, &traced.scene.facet(floor).plane};
  const Vec3 point_m(0.0, 0.3, 0.0);
  CHECK(follow(traced, point_m, Vec3(-2, 0.3, 2), 0, on_floor).free);
  CHECK_FALSE(follow(traced, point_m, Vec3(2, 0.3, 2), 0, on_floor).free);
  CHECK_FALSE(follow(traced, Vec3(2, 0.3, 2), point_m, 0, {}, on_floor).free);
  // However low the leg runs: half a degree above the floor it meets the wall 0.09 mm above its foot.
  CHECK_FALSE(follow(traced, point_m, Vec3(20, 0.3, 0.17), 0, on_floor).free);
  CHECK_FALSE(follow(traced, Vec3(20, 0.3, 0.17), point_m, 0, {}, on_floor).free);
}

TEST_CASE("bodies that are ignored neither block nor are crossed nor are near") {
  Scene scene = scene_of_materials();
  const BodyId car = scene.add_object("car", make_box(Vec3(2, 2, 2), "metal"), {});
  const BodyId bus =
      scene.add_object("bus", make_box(Vec3(2, 2, 2), "glass"), LinearMotion{{Vec3(5, 0, 0)}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const Vec3 from_m(-3, 0.2, 1), to_m(9, 0.2, 1);
  CHECK_FALSE(follow(traced, from_m, to_m, 9).free);
  CHECK(follow(traced, from_m, to_m, 9, {}, {}, {car, std::nullopt}).sheets == Names{"glass", "glass"});
  CHECK(follow(traced, from_m, to_m, 9, {}, {}, {bus, car}).sheets.empty());
  CHECK(traced.tracer.facets_near(Vec3(1, 0, 1), 1e-3, {}, traced.counters).size() == 1);
  CHECK(traced.tracer.facets_near(Vec3(1, 0, 1), 1e-3, {std::nullopt, car}, traced.counters).empty());
  const Ray<double> ray{from_m, Vec3(1, 0, 0)};
  const auto hit = traced.tracer.closest_hit(ray, {}, {car, std::nullopt}, traced.counters);
  REQUIRE(hit.has_value());
  CHECK(traced.scene.facet(hit->facet).body == bus);
  CHECK(hit->t == 7.0);
  CHECK_FALSE(traced.tracer.closest_hit(ray, {}, {car, bus}, traced.counters).has_value());
}

TEST_CASE("the first facet along a ray: nearest, then smallest id, never what the ray starts on") {
  TracedScene<> traced(scene_of(sheets_across_x({{2, "glass"}, {1, "wall"}, {1, "alpha"}, {-1, "metal"}})));
  const Ray<double> ray{Vec3(0, 0, 0), Vec3(0.5, 0.01, 0.02)};
  const auto hit = traced.tracer.closest_hit(ray, {}, {}, traced.counters);
  REQUIRE(hit.has_value());
  CHECK(hit->t == doctest::Approx(2.0).epsilon(1e-15));
  const FacetId wall = traced.facet_at(Vec3(1, 1, 0), "wall"), alpha = traced.facet_at(Vec3(1, 1, 0), "alpha");
  CHECK(hit->facet == std::min(wall, alpha));
  const LegEnd on_both{{&wall, 1}, &traced.scene.facet(wall).plane};  // the duplicate is coplanar
  const auto next = traced.tracer.closest_hit({ray.at(2.0), ray.direction}, on_both, {}, traced.counters);
  REQUIRE(next.has_value());
  CHECK(next->facet == traced.facet_at(Vec3(2, 1, 0), "glass"));
  CHECK_FALSE(traced.tracer.closest_hit({Vec3(3, 0, 0), Vec3(1, 0, 0)}, {}, {}, traced.counters).has_value());
}

TEST_CASE("a facet reflects inside, on diagonals, inner corners and seams, but not on its rim") {
  for (const int cells : {1, 2, 4}) {  // 2, 8 and 32 triangles: the last takes the way through the tree
    TriangleMesh mesh;
    add_tiled_sheet(mesh, Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), cells, "glass");
    add_tiled_sheet(mesh, Vec3(4, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), cells, "metal");  // its neighbour from x = 2 on
    add_sheet(mesh, Vec3(0, 2, 1), Vec3(2, 0, 0), Vec3(0, 0, 1), "opaque");              // a wall on the rim y = 2
    TracedScene<> traced(scene_of(mesh));
    const FacetId glass = traced.facet_at(Vec3(-1.9, 0.3, 0), "glass");
    const FacetId metal = traced.facet_at(Vec3(5.9, 0.3, 0), "metal");
    REQUIRE(traced.scene.facet(glass).triangle_count == 2U * static_cast<unsigned>(cells * cells));
    const auto reflects = [&](FacetId facet, double x, double y) {
      return traced.tracer.reflects_at(facet, Vec3(x, y, 0), {}, traced.counters);
    };
    CHECK(reflects(glass, 0.3, 0.1));
    CHECK(reflects(glass, 0.0, 0.0));  // the diagonal of one cell, an inner corner of more
    CHECK(reflects(glass, 1.0, 1.0));  // corner of four cells
    CHECK(reflects(glass, 1.0, 0.3));  // an inner edge
    CHECK(reflects(glass, 0.7, 0.7));  // a diagonal
    CHECK(reflects(glass, 2.0, 0.3));  // the seam: coplanar facets go on
    CHECK(reflects(metal, 2.0, 0.3));
    CHECK(reflects(glass, 2.0, 0.0));  // a corner on the seam
    CHECK_FALSE(reflects(glass, -2.0, 0.3));
    CHECK_FALSE(reflects(glass, 0.3, 2.0));  // a wall stands here, but it is not coplanar
    CHECK_FALSE(reflects(glass, -2.0, -2.0));
    CHECK_FALSE(reflects(glass, 2.0, 2.0));  // end of the seam: two right angles are half a turn
    CHECK_FALSE(reflects(metal, 6.0, 0.3));
    CHECK_FALSE(reflects(glass, 2.0 + 1e-7, 0.3));
    CHECK_FALSE(reflects(metal, 2.0 - 1e-7, 0.3));
    CHECK(reflects(glass, -2.0 + 1e-7, 0.3));
    CHECK_FALSE(reflects(glass, -2.0 - 1e-7, 0.3));
    CHECK_FALSE(reflects(glass, -2.0 + 5e-10, 0.3));  // closer than 1e-9 m to the rim is on it
  }
}

TEST_CASE("a seam counts only while the neighbour is there") {
  Scene scene = scene_of_materials();
  TriangleMesh own, other;
  add_sheet(own, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), "glass");
  add_sheet(other, Vec3(2, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), "metal");
  scene.set_scenery(own);
  const BodyId plate = scene.add_object("plate", other, {});
  TracedScene<> traced(std::move(scene));
  const FacetId glass = traced.facet_at(Vec3(0, 0, 0), "glass");
  CHECK(traced.tracer.reflects_at(glass, Vec3(1, 0.3, 0), {}, traced.counters));
  CHECK_FALSE(traced.tracer.reflects_at(glass, Vec3(1, 0.3, 0), {plate, std::nullopt}, traced.counters));
}

TEST_CASE("a hole in a facet does not reflect") {
  TriangleMesh mesh;
  const auto at = [](double x, double y) { return Vec3(x, y, 0); };
  add_quad(mesh, {at(-2, -2), at(2, -2), at(1, -1), at(-1, -1)}, "metal");
  add_quad(mesh, {at(2, -2), at(2, 2), at(1, 1), at(1, -1)}, "metal");
  add_quad(mesh, {at(2, 2), at(-2, 2), at(-1, 1), at(1, 1)}, "metal");
  add_quad(mesh, {at(-2, 2), at(-2, -2), at(-1, -1), at(-1, 1)}, "metal");
  TracedScene<> traced(scene_of(mesh));
  REQUIRE(traced.scene.facets().size() == 1);
  const auto reflects = [&](double x, double y) {
    return traced.tracer.reflects_at(FacetId(0), Vec3(x, y, 0), {}, traced.counters);
  };
  CHECK(reflects(1.5, 0.2));
  CHECK(reflects(1.5, 1.5));
  CHECK_FALSE(reflects(0.2, 0.3));
  CHECK_FALSE(reflects(1.0, 0.3));
  CHECK_FALSE(reflects(1.0, 1.0));
}

TEST_CASE("finely cut facets and whole ones give the same answers, with the tree and without") {
  Draw draw(5);
  const Vec3 u = glm::normalize(Vec3(2, 1, 0.3)), v = glm::normalize(glm::cross(u, Vec3(0.2, -0.5, 1)));
  TriangleMesh coarse, fine;
  add_tiled_sheet(coarse, Vec3(30, -20, 10), 3.0 * u, 2.0 * v, 1, "glass");
  add_tiled_sheet(fine, Vec3(30, -20, 10), 3.0 * u, 2.0 * v, 8, "glass");
  TracedScene<> one(scene_of(coarse)), tree(scene_of(fine));
  TracedScene<BruteForceIndex> brute(scene_of(fine));
  REQUIRE(tree.scene.facets().size() == 1);
  REQUIRE(tree.scene.facet(FacetId(0)).triangle_count == 128);
  int inside = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    // Half of the points lie on lines of the tiling, where several triangles meet.
    double a = draw.between(-1.2, 1.2), b = draw.between(-1.2, 1.2);
    if (trial % 2 == 0) a = std::round(a * 4.0) / 4.0;
    if (trial % 3 == 0) b = std::round(b * 4.0) / 4.0;
    if (std::abs(std::abs(a) - 1.0) < 1e-9 || std::abs(std::abs(b) - 1.0) < 1e-9) continue;  // the rim: see above
    const Vec3 point_m = Vec3(30, -20, 10) + 3.0 * a * u + 2.0 * b * v;
    const bool expected = std::abs(a) < 1.0 && std::abs(b) < 1.0;
    CHECK(one.tracer.reflects_at(FacetId(0), point_m, {}, one.counters) == expected);
    CHECK(tree.tracer.reflects_at(FacetId(0), point_m, {}, tree.counters) == expected);
    CHECK(brute.tracer.reflects_at(FacetId(0), point_m, {}, brute.counters) == expected);
    const Vec3 away_m = point_m + 4.0 * draw.direction();
    const Vec3 behind_m = 2.0 * point_m - away_m;
    CHECK(follow(one, away_m, behind_m, 1).sheets.size() == (expected ? 1 : 0));
    CHECK(follow(tree, away_m, behind_m, 1).sheets.size() == (expected ? 1 : 0));
    CHECK(follow(brute, away_m, behind_m, 1).sheets.size() == (expected ? 1 : 0));
    inside += expected;
  }
  CHECK(inside > 1000);
}

TEST_CASE("facets near a point: within the radius, each once, ascending") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(1.0), "opaque");
  TracedScene<> traced(scene_of(mesh));
  const auto near = [&](const Vec3& point_m, double radius_m) {
    return traced.tracer.facets_near(point_m, radius_m, {}, traced.counters);
  };
  CHECK(near(Vec3(0.5, 0.5, 0.5), 0.49).empty());
  CHECK(near(Vec3(0.5, 0.5, 0.5), 0.51).size() == 6);
  CHECK(near(Vec3(0, 0, 0), 1e-4).size() == 3);
  CHECK(near(Vec3(0.5, 0.5, 1.00009), 1e-4).size() == 1);
  CHECK(near(Vec3(0.5, 0.5, 1.00011), 1e-4).empty());
  CHECK(near(Vec3(1.00008, 0.5, 1.00008), 1e-4).empty());  // 0.113 mm from the edge
  const std::vector<FacetId> all = near(Vec3(0.5), 1.0);
  CHECK(std::is_sorted(all.begin(), all.end()));
}

TEST_CASE("by name, then by id: which of two overlapping facets stands for the other") {
  TracedScene<> traced(scene_of(sheets_across_x({{1, "glass"}, {2, "alpha"}, {3, "glass"}})));
  const FacetId glass_1 = traced.facet_at(Vec3(1, 1, 0), "glass"), alpha = traced.facet_at(Vec3(2, 1, 0), "alpha"),
                glass_3 = traced.facet_at(Vec3(3, 1, 0), "glass");
  CHECK(traced.tracer.precedes(alpha, glass_1));
  CHECK_FALSE(traced.tracer.precedes(glass_1, alpha));
  CHECK(traced.tracer.precedes(glass_1, glass_3) == (glass_1 < glass_3));
  CHECK(traced.tracer.precedes(glass_3, glass_1) == (glass_3 < glass_1));
  CHECK_FALSE(traced.tracer.precedes(alpha, alpha));
  CHECK(traced.tracer.parallel(alpha, glass_1));
}

}  // namespace test_scene_tracer
