/// The parts of a surface that an end of a link sees: areas in closed form, what parts are, and who hides nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/paths/visible/visible_trial.hpp"

namespace test_visible_parts {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Corners no farther than 1e-7 m from a side count as on it; sides here are up to 10 m long and there are up to
/// twelve.
constexpr double rounding_m2 = 12 * 10 * 1e-7;

constexpr double wall_x_m = 10.0, wall_half_m = 5.0, wall_m2 = 4.0 * wall_half_m * wall_half_m;

TriangleMesh wall() {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, wall_x_m, wall_half_m, "rough");
  return mesh;
}

/// A rectangle across the x axis.
struct Screen {
  double x_m, low_y_m, high_y_m, low_z_m, high_z_m;
  void add_to(TriangleMesh& mesh, const std::string& material = "metal") const {
    add_quad(mesh,
             {Vec3(x_m, low_y_m, low_z_m), Vec3(x_m, high_y_m, low_z_m), Vec3(x_m, high_y_m, high_z_m),
              Vec3(x_m, low_y_m, high_z_m)},
             material);
  }
};

std::vector<std::uint32_t> triangles_of(const Scene& scene, const std::string& material) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
    if (scene.material(scene.facet(scene.facet_of_triangle(triangle)).material).name == material)
      found.push_back(triangle);
  }
  return found;
}

/// What an end sees of the facets of a material, over all their triangles.
double seen_m2(TracedScene<>& world, const LinkEnd& end, const std::string& material = "rough",
               int max_transmissions = 0) {
  const FacetOutlines outlines(world.scene);
  Sight sight(256);
  const SurfaceView view = look_at_surfaces(sight, world.scene, outlines, end, max_transmissions);
  PartFinder<WideIndex> finder(world.tracer, max_transmissions);
  double sum_m2 = 0.0;
  for (const std::uint32_t triangle : triangles_of(world.scene, material)) {
    const FacetId id = world.scene.facet_of_triangle(triangle);
    if (!std::ranges::binary_search(view.facets, id)) continue;
    const TriangleCorners corners_m = world.scene.corners_m(triangle);
    finder.turn_to(id, corners_m);
    PartList parts;
    parts.add(corners_m, {});
    REQUIRE(finder.leave_visible(view.shades, ScatterLeg::from_transmitter, std::nullopt, parts, [](BodyId) {}));
    sum_m2 += area_of_m2(parts);
  }
  return sum_m2;
}

double seen_m2(const TriangleMesh& mesh, const Vec3& from_m) {
  TracedScene<> world(rough_scene_of(mesh));
  return seen_m2(world, world.end(from_m));
}

double seen_behind_m2(const std::vector<Screen>& screens, const Vec3& from_m) {
  TriangleMesh mesh = wall();
  for (const Screen& screen : screens) screen.add_to(mesh);
  return seen_m2(mesh, from_m);
}

/// What both ends see of the triangles of a material, halved where there are too many parts.
double link_m2(TracedScene<>& world, const LinkEnd& from, const LinkEnd& to, int max_transmissions = 0,
               const std::string& material = "rough") {
  LinkView view(world, from, to, max_transmissions);
  double sum_m2 = 0.0;
  for (const std::uint32_t triangle : triangles_of(world.scene, material)) {
    for (const SeenPiece& piece : view.pieces_of(triangle)) sum_m2 += area_of_m2(piece.parts);
  }
  return sum_m2;
}

doctest::Approx about_m2(double area_m2) {
  return doctest::Approx(area_m2).scale(1.0).epsilon(rounding_m2 / (1.0 + area_m2));
}

}  // namespace

