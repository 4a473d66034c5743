/// Random drives by the hundred, through towns that are clean, turned, on a grid, or dirty: what is remembered changes
/// no bit of any frame. From scratch these towns are searched by trying all sequences.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/paths/halves/small_town.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_drives_slow {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 24;

/// Ground, houses side by side and apart, sheets, some of them twice or a hair apart; every vertex may be off a little.
TriangleMesh dirty_town(Draw& draw) {
  TriangleMesh mesh;
  const double dirt_m = draw.magnitude(1e-6, 6e-4);
  add_tiled_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), 1 + static_cast<int>(draw.below(3)), "opaque");
  Vec3 low_m(draw.between(-20, -8), draw.between(-20, 10), 0);
  for (std::size_t house = 0, houses = 1 + draw.below(3); house < houses; ++house) {
    const Vec3 size_m(draw.between(3, 8), draw.below(2) == 0 ? 6.0 : draw.between(3, 8), draw.between(3, 9));
    add_box_faces(mesh, low_m, low_m + size_m, draw.below(2) == 0 ? "metal" : "opaque");
    low_m.x += size_m.x + (draw.below(2) == 0 ? 0.0 : draw.magnitude(1e-5, 3.0));
  }
  for (std::size_t sheet = 0, sheets = 1 + draw.below(3); sheet < sheets; ++sheet) {
    const Vec3 middle_m = draw.inside(Vec3(-15, -15, 1), Vec3(15, 15, 4)), along = draw.direction();
    const Vec3 level = glm::normalize(Vec3(along.x, along.y, 0));
    const std::size_t layers = 1 + draw.below(3);
    const double half_m = draw.between(1, 4);
    const std::vector<std::string> materials{"glass", "wall", "alpha", "metal", "opaque"};
    for (std::size_t layer = 0; layer < layers; ++layer) {
      const Vec3 across(-level.y, level.x, 0);
      add_tiled_sheet(mesh, middle_m + draw.between(-2e-4, 2e-4) * across,
                      half_m * level + draw.between(0, 2e-3) * across, Vec3(0, 0, 1.5),
                      1 + static_cast<int>(draw.below(2)), materials[draw.below(5)]);
    }
  }
  if (draw.below(3) == 0) return mesh;
  for (Vec3& vertex_m : mesh.vertices_m) vertex_m += draw.inside(Vec3(-dirt_m), Vec3(dirt_m));
  return mesh;
}

