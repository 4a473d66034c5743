/// Random scenes: a point is in a visible part of its triangle if and only if rays from both ends reach it, through the
/// same sheets.
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

namespace test_visible_parts_random {

using namespace dcem;
using namespace dcem::test;

namespace {

using Names = std::vector<std::string>;

const Names opaque_names{"rough", "slab", "rough", "metal"};
const Names mixed_names{"rough", "board", "film", "slab", "glass", "alpha", "board"};

/// How a scene is drawn.
struct Recipe {
  bool has_sheets = false, is_dirty = false;
  double tolerance_m = 1e-4;
  std::string name(Draw& draw) const {
    const Names& names = has_sheets ? mixed_names : opaque_names;
    return names[draw.below(names.size())];
  }
};

constexpr double dirt_m = 1e-4;  ///< by which vertices of a dirty mesh are moved, at most

void make_dirty(TriangleMesh& mesh, Draw& draw) {
  for (Vec3& vertex_m : mesh.vertices_m) vertex_m += draw.between(0, dirt_m) * draw.direction();
}

void add_ground(TriangleMesh& mesh, Draw& draw) {
  add_sheet(mesh, Vec3(0.0), Vec3(draw.between(8, 20), 0, 0), Vec3(0, draw.between(8, 20), 0), "rough");
}

/// Boxes that stand on the ground, are half in it or hover; some on a grid of half metres, so that they touch.
void add_boxes(TriangleMesh& mesh, const Recipe& recipe, Draw& draw, std::size_t count) {
  for (std::size_t box = 0; box < count; ++box) {
    Vec3 low_m = draw.inside(Vec3(-8, -8, 0), Vec3(6, 6, 0)), size_m = draw.inside(Vec3(0.5, 0.5, 0.5), Vec3(4, 4, 5));
    if (draw.below(2) == 0) {
      low_m = 2.0 * glm::floor(0.5 * low_m);
      size_m = 2.0 * glm::ceil(0.5 * size_m);
    }
    low_m.z = std::array{0.0, 0.0, 0.0, -0.3, 0.01, 0.4}[draw.below(6)];
    add_box_faces(mesh, low_m, low_m + size_m, recipe.name(draw));
  }
}

void add_patches(TriangleMesh& mesh, const Recipe& recipe, Draw& draw, std::size_t count) {
  for (std::size_t patch = 0; patch < count; ++patch) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(-8, -8, 0), Vec3(8, 8, 6)), draw.between(0.3, 4) * u, draw.between(0.3, 3) * v,
              recipe.name(draw));
  }
}

/// Half a sphere in rings and columns, its top of triangles alone.
void add_dome(TriangleMesh& mesh, const std::string& material, const Vec3& foot_m, double radius_m, int columns,
              int rings) {
  const std::uint32_t index = material_index(mesh, material);
  const auto corner_m = [&](int column, int ring) {
    const double azimuth = 2.0 * pi * (column % columns) / columns, zenith = 0.5 * pi * ring / rings;
    return foot_m + radius_m * Vec3(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                                    std::cos(zenith));
  };
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.insert(mesh.vertices_m.end(), {a, b, c});
    mesh.triangles.push_back({{first, first + 1, first + 2}, index});
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) {
      const Vec3 a = corner_m(column, ring), b = corner_m(column, ring + 1), c = corner_m(column + 1, ring + 1),
                 d = corner_m(column + 1, ring);
      add(a, b, c);
      if (ring > 0) add(a, c, d);
    }
  }
}

/// Flat facets that do not fill their hull: an L, a wall with a gate, a wall with a window, and two triangles that
/// stand on one edge and lie on each other.
void add_dented(TriangleMesh& mesh, const Recipe& recipe, Draw& draw, std::size_t count) {
  struct Cell {
    int column, row;
  };
  const std::vector<std::vector<Cell>> shapes{
      {{0, 0}, {1, 0}, {0, 1}},
      {{0, 0}, {0, 1}, {1, 1}, {2, 1}, {2, 0}},
      {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {2, 1}, {0, 2}, {1, 2}, {2, 2}},
  };
  for (std::size_t wall = 0; wall < count; ++wall) {
    const double turn = draw.between(-pi, pi), lean = draw.below(2) == 0 ? 0.0 : draw.between(-0.6, 0.6);
    const Vec3 along = draw.between(0.5, 1.5) * Vec3(std::cos(turn), std::sin(turn), 0.0);
    const Vec3 up = draw.between(0.5, 1.2) * glm::normalize(Vec3(-std::sin(turn) * lean, std::cos(turn) * lean, 1.0));
    const Vec3 foot_m = draw.inside(Vec3(-7, -7, 0), Vec3(5, 5, 0));
    const std::string name = recipe.name(draw);
    const std::size_t shape = draw.below(shapes.size() + 1);
    if (shape == shapes.size()) {
      const std::uint32_t index = material_index(mesh, name);
      for (const Vec3& top_m : {0.2 * along + 2.0 * up, 1.8 * along + 1.7 * up}) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
        mesh.vertices_m.insert(mesh.vertices_m.end(), {foot_m, foot_m + 2.0 * along, foot_m + top_m});
        mesh.triangles.push_back({{first, first + 1, first + 2}, index});
      }
      continue;
    }
    for (const Cell& cell : shapes[shape]) {
      const Vec3 low_m = foot_m + double(cell.column) * along + double(cell.row) * up;
      add_quad(mesh, {low_m, low_m + along, low_m + along + up, low_m + up}, name);
    }
  }
}