TEST_CASE("visible parts: a square before a wall hides its own likeness, larger by the ratio of the distances") {
  const Vec3 from_m(0.0);
  CHECK(seen_behind_m2({}, from_m) == about_m2(wall_m2));
  for (const double x_m : {1.0, 4.0, 9.0, 9.99}) {
    CAPTURE(x_m);
    for (const double half_m : {1e-3, 0.1, 0.3}) {
      const double hidden_m2 = std::pow(2.0 * half_m * wall_x_m / x_m, 2.0);
      CHECK(seen_behind_m2({{x_m, -half_m, half_m, -half_m, half_m}}, from_m) == about_m2(wall_m2 - hidden_m2));
    }
  }
  // From elsewhere, and only half on the wall: y from 0.4 + 2.5 (1.7 − 0.4) = 3.65 to its rim, z as high as 2.5 · 2.
  CHECK(seen_behind_m2({{4.0, 1.7, 9.0, -1.0, 1.0}}, Vec3(0, 0.4, 0)) == about_m2(wall_m2 - 1.35 * 5.0));
  // From behind the wall the same is true of what stands there.
  CHECK(seen_behind_m2({{16.0, -1.0, 1.0, -1.0, 1.0}}, Vec3(20, 0, 0)) == about_m2(wall_m2 - 25.0));
}

TEST_CASE("visible parts: what is narrower than the weld tolerance hides nothing") {
  CHECK(seen_behind_m2({{4.0, -1e-5, 1e-5, -1.0, 1.0}}, Vec3(0.0)) == wall_m2);
  CHECK(seen_behind_m2({{4.0, -1e-3, 1e-3, -1.0, 1.0}}, Vec3(0.0)) == about_m2(wall_m2 - 5e-3 * 5.0));
}

TEST_CASE("visible parts: blockers that overlap hide what they cover together") {
  const Vec3 from_m(0, 0, 0);
  // At twice the size on the wall: 4 × 4 and 4 × 4 with 2 × 2 in common.
  const std::vector<Screen> two{{5.0, -1.5, 0.5, -1.5, 0.5}, {5.0, -0.5, 1.5, -0.5, 1.5}};
  CHECK(seen_behind_m2(two, from_m) == about_m2(wall_m2 - 16.0 - 16.0 + 4.0));
  // One behind the other, in either order.
  CHECK(seen_behind_m2({{5.0, -1.5, 0.5, -1.5, 0.5}, {2.5, -0.25, 0.75, -0.25, 0.75}}, from_m) ==
        about_m2(wall_m2 - 28.0));
  CHECK(seen_behind_m2({{2.5, -0.75, 0.25, -0.75, 0.25}, {5.0, -0.5, 1.5, -0.5, 1.5}}, from_m) ==
        about_m2(wall_m2 - 28.0));
  // One wholly behind the other.
  CHECK(seen_behind_m2({{2.0, -0.5, 0.5, -0.5, 0.5}, {5.0, -1.0, 1.0, -1.0, 1.0}}, from_m) == about_m2(wall_m2 - 25.0));
  // Side by side, with an edge in common, and with one that is not quite there.
  CHECK(seen_behind_m2({{5.0, -1.0, 0.0, -1.0, 1.0}, {5.0, 0.0, 1.0, -1.0, 1.0}}, from_m) == about_m2(wall_m2 - 16.0));
  CHECK(seen_behind_m2({{5.0, -1.0, 0.0, -1.0, 1.0}, {4.0, 0.0, 0.8, -0.8, 0.8}}, from_m) == about_m2(wall_m2 - 16.0));
}

TEST_CASE("visible parts: nothing is left behind a blocker that hides all") {
  CHECK(seen_behind_m2({{5.0, -3, 3, -3, 3}}, Vec3(0.0)) == 0.0);
  CHECK(seen_behind_m2({{5.0, -2.5, 2.5, -2.5, 2.5}}, Vec3(0.0)) == 0.0);  // just so
  CHECK(seen_behind_m2({{5.0, -3, 0, -3, 3}, {4.0, 0, 3, -3, 3}}, Vec3(0.0)) == 0.0);
}

TEST_CASE("visible parts: what is behind the wall, behind the end or beside hides nothing") {
  const std::vector<Screen> none{{11.0, -2, 2, -2, 2}, {-1.0, -2, 2, -2, 2}, {5.0, 3, 4, -1, 1}, {5.0, -1, 1, 2.5, 4}};
  CHECK(seen_behind_m2(none, Vec3(0.0)) == wall_m2);
  for (const Screen& screen : none) CHECK(seen_behind_m2({screen}, Vec3(0.0)) == wall_m2);
}

