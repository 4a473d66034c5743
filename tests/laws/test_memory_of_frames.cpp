/// Runs that are hard on what is remembered from frame to frame: jumps, stops, subdivided steps, frames in any order,
/// cut runs, maps in between, threads. In every frame the paths are those from scratch, bit for bit.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/paths/halves/small_town.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_of_frames {

using namespace dcem;
using namespace dcem::test;

namespace {

const MemoryOrders with_edges{2, 0, 1, 2};

TriangleMesh car(const std::string& material = "metal") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(-2, -0.9, 0.1), Vec3(2, 0.9, 1.5), material);
  return mesh;
}

/// A street between two rows of houses; without devices and cars.
Scene street() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-20, 6, 0), Vec3(-4, 14, 9), "metal");
  add_box_faces(mesh, Vec3(-1, 6, 0), Vec3(9, 14, 6), "metal");
  add_box_faces(mesh, Vec3(-15, -14, 0), Vec3(4, -6, 7), "opaque");
  return scene_of(mesh);
}

/// The street with a mast, a lamp, two cars, one of them with a sender, a post, and two who walk.
Scene busy_street(std::size_t frames) {
  Scene scene = street();
  scene.add_object("left", car(), straight_way(frames, Vec3(-14, -2, 0), Vec3(8, -1, 0)));
  scene.add_object("right", car("glass"), straight_way(frames, Vec3(12, 2, 0), Vec3(2, 3, 0)));
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  scene.add_transmitter(device_at("lamp", Vec3(14, 0, 5), 30.0));
  scene.add_transmitter(riding_device("sender", "left", Vec3(0, 0, 1.6)));
  scene.add_receiver(device_at("post", Vec3(6, -4, 1.2)));
  scene.add_receiver(moving_device("walker", straight_way(frames, Vec3(-9, 3, 1.5), Vec3(-6.5, 3.2, 1.5))));
  scene.add_receiver(moving_device("child", straight_way(frames, Vec3(3, -3, 1.1), Vec3(4, -2, 1.1))));
  scene.add_receiver(riding_device("passenger", "right", Vec3(0, 0, 1.6)));
  return scene;
}

void check_remembered(const MemoryTrial& trial) {
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().paths > trial.tally().frames);
  CHECK(trial.has_remembered());
}

}  // namespace

TEST_CASE("teleports, back and forth, stop and go") {
  Scene scene = street();
  scene.add_object("car", car(), way_of(40, [](double at) {
                     return Pose{Vec3(at < 10 ? at : 10 - 0.5 * (at - 10), 2, 0), std::floor(at / 13), 0, 0};
                   }));
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  scene.add_receiver(moving_device("jumps", way_of(40, [](double at) {
                                     return Pose{Vec3(std::fmod(at, 9) < 1 ? 7 : -8 + 0.05 * at, 1, 1.5), 0, 0, 0};
                                   })));
  scene.add_receiver(moving_device("to and fro", way_of(40, [](double at) {
                                     return Pose{Vec3(std::fmod(at, 2) < 1 ? 3 : 3.4, -2, 1.5), 0, 0, 0};
                                   })));
  scene.add_receiver(moving_device("stop and go", way_of(40, [](double at) {
                                     const double gone = std::fmod(at, 8) < 4 ? at - std::fmod(at, 8) : at - 4;
                                     return Pose{Vec3(-5 + 0.1 * gone, 3, 1.5), 0, 0, 0};
                                   })));
  MemoryTrial trial(scene, memory_settings(with_edges));
  trial.follow(40);
  check_remembered(trial);
}

TEST_CASE("ten small steps end in the bits of one large one") {
  const Scene scene = busy_street(12);
  MemoryTrial small(scene, memory_settings(with_edges)), large(scene, memory_settings(with_edges));
  for (std::size_t step = 0; step <= 60; ++step) {
    const FrameResult frame = small.advance_to(0.1 * static_cast<double>(step), step);
    if (step % 10 != 0) continue;
    const Frame same = scene.frame_at(0.1 * static_cast<double>(step), step);
    CHECK((bits(scene, large.advance(same).links) == bits(scene, frame.links)));
  }
  check_remembered(small);
}