TriangleMesh draw_scenery(std::uint64_t seed, const Recipe& recipe, Draw& draw) {
  TriangleMesh mesh;
  switch (seed % 5) {
    case 0:
      add_ground(mesh, draw);
      add_boxes(mesh, recipe, draw, 3 + draw.below(6));
      break;
    case 1:
      add_patches(mesh, recipe, draw, 8 + draw.below(12));
      break;
    case 2:
      add_ground(mesh, draw);
      add_dome(mesh, recipe.name(draw), draw.inside(Vec3(-4, -4, 0), Vec3(4, 4, 1)), draw.between(0.5, 3),
               6 + static_cast<int>(draw.below(8)), 2 + static_cast<int>(draw.below(4)));
      add_boxes(mesh, recipe, draw, 2);
      break;
    case 3:
      add_ground(mesh, draw);
      add_dented(mesh, recipe, draw, 4);
      add_patches(mesh, recipe, draw, 3);
      break;
    default:
      add_box_faces(mesh, Vec3(-9, -9, 0), Vec3(9, 9, 6), "rough");
      add_boxes(mesh, recipe, draw, 3);
      add_dented(mesh, recipe, draw, 2);
      add_patches(mesh, recipe, draw, 3);
  }
  if (recipe.is_dirty) {
    make_dirty(mesh, draw);
  } else if (draw.below(2) == 0) {
    const Vec3 low_m = draw.inside(Vec3(-6, -6, 0), Vec3(4, 4, 0));
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(1.0), Vec3(3.0)), "hedge");  // no surface
  }
  return mesh;
}

Scene draw_scene(std::uint64_t seed, const Recipe& recipe, Draw& draw) {
  Scene scene = rough_scene_of(draw_scenery(seed, recipe, draw), {recipe.tolerance_m});
  if (draw.below(2) == 0) return scene;
  for (const char* name : {"one", "two"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), recipe.name(draw));
    Pose pose{draw.inside(Vec3(-7, -7, 0), Vec3(7, 7, 0.1)), draw.between(-pi, pi)};
    if (draw.below(2) == 0) pose.pitch_rad = draw.between(-0.2, 0.2), pose.roll_rad = draw.between(-0.2, 0.2);
    scene.add_object(name, car, LinearMotion{pose});
  }
  TriangleMesh absent;
  add_box_faces(absent, Vec3(-3), Vec3(3), "rough");
  scene.add_body_pool(1, absent);
  return scene;
}

/// Anywhere, on a facet, or on a car, which is ignored then.
LinkEnd draw_any_end(TracedScene<>& world, Draw& draw) {
  const std::uint64_t kind = draw.below(8);
  if (kind == 0) {
    const auto triangle = static_cast<std::uint32_t>(draw.below(world.scene.triangles().size()));
    if (world.scene.facet(world.scene.facet_of_triangle(triangle)).present) {
      return world.end(point_of(world.scene.corners_m(triangle), draw));
    }
  }
  if (kind == 1 && world.scene.bodies().size() > 1) {
    const BodyId body(1 + draw.below(2));
    const Pose& pose = world.scene.body_state(body).placement.pose;
    return world.end(pose.position_m + rotation_matrix(pose) * draw.inside(Vec3(-2, -1, 0.2), Vec3(2, 1, 2)), body);
  }
  const Vec3 place_m = draw.inside(Vec3(-8.5, -8.5, 0.1), Vec3(8.5, 8.5, 5.5));
  if (kind == 2) return world.end(glm::round(place_m));  // in planes of boxes, on their edges and corners
  if (kind == 3) return world.end(place_m + draw.magnitude(10, 3000) * glm::normalize(place_m));
  return world.end(place_m);
}

constexpr double clearance_m = 0.3;  ///< of an end from dirty facets that it is not mounted on