TEST_CASE("visible parts: a blocker on the wall's foot hides the wall from its foot on") {
  constexpr double height_m = 3.0;
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(10, -6, 0), Vec3(10, 6, 0), Vec3(10, 6, 8), Vec3(10, -6, 8)}, "rough");
  const Vec3 from_m(0, 0, height_m);
  const double free_m2 = 12.0 * 8.0;
  CHECK(seen_m2(mesh, from_m) == about_m2(free_m2));
  // Across the wall: a plate at y = 1 from x = 8 to the wall, 2 m high. It hides y from 1 to 10/8, and z up to
  // 3 + (2 − 3) y.
  TriangleMesh across = mesh;
  add_quad(across, {Vec3(8, 1, 0), Vec3(10, 1, 0), Vec3(10, 1, 2), Vec3(8, 1, 2)}, "metal");
  CHECK(seen_m2(across, from_m) == about_m2(free_m2 - (3.0 * 0.25 - 0.5 * (1.25 * 1.25 - 1.0))));
  // The same plate goes on behind the wall, and into the ground.
  TriangleMesh beyond = mesh;
  add_quad(beyond, {Vec3(8, 1, -4), Vec3(17, 1, -4), Vec3(17, 1, 2), Vec3(8, 1, 2)}, "metal");
  CHECK(seen_m2(beyond, from_m) == about_m2(free_m2 - (3.0 * 0.25 - 0.5 * (1.25 * 1.25 - 1.0))));
  // Parallel to the wall on a ground that reaches to the wall and beyond.
  TriangleMesh along = mesh;
  add_sheet(along, Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  CHECK(seen_m2(along, from_m) == about_m2(free_m2));
  Screen{8.0, -1, 1, 0, 2}.add_to(along);
  CHECK(seen_m2(along, from_m) == about_m2(free_m2 - 2.5 * (3.0 - 1.25)));
  // A blocker in the corner: it leans on the wall at 45°, up to z = 2 at the wall. Its top edge is on the wall.
  TriangleMesh leaning = mesh;
  add_quad(leaning, {Vec3(8, -1, 0), Vec3(8, 1, 0), Vec3(10, 1, 2), Vec3(10, -1, 2)}, "metal");
  // Seen on the wall it is 2 m wide at z = 2 and 2.5 m at z = −0.75.
  const double at_foot_m = 2.5 - 0.5 * 0.75 / 2.75;
  CHECK(seen_m2(leaning, from_m) == about_m2(free_m2 - 0.5 * (2.0 + at_foot_m) * 2.0));
}

TEST_CASE("visible parts: an end in the plane of a blocker sees past it, and almost in its plane almost all") {
  const auto seen = [](double off_m) {
    TriangleMesh mesh = wall();
    add_quad(mesh, {Vec3(2, -1, 0), Vec3(8, -1, 0), Vec3(8, 1, 0), Vec3(2, 1, 0)}, "metal");
    return seen_m2(mesh, Vec3(0, 0, off_m));
  };
  CHECK(seen(0.0) == wall_m2);
  CHECK(seen(5e-10) == wall_m2);
  CHECK(seen(1e-8) == wall_m2);
  // From a height of h over it: the near edge is seen at −4 h, the far one at −h/4, 10 and 2.5 m wide.
  for (const double h_m : {1e-3, 0.1, -0.1, 0.5}) {
    CAPTURE(h_m);
    const double hidden_m2 = 3.75 * std::abs(h_m) * 0.5 * (10.0 + 2.5);
    CHECK(seen(h_m) == about_m2(wall_m2 - hidden_m2));
  }
}