TEST_CASE("frames in any order, with maps, links and other frames in between") {
  const Scene scene = busy_street(12);
  MemoryTrial trial(scene, memory_settings(with_edges));
  Draw draw(4);
  ReceiverGrid grid;
  grid.id = "grid";
  grid.origin_m = Vec3(-6, -2, 1.5);
  grid.count = {3, 2};
  const std::vector<Device> others{device_at("other", Vec3(1, 1, 1))};
  for (std::size_t index = 0; index < 40; ++index) {
    const double time_s = draw.below(3) == 0 ? draw.between(0, 11) : 0.2 * static_cast<double>(index);
    trial.advance_to(time_s, draw.below(100));
    if (draw.below(4) == 0) trial.own().radio_maps(grid);
    if (draw.below(4) == 0) trial.own().solve(others);
    if (draw.below(6) == 0) trial.own().move_to(scene.frame_at(draw.between(0, 11), index));
  }
  check_remembered(trial);
}

TEST_CASE("a run that is cut at any frame and gone on with") {
  constexpr std::size_t frames = 16;
  const Scene scene = busy_street(frames);
  const SimulationSettings settings = with_cache(memory_settings(with_edges), CacheMode::exact);
  const auto frame_at = [&](std::size_t index) { return scene.frame_at(0.5 * static_cast<double>(index), index); };
  std::vector<FrameResult> whole;
  Simulator all(scene, settings);
  for (std::size_t index = 0; index < frames; ++index) whole.push_back(all.advance(frame_at(index)));
  for (std::size_t cut = 1; cut < frames; ++cut) {
    CAPTURE(cut);
    Simulator simulator(scene, settings);
    const std::size_t first = cut % 3;  // some frames are solved, then some are passed, the rest is solved again
    for (std::size_t index = 0; index < frames; ++index) {
      if (index >= first && index < cut) {
        simulator.pass(frame_at(index), whole[index].work);
        continue;
      }
      CHECK((bits(scene, simulator.advance(frame_at(index)).links) == bits(scene, whole[index].links)));
    }
  }
  MemoryTrial trial(scene, memory_settings(with_edges));
  trial.follow(frames, 0.5);
  check_remembered(trial);
}

TEST_CASE("1, 2 and 5 threads, and devices in another order") {
  const Scene scene = busy_street(12);
  SimulationSettings settings = memory_settings(with_edges);
  const auto sorted = [](const Scene& of, const FrameResult& frame) {
    std::vector<std::string> links;
    for (const LinkResult& link : frame.links) links.push_back(of.receivers()[link.receiver].id + bits(of, link));
    std::ranges::sort(links);
    return links;
  };
  std::vector<std::vector<std::string>> expected;
  for (const unsigned threads : {1U, 2U, 5U}) {
    Scene shuffled = scene;
    std::vector<Device> receivers = shuffled.take_receivers();
    std::rotate(receivers.begin(), receivers.begin() + threads % 4, receivers.end());
    for (Device& receiver : receivers) shuffled.add_receiver(std::move(receiver));
    settings.threads = threads;
    MemoryTrial trial(shuffled, settings);
    for (std::size_t index = 0; index < 24; ++index) {
      const auto links = sorted(shuffled, trial.advance_to(0.4 * static_cast<double>(index), index));
      if (threads == 1) expected.push_back(links);
      CHECK((links == expected[index]));
    }
    check_remembered(trial);
  }
}