LinkEnd draw_end(TracedScene<>& world, const Recipe& recipe, Draw& draw) {
  while (true) {
    const LinkEnd end = draw_any_end(world, draw);
    if (!recipe.is_dirty) return end;
    const IgnoredBodies ignored{end.ignored_body, std::nullopt};
    if (world.tracer.facets_near(end.position_m, clearance_m, ignored, world.counters) == end.mounted_on) return end;
  }
}

/// Within this of a rim a point is doubtful. In clean scenes rounding and what is cut off as too narrow decide, and
/// this is five times the latter. In dirty ones quadrilaterals are folded by up to twice the dirt; a fold casts a
/// shadow as many times as large as the point is farther from the end than the fold, at the angle of incidence.
double margin_m(const Recipe& recipe, const Plane& plane, const LinkEnd& end, const Vec3& point_m) {
  const double clean_m = 10.0 * recipe.tolerance_m;
  if (!recipe.is_dirty) return clean_m;
  const double distance_m = glm::distance(end.position_m, point_m);
  const double sine = std::abs(signed_distance_m(plane, end.position_m)) / distance_m;
  return clean_m + 4.0 * dirt_m * (1.0 + distance_m / clearance_m) / sine;
}

Tally judge_scenes(const Recipe& recipe, std::uint64_t first_seed, std::uint64_t end_seed, int points) {
  Tally tally;
  for (std::uint64_t seed = first_seed; seed < end_seed; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> world(draw_scene(seed, recipe, draw));
    for (int sheets = 0; sheets <= (recipe.has_sheets ? 3 : 1); ++sheets) {
      CAPTURE(sheets);
      const LinkEnd from = draw_end(world, recipe, draw), to = draw_end(world, recipe, draw);
      LinkView view(world, from, to, sheets);
      PointJudge judge(view, tally);
      for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
        const FacetId id = world.scene.facet_of_triangle(triangle);
        const WorldFacet& facet = world.scene.facet(id);
        CHECK(may_scatter(world.scene, from, to, id) == view.traces(id));
        if (!view.traces(id)) continue;
        const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
        for (int index = 0; index < points; ++index) {
          const Vec3 point_m = point_of(world.scene.corners_m(triangle), draw);
          const double margin =
              std::max(margin_m(recipe, facet.plane, from, point_m), margin_m(recipe, facet.plane, to, point_m));
          judge.judge(triangle, pieces, point_m, margin);
        }
      }
      tally.halvings += view.halvings;
    }
  }
  MESSAGE(tally.visible << " visible, " << tally.through << " of them through sheets, " << tally.hidden << " hidden, "
                        << tally.doubtful << " doubtful, " << tally.narrow << " narrow, " << tally.at_tolerance
                        << " at the tolerance, " << tally.halvings << " halvings");
  return tally;
}

}  // namespace

