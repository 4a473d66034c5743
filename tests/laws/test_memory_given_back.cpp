/// What is remembered of devices that have left is given back: a run of an hour takes what those take that are there.
#include <doctest/doctest.h>
#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tests/paths/halves/small_town.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_given_back {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t vehicles = 24, frames_each = 8, at_a_time = 2;

/// A street with a mast, through which vehicles with a device each come one after the other, two at a time.
Scene street() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-20, 6, 0), Vec3(-4, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-15, -14, 0), Vec3(4, -6, 7), "opaque");
  Scene scene = scene_of(mesh);
  TriangleMesh car;
  add_box_faces(car, Vec3(-2, -0.9, 0.1), Vec3(2, 0.9, 1.5), "metal");
  scene.add_body_pool(at_a_time, car);
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  for (std::size_t vehicle = 0; vehicle < vehicles; ++vehicle) {
    const std::string name = "v" + std::to_string(vehicle);
    scene.add_transmitter(riding_device(name, name, Vec3(0, 0, 1.6)));
    scene.add_receiver(riding_device(name, name, Vec3(0, 0, 1.6)));
  }
  return scene;
}

/// Each vehicle drives for the first half of its time, and then stands.
Frame frame_of(const Scene& scene, std::size_t index) {
  Frame frame = scene.frame_at(static_cast<double>(index), index);
  const std::size_t first = at_a_time * (index / frames_each), age = index % frames_each;
  for (std::size_t place = 0; place < at_a_time; ++place) {
    BodyState& state = frame.bodies[1 + place];
    state.present = true;
    state.occupant = "v" + std::to_string(first + place);
    const double gone_m = 0.2 * static_cast<double>(std::min(age, frames_each / 2));
    state.placement.pose = Pose{Vec3(-6.0 + 8.0 * static_cast<double>(place) + gone_m, 1.0, 0.0), 0, 0, 0};
  }
  return frame;
}

/// What has been asked for and not given back, by the one thread there is.
double held_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

/// False where a checker of memory answers for malloc.
bool is_told() {
  constexpr std::size_t size_bytes = 1 << 20;
  const double before = held_bytes();
  const std::vector<char> block(size_bytes, 1);
  return held_bytes() - before >= static_cast<double>(block.size());
}

/// Held at the end of the time of each pair of vehicles.
std::vector<double> held_by_pair(double most_bytes) {
  const Scene scene = street();
  SimulationSettings settings = with_cache(memory_settings({2, 0, 1, 2}), CacheMode::exact);
  settings.most_remembered_bytes = most_bytes;
  Simulator simulator(scene, settings);
  std::vector<double> held;
  const double before = held_bytes();
  for (std::size_t index = 0; index < vehicles / at_a_time * frames_each; ++index) {
    const FrameResult frame = simulator.advance(frame_of(scene, index));
    REQUIRE(frame.links.size() == at_a_time * at_a_time);
    if (index % frames_each == frames_each - 1) held.push_back(held_bytes() - before);
  }
  return held;
}

constexpr double view_bytes = 6.0 * 128 * 128 * sizeof(float);  ///< the least of what is known of one device

}  // namespace

TEST_CASE("what is remembered of vehicles that have left is given back") {
  if (!is_told()) {
    MESSAGE("skipped: a checker of memory answers for malloc");
    return;
  }
  for (const double most_bytes : {std::numeric_limits<double>::infinity(), 10e6, 0.0}) {
    CAPTURE(most_bytes);
    const std::vector<double> held = held_by_pair(most_bytes);
    // All pairs do the same: what the last ones hold is what the second ones do.
    CHECK(held.back() - held[1] < view_bytes);
    CHECK(held[1] > at_a_time * view_bytes);
  }
}

TEST_CASE("of those that are there, the first ones are remembered, whoever has left") {
  const Scene scene = street();
  SimulationSettings settings = with_cache(memory_settings({2, 0, 1, 2}), CacheMode::exact);
  settings.most_remembered_bytes = 20e6;  // two, and what stands, but not three
  Simulator few(scene, settings);
  settings.most_remembered_bytes = std::numeric_limits<double>::infinity();
  Simulator all(scene, settings);
  for (std::size_t index = 0; index < vehicles / at_a_time * frames_each; ++index) {
    const Frame frame = frame_of(scene, index);
    const FrameResult own = few.advance(frame), expected = all.advance(frame);
    CHECK((bits(scene, own.links) == bits(scene, expected.links)));
    CHECK(work_of(own) == work_of(expected));
    CHECK(own.cache.taken_over == expected.cache.taken_over);
  }
}

}  // namespace test_memory_given_back