TEST_CASE("visible parts: a wall that is seen edge on does not scatter, and one almost so is seen right") {
  TriangleMesh mesh = wall();
  add_quad(mesh, {Vec3(9.6, 6, -1), Vec3(10, 6, -1), Vec3(10, 6, 1), Vec3(9.6, 6, 1)}, "metal");
  TracedScene<> world(rough_scene_of(mesh));
  const LinkEnd other = world.end(Vec3(0, 0, 0));
  const FacetId facet = world.facet_at(Vec3(10, 0.1, 0.2), "rough");
  for (const double off_m : {0.0, 1e-10, -1e-10}) {
    const LinkEnd along = world.end(Vec3(wall_x_m - off_m, 20, 0));
    CHECK_FALSE(may_scatter(world.scene, along, other, facet));
    CHECK_FALSE(may_scatter(world.scene, other, along, facet));
    CHECK(link_m2(world, along, other) == 0.0);
  }
  CHECK(link_m2(world, world.end(Vec3(wall_x_m + 1e-3, 20, 0)), other) == 0.0);
  TracedScene<> bare(rough_scene_of(wall()));
  for (const double off_m : {1e-8, 1e-6, 1e-4, 1e-2, 0.3}) {
    CAPTURE(off_m);
    CHECK(link_m2(bare, bare.end(Vec3(wall_x_m - off_m, 20, 0)), bare.end(Vec3(0.0))) == about_m2(wall_m2));
    // From less than 1e-7 m off the plane all of the wall counts as on the side of what stands on the plane.
    if (off_m > 1e-7) CHECK(link_m2(world, world.end(Vec3(wall_x_m - off_m, 20, 0)), other) < wall_m2 - 20.0);
  }
  // A plate that stands on the plane beside the wall, 14 m away and 0.4 m deep, hides from 0.7 m off the plane all y up
  // to 20 − 14 · 0.7/0.3, which is beyond the wall, where |z| < (20 − y)/14.
  CHECK(link_m2(world, world.end(Vec3(wall_x_m - 0.7, 20, 0)), other) ==
        about_m2(wall_m2 - 2.0 * (20.0 * 10.0) / 14.0));
}

TEST_CASE("visible parts: of both ends only what both see is left") {
  TriangleMesh mesh = wall();
  Screen{5.0, -1, 1, -1, 1}.add_to(mesh);
  TracedScene<> world(rough_scene_of(mesh));
  const Vec3 from_m(0, -1, 0), to_m(0, 1, 0);
  // Each shadow is a square of 4 m, with its middle at y = ±1: 2 × 4 are in both.
  CHECK(link_m2(world, world.end(from_m), world.end(to_m)) == about_m2(wall_m2 - 16.0 - 16.0 + 8.0));
  CHECK(link_m2(world, world.end(from_m), world.end(from_m)) == about_m2(wall_m2 - 16.0));
  CHECK(link_m2(world, world.end(from_m), world.end(Vec3(12, 0, 0))) == 0.0);
}

TEST_CASE("visible parts: sheets are counted over both legs") {
  TriangleMesh mesh = wall();
  Screen{5.0, -1, 1, -1, 1}.add_to(mesh, "glass");
  Screen{8.0, -8, 8, -0.8, 0.8}.add_to(mesh, "alpha");
  TracedScene<> world(rough_scene_of(mesh));
  const LinkEnd from = world.end(Vec3(0, -1, 0)), to = world.end(Vec3(0, 1, 0));
  // Squares of 4 m at y = ±1 through `glass`, a band of 2 m all along through `alpha`, on both legs.
  // Legs through glass outside of the band: 8 and 8 less the 2 · 2 m that are in both, twice 1 m above and below.
  const double band_m2 = 20.0, both_m2 = 4.0, one_m2 = 8.0;
  const std::array seen_m2{wall_m2 - band_m2 - both_m2 - one_m2,  // 0: nothing of any
                           wall_m2 - band_m2 - both_m2,           // 1: one leg through the glass
                           wall_m2 - 2.0 * (2.0 + 4.0),           // 2: two, of either kind
                           wall_m2 - 2.0 * 2.0,                   // 3
                           wall_m2};
  for (int sheets = 0; sheets <= 4; ++sheets) {
    CAPTURE(sheets);
    CHECK(link_m2(world, from, to, sheets) == about_m2(seen_m2[static_cast<std::size_t>(sheets)]));
  }
}