TEST_CASE("visible parts: in clean opaque scenes a point is in a part if and only if both ends reach it") {
  const Tally tally = judge_scenes({}, 1, all_or(1000U, 60U), 20);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow == 0);
  CHECK(tally.at_tolerance == 0);
  CHECK(tally.visible > 15'000);
  CHECK(tally.hidden > 40'000);
  CHECK(tally.doubtful < tally.visible / 10);
}

TEST_CASE("visible parts: in dirty opaque scenes a point is in a part if and only if both ends reach it") {
  const Tally tally = judge_scenes({false, true}, 1001, all_or(2000U, 1060U), 20);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow + tally.at_tolerance <= tally.visible / 5'000);
  CHECK(tally.visible > 7'000);
  CHECK(tally.hidden > 20'000);
  CHECK(tally.doubtful < tally.visible + tally.hidden);
}

TEST_CASE("visible parts: behind sheets a point is in a part if and only if both ends reach it through the same ones") {
  const Tally tally = judge_scenes({true, false}, 2001, all_or(2500U, 2035U), 20);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow == 0);
  CHECK(tally.at_tolerance == 0);
  CHECK(tally.visible > 30'000);
  CHECK(tally.hidden > 40'000);
  CHECK(tally.through > 10'000);
  CHECK(tally.halvings > 100);
}

TEST_CASE("visible parts: the same behind dirty sheets") {
  const Tally tally = judge_scenes({true, true}, 3001, all_or(3500U, 3035U), 20);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow + tally.at_tolerance <= tally.visible / 5'000);
  CHECK(tally.visible > 15'000);
  CHECK(tally.hidden > 20'000);
  CHECK(tally.through > 5'000);
}

TEST_CASE("visible parts: the same with a tolerance of two millimetres") {
  const Tally tally = judge_scenes({true, false, 2e-3}, 4001, all_or(4500U, 4020U), 20);
  CHECK(tally.wrong == 0);
  CHECK(tally.narrow <= 1);
  CHECK(tally.visible > 10'000);
  CHECK(tally.hidden > 13'000);
  CHECK(tally.through > 3'000);
}

TEST_CASE("visible parts: on a floor that is bent, each triangle in its own plane") {
  // Strips of a metre, each 0.05 degrees steeper than the one before: one facet, millimetres off its mean plane.
  constexpr int strips = 6;
  constexpr double bend_rad = 0.05 * pi / 180.0;
  Tally tally;
  double stray_m = 0.0;
  for (std::uint64_t seed = 1; seed <= all_or(400U, 60U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TriangleMesh mesh;
    Vec3 rim_m(0, -2, 0);
    for (int strip = 0; strip < strips; ++strip) {
      const double slope_rad = bend_rad * (strip - 0.5 * (strips - 1));
      const Vec3 along(std::cos(slope_rad), 0, std::sin(slope_rad)), across(0, 4, 0);
      add_quad(mesh, {rim_m, rim_m + along, rim_m + along + across, rim_m + across}, "rough");
      rim_m += along;
    }
    for (int post = 0; post < 4; ++post) {
      const Vec3 foot_m = draw.inside(Vec3(0.5, -1.5, -0.1), Vec3(5.5, 1.5, -0.1));
      const double turn = draw.between(-pi, pi);
      const Vec3 along = draw.between(0.05, 0.5) * Vec3(std::cos(turn), std::sin(turn), 0.0);
      add_quad(mesh,
               {foot_m - along, foot_m + along, foot_m + along + Vec3(0, 0, 0.5), foot_m - along + Vec3(0, 0, 0.5)},
               draw.below(2) == 0 ? "metal" : "glass");
    }
    TracedScene<> world(rough_scene_of(mesh));
    const auto end = [&] { return world.end(draw.inside(Vec3(-4, -4, 0.05), Vec3(10, 4, 1.0))); };
    LinkView view(world, end(), end(), 1);
    PointJudge judge(view, tally);
    const FacetId facet = world.facet_at(Vec3(3, 0.1, mesh.vertices_m[12].z), "rough");
    REQUIRE(world.scene.facet(facet).triangle_count == 2 * strips);
    for (std::uint32_t index = 0; index < 2 * strips; ++index) {
      const std::uint32_t triangle = world.scene.facet(facet).first_triangle + index;
      const TriangleCorners corners_m = world.scene.corners_m(triangle);
      for (const Vec3& corner_m : corners_m) {
        stray_m = std::max(stray_m, std::abs(signed_distance_m(world.scene.facet(facet).plane, corner_m)));
      }
      const std::vector<SeenPiece> pieces = view.pieces_of(triangle);
      for (int point = 0; point < 40; ++point) judge.judge(triangle, pieces, point_of(corners_m, draw), 1e-3, false);
    }
  }
  MESSAGE(tally.visible << " visible, " << tally.through << " of them through sheets, " << tally.hidden << " hidden, "
                        << tally.doubtful << " doubtful; up to " << stray_m << " m off the plane");
  CHECK(tally.wrong == 0);
  CHECK(stray_m > 2e-3);
  CHECK(tally.visible > 10'000);
  CHECK(tally.hidden > 5'000);
  CHECK(tally.through > 1'000);
}

TEST_CASE("visible parts: a body that is not noted has taken nothing of what a transmitter sees") {
  std::size_t without = 0, noted = 0, changed = 0;
  for (std::uint64_t seed = 1; seed <= all_or(600U, 60U); ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    const Recipe recipe{seed % 2 == 0, false};
    TracedScene<> world(draw_scene(seed, recipe, draw));
    if (world.scene.bodies().size() < 3) continue;
    LinkView view(world, draw_end(world, recipe, draw), draw_end(world, recipe, draw), 1);
    for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
      const FacetId facet = world.scene.facet_of_triangle(triangle);
      if (!view.asks(facet)) continue;
      const TriangleCorners corners_m = world.scene.corners_m(triangle);
      const LitParts all = view.find_lit(facet, corners_m, std::nullopt);
      if (all.are_too_many) continue;  // it is halved whoever is not there
      for (const BodyId body : {BodyId(1), BodyId(2)}) {
        const LitParts other = view.find_lit(facet, corners_m, body);
        const bool are_same =
            !other.are_too_many && std::ranges::equal(all.parts.all_corners_m(), other.parts.all_corners_m());
        const bool is_noted = std::ranges::find(all.bodies, body) != all.bodies.end();
        if (!is_noted) CHECK(are_same);
        ++(is_noted ? noted : without);
        changed += !are_same;
      }
    }
  }
  MESSAGE(noted << " noted, " << changed << " changed, " << without << " not noted");
  CHECK(without > 200);
  CHECK(changed > 50);
}

}  // namespace test_visible_parts_random
