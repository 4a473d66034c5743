/// Scenes that are hard on what is remembered from frame to frame: what lies in one plane, touches, is bent, tilted or
/// grazed. In every frame the paths are those from scratch, bit for bit.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/paths/halves/small_town.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_adversaries {

using namespace dcem;
using namespace dcem::test;

namespace {

const MemoryOrders mirrors_alone{2, 0, 0, 2};
const MemoryOrders with_edges{2, 0, 1, 2};
const MemoryOrders through_sheets{2, 2, 1, 2, true};

Scene scene_with(const TriangleMesh& mesh, const SurfaceSettings& tolerances) {
  Scene scene(tolerances);
  scene.add_material({"opaque", ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"metal", PerfectConductor{}});
  scene.set_scenery(mesh);
  return scene;
}

TriangleMesh box_of(const Vec3& low_m, const Vec3& high_m, const std::string& material = "metal") {
  TriangleMesh mesh;
  add_box_faces(mesh, low_m, high_m, material);
  return mesh;
}
TriangleMesh car() {
  return box_of(Vec3(-2, -0.9, 0.1), Vec3(2, 0.9, 1.5));
}

/// A street between two rows of houses, on a ground.
TriangleMesh street() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-20, 6, 0), Vec3(-4, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-4, 6, 0), Vec3(9, 14, 6), "metal");
  add_box_faces(mesh, Vec3(-15, -14, 0), Vec3(4, -6, 7), "opaque");
  add_box_faces(mesh, Vec3(8, -13, 0), Vec3(18, -7, 11), "opaque");
  return mesh;
}

/// Five strips of 2 m, each a little steeper than the one before: one facet, which leaves its plane by 1.4 mm.
TriangleMesh bent_plate(double up) {
  TriangleMesh mesh;
  const std::vector<double> height_m{0, 0, 0.0008, 0.0024, 0.0048, 0.008};
  for (std::size_t strip = 0; strip + 1 < height_m.size(); ++strip) {
    const double x = 2.0 * static_cast<double>(strip), low = up * height_m[strip], high = up * height_m[strip + 1];
    add_quad(mesh, {Vec3(x, -5, low), Vec3(x + 2, -5, high), Vec3(x + 2, 5, high), Vec3(x, 5, low)}, "opaque");
  }
  return mesh;
}

Device mast(const Vec3& position_m = Vec3(-22, 1, 9)) {
  return device_at("mast", position_m, 30.0);
}

/// Follows a drive; it must have paths, and memory must have spared work.
MemoryTally check_drive(const Scene& scene, const MemoryOrders& orders, std::size_t frames) {
  MemoryTrial trial(scene, memory_settings(orders));
  trial.follow(frames);
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().paths > frames);
  CHECK(trial.has_remembered());
  return trial.tally();
}

}  // namespace

TEST_CASE("a leg that grazes a bent plate passes its rim while it crosses the mean plane well inside") {
  TriangleMesh mesh = bent_plate(-1.0);
  add_sheet(mesh, Vec3(30, 0, 0), Vec3(0, 10, 0), Vec3(0, 0, 5), "metal");
  Scene scene = scene_of(mesh);
  REQUIRE(scene.facets().size() == 2);
  scene.add_transmitter(mast(Vec3(-30, 0, 0.792)));
  for (const double z : {-0.76, -0.765, -0.78}) {
    const std::size_t frames = 100;
    scene.add_receiver(moving_device("at " + std::to_string(z), straight_way(frames, Vec3(13, 0, z), Vec3(12, 0, z))));
  }
  check_drive(scene, mirrors_alone, 100);
}