TEST_CASE("swapped ends have the same paths") {
  constexpr std::size_t frames = 20;
  const Vec3 mast_m(-22, 1, 9);
  const WaypointMotion way = straight_way(frames, Vec3(-6, 2, 1.5), Vec3(-3, 3, 1.5));
  Scene there = street(), back = street();
  for (Scene* scene : {&there, &back}) {
    scene->add_object("car", car(), straight_way(frames, Vec3(-14, -2, 0), Vec3(8, -1, 0)));
  }
  there.add_transmitter(device_at("mast", mast_m));
  there.add_receiver(moving_device("walker", way));
  back.add_transmitter(moving_device("walker", way));
  back.add_receiver(device_at("mast", mast_m));
  MemoryTrial one(there, memory_settings(with_edges)), other(back, memory_settings(with_edges));
  const auto touched = [](const FrameResult& frame, bool turned) {
    std::multiset<std::vector<std::uint32_t>> all;
    for (const PathContribution& path : frame.links.at(0).paths) {
      std::vector<std::uint32_t> names;
      for (const SequenceElement element : sequence_of(path.path)) names.push_back(element.code());
      if (turned) std::ranges::reverse(names);
      all.insert(names);
    }
    return all;
  };
  for (std::size_t index = 0; index < frames; ++index) {
    const double time_s = static_cast<double>(index);
    CHECK((touched(one.advance_to(time_s, index), false) == touched(other.advance_to(time_s, index), true)));
  }
  check_remembered(one);
  CHECK(other.tally().different == 0);  // nothing is kept of a link whose transmitter moves, but what it may see
}

TEST_CASE("a vehicle passes a parked pair at walking pace; between vehicles; a mast that moves") {
  constexpr std::size_t frames = 40;
  Scene scene = street();
  for (const char* name : {"first", "second", "third"}) {
    const double x = name[0] == 'f' ? -6 : name[0] == 's' ? 7 : 0;
    scene.add_object(name, car(), LinearMotion{{Vec3(x, 4, 0), 0.1 * x, 0, 0}});
  }
  scene.add_object("passes", car(), straight_way(frames, Vec3(-4, 1.5, 0), Vec3(1.5, 1.5, 0)));
  scene.add_object("follows", car("glass"), straight_way(frames, Vec3(-9, 1.6, 0), Vec3(-3.5, 1.4, 0)));
  scene.add_transmitter(riding_device("parked", "first", Vec3(0, 0, 1.6)));
  scene.add_transmitter(riding_device("drives", "passes", Vec3(0, 0, 1.6)));
  scene.add_transmitter(moving_device("hoist", straight_way(frames, Vec3(-22, 1, 7), Vec3(-22, 1.5, 11))));
  scene.add_receiver(riding_device("opposite", "second", Vec3(0, 0.2, 1.55)));
  scene.add_receiver(riding_device("behind", "follows", Vec3(0, 0, 1.6), true));
  scene.add_receiver(device_at("post", Vec3(5, -4, 1.2)));
  MemoryTrial trial(scene, memory_settings({2, 1, 1, 2}));
  trial.follow(frames);
  check_remembered(trial);
  CHECK(trial.tally().taken_over > 100);
}

TEST_CASE("what turns on the spot, or changes its speed alone") {
  constexpr std::size_t frames = 12;
  Scene scene = street();
  scene.add_object("car", car(), LinearMotion{{Vec3(2, 1, 0), 0, 0, 0}});
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  scene.add_transmitter(riding_device("top", "car", Vec3(0, 0, 1.6)));
  scene.add_receiver(device_at("post", Vec3(6, -4, 1.2)));
  Device aerial = moving_device("turns", way_of(frames, [](double at) {
                                  return Pose{Vec3(-8, 0, 2), at < 3 ? 0.0 : 0.3 * std::floor(at / 2), 0.1, 0};
                                }));
  aerial.antenna = antenna(PolarizationKind::horizontal);
  scene.add_receiver(aerial);
  MemoryTrial trial(scene, memory_settings(with_edges));
  for (std::size_t index = 0; index < frames; ++index) {
    Frame frame = scene.frame_at(static_cast<double>(index), index);
    Placement& placement = frame.bodies[1].placement;
    placement.velocity.linear_mps = Vec3(index < 4 ? 0.0 : 0.5 * static_cast<double>(index / 2), 0, 0);
    placement.pose.yaw_rad = index < 8 ? 0.0 : 0.2 * static_cast<double>(index);
    trial.advance(frame);
  }
  check_remembered(trial);
  CHECK(trial.tally().taken_over > 0);
}