/// A way with steps of all sizes, mostly straight on; whole metres where the town is on a grid.
WaypointMotion wandering(Draw& draw, double height_m, double largest_step_m, bool on_grid) {
  const auto somewhere = [&] {
    const Vec3 at_m = draw.inside(Vec3(-14, -14, height_m), Vec3(14, 14, height_m + 0.01));
    return on_grid ? glm::round(at_m) + Vec3(0, 0, 1) : at_m;
  };
  double heading_rad = on_grid ? 0.5 * pi * static_cast<double>(draw.below(4)) : draw.between(-pi, pi);
  double step_m = draw.magnitude(1e-3, largest_step_m), turn_rad = 0.0, climb = 0.0;
  Pose pose{somewhere(), 0, 0, 0};
  return way_of(frames, [&](double) {
    if (!on_grid) pose.yaw_rad = heading_rad;
    const Pose now = pose;
    const std::size_t event = draw.below(24);
    if (event == 0) step_m = draw.below(2) == 0 ? 0.0 : draw.magnitude(1e-4, largest_step_m);
    if (event == 1 && !on_grid) turn_rad = draw.between(-0.2, 0.2);
    if (event == 2) pose.position_m = somewhere();
    if (event == 3) step_m = -step_m;
    if (event == 4) climb = draw.between(-0.3, 0.3);
    if (step_m != 0.0) heading_rad += turn_rad;
    const Vec3 ahead(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    pose.position_m += step_m * (on_grid ? glm::round(ahead) : ahead);
    pose.position_m.z = std::max(0.02, pose.position_m.z + step_m * climb);
    return now;
  });
}

/// Everything by the turn of a town.
void turn(Motion& motion, const Mat3& by) {
  for (auto& waypoint : std::get<WaypointMotion>(motion).waypoints) {
    waypoint.pose.position_m = by * waypoint.pose.position_m;
  }
}

struct Drive {
  Scene scene;
  SimulationSettings settings;
};

Scene town_of(Draw& draw, std::size_t kind, const Mat3& by) {
  if (kind == 0) return small_town(draw);
  if (kind == 1) return town_on_grid(draw);
  TriangleMesh mesh = dirty_town(draw);
  for (Vec3& vertex_m : mesh.vertices_m) vertex_m = by * vertex_m;
  Scene scene = scene_of(mesh);
  return scene;
}

Drive drive_of(Draw& draw) {
  const std::size_t kind = draw.below(4);
  const bool on_grid = kind == 1;
  const Mat3 by = kind == 3 ? rotation_about(draw.direction(), draw.between(0, pi)) : Mat3(1.0);
  Drive drive{town_of(draw, kind, by), {}};
  Scene& scene = drive.scene;
  scene.add_material({"leaves", Foliage{2.0}});
  const auto way = [&](double height_m, double step_m) {
    Motion motion = wandering(draw, height_m, step_m, on_grid);
    turn(motion, by);
    return motion;
  };
  std::vector<std::string> cars;
  for (std::size_t car = 0, count = draw.below(4); car < count; ++car) {
    const std::vector<std::string> materials{"metal", "metal", "glass", "opaque", "leaves"};
    TriangleMesh mesh;
    add_box_faces(mesh, Vec3(-2, -1, 0), Vec3(2, 1, 1.5), materials[draw.below(5)]);
    cars.push_back("car " + std::to_string(car));
    scene.add_object(cars.back(), mesh, way(0.02, draw.below(3) == 0 ? 1e-9 : 1.5));
  }
  scene.add_transmitter(device_at("mast", by * draw.inside(Vec3(-20, -20, 8), Vec3(20, 20, 14)), 30.0));
  scene.add_transmitter(draw.below(2) == 0
                            ? moving_device("sender", way(1.7, 1.0))
                            : device_at("lamp", by * draw.inside(Vec3(-15, -15, 2), Vec3(15, 15, 6)), 30.0));
  scene.add_receiver(device_at("post", by * draw.inside(Vec3(-18, -18, 1), Vec3(18, 18, 3))));
  scene.add_receiver(moving_device("walker", way(1.5, 0.1)));
  scene.add_receiver(moving_device("driver", way(1.2, 1.9)));
  for (std::size_t car = 0; car < cars.size(); ++car) {
    Device rider = riding_device("rider " + cars[car], cars[car], Vec3(0.3, 0, 1.6), draw.below(2) == 0);
    if (draw.below(2) == 0) continue;
    if (draw.below(2) == 0)
      scene.add_transmitter(rider);
    else
      scene.add_receiver(rider);
  }
  const std::vector<MemoryOrders> orders{{2, 0, 1, 2}, {2, 0, 1, 2}, {2, 2, 1, 2},       {2, 0, 0, 2},
                                         {1, 1, 1, 2}, {1, 0, 1, 1}, {2, 1, 1, 2, true}, {1, 0, 2, 2}};
  drive.settings = memory_settings(orders[draw.below(orders.size())]);
  if (draw.below(8) == 0) drive.settings.propagation.diffraction.region = DiffractionRegion::shadow;
  drive.settings.threads = draw.below(8) == 0 ? 3 : 1;
  return drive;
}

void check_drive(std::uint64_t seed, MemoryTally& sum) {
  Draw draw(seed);
  const Drive drive = drive_of(draw);
  MemoryTrial trial(drive.scene, drive.settings, false);
  std::vector<bool> away(drive.scene.bodies().size(), false);
  CAPTURE(seed);
  double time_s = 0.0;
  for (std::size_t index = 0; index < frames; ++index) {
    if (draw.below(6) != 0) time_s += draw.below(4) == 0 ? 0.1 : 1.0;
    if (draw.below(40) == 0) time_s = draw.between(0, frames);
    Frame frame = drive.scene.frame_at(std::min(time_s, static_cast<double>(frames)), index);
    for (std::size_t body = 1; body < away.size(); ++body) {
      if (draw.below(15) == 0) away[body] = !away[body];
      frame.bodies[body].present = !away[body];
    }
    trial.advance(frame);
  }
  sum.frames += trial.tally().frames;
  sum.links += trial.tally().links;
  sum.paths += trial.tally().paths;
  sum.taken_over += trial.tally().taken_over;
  sum.different += trial.tally().different;
}

}  // namespace

TEST_CASE("memory changes no bit of hundreds of random drives") {
  MemoryTally sum;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) check_drive(seed, sum);
  MESSAGE(sum.frames << " frames, " << sum.links << " links, " << sum.paths << " paths, " << sum.taken_over
                     << " taken over");
  CHECK(sum.different == 0);
  CHECK(sum.paths > 100'000);
  CHECK(sum.taken_over > 10'000);  // or nothing was remembered
}

}  // namespace test_memory_drives_slow
