/// What is remembered of a sequence that carries no path: why, and how far the receiver may go until that is asked
/// again. Each of these ends in the middle of a way.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/paths/small_scenes.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_refusals {

using namespace dcem;
using namespace dcem::test;

namespace {

const MemoryOrders with_edges{2, 0, 1, 2};

TriangleMesh box_of(const Vec3& low_m, const Vec3& high_m, const std::string& material = "metal") {
  TriangleMesh mesh;
  add_box_faces(mesh, low_m, high_m, material);
  return mesh;
}

/// Follows a drive; the number of paths must change in the middle of it, and memory must have spared work.
void check_changes(const Scene& scene, std::size_t frames, std::size_t least_changes = 1,
                   const MemoryOrders& orders = with_edges) {
  MemoryTrial trial(scene, memory_settings(orders));
  std::size_t changes = 0, before = 0;
  for (std::size_t index = 0; index < frames; ++index) {
    const std::size_t paths = trial.advance_to(static_cast<double>(index), index).links[0].paths.size();
    if (index > 8 && paths != before) ++changes;  // by then what the transmitter reaches is listed
    before = paths;
  }
  CHECK(trial.tally().different == 0);
  CHECK(trial.has_remembered());
  CHECK(changes >= least_changes);
}

}  // namespace

TEST_CASE("a car drives off from a leg of a receiver that creeps") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-20, 6, 0), Vec3(-4, 14, 9), "metal");
  Scene scene = scene_of(mesh);
  scene.add_object("car", box_of(Vec3(-2, -0.9, 0.1), Vec3(2, 0.9, 1.5)), way_of(40, [](double at) {
                     return Pose{Vec3(-3.2, at < 25 ? 0 : at < 30 ? 3 : 0, 0), 0, 0, 0};
                   }));
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  scene.add_receiver(moving_device("creeps", straight_way(40, Vec3(0, 0, 1.5), Vec3(0.2, 0, 1.5))));
  check_changes(scene, 40, 2);
}

TEST_CASE("a gap between houses opens when the receiver has left the place from which it was hidden") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(-30, 6, 0), Vec3(-4, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-1, 6, 0), Vec3(30, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-3, 22, 0), Vec3(-2, 24, 8), "opaque");
  add_box_faces(mesh, Vec3(3, 24, 0), Vec3(5, 25, 8), "metal");
  for (const double step_m : {0.02, 0.1, 0.3, 1.1}) {
    CAPTURE(step_m);
    const std::size_t frames = step_m < 0.05 ? 200 : 60;
    const double from_m = std::max(-14.0, -2.5 - 0.5 * step_m * static_cast<double>(frames));
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("mast", Vec3(-2.5, 60, 30), 30.0));
    scene.add_receiver(moving_device("rx", way_of(frames, [&](double at) {
                                       return Pose{Vec3(from_m + step_m * at, 2, 1.5), 0, 0, 0};
                                     })));
    check_changes(scene, frames);
  }
}

TEST_CASE("a point climbs an edge, out of the shadow of a wall, as the receiver climbs") {
  for (const double apart_m : {0.05, 1.0, 2.0}) {  // of the wall from the edge
    CAPTURE(apart_m);
    TriangleMesh mesh = box_of(Vec3(0, 0, -5), Vec3(5, 5, 40));
    add_sheet(mesh, Vec3(-30, 5, 0), Vec3(0, 12, 0), Vec3(0, 0, 12), "metal");  // lights the edge, too
    add_sheet(mesh, Vec3(-apart_m, 0.5 * apart_m, 0), Vec3(0, 3, 0), Vec3(0, 0, 6), "opaque");
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("mast", Vec3(-20, 10, 3), 30.0));
    for (const double step_m : {0.02, 0.1}) {
      scene.add_receiver(moving_device("rx " + std::to_string(step_m), way_of(140, [&](double at) {
                                         const double rise_m = step_m * at;
                                         return Pose{Vec3(3, -2, step_m < 0.05 ? 5.5 + rise_m : rise_m), 0, 0, 0};
                                       })));
    }
    check_changes(scene, 140, 0);
  }
}

TEST_CASE("a fence ends beside a receiver") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(-1.5, 0.1, 1.5), Vec3(1.5, 0, 0), Vec3(0, 0, 1.5), "opaque");
  for (const double y : {12.0, 16.0, 21.0}) {
    add_sheet(mesh, Vec3(-15, y, y - 10), Vec3(14, 0, 0), Vec3(0, 0, 1.8), "metal");
  }
  add_box_faces(mesh, Vec3(4, 8, 0), Vec3(6, 9, 5), "metal");
  for (const double step_m : {0.01, 0.03, 0.06}) {
    CAPTURE(step_m);
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("mast", Vec3(-30, 0.5, 4), 30.0));
    scene.add_receiver(moving_device("rx", way_of(100, [&](double at) {
                                       return Pose{Vec3(std::max(-2.8, -70 * step_m) + step_m * at, 0, 1.2), 0, 0, 0};
                                     })));
    check_changes(scene, 100);
  }
}

