/// Receivers that come one after the other along the same way take over what is known of it: that changes no bit.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/paths/halves/small_street.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_of_columns {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 48;

/// A way through the street and back, at a pace, with stops: long enough that others can come behind.
std::vector<Vec3> way_through(Draw& draw, std::size_t steps) {
  const double step_m = draw.below(3) == 0 ? draw.between(0.02, 0.2) : draw.between(0.3, 1.2);
  Vec3 at_m = draw.inside(Vec3(-9, -2.5, 0.5), Vec3(-5, 2.5, 2));
  double yaw_rad = draw.between(-0.2, 0.2);
  std::vector<Vec3> way_m;
  std::size_t waits = 0;
  while (way_m.size() < steps) {
    way_m.push_back(at_m);
    if (draw.below(20) == 0) waits = draw.below(4);
    if (waits > 0) {
      --waits;
      continue;
    }
    if (std::abs(at_m.x) > 10.0) yaw_rad = at_m.x > 0.0 ? pi : 0.0;
    at_m += step_m * Vec3(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  }
  return way_m;
}

/// Somebody who is where the first one was some frames before, a hand's breadth aside.
WaypointMotion behind(const std::vector<Vec3>& way_m, std::size_t seen, std::size_t later, const Vec3& aside_m) {
  return way_of(seen + 1, [&](double at) {
    const auto index = static_cast<std::size_t>(at) + way_m.size() - seen - 1;
    return Pose{way_m[index - later] + aside_m, 0, 0, 0};
  });
}

/// Straight through the street and past it.
std::vector<Vec3> straight_way(Draw& draw, std::size_t steps) {
  const Vec3 from_m = draw.inside(Vec3(-48, -1, 0.5), Vec3(-43, 1, 2));
  const Vec3 step_m(draw.between(0.8, 1.2), draw.between(-0.02, 0.02), 0.0);
  std::vector<Vec3> way_m;
  while (way_m.size() < steps) way_m.push_back(from_m + static_cast<double>(way_m.size()) * step_m);
  return way_m;
}

template <typename WayOf>
void add_column(Draw& draw, Scene& scene, std::size_t seen, WayOf way_of_steps, bool is_alone = false) {
  const std::size_t gap = 3 + draw.below(6), count = is_alone ? 1 : 2 + draw.below(3);
  const std::vector<Vec3> way_m = way_of_steps(draw, seen + 1 + gap * count);
  for (std::size_t number = 0; number < count; ++number) {
    const Vec3 aside_m = number == 0 ? Vec3(0.0) : draw.inside(Vec3(-0.1, -0.1, -0.05), Vec3(0.1, 0.1, 0.05));
    scene.add_receiver(moving_device("follower" + std::to_string(number), behind(way_m, seen, gap * number, aside_m)));
  }
}

Scene column_in_street(Draw& draw) {
  Scene scene = small_street(draw);
  scene.add_transmitter(device_at("mast", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)), 30.0));
  if (draw.below(2) == 0) scene.add_transmitter(device_at("lamp", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 5)), 20.0));
  if (draw.below(2) == 0) {  // stands, is elsewhere for a frame or two, and stands again
    const Vec3 here_m = draw.inside(Vec3(-8, -3, 1), Vec3(8, 3, 5)),
               there_m = draw.inside(Vec3(-8, -3, 1), Vec3(8, 3, 5));
    const double from = 15.0 + static_cast<double>(draw.below(10)),
                 to = from + 1.0 + static_cast<double>(draw.below(2));
    scene.add_transmitter(moving_device("restless", way_of(frames + 1, [&](double at) {
                                          return Pose{at >= from && at < to ? there_m : here_m, 0, 0, 0};
                                        })));
  }
  add_column(draw, scene, frames, way_through);
  return scene;
}

MemoryTally follow_column(std::uint64_t seed) {
  Draw draw(seed);
  const Scene scene = column_in_street(draw);
  const std::vector<MemoryOrders> orders{{2, 0, 1, 2}, {2, 0, 1, 2},       {2, 1, 1, 2},
                                         {1, 0, 1, 2}, {2, 0, 1, 2, true}, {2, 0, 1, 3}};
  SimulationSettings settings = memory_settings(orders[draw.below(orders.size())]);
  settings.threads = 1 + static_cast<unsigned>(draw.below(3));
  if (draw.below(4) == 0) settings.most_remembered_bytes = draw.between(1e7, 6e7);
  MemoryTrial trial(scene, settings);
  REQUIRE(trial.own().cache() == CacheMode::exact);
  CAPTURE(seed);
  for (std::size_t index = 0; index < frames; ++index) {
    const Frame frame = scene.frame_at(static_cast<double>(index), index);
    // A frame that is not solved, in which all are elsewhere, and something may have moved and come back.
    if (draw.below(24) == 0) trial.own().move_to(scene.frame_at(static_cast<double>(draw.below(frames)), index));
    trial.advance(frame);
  }
  return trial.tally();
}

/// Three interactions, at steps at which nobody makes places for himself alone.
MemoryTally follow_fast_column(std::uint64_t seed, bool is_alone) {
  Draw draw(seed);
  Scene scene = small_street(draw);
  scene.add_transmitter(device_at("mast", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)), 30.0));
  constexpr std::size_t fast_frames = 90;
  add_column(draw, scene, fast_frames, straight_way, is_alone);
  SimulationSettings settings = memory_settings({2, 0, 1, 3});
  settings.threads = 1 + static_cast<unsigned>(draw.below(3));
  MemoryTrial trial(scene, settings);
  CAPTURE(seed);
  for (std::size_t index = 0; index < fast_frames; ++index)
    trial.advance(scene.frame_at(static_cast<double>(index), index));
  return trial.tally();
}

}  // namespace

TEST_CASE("what others knew of a place changes no bit, though transmitters move and frames are left out") {
  check_drives(40, follow_column);
}

TEST_CASE(
    "three interactions, driving fast: who follows goes through places, who is alone does not, and no bit changes") {
  for (const bool is_alone : {false, true}) {
    CAPTURE(is_alone);
    MemoryTally sum;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) sum += follow_fast_column(seed, is_alone);
    CHECK(sum.different == 0);
    CHECK(sum.paths > 10'000);
    CHECK((sum.work == sum.work_anew) == is_alone);  // as from scratch where nobody is in a place
  }
}

}  // namespace test_memory_of_columns