TEST_CASE("visible parts: a facet that an end is mounted on hides nothing and does not scatter") {
  TriangleMesh mesh = wall();
  Screen{5.0, -1, 1, -1, 1}.add_to(mesh);
  TracedScene<> world(rough_scene_of(mesh));
  const LinkEnd other = world.end(Vec3(7, 0, 0));
  for (const double off_m : {0.0, 5e-5, -5e-5}) {
    CAPTURE(off_m);
    const LinkEnd end = world.end(Vec3(5 + off_m, 0.2, 0.1));
    REQUIRE(end.mounted_on.size() == 1);
    CHECK(link_m2(world, end, other) == about_m2(wall_m2));
    CHECK(link_m2(world, other, end) == about_m2(wall_m2));
    CHECK(link_m2(world, world.end(Vec3(wall_x_m - off_m, 0, 0)), other) == 0.0);
  }
  // A finger's breadth before it, it hides all of the wall.
  CHECK(link_m2(world, world.end(Vec3(4.98, 0.2, 0.1)), other) == 0.0);
  // For the other end it is a wall like any other.
  CHECK(link_m2(world, world.end(Vec3(5.0, 0.2, 0.1)), world.end(Vec3(0.0))) == about_m2(wall_m2 - 16.0));
}

TEST_CASE("visible parts: what a device rides on does not exist for its links, and what is absent for nobody") {
  Scene scene = rough_scene_of(wall());
  TriangleMesh plate, behind;
  Screen{0.0, -1, 1, -1, 1}.add_to(plate, "slab");
  const BodyId near = scene.add_object("near", plate, LinearMotion{{Vec3(5, 0, 0)}});
  const BodyId far = scene.add_object("far", plate, LinearMotion{{Vec3(8, 0, 0)}});
  scene.add_body_pool(1, plate);
  TracedScene<> world(std::move(scene));
  const Vec3 from_m(0, 0, 0), to_m(0, 0.5, 0);
  const auto link = [&](std::optional<BodyId> first, std::optional<BodyId> second) {
    return link_m2(world, world.end(from_m, first), world.end(to_m, second));
  };
  // Squares of 4 and of 2.5 m, at y = 0, and for the other end at −0.5 and −0.125 m.
  CHECK(link({}, {}) == about_m2(wall_m2 - 4.5 * 4.0));
  for (const auto& [first, second] : {std::pair(std::optional(near), std::optional<BodyId>()),
                                      std::pair(std::optional<BodyId>(), std::optional(near))}) {
    // Behind what is not there the other one is, wholly hidden as it was before.
    CHECK(link(first, second) == about_m2(wall_m2 - 2.625 * 2.5));
  }
  CHECK(link(far, {}) == about_m2(wall_m2 - 4.5 * 4.0));
  CHECK(link({}, far) == about_m2(wall_m2 - 4.5 * 4.0));
  CHECK(link(near, far) == wall_m2);
  CHECK(link(far, near) == wall_m2);
  // The plates scatter for those who do not ride on them.
  const auto scattered = [&](std::optional<BodyId> first) {
    return link_m2(world, world.end(from_m, first), world.end(to_m), 0, "slab");
  };
  // All of the near plate; of the far one what is not in a shadow of 3.2 by 3.2 m.
  CHECK(scattered({}) == about_m2(4.0));
  CHECK(scattered(near) == about_m2(4.0));
  CHECK(scattered(far) == about_m2(4.0));
}