TEST_CASE("a face of a wedge is no mirror beside it, however far the edge is from its mean plane") {
  TriangleMesh mesh = bent_plate(0.12);  // and under it, from its rim back, another: the edge of a knife
  add_quad(mesh, {Vec3(10, -5, 0.00096), Vec3(10, 5, 0.00096), Vec3(0, 5, -0.9), Vec3(0, -5, -0.9)}, "metal");
  Scene scene = scene_of(mesh);
  REQUIRE(scene.facets().size() == 2);
  scene.add_transmitter(mast(Vec3(3, 0, 0.7)));
  scene.add_receiver(moving_device("rx", straight_way(30, Vec3(6, 0.5, -3), Vec3(5, 0.5, -3))));
  MemoryTrial trial(scene, memory_settings(with_edges));
  for (std::size_t index = 0; index < 30; ++index) {
    const FrameResult frame = trial.advance_to(static_cast<double>(index), index);
    const std::vector<PathContribution>& paths = frame.links[0].paths;
    CHECK(std::ranges::count_if(paths, [&](const auto& path) { return path_id(scene, path.path) == "D0"; }) == 1);
    CHECK(std::ranges::none_of(paths, [&](const auto& path) { return path_id(scene, path.path).ends_with("/D0"); }));
  }
}

TEST_CASE("two facets on top of each other, tilted by less than a tenth of a degree: one way hangs on the other") {
  const double tilt_rad = 0.09 * pi / 180;
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(200, 0, 0), Vec3(0, 200, 0), "opaque");
  add_sheet(mesh, Vec3(0.0), Vec3(std::cos(tilt_rad), 0, std::sin(tilt_rad)), Vec3(0, 1, 0), "metal");
  Scene scene = scene_of(mesh);
  // A stone of 2 cm, at times in the way over the metal, which meets it 16 cm from where the other way is.
  const std::vector<double> stone_x_m{5, 5, 5, 0.163, 0.163, 7, 7, 0.163, 5};
  scene.add_object("stone", box_of(Vec3(-0.01, -0.01, 0), Vec3(0.01, 0.01, 0.02)), way_of(9, [&](double at) {
                     return Pose{Vec3(stone_x_m[static_cast<std::size_t>(at)], 0, 0), 0, 0, 0};
                   }));
  scene.add_transmitter(mast(Vec3(-20, 0, 100)));
  scene.add_receiver(device_at("post", Vec3(20, 0, 100)));
  MemoryTrial trial(scene, memory_settings(mirrors_alone));
  std::string materials;
  for (std::size_t index = 0; index < 9; ++index) {
    const FrameResult frame = trial.advance_to(static_cast<double>(index), index);
    REQUIRE(frame.links[0].paths.size() == 2);
    materials += scene.material(scene.facet(frame.links[0].paths[1].path.interactions[0].facet).material).name[0];
  }
  CHECK(materials == "mmmoommom");
  CHECK(trial.has_remembered());
}

TEST_CASE("with coarse tolerances what touches an edge is far from all legs") {
  Scene scene = scene_with(box_of(Vec3(-10, -10, 0), Vec3(0, 0, 10), "opaque"), {0.3, 1e-3});
  scene.add_object("crate", box_of(Vec3(-0.2, -0.2, 0), Vec3(0.2, 0.2, 1.5)), way_of(12, [](double at) {
                     const double away_m = at < 4 ? 1.0 : at < 8 ? 0.35 : 2.0;
                     return Pose{Vec3(away_m, away_m, 1), 0, 0, 0};
                   }));
  scene.add_transmitter(mast(Vec3(-5, 5, 1.5)));
  scene.add_receiver(device_at("post", Vec3(5, -5, 1.5)));
  check_drive(scene, {0, 0, 1, 1}, 12);
}

TEST_CASE("a coordinate of -0 is not one of 0") {
  Scene scene = scene_of(street());
  scene.add_transmitter(mast(Vec3(-10, 0, 5)));
  scene.add_receiver(
      moving_device("rx", way_over({Pose{Vec3(10, 0.0, 2), 0, 0, 0}, Pose{Vec3(10, -0.0, 2), 0, 0, 0}})));
  MemoryTrial trial(scene, memory_settings(with_edges));
  for (const double time_s : {0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 2.0}) trial.advance_to(time_s);
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().taken_over > 0);
}