TEST_CASE("points run along mirrors far faster than the receiver, out from behind a wall") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(60, 0, 0), Vec3(0, 0, 6), "metal");    // y = 0
  add_sheet(mesh, Vec3(0, 30, 0), Vec3(60, 0, 0), Vec3(0, 0, 6), "opaque");  // y = 30
  add_sheet(mesh, Vec3(-5, 0.6, 0), Vec3(4, 0, 0), Vec3(0, 0, 6), "opaque");
  add_sheet(mesh, Vec3(10, 1.5, 0), Vec3(0, 1, 0), Vec3(0, 0, 6), "opaque");
  Scene scene = scene_of(mesh);
  scene.add_transmitter(device_at("mast", Vec3(-40, 0.8, 1), 30.0));
  scene.add_receiver(moving_device("nears the wall", straight_way(120, Vec3(30, 2.5, 1), Vec3(30, 0.2, 1))));
  scene.add_receiver(moving_device("along it", straight_way(120, Vec3(0, 0.9, 1), Vec3(30, 1.2, 1))));
  scene.add_receiver(moving_device("across", straight_way(120, Vec3(12, 28, 1), Vec3(14, 3, 1))));
  check_changes(scene, 120);
}

/// Along a wall at y = 0, 30 cm beside it, and after some frames 70.
WaypointMotion stepping_aside(double from_x_m, std::size_t when) {
  return way_of(64, [=](double at) {
    return Pose{Vec3(from_x_m + 0.14 * at, at < static_cast<double>(when) ? 0.3 : 0.7, 1.5), 0, 0, 0};
  });
}

TEST_CASE(
    "a receiver that has gone straight along a wall steps aside, and the point on the wall leaps by twenty metres") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(17.5, 0, 3), Vec3(17.5, 0, 0), Vec3(0, 0, 3), "metal");  // it ends 35 m from the mast
  add_box_faces(mesh, Vec3(60, -6, 0), Vec3(64, -5, 4), "metal");
  for (const std::size_t when : {20U, 26U, 30U, 34U, 43U, 46U, 50U}) {
    CAPTURE(when);
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("mast", Vec3(0, 0.3, 2), 30.0));
    scene.add_receiver(moving_device("rx", stepping_aside(98, when)));
    check_changes(scene, 64);
  }
}

TEST_CASE("nor is that lost where two more mirrors are on the way") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(-8.25, 0, 6.5), Vec3(11.25, 0, 0), Vec3(0, 0, 2.5), "metal");  // along which it goes
  add_sheet(mesh, Vec3(5, 0, 8.1), Vec3(0, 2, 0), Vec3(0, 0, 0.9), "metal");          // before and behind the mast
  add_sheet(mesh, Vec3(-20, 0, 6.5), Vec3(0, 2, 0), Vec3(0, 0, 1.5), "metal");
  for (const std::size_t when : {20U, 26U, 30U, 34U, 43U, 46U, 50U}) {
    CAPTURE(when);
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("mast", Vec3(0, 0.3, 8), 30.0));
    scene.add_receiver(moving_device("rx", stepping_aside(78, when)));
    check_changes(scene, 64, 1, {3, 0, 0, 3});
  }
}

TEST_CASE("a way whose middle point is not there yet comes into being while the receiver drives") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(1.5, 10, 3), Vec3(1, 0, 0), Vec3(0, 0, 3), "metal");
  add_sheet(mesh, Vec3(10, 0, 3), Vec3(10, 0, 0), Vec3(0, 0, 3), "metal");
  add_sheet(mesh, Vec3(0, 10, 3), Vec3(0, 10, 0), Vec3(0, 0, 3), "metal");
  Scene scene = scene_of(mesh);
  scene.add_transmitter(device_at("mast", Vec3(1, 5, 1.5), 30.0));
  scene.add_receiver(moving_device("rx", straight_way(81, Vec3(2, 2, 1.5), Vec3(6, 2, 1.5))));
  check_changes(scene, 81, 1, {3, 0, 0, 3});
}

TEST_CASE("a mast that is put up elsewhere while the receiver stays in its place") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-20, 6, 0), Vec3(-4, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-1, 6, 0), Vec3(9, 14, 6), "opaque");
  add_box_faces(mesh, Vec3(-15, -14, 0), Vec3(4, -6, 7), "metal");
  Scene scene = scene_of(mesh);
  scene.add_transmitter(moving_device("mast", way_of(64, [](double at) {
                                        const std::vector<Vec3> places_m{{-22, 1, 9}, {14, 1, 5}, {-2.5, 25, 12}};
                                        const auto place = static_cast<std::size_t>(at / 16) % places_m.size();
                                        return Pose{places_m[place], 0, 0, 0};
                                      })));
  scene.add_receiver(moving_device("creeps", straight_way(64, Vec3(0, 0, 1.5), Vec3(1.2, 0.2, 1.5))));
  scene.add_receiver(moving_device("walks", straight_way(64, Vec3(-7, 2, 1.5), Vec3(0, 3, 1.5))));
  check_changes(scene, 64, 3);
}

}  // namespace test_memory_refusals