TEST_CASE("objects that come, go, and take each other's places, with and without devices on them") {
  Scene scene = street();
  scene.add_object("barrier", car("glass"), LinearMotion{{Vec3(-3, -3, 0), 1.5, 0, 0}});
  scene.add_body_pool(3, car());
  scene.add_transmitter(device_at("mast", Vec3(-22, 1, 9), 30.0));
  scene.add_transmitter(riding_device("of a", "a", Vec3(0, 0, 1.6)));
  scene.add_receiver(device_at("post", Vec3(6, -4, 1.2)));
  scene.add_receiver(riding_device("of b", "b", Vec3(0, 0, 1.6)));
  scene.add_receiver(moving_device("walker", straight_way(60, Vec3(-9, 3, 1.5), Vec3(-6.5, 3.2, 1.5))));
  MemoryTrial trial(scene, memory_settings(with_edges));
  Draw draw(8);
  std::vector<std::string> places(3);
  Frame frame = scene.frame_at(0.0);
  for (std::size_t index = 0; index < 60; ++index) {
    frame.index = index;
    frame.time_s = 0.5 * static_cast<double>(index / 3);
    if (draw.below(3) == 0) {
      std::vector<std::string> names{"a", "b", "c", "", ""};
      for (std::string& place : places) {
        const std::size_t name = draw.below(names.size());
        place = names[name];
        names.erase(names.begin() + static_cast<std::ptrdiff_t>(name));
      }
    }
    for (std::size_t place = 0; place < places.size(); ++place) {
      BodyState& state = frame.bodies[2 + place];
      state.present = !places[place].empty();
      state.occupant = places[place];
      const double along = 5.0 * static_cast<double>(place) + (draw.below(3) == 0 ? 0.1 : 0.0);
      state.placement.pose = Pose{Vec3(-5 + along, 1, 0), 0, 0, 0};
    }
    frame.bodies[1].present = draw.below(5) != 0;
    trial.advance(frame);
  }
  check_remembered(trial);
  CHECK(trial.tally().taken_over > 100);
}

TEST_CASE(
    "every kind of search and of output: two edges, three interactions, diffuse power, elements, a floor of gain") {
  constexpr std::size_t frames = 10;
  const auto check = [&](const MemoryOrders& orders, auto&& change) {
    Scene scene = busy_street(frames);
    Device panel = moving_device("panel", straight_way(frames, Vec3(6, 4, 3), Vec3(6.3, 4, 3)));
    panel.antenna.array = {2, 2, 0.5};
    scene.add_receiver(panel);
    SimulationSettings settings = memory_settings(orders);
    change(settings.propagation);
    MemoryTrial trial(scene, settings);
    for (std::size_t index = 0; index < frames; ++index) {
      const double time_s = static_cast<double>(index < 4 ? index : index - index % 2);  // some frames are alike
      trial.advance_to(time_s, index);
    }
    CHECK(trial.tally().different == 0);
    CHECK(trial.tally().taken_over > 0);
  };
  check({1, 0, 2, 2, true}, [](PropagationSettings&) {});
  check({2, 0, 1, 3}, [](PropagationSettings&) {});
  check({1, 2, 1, 2}, [](PropagationSettings& propagation) {
    propagation.diffuse.enabled = true;
    propagation.diffuse.tile_budget = 200;
  });
  check({2, 1, 1, 2}, [](PropagationSettings& propagation) { propagation.min_path_gain_db = -85.0; });
  check({2, 1, 1, 2}, [](PropagationSettings& propagation) { propagation.max_path_length_m = 20.0; });
  check({2, 1, 1, 2}, [](PropagationSettings& propagation) { propagation.line_of_sight = false; });
  check({1, 0, 0, 1}, [](PropagationSettings&) {});
  check({0, 1, 1, 1},
        [](PropagationSettings& propagation) { propagation.diffraction.region = DiffractionRegion::shadow; });
  check({0, 2, 0, 0}, [](PropagationSettings&) {});
  check({2, 1, 1, 2}, [](PropagationSettings& propagation) { propagation.antenna_array = ArrayChannel::exact; });
}

}  // namespace test_memory_of_frames