TEST_CASE("a receiver slides along a wall, 1 mm from it, 1 mm a frame") {
  for (const double away_m : {1e-3, 1.5e-4, 1e-5}) {
    CAPTURE(away_m);
    Scene scene = scene_of(street());
    scene.add_transmitter(mast());
    const double y = 6.0 - away_m;  // past the line at which two houses meet
    scene.add_receiver(moving_device("rx", straight_way(61, Vec3(-4.03, y, 1.5), Vec3(-3.97, y, 1.5))));
    scene.add_receiver(moving_device("up", straight_way(61, Vec3(-8, y, 8.97), Vec3(-8, y, 9.03))));
    check_drive(scene, with_edges, 61);
  }
}

TEST_CASE("legs graze walls, roofs and the ground") {
  Scene scene = scene_of(street());
  scene.add_transmitter(mast(Vec3(-25, 5.9995, 9.0005)));  // a hair from the planes of a wall and of a roof
  scene.add_receiver(moving_device("wall", straight_way(60, Vec3(12, 5.99, 3), Vec3(12, 6.01, 3))));
  scene.add_receiver(moving_device("roof", straight_way(60, Vec3(12, 9, 8.99), Vec3(12.3, 9, 9.01))));
  scene.add_receiver(moving_device("ground", straight_way(60, Vec3(20, 0, 2e-4), Vec3(20.5, 1, 2e-3))));
  check_drive(scene, with_edges, 60);
}

TEST_CASE("scenes that are turned, about any axis") {
  std::vector<std::size_t> paths;
  for (const double turn_rad : {0.0, 0.4, 2.1}) {
    const Mat3 turn = rotation_about(Vec3(0.2, -0.5, 1), turn_rad);
    TriangleMesh mesh = street();
    for (Vec3& vertex_m : mesh.vertices_m) vertex_m = turn * vertex_m;
    Scene scene = scene_of(mesh);
    scene.add_transmitter(mast(turn * Vec3(-22, 1, 9)));
    scene.add_receiver(
        moving_device("rx", straight_way(40, turn * Vec3(-6.05, 0.3, 1.5), turn * Vec3(-3.1, 1.2, 1.6))));
    paths.push_back(check_drive(scene, with_edges, 40).paths);
  }
  CHECK(paths[1] == paths[0]);
  CHECK(paths[2] == paths[0]);
}

TEST_CASE("edges that two houses share, facades in one plane, and faces that are there twice") {
  TriangleMesh mesh = street();
  add_box_faces(mesh, Vec3(9, 6, 0), Vec3(15, 14, 6), "opaque");  // goes on where a house ends, as high
  for (const char* material : {"opaque", "glass", "metal"}) {
    add_sheet(mesh, Vec3(0, -6, 3), Vec3(3, 0, 0), Vec3(0, 0, 2), material);
    add_sheet(mesh, Vec3(2, 6, 3), Vec3(4, 0, 0), Vec3(0, 0, 2), material);
  }
  Scene scene = scene_of(mesh);
  scene.add_object("plate", box_of(Vec3(-2, -0.1, 0), Vec3(2, 0, 3), "alpha"), way_of(50, [](double at) {
                     return Pose{Vec3(-4 + 0.2 * at, 6.0, 1), 0, 0, 0};
                   }));
  scene.add_transmitter(mast());
  scene.add_receiver(device_at("post", Vec3(11, -2, 2)));
  scene.add_receiver(moving_device("rx", straight_way(50, Vec3(5, 0, 1.5), Vec3(9.5, 0.5, 1.5))));
  check_drive(scene, with_edges, 50);
  check_drive(scene, through_sheets, 30);
}

