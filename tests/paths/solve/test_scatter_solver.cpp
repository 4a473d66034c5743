/// What a point of a rough surface sees, against triangles and rays of this file's own.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/paths/small_scenes.hpp"
#include "tests/support/scatter_solver.hpp"

namespace test_scatter_solver {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Rough walls `rough` (opaque) and `board` (a sheet), smooth `alpha` and `glass` (sheets), `metal` and `opaque`,
/// `hedge` and `tree` (foliage).
Scene rough_scene(const TriangleMesh& mesh) {
  Scene scene;
  const Scattering half{0.5};
  scene.add_material({"rough", ConstantReflection{0.7, std::nullopt}, 0.0, half});
  scene.add_material({"board", ConstantReflection{0.6, 10.0}, 0.0, half});
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_material({"opaque", ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"glass", ConstantReflection{0.74, 5.0}});
  scene.add_material({"alpha", ConstantReflection{0.5, 3.0}});
  scene.add_material({"hedge", Foliage{1.0}});
  scene.add_material({"tree", Foliage{}});
  scene.add_material({"rough_metal", PerfectConductor{}, 0.0, half});
  scene.set_scenery(mesh);
  return scene;
}

/// A wall in the plane x = 10, 20 m wide and 20 m high.
TriangleMesh one_wall(const std::string& material = "rough") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 10.0, 10.0, material);
  return mesh;
}

struct Question {
  Vec3 from_m, to_m, point_m;
  std::string material = "rough";
  int sheets = 2;
};

/// The path over a point of the facet that lies there; nothing where there is none.
std::optional<Path> scattered(TracedScene<>& world, const Question& question,
                              const std::array<std::optional<BodyId>, 2>& rides = {}) {
  const LinkEnd from = world.end(question.from_m, rides[0]), to = world.end(question.to_m, rides[1]);
  ScatterSolver<WideIndex> solver(world.tracer, question.sheets);
  const FacetId facet = world.facet_at(question.point_m, question.material);
  Path path;
  if (!solver.may_scatter(from, to, facet)) return std::nullopt;
  if (!solver.solve(from, to, facet, question.point_m, path)) return std::nullopt;
  return path;
}

std::optional<std::string> kinds_of(TracedScene<>& world, const Question& question) {
  const std::optional<Path> path = scattered(world, question);
  return path ? std::optional(kinds(*path)) : std::nullopt;
}

using Letters = std::optional<std::string>;

}  // namespace

TEST_CASE("scatter solver: a free wall scatters between any two points before it, and between any two behind it") {
  TracedScene<> world(rough_scene(one_wall()));
  const Vec3 point_m(10, 1.3, -2.1), from_m(0, 3, 1), to_m(4, -7, 2.5);
  const std::optional<Path> path = scattered(world, {from_m, to_m, point_m});
  REQUIRE(path);
  CHECK(kinds(*path) == "S");
  CHECK(path->interactions[0].point_m == point_m);
  CHECK(path->interactions[0].facet == world.facet_at(point_m, "rough"));
  CHECK(path->length_m == glm::distance(from_m, point_m) + glm::distance(point_m, to_m));
  CHECK(path->foliage.empty());
  CHECK(kinds_of(world, {Vec3(17, 3, 1), Vec3(11, -7, 2.5), point_m}) == Letters("S"));
  // From one side to the other, and with an end in the plane of the wall (beside it or on it): nothing.
  CHECK_FALSE(scattered(world, {from_m, Vec3(11, -7, 2.5), point_m}));
  CHECK_FALSE(scattered(world, {Vec3(17, 0, 0), to_m, point_m}));
  CHECK_FALSE(scattered(world, {Vec3(10, 14, 0), to_m, point_m}));
  CHECK_FALSE(scattered(world, {from_m, Vec3(10 - 1e-10, 0, 14), point_m}));
  CHECK(scattered(world, {from_m, Vec3(10 - 1e-8, 0, 14), point_m}));
}

TEST_CASE("scatter solver: only rough surfaces scatter") {
  for (const std::string material : {"metal", "opaque", "glass", "alpha"}) {
    TracedScene<> world(rough_scene(one_wall(material)));
    CHECK_FALSE(scattered(world, {Vec3(0, 3, 1), Vec3(4, -7, 2.5), Vec3(10, 1, 1), material}));
  }
  for (const std::string material : {"rough", "board", "rough_metal"}) {
    TracedScene<> world(rough_scene(one_wall(material)));
    CHECK(scattered(world, {Vec3(0, 3, 1), Vec3(4, -7, 2.5), Vec3(10, 1, 1), material}));
  }
}