namespace {

/// What two convex polygons in one plane have in common, m²: Sutherland and Hodgman 1974.
double common_m2(std::span<const Vec3> one, std::span<const Vec3> other, const Vec3& normal) {
  std::vector<Vec3> left(one.begin(), one.end());
  double turn = 0.0;
  for (std::size_t index = 1; index + 1 < other.size(); ++index) {
    turn += glm::dot(normal, glm::cross(other[index] - other[0], other[index + 1] - other[0]));
  }
  for (std::size_t index = 0; index < other.size() && left.size() > 2; ++index) {
    const Vec3 &here_m = other[index], &next_m = other[(index + 1) % other.size()];
    const Vec3 inwards = (turn > 0.0 ? 1.0 : -1.0) * glm::normalize(glm::cross(normal, next_m - here_m));
    std::vector<Vec3> kept;
    for (std::size_t corner = 0; corner < left.size(); ++corner) {
      const Vec3 &a = left[corner], &b = left[(corner + 1) % left.size()];
      const double at_a = glm::dot(inwards, a - here_m), at_b = glm::dot(inwards, b - here_m);
      if (at_a >= 0.0) kept.push_back(a);
      if ((at_a < 0.0) != (at_b < 0.0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    left = std::move(kept);
  }
  return left.size() > 2 ? 0.5 * twice_area_m2(left) : 0.0;
}

/// A wall behind boxes, plates and a board.
TriangleMesh cluttered_wall(Draw& draw) {
  TriangleMesh mesh = wall();
  for (int box = 0; box < 2; ++box) {
    const Vec3 low_m = draw.inside(Vec3(3, -4, -4), Vec3(8, 3, 3));
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(0.2), Vec3(1.5)), "metal");
  }
  for (int plate = 0; plate < 3; ++plate) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(3, -4, -4), Vec3(9, 4, 4)), draw.between(0.2, 1) * u, draw.between(0.2, 1) * v,
              plate == 0 ? "board" : "metal");
  }
  return mesh;
}

}  // namespace

TEST_CASE("visible parts: they are convex and flat, lie in their triangle, and have nothing in common") {
  std::size_t parts_seen = 0, of_many = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> world(rough_scene_of(cluttered_wall(draw)));
    LinkView view(world, world.end(Vec3(0, draw.between(-3, 3), draw.between(-3, 3))),
                  world.end(Vec3(draw.between(0, 2), draw.between(-3, 3), 0)), 1);
    for (const std::uint32_t triangle : triangles_of(world.scene, "rough")) {
      const TriangleCorners corners_m = world.scene.corners_m(triangle);
      const Vec3 normal = glm::normalize(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]));
      std::vector<std::span<const Vec3>> all;
      const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
      double area_m2 = 0.0;
      for (const SeenPiece& piece : pieces) {
        for (std::size_t part = 0; part < piece.parts.size(); ++part) all.push_back(piece.parts.corners_m(part));
        area_m2 += area_of_m2(piece.parts);
      }
      parts_seen += all.size();
      of_many += all.size() > 8;
      double common = 0.0;
      for (std::size_t one = 0; one < all.size(); ++one) {
        const std::size_t count = all[one].size();
        REQUIRE(count >= 3);
        int turns_left = 0, turns_right = 0;
        for (std::size_t corner = 0; corner < count; ++corner) {
          const Vec3 &a = all[one][corner], &b = all[one][(corner + 1) % count], &c = all[one][(corner + 2) % count];
          CHECK(std::abs(glm::dot(normal, a - corners_m[0])) < 1e-12);  // rounding of 10 m
          // Corners that count as on a side are up to 1e-7 m off it.
          CHECK(inside_m(corners_m, a) > -2e-7);
          const double height_m = glm::dot(normal, glm::cross(b - a, c - b)) / std::max(glm::length(c - a), 1e-9);
          turns_left += height_m > 2e-7;
          turns_right += height_m < -2e-7;
        }
        CHECK((turns_left == 0 || turns_right == 0));
        CHECK(0.5 * twice_area_m2(all[one]) > 0.0);
        for (std::size_t other = one + 1; other < all.size(); ++other) {
          common += common_m2(all[one], all[other], normal);
        }
      }
      CHECK(common < 1e-7 * 10.0 * double(all.size() + 1));  // 1e-7 m along sides of up to 10 m
      CHECK(area_m2 <= area_of_m2(corners_m) + rounding_m2);
    }
  }
  MESSAGE(parts_seen << " parts, more than 8 in " << of_many << " triangles");
  CHECK(parts_seen > 500);
  CHECK(of_many > 20);
}