TEST_CASE("cars that touch each other, the ground and walls") {
  Scene scene = scene_of(street());
  const TriangleMesh flat_car = box_of(Vec3(-2, -1, 0), Vec3(2, 1, 1.5));
  for (const double gap_m : {0.0, 5e-5}) {
    const std::string side = gap_m == 0.0 ? "left" : "right";
    const double sign = gap_m == 0.0 ? 1.0 : -1.0;
    scene.add_object(side + " parked", flat_car, LinearMotion{{Vec3(2, sign * (5 - gap_m), 0), 0, 0, 0}});
    scene.add_object(side + " comes", flat_car, way_of(24, [&](double at) {
                       return Pose{Vec3(-2 - gap_m - 0.5 * std::abs(at - 12), sign * (5 - gap_m), 0), 0, 0, 0};
                     }));
  }
  scene.add_transmitter(mast());
  scene.add_transmitter(device_at("lamp", Vec3(14, 0, 5), 30.0));
  scene.add_receiver(device_at("post", Vec3(7, 1, 1.2)));
  scene.add_receiver(device_at("on the roof", Vec3(2, 5, 1.5)));
  scene.add_receiver(moving_device("walker", straight_way(24, Vec3(-9, 3, 1.5), Vec3(-6, 3.2, 1.5))));
  check_drive(scene, with_edges, 24);
}

TEST_CASE("receivers through walls, under roofs and across corners") {
  Scene scene = scene_of(street());
  scene.add_transmitter(mast());
  scene.add_receiver(moving_device("into", straight_way(50, Vec3(-6, 5, 1.5), Vec3(-5.5, 7, 1.5))));
  scene.add_receiver(moving_device("out", straight_way(50, Vec3(9.6, 6.6, 3), Vec3(8.4, 5.4, 3))));
  scene.add_receiver(moving_device("up", straight_way(50, Vec3(-10, 10, 8), Vec3(-10.4, 10.1, 10))));
  check_drive(scene, with_edges, 50);
  check_drive(scene, {2, 2, 1, 2}, 50);
}

TEST_CASE("ways that weave, climb, and turn beside an edge: of a corridor the outermost corner counts, not the end") {
  Scene scene = scene_of(street());
  scene.add_transmitter(mast());
  scene.add_receiver(moving_device("weaves", way_of(60, [](double at) {
                                     return Pose{Vec3(-3 + 0.15 * at, std::sin(0.4 * at), 1.5), 0, 0, 0};
                                   })));
  scene.add_receiver(moving_device("climbs", way_of(60, [](double at) {
                                     return Pose{Vec3(0.1 * at, 2, 0.5 + 0.08 * at), 0, 0, 0};
                                   })));
  scene.add_receiver(moving_device("lift", straight_way(60, Vec3(6, 0, 0.4), Vec3(6, 0, 9))));
  scene.add_receiver(moving_device("beside an edge", way_of(60, [](double at) {
                                     const double turn = 0.05 * at;
                                     return Pose{Vec3(9 + 0.3 * std::cos(turn), 6 + 0.3 * std::sin(turn), 2), 0, 0, 0};
                                   })));
  check_drive(scene, with_edges, 60);
}

TEST_CASE("receivers level with the roofs of cars, and with shelves in front of them") {
  // Of a roof that is hidden from all of a place in general, one point in its plane may see all along a shelf.
  for (const double weld_m : {1e-4, 5e-3}) {
    CAPTURE(weld_m);
    for (const double over_m : {0.0, 1e-7, 1e-5, 2e-4, 1e-3, -3e-3, 0.02, -0.05}) {
      CAPTURE(over_m);
      TriangleMesh mesh = street();
      for (const double x : {-2.0, 0.5, 3.0}) {
        add_sheet(mesh, Vec3(x, 0.5 * x, 1.5), Vec3(0.9, 0, 0), Vec3(0, 1.4, 0), x < 0.0 ? "metal" : "opaque");
      }
      add_box_faces(mesh, Vec3(5.5, -2, 0), Vec3(6, 2, 1.5), "opaque");
      Scene scene = scene_with(mesh, {weld_m, 1e-3});
      scene.add_object("comes", car(), straight_way(40, Vec3(12, -1, 0), Vec3(8, 1.5, 0)));
      scene.add_object("tilts", car(), way_of(40, [](double at) {
                         return Pose{Vec3(12, 3, 0), 0.05 * at, 1e-4 * at - 2e-3, 0};
                       }));
      scene.add_object("slides", car(), straight_way(40, Vec3(1, -4, 0), Vec3(3, -4, 0)));
      scene.add_transmitter(mast(Vec3(16, 1, 4)));
      scene.add_receiver(
          moving_device("level", straight_way(40, Vec3(-8, 0, 1.5 + over_m), Vec3(-4.1, 0.4, 1.5 + over_m))));
      scene.add_receiver(
          moving_device("sinks", straight_way(40, Vec3(-8, -2, 1.5 + over_m), Vec3(-6, -2, 1.5 - over_m))));
      check_drive(scene, with_edges, 40);
    }
  }
}