TEST_CASE("scatter solver: a blocker in either leg takes the path, and one beside the legs does not") {
  const Vec3 from_m(0, -4, 0), to_m(0, 4, 0), point_m(10, 0, 0);
  struct Case {
    Vec3 centre_m;
    bool blocks;
  };
  for (const Case& one : {Case{Vec3(5, -2, 0), true},
                          {Vec3(5, 2, 0), true},
                          {Vec3(5, 0, 0), false},
                          {Vec3(-1, -4, 0), false},
                          {Vec3(11, 0, 0), false},
                          {Vec3(9.999, 0, 0), true}}) {
    CAPTURE(one.centre_m.x);
    CAPTURE(one.centre_m.y);
    TriangleMesh mesh = one_wall();
    add_sheet_across_x(mesh, one.centre_m.x, 0.25, "metal");
    for (std::size_t corner = mesh.vertices_m.size() - 4; corner < mesh.vertices_m.size(); ++corner) {
      mesh.vertices_m[corner] += Vec3(0, one.centre_m.y, one.centre_m.z);
    }
    TracedScene<> world(rough_scene(mesh));
    CHECK(scattered(world, {from_m, to_m, point_m}).has_value() == !one.blocks);
    CHECK(scattered(world, {to_m, from_m, point_m}).has_value() == !one.blocks);
  }
}

TEST_CASE("scatter solver: sheets are crossed, listed with their points in order, and counted over both legs") {
  TriangleMesh mesh = one_wall();
  add_sheet(mesh, Vec3(4, -5, 0), Vec3(0, 4.9, 0), Vec3(0, 0, 5), "glass");  // in the leg that comes
  add_sheet(mesh, Vec3(6, -5, 0), Vec3(0, 4.9, 0), Vec3(0, 0, 5), "alpha");
  add_sheet(mesh, Vec3(5, 5, 0), Vec3(0, 4.9, 0), Vec3(0, 0, 5), "board");  // in the one that goes, rough itself
  TracedScene<> world(rough_scene(mesh));
  const Vec3 from_m(0, -8, 1), to_m(0, 8, -1), point_m(10, 0, 0.3);
  const std::optional<Path> path = scattered(world, {from_m, to_m, point_m, "rough", 3});
  REQUIRE(path);
  CHECK(kinds(*path) == "TTST");
  const std::array materials{"glass", "alpha", "rough", "board"};
  const std::array planes_m{4.0, 6.0, 10.0, 5.0};
  for (std::size_t index = 0; index < 4; ++index) {
    const Interaction& at = path->interactions[index];
    CHECK(world.scene.material(world.scene.facet(at.facet).material).name == materials[index]);
    const Vec3& end_m = index < 2 ? from_m : to_m;
    const double share = (planes_m[index] - end_m.x) / (point_m.x - end_m.x);
    CHECK(glm::distance(at.point_m, end_m + share * (point_m - end_m)) < 1e-13);
  }
  CHECK(path->length_m ==
        doctest::Approx(glm::distance(from_m, point_m) + glm::distance(point_m, to_m)).epsilon(1e-15));
  CHECK(kinds_of(world, {to_m, from_m, point_m, "rough", 3}) == Letters("TSTT"));
  for (const int sheets : {0, 1, 2}) CHECK_FALSE(scattered(world, {from_m, to_m, point_m, "rough", sheets}));
  // Between the sheets.
  CHECK(kinds_of(world, {Vec3(5, -5, 0), Vec3(5.5, -5, 0), Vec3(10, -5, 0), "rough", 2}) == Letters("TST"));
  CHECK_FALSE(scattered(world, {Vec3(5, -5, 0), Vec3(5.5, -5, 0), Vec3(10, -5, 0), "rough", 1}));
  CHECK(kinds_of(world, {Vec3(0, 3, 0), Vec3(1, 6, 0), Vec3(5, 5, 0), "board", 0}) == Letters("S"));
}

