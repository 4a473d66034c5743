/// Three interactions of receivers that walk: what is known of the places that they walk through changes no bit. From
/// scratch these small streets are searched by trying all sequences.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/paths/halves/small_street.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_of_walkers {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 40;

/// Walks on, turning a little, up and down a little; one in three seldom runs, jumps, turns round or stands for some
/// frames, too.
WaypointMotion walk(Draw& draw) {
  Vec3 at_m = draw.inside(Vec3(-8, -3, 0.5), Vec3(8, 3, 2));
  double step_m = draw.magnitude(0.02, 0.5), yaw_rad = draw.between(-pi, pi);
  const double climb = draw.below(3) == 0 ? draw.between(-0.1, 0.1) : 0.0;
  const bool is_calm = draw.below(3) != 0;
  const auto seldom = [&, is_calm](std::size_t one_in) { return !is_calm && draw.below(one_in) == 0; };
  std::size_t waits = 0;
  return way_of(frames + 1, [&](double) {
    if (seldom(16)) yaw_rad += pi;
    if (seldom(24)) at_m = draw.inside(Vec3(-8, -3, 0.5), Vec3(8, 3, 2));
    yaw_rad += draw.between(-0.05, 0.05);
    if (seldom(16)) waits = 1 + draw.below(4);
    const double fast = seldom(16) ? 4.0 : 1.0;
    if (waits == 0) at_m += fast * step_m * Vec3(std::cos(yaw_rad), std::sin(yaw_rad), climb);
    waits -= waits > 0 ? 1 : 0;
    return Pose{at_m, 0, 0, 0};
  });
}

/// Goes straight on, some frames each time, and then a step aside, up or down, or round a corner.
WaypointMotion walk_straight(Draw& draw) {
  Vec3 at_m = draw.inside(Vec3(-8, -3, 0.5), Vec3(8, 3, 2));
  const double step_m = draw.magnitude(0.02, 0.3);
  double yaw_rad = draw.between(-pi, pi);
  std::size_t left = 16;  // until then it is in a place
  return way_of(frames + 1, [&](double) {
    const Vec3 ahead(std::cos(yaw_rad), std::sin(yaw_rad), 0), aside(-ahead.y, ahead.x, 0);
    at_m += step_m * ahead;
    if (left-- > 0) return Pose{at_m, 0, 0, 0};
    left = 3 + draw.below(8);
    const std::size_t how = draw.below(4);
    if (how < 2) at_m += draw.magnitude(0.02, 0.5) * (draw.below(2) == 0 ? aside : -aside);
    if (how == 2) at_m.z += draw.between(-0.08, 0.08);
    if (how == 3) yaw_rad += draw.between(-1, 1);
    return Pose{at_m, 0, 0, 0};
  });
}

template <typename Walk>
Scene walked_street(Draw& draw, Walk&& walk) {
  Scene scene = small_street(draw);
  const std::size_t cars = draw.below(3);
  for (std::size_t car = 0; car < cars; ++car) {
    TriangleMesh mesh;
    add_box_faces(mesh, Vec3(-1.5, -0.8, 0), Vec3(1.5, 0.8, 1.4), draw.below(4) == 0 ? "glass" : "metal");
    const Vec3 from_m = draw.inside(Vec3(-9, -3, 0.02), Vec3(9, 3, 0.03));
    const Vec3 to_m = draw.below(3) == 0 ? from_m : draw.inside(Vec3(-9, -3, 0.02), Vec3(9, 3, 0.03));
    scene.add_object(car == 0 ? "two" : "three", mesh, straight_way(frames + 1, from_m, to_m));
  }
  scene.add_transmitter(device_at("mast", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)), 30.0));
  if (draw.below(4) == 0) scene.add_transmitter(moving_device("sender", walk(draw)));
  if (draw.below(4) == 0) scene.add_transmitter(device_at("lamp", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 5)), 20.0));
  scene.add_receiver(moving_device("walker", walk(draw)));
  if (draw.below(3) == 0) scene.add_receiver(moving_device("other", walk(draw)));
  if (cars > 0 && draw.below(3) == 0) {
    scene.add_receiver(riding_device("rider", "two", Vec3(0, 0, 1.6), draw.below(2) == 0));
  }
  return scene;
}

template <typename Walk>
MemoryTally follow_walk(std::uint64_t seed, Walk&& walk) {
  Draw draw(seed);
  const Scene scene = walked_street(draw, walk);
  const std::vector<MemoryOrders> orders{{3, 0, 1, 3}, {2, 0, 1, 3},       {2, 1, 1, 3},
                                         {3, 0, 0, 3}, {2, 0, 1, 3, true}, {2, 2, 1, 3}};
  SimulationSettings settings = memory_settings(orders[draw.below(orders.size())]);
  settings.threads = draw.below(3) == 0 ? 2 : 1;
  if (draw.below(4) == 0) settings.propagation.max_path_length_m = draw.between(10.0, 60.0);
  MemoryTrial trial(scene, settings);
  REQUIRE(trial.own().cache() == CacheMode::exact);
  CAPTURE(seed);
  for (std::size_t index = 0; index < frames; ++index) {
    Frame frame = scene.frame_at(static_cast<double>(index), index);
    if (draw.below(48) == 0 && frame.bodies.size() > 1) frame.bodies[1].present = false;
    trial.advance(frame);
  }
  return trial.tally();
}

/// Everybody walks, most of the time straight on: nobody has candidates, all are in places of their own.
MemoryTally follow_all_walking(std::uint64_t seed) {
  Draw draw(seed);
  Scene scene = small_street(draw);
  const auto way = [&] {
    Vec3 at_m = draw.inside(Vec3(-6, -3, 0.5), Vec3(6, 3, 2));
    const double step_m = draw.magnitude(0.01, 0.2), turn_rad = draw.below(2) == 0 ? draw.between(-0.004, 0.004) : 0.0;
    double yaw_rad = draw.between(-pi, pi);
    return way_of(frames + 1, [&, at_m, step_m, turn_rad, yaw_rad](double) mutable {
      yaw_rad += turn_rad;
      return Pose{at_m += step_m * Vec3(std::cos(yaw_rad), std::sin(yaw_rad), 0), 0, 0, 0};
    });
  };
  scene.add_transmitter(moving_device("sender", way()));
  scene.add_receiver(moving_device("walker", way()));
  scene.add_receiver(moving_device("other", way()));
  const std::vector<MemoryOrders> orders{{2, 0, 1, 2}, {2, 0, 1, 3}, {3, 0, 1, 3}, {2, 1, 1, 2}};
  MemoryTrial trial(scene, memory_settings(orders[draw.below(orders.size())]));
  CAPTURE(seed);
  trial.follow(frames);
  return trial.tally();
}

}  // namespace

TEST_CASE("memory changes no bit of walks through random streets, over three interactions") {
  check_drives(24, [](std::uint64_t seed) { return follow_walk(seed, walk); });
}

TEST_CASE("nor of walks straight on that step aside") {
  check_drives(24, [](std::uint64_t seed) { return follow_walk(seed, walk_straight); });
}

TEST_CASE("nor where both ends walk") {
  MemoryTally sum;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) sum += follow_all_walking(seed);
  MESSAGE(sum.frames << " frames, " << sum.paths << " paths, " << sum.different << " different");
  CHECK(sum.different == 0);
  CHECK(sum.paths > 10'000);
}

}  // namespace test_memory_of_walkers