TEST_CASE("a sign behind a wall that hides it from all of a place, but for a leg that ignores the wall close to it") {
  // The wall crosses the sign's plane at 5 degrees, a metre before the sign begins, and the receiver is on its other
  // side. With a tolerance of 5 mm a leg that comes in 5 cm beside the sign's plane crosses the wall where it is as
  // close to that plane, and counts as a part of the sign.
  const double slope = std::tan(5 * pi / 180);
  TriangleMesh mesh;
  add_quad(mesh,
           {Vec3(-10, 10 * slope, 0), Vec3(45, -45 * slope, 0), Vec3(45, -45 * slope, 18), Vec3(-10, 10 * slope, 18)},
           "opaque");
  Scene scene = scene_with(mesh, {5e-3, 1e-3});
  TriangleMesh sign;
  add_quad(sign, {Vec3(1.2, 0, -0.9), Vec3(4, 0, -0.9), Vec3(4, 0, 0.9), Vec3(1.2, 0, 0.9)}, "metal");
  scene.add_object("sign", sign, straight_way(100, Vec3(0, 0, 9), Vec3(0, 0, 9.3)));
  scene.add_transmitter(mast(Vec3(40, 0.0889, 9)));
  scene.add_receiver(moving_device("rx", straight_way(100, Vec3(-20.8, 0.05, 9), Vec3(-19.2, 0.05, 9))));
  MemoryTrial trial(scene, memory_settings(mirrors_alone));
  trial.follow(100);
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().paths > 20);  // it comes, and goes behind the wall
  CHECK(trial.tally().paths < 90);
}

TEST_CASE("crowns, panes and a rider's own car move through legs") {
  Scene scene = scene_of(street());
  scene.add_material({"leaves", Foliage{2.0}});
  for (const char* material : {"glass", "wall", "leaves"}) {
    scene.add_object(material, box_of(Vec3(-1, -1, 0), Vec3(1, 1, 2.5), material), way_of(24, [&](double at) {
                       return Pose{Vec3(material[0] == 'g' ? 6 - 0.5 * at : -6 + 0.5 * at, 0, 0), 0.1 * at, 0, 0};
                     }));
  }
  scene.add_object("car", car(), straight_way(24, Vec3(-12, -3, 0), Vec3(4, -3, 0)));
  scene.add_transmitter(mast());
  scene.add_transmitter(riding_device("rider", "car", Vec3(0, 0, 1.6)));
  scene.add_receiver(device_at("post", Vec3(9, -2, 1.2)));
  scene.add_receiver(device_at("within", Vec3(0, 0, 1.2)));
  scene.add_receiver(riding_device("sees its car", "car", Vec3(0.5, 0, 1.7), true));
  check_drive(scene, through_sheets, 24);
}

TEST_CASE("a pane drives off from legs that a pane of the scenery crosses, too") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  add_sheet(mesh, Vec3(0, 0, 2), Vec3(0, 5, 0), Vec3(0, 0, 2), "glass");
  Scene scene = scene_of(mesh);
  TriangleMesh pane;
  add_sheet(pane, Vec3(0.0), Vec3(0, 2, 0), Vec3(0, 0, 2), "wall");
  scene.add_object("pane", pane, way_of(10, [](double at) {
                     return Pose{Vec3(3, at < 3 || at == 6 ? 0 : 9, 2), 0, 0, 0};
                   }));
  scene.add_transmitter(mast(Vec3(-8, 0, 3)));
  scene.add_receiver(device_at("post", Vec3(8, 0.5, 2)));
  check_drive(scene, {2, 1, 1, 2}, 10);
}

}  // namespace test_memory_adversaries