TEST_CASE("scatter solver: a closed box of sheets scatters inside, and its far face through the near one") {
  TriangleMesh glass, metal;
  add_box_faces(glass, Vec3(2, -3, -3), Vec3(6, 3, 3), "board");
  add_box_faces(metal, Vec3(2, -3, -3), Vec3(6, 3, 3), "rough_metal");
  TracedScene<> clear(rough_scene(glass)), opaque(rough_scene(metal));
  const Vec3 from_m(-4, -1, 0), to_m(-5, 1, 0.5);
  CHECK(kinds_of(clear, {from_m, to_m, Vec3(2, 0.4, 0.2), "board"}) == Letters("S"));
  CHECK(kinds_of(clear, {from_m, to_m, Vec3(6, 0.4, 0.2), "board"}) == Letters("TST"));
  CHECK(kinds_of(opaque, {from_m, to_m, Vec3(2, 0.4, 0.2), "rough_metal"}) == Letters("S"));
  CHECK_FALSE(scattered(opaque, {from_m, to_m, Vec3(6, 0.4, 0.2), "rough_metal"}));
  for (const Vec3& point_m : {Vec3(2, 0.4, 0.2), Vec3(6, 0.4, 0.2), Vec3(3, 3, 0.1), Vec3(3, -3, 0.1), Vec3(4, 1, 3)}) {
    CHECK(kinds_of(opaque, {Vec3(3, 0, 0), Vec3(5, 1, -1), point_m, "rough_metal", 0}) == Letters("S"));
    CHECK_FALSE(scattered(opaque, {Vec3(3, 0, 0), to_m, point_m, "rough_metal"}));
  }
}

TEST_CASE("scatter solver: next to a corner of the room the wall that stands there neither blocks nor stands in") {
  TriangleMesh room;
  add_box_faces(room, Vec3(0), Vec3(6, 5, 3), "rough");
  TracedScene<> world(rough_scene(room));
  const Vec3 from_m(1, 1, 1), to_m(5, 4, 2);
  for (const double near_m : {1e-2, 1e-3, 2e-4, 1e-5}) {
    CAPTURE(near_m);
    for (const Vec3& point_m : {Vec3(near_m, 2.0, 0), Vec3(6 - near_m, near_m, 0), Vec3(near_m, near_m, 3)}) {
      const FacetId facet = world.facet_at(point_m, "rough");
      // Of the facets at a corner that within 1e-6 m is the floor's or the ceiling's.
      CHECK(std::abs(world.scene.facet(facet).plane.normal.z) > 0.9);
      CHECK(kinds_of(world, {from_m, to_m, point_m, "rough", 0}) == Letters("S"));
    }
  }
}

TEST_CASE("scatter solver: a device mounted on a wall hears nothing of that wall, and all of the others") {
  TriangleMesh room;
  add_box_faces(room, Vec3(0), Vec3(6, 5, 3), "rough");
  TracedScene<> world(rough_scene(room));
  for (const double off_m : {0.0, 5e-5, -5e-5}) {
    CAPTURE(off_m);
    const Vec3 mounted_m(off_m, 2, 1.5), other_m(4, 3, 1);
    CHECK_FALSE(scattered(world, {mounted_m, other_m, Vec3(0, 4, 2)}));
    CHECK_FALSE(scattered(world, {other_m, mounted_m, Vec3(0, 4, 2)}));
    CHECK_FALSE(scattered(world, {mounted_m, mounted_m + Vec3(0, 1, 0), Vec3(0, 4, 2)}));
    CHECK(kinds_of(world, {mounted_m, other_m, Vec3(6, 2, 1)}) == Letters("S"));
    CHECK(kinds_of(world, {other_m, mounted_m, Vec3(3, 2, 3)}) == Letters("S"));
    CHECK(kinds_of(world, {mounted_m, mounted_m + Vec3(0, 1, 0), Vec3(3, 0, 1)}) == Letters("S"));
  }
  // A finger's breadth off it is a wall like any other.
  CHECK(kinds_of(world, {Vec3(2e-4, 2, 1.5), Vec3(4, 3, 1), Vec3(0, 4, 2)}) == Letters("S"));
}

