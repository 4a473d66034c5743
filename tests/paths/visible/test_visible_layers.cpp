/// Patches that lie on top of each other, in one plane or almost: which of them scatters, which hides the other, and
/// which of two sheets is crossed, against rays.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/paths/visible/visible_trial.hpp"
#include "tests/support/all_tests.hpp"

namespace test_visible_layers {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double degree_rad = pi / 180.0;

template <typename View>
double seen_m2(View& view, const std::string& material) {
  double sum_m2 = 0.0;
  for (std::uint32_t triangle = 0; triangle < view.scene().triangles().size(); ++triangle) {
    const WorldFacet& facet = view.scene().facet(view.scene().facet_of_triangle(triangle));
    if (view.scene().material(facet.material).name != material) continue;
    for (const SeenPiece& piece : view.pieces_of(triangle)) sum_m2 += area_of_m2(piece.parts);
  }
  return sum_m2;
}

/// A patch almost in the plane of a wall at x = 0: shifted along x, and tilted about a line of that plane.
struct Layer {
  Vec3 middle_m;
  double half_y_m, half_z_m, tilt_rad, axis_rad;
  std::string material;

  void add_to(TriangleMesh& mesh) const {
    const Vec3 axis(0, std::cos(axis_rad), std::sin(axis_rad)), across(0, -axis.z, axis.y);
    const Vec3 tilted = std::cos(tilt_rad) * across + std::sin(tilt_rad) * Vec3(1, 0, 0);
    const auto turned = [&](const Vec3& way) { return glm::dot(way, axis) * axis + glm::dot(way, across) * tilted; };
    add_sheet(mesh, middle_m, turned(Vec3(0, half_y_m, 0)), turned(Vec3(0, 0, half_z_m)), material);
  }
};

const std::vector<std::string> names{"rough", "slab", "board", "film", "metal", "glass", "opaque"};

Layer draw_layer(Draw& draw) {
  constexpr std::array shifts_m{0.0, 3e-5, -3e-5, 8e-5, 2.5e-4, -2.5e-4, 1e-3};
  constexpr std::array tilts_deg{0.0, 0.0, 0.02, 0.05, 0.08, 0.3, 3.0, 8.0};
  Layer layer;
  layer.middle_m = Vec3(shifts_m[draw.below(shifts_m.size())], draw.between(-2, 2), draw.between(-2, 2));
  layer.half_y_m = draw.between(0.5, 3.0);
  layer.half_z_m = draw.between(0.5, 3.0);
  layer.tilt_rad = degree_rad * tilts_deg[draw.below(tilts_deg.size())];
  layer.axis_rad = draw.between(-pi, pi);
  layer.material = names[draw.below(names.size())];
  return layer;
}

struct LayeredScene {
  Scene scene;
  Mat3 turn{1.0};
  Vec3 place_m{0.0};
  bool is_turned = false;
};

/// A wall and some layers on it; in every second scene the layers are on two bodies that are turned together, each in
/// its own way to that place.
LayeredScene draw_layers(Draw& draw) {
  TriangleMesh wall, first, second;
  add_sheet(wall, Vec3(0.0), Vec3(0, 3, 0), Vec3(0, 0, 3), draw.below(2) == 0 ? "rough" : "board");
  if (draw.below(2) == 0) add_sheet(wall, Vec3(0, 1, 1), Vec3(0, 3, 0), Vec3(0, 0, 3), names[draw.below(4)]);
  draw_layer(draw).add_to(first);
  if (draw.below(2) == 0) draw_layer(draw).add_to(first);
  draw_layer(draw).add_to(second);
  LayeredScene made{scene_of_rough_materials()};
  TriangleMesh ground;
  add_sheet(ground, Vec3(0, 0, -50), Vec3(1, 0, 0), Vec3(0, 1, 0), "metal");  // far away: there is a scenery
  if (draw.below(2) == 0) {
    for (const TriangleMesh* mesh : {&first, &second}) {
      for (const TriangleMesh::Triangle& triangle : mesh->triangles) {
        TriangleMesh::Triangle moved{{}, material_index(wall, mesh->material_names[triangle.material])};
        for (std::size_t corner = 0; corner < 3; ++corner) {
          moved.vertices[corner] = static_cast<std::uint32_t>(wall.vertices_m.size());
          wall.vertices_m.push_back(mesh->vertices_m[triangle.vertices[corner]]);
        }
        wall.triangles.push_back(moved);
      }
    }
    made.scene.set_scenery(wall);
    return made;
  }
  const Pose pose{draw.inside(Vec3(-30), Vec3(30)), draw.between(-pi, pi), draw.between(-0.3, 0.3),
                  draw.between(-0.3, 0.3)};
  made.scene.set_scenery(ground);
  made.scene.add_object("wall", wall, LinearMotion{pose});
  made.scene.add_object("first", first, LinearMotion{pose});
  made.scene.add_object("second", second, LinearMotion{pose});
  made.turn = rotation_matrix(pose);
  made.place_m = pose.position_m;
  made.is_turned = true;
  return made;
}

}  // namespace