TEST_CASE("visible parts: with what rays say is hidden they make up the area of the triangle") {
  double largest = 0.0;
  int all_hidden = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> world(rough_scene_of(cluttered_wall(draw)));
    LinkView view(world, world.end(Vec3(0, draw.between(-3, 3), draw.between(-3, 3))),
                  world.end(Vec3(draw.between(0, 2), draw.between(-3, 3), 0)), 1);
    const FacetId facet = world.facet_at(Vec3(wall_x_m, 0.1, 0.2), "rough");
    const double area_m2 = link_m2(world, view.from, view.to, 1);
    // Cells in rows that begin at random places: a cell that a rim cuts counts wholly or not.
    constexpr int cells = 160;
    constexpr double cell_m = 2.0 * wall_half_m / cells;
    int hidden = 0;
    for (int row = 0; row < cells; ++row) {
      for (int column = 0; column < cells; ++column) {
        const Vec3 point_m(wall_x_m, -wall_half_m + (column + draw.between(0, 1)) * cell_m,
                           -wall_half_m + (row + draw.between(0, 1)) * cell_m);
        hidden += !view.traced(facet, point_m);
      }
    }
    // Some 60 m of rims run through some 60/0.0625 ≈ 1000 cells, each of which errs by half of itself at random: the
    // sum by √1000 · 0.5 · 0.0039 m² ≈ 0.06 m². Five times that never happens.
    const double missing_m2 = std::abs(area_m2 + hidden * cell_m * cell_m - wall_m2);
    largest = std::max(largest, missing_m2);
    CHECK(missing_m2 < 0.3);
    CHECK(hidden > 250);
    CHECK(hidden < cells * cells / 2);
    all_hidden += hidden;
  }
  CHECK(all_hidden > 30'000);
  MESSAGE("off by " << largest << " m2 at most");
}

TEST_CASE("visible parts: turned and moved away a scene has the same parts") {
  constexpr std::uint64_t scenes = 100;
  std::size_t to_rounding = 0, with_shadows = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    const TriangleMesh mesh = cluttered_wall(draw);
    const Vec3 from_m(0, draw.between(-3, 3), draw.between(-3, 3)), to_m(draw.between(0, 2), draw.between(-3, 3), 0);
    const Mat3 turn = rotation_matrix({Vec3(0.0), draw.between(-pi, pi), draw.between(-1, 1), draw.between(-pi, pi)});
    const Vec3 away_m = 500.0 * draw.direction();
    std::array<double, 3> areas_m2;
    for (std::size_t how = 0; how < 3; ++how) {
      const auto placed = [&](const Vec3& m) { return how == 0 ? m : how == 1 ? m + away_m : turn * m + away_m; };
      TriangleMesh moved = mesh;
      for (Vec3& vertex_m : moved.vertices_m) vertex_m = placed(vertex_m);
      TracedScene<> world(rough_scene_of(moved));
      areas_m2[how] = link_m2(world, world.end(placed(from_m)), world.end(placed(to_m)), 1);
    }
    const double off_m2 = std::max(std::abs(areas_m2[1] - areas_m2[0]), std::abs(areas_m2[2] - areas_m2[0]));
    to_rounding += off_m2 < 1e-9 * wall_m2;
    with_shadows += areas_m2[0] < wall_m2 - 1.0;
    // Where a sliver is just as wide as the least width of a piece, or a corner 1e-7 m off a side, rounding decides:
    // that is in less than one scene of fifty. A sliver of 0.1 mm is 5 m long, at most.
    CHECK(off_m2 < 5e-4);
  }
  CHECK(to_rounding > scenes - 8);
  CHECK(with_shadows > scenes / 2);
}

}  // namespace test_visible_parts