TEST_CASE("scatter solver: the object that a device rides on does not exist for its links, for others it does") {
  Scene scene = rough_scene(one_wall());
  TriangleMesh car;
  add_box_faces(car, Vec3(-2, -1, 0), Vec3(2, 1, 1.5), "rough_metal");
  const BodyId own = scene.add_object("own", car, LinearMotion{{Vec3(0, 0, -1)}});
  const BodyId other = scene.add_object("other", car, LinearMotion{{Vec3(5, -4, -1)}});
  TracedScene<> world(std::move(scene));
  const Vec3 inside_m(0, 0, 0), away_m(0, -8, 3), on_wall_m(10, 2, 3), on_own_roof_m(1, 0.2, 0.5);
  const Question over_wall{inside_m, away_m, on_wall_m},
      over_roof{Vec3(0, 0, 1.5), away_m, on_own_roof_m, "rough_metal"};
  // The body of the car around the device blocks its legs, unless it is its own.
  CHECK_FALSE(scattered(world, over_wall));
  CHECK(scattered(world, over_wall, {own, std::nullopt}));
  CHECK(scattered(world, {away_m, inside_m, on_wall_m}, {std::nullopt, own}));
  CHECK_FALSE(scattered(world, over_wall, {other, std::nullopt}));
  // Its roof scatters for everybody but the device itself, at whichever end it is.
  CHECK(scattered(world, over_roof));
  CHECK(scattered(world, over_roof, {other, std::nullopt}));
  CHECK_FALSE(scattered(world, over_roof, {own, std::nullopt}));
  CHECK_FALSE(scattered(world, over_roof, {std::nullopt, own}));
  // Between two devices that ride on two cars neither car exists.
  const Vec3 on_other_m(5, -4, 0.2), over_other_m(4, -4.5, 0.5);
  CHECK(scattered(world, {inside_m, on_other_m, on_wall_m}, {own, other}));
  CHECK_FALSE(scattered(world, {inside_m, on_other_m, on_wall_m}, {own, std::nullopt}));
  CHECK_FALSE(scattered(world, {Vec3(0, 0, 2), Vec3(5, -4, 2), over_other_m, "rough_metal"}, {own, other}));
  CHECK(scattered(world, {Vec3(0, 0, 2), Vec3(5, -4, 2), over_other_m, "rough_metal"}, {own, std::nullopt}));
}

TEST_CASE("scatter solver: patches that overlap in one plane scatter once, the one whose material's name comes first") {
  struct Patch {
    std::string material;
    double left_m, right_m, depth_m;
  };
  const auto scatterers = [](const std::vector<Patch>& patches, double y_m) {
    TriangleMesh mesh;
    for (const Patch& patch : patches) {
      add_sheet(mesh, Vec3(10 + patch.depth_m, 0.5 * (patch.left_m + patch.right_m), 0),
                Vec3(0, 0.5 * (patch.right_m - patch.left_m), 0), Vec3(0, 0, 4), patch.material);
    }
    TracedScene<> world(rough_scene(mesh));
    const LinkEnd from = world.end(Vec3(0, 1, 1)), to = world.end(Vec3(2, -3, 2));
    ScatterSolver<WideIndex> solver(world.tracer, 2);
    std::multiset<std::string> found;
    Path path;
    for (std::uint32_t id = 0; id < world.scene.facets().size(); ++id) {
      const FacetId facet(id);
      const double depth_m = -signed_distance_m(world.scene.facet(facet).plane, Vec3(10, y_m, 0.7));
      const Vec3 point_m = Vec3(10, y_m, 0.7) + depth_m * world.scene.facet(facet).plane.normal;
      const auto near = world.tracer.facets_near(point_m, 1e-6, {}, world.counters);
      if (std::find(near.begin(), near.end(), facet) == near.end() || !solver.may_scatter(from, to, facet)) continue;
      if (solver.solve(from, to, facet, point_m, path)) {
        found.insert(world.scene.material(world.scene.facet(facet).material).name + " ");
      }
    }
    std::string names;
    for (const std::string& name : found) names += name;
    return names;
  };
  // Two rough ones, overlapping from −1 to 1; `board` comes before `rough`.
  for (const double depth_m : {0.0, 5e-5, -5e-5}) {
    CAPTURE(depth_m);
    const std::vector<Patch> two{{"rough", -4, 1, 0.0}, {"board", -1, 4, depth_m}};
    CHECK(scatterers(two, -2.5) == "rough ");
    CHECK(scatterers(two, 0.2) == "board ");
    CHECK(scatterers(two, 2.5) == "board ");
    const std::vector<Patch> turned{two[1], two[0]};
    CHECK(scatterers(turned, 0.2) == "board ");
  }
  // The same material twice.
  const std::vector<Patch> same{{"rough", -4, 1, 0.0}, {"rough", -1, 4, 0.0}};
  CHECK(scatterers(same, -2.5) == "rough ");
  CHECK(scatterers(same, 0.2) == "rough ");
  // A smooth one that comes first hides the rough one, as it does for reflections; one that comes later does not.
  CHECK(scatterers({{"rough", -4, 4, 0.0}, {"glass", -1, 1, 0.0}}, 0.2) == "");
  CHECK(scatterers({{"board", -4, 4, 0.0}, {"glass", -1, 1, 0.0}}, 0.2) == "board ");
  CHECK(scatterers({{"rough", -4, 4, 0.0}, {"glass", -1, 1, 0.0}}, 2.2) == "rough ");
  // A patch a finger's breadth in front is a wall of its own, and what is behind it pays for it, or is hidden.
  CHECK(scatterers({{"rough", -4, 4, 0.0}, {"board", -1, 1, -0.02}}, 0.2) == "board rough ");
  CHECK(scatterers({{"board", -4, 4, 0.0}, {"rough", -1, 1, -0.02}}, 0.2) == "rough ");
}

