/// What is remembered from frame to frame changes no bit: each frame is as it is from scratch, however ends and bodies
/// move, stop, come, go and jump. From scratch these small towns are searched by trying all sequences, so the memory is
/// held against another search, too.
#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "dcem/sim/basic_simulator.hpp"
#include "tests/paths/halves/small_town.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_exact_memory {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A way through a town: some steps are small, some are none, some are jumps.
WaypointMotion wandering(Draw& draw, std::size_t frames, double height_m, double largest_step_m) {
  WaypointMotion motion;
  Pose pose{draw.inside(Vec3(-18, -18, height_m), Vec3(18, 18, height_m + 0.01)), draw.between(-pi, pi), 0, 0};
  double step_m = draw.magnitude(1e-3, largest_step_m), turn_rad = 0.0;
  for (std::size_t frame = 0; frame <= frames; ++frame) {
    motion.waypoints.push_back({static_cast<double>(frame), pose});
    const std::size_t event = draw.below(12);
    if (event == 0) step_m = draw.below(2) == 0 ? 0.0 : draw.magnitude(1e-3, largest_step_m);
    if (event == 1) turn_rad = draw.between(-0.3, 0.3);
    if (event == 2) pose.position_m = draw.inside(Vec3(-18, -18, height_m), Vec3(18, 18, height_m + 3));
    if (event == 3) step_m = -step_m;
    pose.yaw_rad += turn_rad * (step_m != 0.0 ? 1.0 : 0.0);
    pose.position_m += step_m * Vec3(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad), 0.0);
  }
  return motion;
}

Device moving(const std::string& id, const Motion& motion) {
  Device device = device_at(id, Vec3(0.0), 30.0);
  device.motion = motion;
  return device;
}

/// A town through which cars drive, with devices of all kinds.
Scene busy_town(Draw& draw, std::size_t frames) {
  Scene scene = small_town(draw);
  for (const char* name : {"three", "four"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), draw.below(3) == 0 ? "glass" : "metal");
    scene.add_object(name, car, wandering(draw, frames, 0.02, 1.5));
  }
  scene.add_transmitter(device_at("mast", draw.inside(Vec3(-20, -20, 8), Vec3(20, 20, 14)), 30.0));
  scene.add_transmitter(moving("sender", wandering(draw, frames, 1.7, 1.0)));
  Device rider = device_at("rider", Vec3(0.0), 20.0);
  rider.attachment = Attachment{"three", Vec3(0.3, 0.0, 1.6), draw.below(2) == 0};
  scene.add_transmitter(rider);
  scene.add_receiver(device_at("post", draw.inside(Vec3(-18, -18, 1), Vec3(18, 18, 3))));
  scene.add_receiver(moving("walker", wandering(draw, frames, 1.5, 0.3)));
  scene.add_receiver(moving("driver", wandering(draw, frames, 1.2, 2.0)));
  rider.id = "passenger";
  rider.attachment = Attachment{"four", Vec3(0.0, 0.2, 1.7), draw.below(2) == 0};
  scene.add_receiver(rider);
  return scene;
}

struct Case {
  int reflections, transmissions, diffractions, interactions;
  bool free_edges = false;
};

SimulationSettings settings_of(const Case& orders, CacheMode cache) {
  SimulationSettings settings;
  settings.frequency_hz = 5e9;
  settings.threads = 1;
  PropagationSettings& propagation = settings.propagation;
  propagation.max_reflections = orders.reflections;
  propagation.max_transmissions = orders.transmissions;
  propagation.max_diffractions = orders.diffractions;
  propagation.max_interactions = orders.interactions;
  propagation.diffraction.free_edges = orders.free_edges;
  propagation.cache = cache;
  return settings;
}

/// What all frames of one drive came to.
struct Tally {
  std::size_t frames = 0, links = 0, paths = 0, taken_over = 0;
};

/// Follows a drive with and without memory; bodies come and go, and some frames are as the one before.
void compare(std::uint64_t seed, const Case& orders, Tally& tally,
             double remembered_bytes = std::numeric_limits<double>::infinity()) {
  constexpr std::size_t frames = 14;
  Draw draw(seed);
  const Scene scene = busy_town(draw, frames);
  SimulationSettings settings = settings_of(orders, CacheMode::exact);
  settings.most_remembered_bytes = remembered_bytes;
  if (seed % 3 > 0) settings.expected_frames = seed % 3 == 1 ? frames : 1'000'000;
  Simulator remembering(scene, settings);
  Simulator from_scratch(scene, settings_of(orders, CacheMode::off));
  REQUIRE(remembering.cache() == CacheMode::exact);
  std::vector<bool> away(scene.bodies().size(), false);
  double time_s = 0.0;
  for (std::size_t index = 0; index < frames; ++index) {
    if (draw.below(4) != 0) time_s += draw.below(3) == 0 ? 0.1 : 1.0;
    Frame frame = scene.frame_at(std::min(time_s, static_cast<double>(frames)), index);
    for (std::size_t body = 1; body < away.size(); ++body) {
      if (draw.below(10) == 0) away[body] = !away[body];
      frame.bodies[body].present = !away[body];
    }
    const FrameResult own = remembering.advance(frame), expected = from_scratch.advance(frame);
    ++tally.frames;
    tally.taken_over += own.cache.taken_over;
    REQUIRE(own.links.size() == expected.links.size());
    for (std::size_t link = 0; link < own.links.size(); ++link) {
      ++tally.links;
      tally.paths += expected.links[link].paths.size();
      const bool same = bits(scene, own.links[link]) == bits(scene, expected.links[link]);
      INFO("seed " << seed << ", frame " << index << ", link " << own.links[link].transmitter << " to "
                   << own.links[link].receiver << ": " << own.links[link].paths.size() << " paths, expected "
                   << expected.links[link].paths.size());
      CHECK(same);
    }
  }
}

}  // namespace

TEST_CASE("memory changes no bit of drives through random towns") {
  const std::vector<Case> cases{{2, 0, 1, 2},       {2, 2, 1, 2}, {2, 0, 0, 2}, {1, 1, 1, 2},
                                {2, 0, 2, 2, true}, {1, 0, 1, 1}, {2, 0, 1, 3}};
  Tally tally;
  std::uint64_t seed = 0;
  for (int round = 0; round < 3; ++round) {
    for (const Case& orders : cases) compare(++seed, orders, tally);
  }
  MESSAGE(tally.frames << " frames, " << tally.links << " links, " << tally.paths << " paths, " << tally.taken_over
                       << " taken over");
  CHECK(tally.paths > 10'000);
  CHECK(tally.taken_over > 500);  // or nothing was remembered
}

TEST_CASE("nor does it where only some receivers are remembered, or none") {
  const std::vector<Case> cases{{2, 2, 1, 2}, {2, 0, 2, 2, true}, {2, 0, 1, 3}};
  Tally tally;
  std::uint64_t seed = 100;
  for (const Case& orders : cases) {
    for (const double remembered_bytes : {0.0, 8e6, 25e6}) compare(++seed, orders, tally, remembered_bytes);
  }
  CHECK(tally.paths > 3'000);
  CHECK(tally.taken_over > 100);  // what nothing has changed is taken over all the same
}

}  // namespace test_exact_memory