TEST_CASE("visible layers: of patches that overlap in one plane, or almost, rays and parts choose the same") {
  Tally tally;
  std::size_t taken = 0, on_bodies = 0, noted = 0, changed = 0;
  for (std::uint64_t seed = 1; seed <= all_or(3000U, 250U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    LayeredScene layered = draw_layers(draw);
    TracedScene<> world(std::move(layered.scene));
    const double side = draw.below(2) == 0 ? 1.0 : -1.0;
    const auto end = [&] {
      const Vec3 place_m(side * draw.magnitude(0.02, 8), draw.between(-6, 6), draw.between(-6, 6));
      const std::optional<BodyId> ridden =
          layered.is_turned && draw.below(6) == 0 ? std::optional(BodyId(1 + draw.below(3))) : std::nullopt;
      return world.end(layered.place_m + layered.turn * place_m, ridden);
    };
    const LinkEnd from = end(), to = end();
    LinkView view(world, from, to, 2);
    PointJudge judge(view, tally);
    for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
      const FacetId facet = world.scene.facet_of_triangle(triangle);
      if (!view.traces(facet)) continue;
      const TriangleCorners corners_m = world.scene.corners_m(triangle);
      const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
      double area_m2 = 0.0;
      for (const SeenPiece& piece : pieces) area_m2 += area_of_m2(piece.parts);
      taken += area_m2 < 0.99 * area_of_m2(corners_m);
      on_bodies += world.scene.facet(facet).body != BodyId{};
      // Where a body is not noted, nothing changes without it.
      const LitParts lit = view.find_lit(facet, corners_m, std::nullopt);
      for (std::size_t number = 1; number < world.scene.bodies().size() && !lit.are_too_many; ++number) {
        const LitParts without = view.find_lit(facet, corners_m, BodyId(number));
        const bool are_same = std::ranges::equal(lit.parts.all_corners_m(), without.parts.all_corners_m());
        const bool is_noted = std::ranges::find(lit.bodies, BodyId(number)) != lit.bodies.end();
        CHECK((is_noted || are_same));
        noted += is_noted;
        changed += !are_same;
      }
      for (int index = 0; index < 40; ++index) judge.judge(triangle, pieces, point_of(corners_m, draw), 1e-3);
    }
  }
  MESSAGE(tally.visible << " visible, " << tally.through << " of them through sheets, " << tally.hidden << " hidden, "
                        << tally.doubtful << " doubtful, " << tally.narrow << " narrow, " << tally.at_tolerance
                        << " at the tolerance; " << taken << " triangles not wholly visible, " << on_bodies
                        << " on bodies");
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow <= 1);
  CHECK(tally.at_tolerance < tally.visible / 500);
  CHECK(tally.visible > 20'000);
  CHECK(tally.hidden > 15'000);
  CHECK(tally.through > 4'000);
  CHECK(taken > 1'000);
  CHECK(on_bodies > 500);
  CHECK(noted > 200);
  CHECK(changed > 200);
}

TEST_CASE("visible layers: of two patches in one plane that of the first name scatters, the other where it is alone") {
  for (const bool is_turned : {false, true}) {
    CAPTURE(is_turned);
    for (const double off_m : {0.0, 5e-5, -5e-5}) {
      CAPTURE(off_m);
      TriangleMesh mesh;
      const auto add = [&](const char* name, double x_m, double low_y_m, double high_y_m) {
        add_sheet(mesh, Vec3(x_m, 0.5 * (low_y_m + high_y_m), 0), Vec3(0, 0.5 * (high_y_m - low_y_m), 0), Vec3(0, 0, 3),
                  name);
      };
      add(is_turned ? "rough" : "slab", 0.0, -3, 1);
      add(is_turned ? "slab" : "rough", off_m, -1, 3);
      TracedScene<> world(rough_scene_of(mesh));
      LinkView view(world, world.end(Vec3(-4, 1, 0)), world.end(Vec3(-3, -2, 1)), 0);
      // What lies up to the tolerance before hides nothing: a corner of it is seen as if it were on the patch.
      CHECK(seen_m2(view, "rough") == doctest::Approx(24.0).epsilon(1e-9));
      CHECK(seen_m2(view, "slab") == doctest::Approx(12.0).epsilon(1e-9));
    }
  }
}

TEST_CASE("visible layers: a patch that is tilted by 0.05 degrees leaves to the other what is within the tolerance") {
  constexpr double tilt_rad = 0.05 * degree_rad, tolerance_m = 1e-4, far_m = 10.0;
  for (const bool rides : {false, true}) {
    CAPTURE(rides);
    // `slab` stands for nothing that `rough` is at; where y > 0 it is the nearer one.
    TriangleMesh flat, tilted;
    add_sheet(flat, Vec3(0.0), Vec3(0, 3, 0), Vec3(0, 0, 3), "rough");
    add_sheet(tilted, Vec3(0.0), 3.0 * Vec3(-std::sin(tilt_rad), std::cos(tilt_rad), 0), Vec3(0, 0, 3), "slab");
    Scene scene = scene_of_rough_materials();
    const Pose pose{Vec3(40, -20, 7), 0.4, 0.2, -0.3};
    if (rides) {
      TriangleMesh ground;
      add_sheet(ground, Vec3(0, 0, -90), Vec3(1, 0, 0), Vec3(0, 1, 0), "metal");
      scene.set_scenery(ground);
      scene.add_object("tilted", tilted, LinearMotion{pose});
      scene.add_object("flat", flat, LinearMotion{pose});
    } else {
      for (const TriangleMesh::Triangle& triangle : tilted.triangles) {
        TriangleMesh::Triangle moved{{}, material_index(flat, "slab")};
        for (std::size_t corner = 0; corner < 3; ++corner) {
          moved.vertices[corner] = static_cast<std::uint32_t>(flat.vertices_m.size());
          flat.vertices_m.push_back(tilted.vertices_m[triangle.vertices[corner]]);
        }
        flat.triangles.push_back(moved);
      }
      scene.set_scenery(flat);
    }
    TracedScene<> world(std::move(scene));
    const Vec3 local_m(-far_m, 0, 0), from_m = rides ? pose.position_m + rotation_matrix(pose) * local_m : local_m;
    LinkView view(world, world.end(from_m), world.end(from_m), 0);
    // `rough` from its rim to where `slab` is a tolerance before it, as far out as that is seen on it; `slab` from
    // there on, along itself. In between a micrometre is left over, which is too narrow for a piece.
    const double rough_m = 3.0 + tolerance_m / std::tan(tilt_rad) * far_m / (far_m - tolerance_m);
    const double slab_m = 3.0 - tolerance_m / std::tan(tilt_rad);
    CHECK(seen_m2(view, "rough") == doctest::Approx(6.0 * rough_m).epsilon(1e-6));
    CHECK(seen_m2(view, "slab") == doctest::Approx(6.0 * slab_m).epsilon(1e-6));
    // An end that rides on one of them sees all of the other.
    if (rides) {
      LinkView alone(world, world.end(from_m, BodyId(2)), world.end(from_m), 0);
      CHECK(seen_m2(alone, "slab") == doctest::Approx(36.0).epsilon(1e-9));
      CHECK(seen_m2(alone, "rough") == 0.0);
    }
  }
}

namespace {

/// A wall behind sheets that each may be tilted about the z axis.
struct SheetBefore {
  double x_m, tilt_rad;
  std::string material;
};

Tally judge_behind(const std::vector<SheetBefore>& sheets, int max_transmissions, Draw draw = Draw(7),
                   int points = 500) {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 10.0, 5.0, "rough");
  double half_m = 4.0;
  for (const SheetBefore& sheet : sheets) {
    add_sheet(mesh, Vec3(sheet.x_m, 0, 0), half_m * Vec3(-std::sin(sheet.tilt_rad), std::cos(sheet.tilt_rad), 0),
              Vec3(0, 0, half_m), sheet.material);
    half_m += 0.1;  // or they would be welded
  }
  TracedScene<> world(rough_scene_of(mesh));
  // The second end sees the wall from between it and the sheets.
  LinkView view(world, world.end(Vec3(0.0)), world.end(Vec3(8, 0.5, 1)), max_transmissions);
  Tally tally;
  PointJudge judge(view, tally);
  for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
    const FacetId facet = world.scene.facet_of_triangle(triangle);
    if (world.scene.material(world.scene.facet(facet).material).name != "rough") continue;
    const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
    for (int index = 0; index < points; ++index) {
      judge.judge(triangle, pieces, point_of(world.scene.corners_m(triangle), draw), 1e-3, false);
    }
  }
  return tally;
}

}  // namespace

TEST_CASE(
    "visible layers: two sheets within the tolerance count once, whichever comes first, and two beyond it twice") {
  using Names = std::array<std::string, 2>;
  for (const Names& names_of : {Names{"glass", "alpha"}, Names{"alpha", "glass"}, Names{"film", "film"}}) {
    const std::string &one = names_of[0], &other = names_of[1];
    CAPTURE(one);
    CAPTURE(other);
    // Of a thousand points one is on a rim.
    const auto behind = [&](double apart_m, int max_transmissions) {
      return judge_behind({{5.0, 0.0, one}, {5.0 + apart_m, 0.0, other}}, max_transmissions);
    };
    for (const double apart_m : {0.0, 5e-5, 9e-5}) {
      CAPTURE(apart_m);
      CHECK(behind(apart_m, 1).through > 990);
      CHECK(behind(apart_m, 0).hidden > 990);
    }
    for (const double apart_m : {2e-4, 0.1}) {
      CAPTURE(apart_m);
      CHECK(behind(apart_m, 2).through > 990);
      CHECK(behind(apart_m, 1).hidden > 990);
    }
  }
}

TEST_CASE(
    "visible layers: two sheets that are tilted against each other count once where they are within the tolerance") {
  // 0.05 degrees: parallel by the rule, and farther apart than the tolerance from 0.115 m off their common line on.
  const std::vector<SheetBefore> two{{5.0, 0.0, "glass"}, {5.0, 0.05 * degree_rad, "alpha"}};
  const Tally once = judge_behind(two, 1), twice = judge_behind(two, 2);
  CHECK(once.visible + once.hidden + once.wrong > 950);
  CHECK(once.wrong == 0);
  CHECK(twice.wrong == 0);
}

TEST_CASE("visible layers: the sheet between two others makes one of them, in whichever order their planes are") {
  // The third one is tilted: its plane is farther from the first end than those of the others, and from y = 0.2865 to
  // 0.344 m it is within the tolerance of both.
  const std::vector<SheetBefore> stack{
      {5.0, 0.0, "alpha"}, {5.00016, 0.0, "board"}, {5.0003, 0.04 * degree_rad, "film"}};
  const Tally tally = judge_behind(stack, 1);
  CHECK(tally.wrong == 0);
  CHECK(tally.visible > 10);
  CHECK(tally.hidden > 900);
}

TEST_CASE("visible layers: stacks of sheets that are tilted against each other count as rays count them") {
  // Each is parallel to each by the rule.
  constexpr std::array tilts_deg{0.0, 0.0, 0.02, -0.02, 0.04, -0.04};
  const std::vector<std::string> sheet_names{"alpha", "board", "film", "glass"};
  Tally tally;
  for (std::uint64_t seed = 1; seed <= all_or(2000U, 200U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    std::vector<SheetBefore> stack;
    const std::size_t count = 2 + draw.below(3);
    for (std::size_t sheet = 0; sheet < count; ++sheet) {
      stack.push_back({5.0 + draw.between(0, 4e-4), degree_rad * tilts_deg[draw.below(tilts_deg.size())],
                       sheet_names[draw.below(sheet_names.size())]});
    }
    const Tally one = judge_behind(stack, static_cast<int>(1 + draw.below(3)), Draw(seed), 25);
    tally.wrong += one.wrong;
    tally.visible += one.visible;
    tally.hidden += one.hidden;
    tally.doubtful += one.doubtful;
  }
  MESSAGE(tally.visible << " visible, " << tally.hidden << " hidden, " << tally.doubtful << " doubtful, " << tally.wrong
                        << " wrong");
  CHECK(tally.wrong == 0);
  CHECK(tally.visible > 3'000);
  CHECK(tally.hidden > 3'000);
}

TEST_CASE("visible layers: of a stack of sheets each is one with the next") {
  for (const auto& names_of : std::vector<std::vector<std::string>>{
           {"alpha", "board", "film"}, {"film", "board", "alpha"}, {"film", "alpha", "board"}}) {
    CAPTURE(names_of[0]);
    std::vector<SheetBefore> stack;
    for (std::size_t sheet = 0; sheet < 3; ++sheet) stack.push_back({5.0 + 8e-5 * double(sheet), 0.0, names_of[sheet]});
    const Tally tally = judge_behind(stack, 1);
    CHECK(tally.wrong == 0);
    CHECK(tally.through > 990);
  }
}

}  // namespace test_visible_layers