TEST_CASE("scatter solver: both legs add up what they run through foliage") {
  TriangleMesh mesh = one_wall();
  add_box_faces(mesh, Vec3(3, -9, -2), Vec3(5, -1, 4), "hedge");
  add_box_faces(mesh, Vec3(6, 1, -2), Vec3(7, 9, 4), "hedge");
  add_box_faces(mesh, Vec3(2, 1, -2), Vec3(2.5, 9, 4), "tree");
  TracedScene<> world(rough_scene(mesh));
  const Vec3 from_m(0, -6, 1), to_m(0, 8, 0), point_m(10, 0, 0.5);
  const std::optional<Path> path = scattered(world, {from_m, to_m, point_m, "rough", 0});
  REQUIRE(path);
  CHECK(kinds(*path) == "S");  // foliage is no sheet
  const double first_m = glm::distance(from_m, point_m), second_m = glm::distance(point_m, to_m);
  CHECK(path->length_m == doctest::Approx(first_m + second_m).epsilon(1e-15));
  // By similar triangles: 2 m of the 10 m along x in the first leg; 1 m of hedge and 0.5 m of tree in the second.
  std::map<std::string, double> lengths_m;
  for (const FoliageLength& part : path->foliage) lengths_m[world.scene.material(part.material).name] += part.length_m;
  CHECK(path->foliage.size() == 2);
  CHECK(lengths_m["hedge"] == doctest::Approx(0.2 * first_m + 0.1 * second_m).epsilon(1e-12));
  CHECK(lengths_m["tree"] == doctest::Approx(0.05 * second_m).epsilon(1e-12));
  // An end within it counts from there; what was found before is forgotten.
  ScatterSolver<WideIndex> solver(world.tracer, 0);
  Path reused = *path;
  REQUIRE(solver.solve(world.end(Vec3(4, -6, 1)), world.end(Vec3(8, 5, 1)), world.facet_at(point_m, "rough"), point_m,
                       reused));
  REQUIRE(reused.foliage.size() == 1);
  CHECK(reused.foliage[0].length_m == doctest::Approx(glm::distance(Vec3(4, -6, 1), point_m) / 6.0).epsilon(1e-12));
  CHECK(reused.interactions.size() == 1);
}

TEST_CASE("scatter solver: an absent object neither scatters nor blocks") {
  Scene scene = rough_scene(one_wall());
  TriangleMesh screen;
  add_sheet_across_x(screen, 0.0, 3.0, "rough");
  scene.add_body_pool(1, screen);
  TracedScene<> world(std::move(scene));
  const Vec3 from_m(0, -4, 0), to_m(0, 4, 0), point_m(10, 0, 0);
  CHECK(scattered(world, {from_m, to_m, point_m}));
  const LinkEnd from = world.end(from_m), to = world.end(to_m);
  ScatterSolver<WideIndex> solver(world.tracer, 2);
  std::size_t scattering = 0;
  for (std::uint32_t id = 0; id < world.scene.facets().size(); ++id)
    scattering += solver.may_scatter(from, to, FacetId(id));
  CHECK(scattering == 1);
}

// Random scenes -------------------------------------------------------------------------------------------------------

namespace {

/// Moeller and Trumbore 1997: where the segment meets the triangle, and how far inside it (barycentric, least of the
/// three); nothing where it passes by.
struct Meeting {
  double t, margin;
};

std::optional<Meeting> meeting(const Vec3& from_m, const Vec3& to_m, const std::array<Vec3, 3>& corners) {
  const Vec3 along = to_m - from_m, one = corners[1] - corners[0], two = corners[2] - corners[0];
  const Vec3 p = glm::cross(along, two);
  const double determinant = glm::dot(one, p);
  if (std::abs(determinant) < 1e-12) return std::nullopt;
  const Vec3 s = from_m - corners[0], q = glm::cross(s, one);
  const double u = glm::dot(s, p) / determinant, v = glm::dot(along, q) / determinant;
  const double margin = std::min({u, v, 1.0 - u - v});
  if (margin < -1e-6) return std::nullopt;
  return Meeting{glm::dot(two, q) / determinant, margin};
}

/// What a leg of its own meets: sheets in order; `doubtful` where rounding could decide.
struct Leg {
  bool blocked = false, doubtful = false;
  std::vector<std::pair<double, std::uint32_t>> sheets;
};

Leg follow(const Scene& scene, const Vec3& from_m, const Vec3& to_m, std::uint32_t own_triangle) {
  Leg leg;
  for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
    if (triangle == own_triangle) continue;
    const std::optional<Meeting> at = meeting(from_m, to_m, scene.corners_m(triangle));
    if (!at || at->t < -1e-6 || at->t > 1.0 + 1e-6) continue;
    if (at->margin < 1e-6 || at->t < 1e-3 || at->t > 1.0 - 1e-3) leg.doubtful = true;
    if (at->t < 0.0 || at->t > 1.0) continue;
    if (!scene.facet(scene.facet_of_triangle(triangle)).transmits) leg.blocked = true;
    leg.sheets.emplace_back(at->t, triangle);
  }
  std::sort(leg.sheets.begin(), leg.sheets.end());
  return leg;
}

}  // namespace

TEST_CASE("scatter solver: in random scenes of sheets it sees what a loop over all triangles sees") {
  std::size_t free = 0, blocked = 0, through = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TriangleMesh mesh;
    const std::vector<std::string> names{"rough", "board", "glass", "opaque", "board", "rough_metal"};
    for (int sheet = 0; sheet < 14; ++sheet) {
      const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
      add_sheet(mesh, draw.inside(Vec3(-8), Vec3(8)), draw.between(0.5, 4) * u, draw.between(0.5, 3) * v,
                names[draw.below(names.size())]);
    }
    TracedScene<> world(rough_scene(mesh));
    for (int trial = 0; trial < 400; ++trial) {
      const Vec3 from_m = draw.inside(Vec3(-9), Vec3(9)), to_m = draw.inside(Vec3(-9), Vec3(9));
      const auto triangle = static_cast<std::uint32_t>(draw.below(world.scene.triangles().size()));
      const auto corners = world.scene.corners_m(triangle);
      const double a = draw.between(0.05, 0.9), b = draw.between(0.05, 0.95 - a);
      const Vec3 point_m = corners[0] + a * (corners[1] - corners[0]) + b * (corners[2] - corners[0]);
      const FacetId facet = world.scene.facet_of_triangle(triangle);
      const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
      const double side = glm::dot(from_m - corners[0], normal) * glm::dot(to_m - corners[0], normal);
      const Leg first = follow(world.scene, from_m, point_m, triangle),
                second = follow(world.scene, point_m, to_m, triangle);
      if (first.doubtful || second.doubtful || std::abs(side) < 1e-6) continue;
      const std::size_t sheets = first.sheets.size() + second.sheets.size();
      const bool rough = world.scene.material(world.scene.facet(facet).material).scattering.coefficient > 0.0;
      const bool expected = rough && side > 0.0 && !first.blocked && !second.blocked && sheets <= 2;
      const LinkEnd from = world.end(from_m), to = world.end(to_m);
      ScatterSolver<WideIndex> solver(world.tracer, 2);
      Path path;
      const bool found = solver.may_scatter(from, to, facet) && solver.solve(from, to, facet, point_m, path);
      CHECK(found == expected);
      (expected ? free : blocked) += rough && side > 0.0;
      if (!found || !expected) continue;
      CHECK(kinds(path) == std::string(first.sheets.size(), 'T') + "S" + std::string(second.sheets.size(), 'T'));
      through += sheets > 0;
      std::vector<std::uint32_t> order;
      for (const auto& [t, met] : first.sheets) order.push_back(world.scene.facet_of_triangle(met).value);
      order.push_back(facet.value);
      for (const auto& [t, met] : second.sheets) order.push_back(world.scene.facet_of_triangle(met).value);
      REQUIRE(path.interactions.size() == order.size());
      for (std::size_t index = 0; index < order.size(); ++index)
        CHECK(path.interactions[index].facet.value == order[index]);
    }
  }
  MESSAGE(free << " free, " << through << " of them through sheets, " << blocked << " blocked");
  CHECK(free > 200);
  CHECK(blocked > 200);
  CHECK(through > 60);
}

}  // namespace test_scatter_solver
