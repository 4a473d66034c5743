/// One question, one answer: whatever the number of threads, the order of the devices, the tree or what was solved
/// before.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "dcem/accel/binary_index.hpp"
#include "dcem/sim/verify/brute_force_simulator.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_determinism {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t transmitters = 4, receivers = 7;

/// A room with sheets and boxes, through which two objects move and turn; one carries devices of both kinds.
Scene moving_scene(const std::vector<std::size_t>& transmitter_order, const std::vector<std::size_t>& receiver_order,
                   std::optional<double> frozen_at_s = std::nullopt) {
  const RandomRoom room = random_room(91, 4, 1);
  const Patches box = box_faces(Vec3(-0.5, -0.3, -0.2), Vec3(0.5, 0.3, 0.2), "pec");
  const Vec3 middle = 0.5 * room.size_m;
  const WaypointMotion turning{{{0.0, {middle - 1.0, 0.1, 0.0, 0.0}}, {1.0, {middle + 0.9, 2.5, 0.2, -0.1}}}};
  const LinearMotion straight{{0.6 * middle, 0.3, 0.0, 0.0}, Vec3(0.7, -0.4, 0.1), 0.0};
  const auto motion = [&](const Motion& moving) {
    return frozen_at_s ? Motion(LinearMotion{placement_at(moving, *frozen_at_s).pose, Vec3(0.0), 0.0}) : moving;
  };
  Scene scene = scene_through_files(
      room.patches, {{"turning", box, motion(turning)},
                     {"curtain", {sheet(Vec3(0), Vec3(0, 1, 0.1), Vec3(0.2, 0, 1), "glass")}, motion(straight)}});
  Dice dice(92);
  std::vector<Device> sending, receiving;
  const std::vector<PolarizationKind> kinds{PolarizationKind::vertical, PolarizationKind::dual,
                                            PolarizationKind::right_circular};
  for (std::size_t index = 0; index < transmitters + receivers; ++index) {
    Device device = device_at("device" + std::to_string(index), dice.inside(Vec3(0.2), room.size_m - 0.2),
                              dice.between(0.0, 30.0), antenna(kinds[index % kinds.size()]));
    if (index % 5 == 3) device.attachment = Attachment{"turning", Vec3(0.1, 0.2, 0.4), index % 2 == 0};
    (index < transmitters ? sending : receiving).push_back(device);
  }
  for (const std::size_t index : transmitter_order) scene.add_transmitter(sending[index]);
  for (const std::size_t index : receiver_order) scene.add_receiver(receiving[index]);
  return scene;
}

std::vector<std::size_t> counted(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

/// All bytes of some frames, by frame, transmitter and receiver.
using Bytes = std::map<std::string, std::string>;

void add_bytes(Bytes& bytes, const Scene& scene, const FrameResult& frame) {
  for (const LinkResult& link : frame.links) {
    const std::string key = std::to_string(frame.index) + " " + scene.transmitters()[link.transmitter].id + " " +
                            scene.receivers()[link.receiver].id;
    CHECK(bytes.emplace(key, bits(scene, link)).second);
  }
}

/// How paths are found, and what is remembered from frame to frame.
struct Way {
  Discovery discovery;
  CacheMode cache;
};

constexpr Way without_memory[]{{Discovery::exact, CacheMode::off}, {Discovery::sampled, CacheMode::off}};
constexpr Way seeded{Discovery::sampled, CacheMode::seed};
constexpr Way all_ways[]{without_memory[0], without_memory[1], seeded};

SimulationSettings settings_of(const Way& way) {
  SimulationSettings settings = law_settings(3, 2, way.discovery);
  settings.propagation.cache = way.cache;
  return settings;
}

template <typename Index>
Bytes run(Scene scene, const Way& way, unsigned threads, std::vector<std::size_t> frames,
          std::vector<std::uint64_t>* work = nullptr) {
  SimulationSettings settings = settings_of(way);
  settings.propagation.rays = 500;
  settings.threads = threads;
  BasicSimulator<MaterialTable, Index> simulator(std::move(scene), settings);
  Bytes bytes;
  for (const std::size_t index : frames) {
    const FrameResult frame = simulator.advance_to(0.23 * static_cast<double>(index), index);
    add_bytes(bytes, simulator.scene(), frame);
    if (work != nullptr) {
      const WorkCounters& w = frame.work;
      work->insert(work->end(), {w.rays, w.legs, w.sequences_proposed, w.sequences_solved, w.paths, w.nodes_visited,
                                 w.primitives_tested});
    }
  }
  return bytes;
}

Scene ordered_scene() {
  return moving_scene(counted(transmitters), counted(receivers));
}

const std::vector<std::size_t> all_frames{0, 1, 2, 3};

}  // namespace

TEST_CASE("determinism: 1, 2 and 5 threads, and twice in a row, give the same bits and the same counts of work") {
  for (const Way& way : all_ways) {
    std::vector<std::uint64_t> work;
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames, &work);
    CHECK(expected.size() == all_frames.size() * transmitters * receivers);
    for (const unsigned threads : {1U, 2U, 5U}) {
      std::vector<std::uint64_t> other_work;
      CHECK(run<WideIndex>(ordered_scene(), way, threads, all_frames, &other_work) == expected);
      CHECK(other_work == work);
    }
  }
}

TEST_CASE("determinism: the order of transmitters and receivers changes no bit of any link") {
  Dice dice(93);
  for (const Way& way : all_ways) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    for (int trial = 0; trial < 3; ++trial) {
      std::vector<std::size_t> sending = counted(transmitters), receiving = counted(receivers);
      dice.shuffle(sending);
      dice.shuffle(receiving);
      CHECK(run<WideIndex>(moving_scene(sending, receiving), way, 2, all_frames) == expected);
    }
  }
}

TEST_CASE("determinism: a subset of the devices gives the same links") {
  for (const Way& way : {without_memory[1], seeded}) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    const Bytes some = run<WideIndex>(moving_scene({2}, {5, 1}), way, 1, all_frames);
    CHECK(some.size() == 2 * all_frames.size());
    for (const auto& [key, bytes] : some) CHECK(expected.at(key) == bytes);
  }
}

TEST_CASE("determinism: without a memory a frame does not depend on the frames before it") {
  for (const Way& way : without_memory) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    Bytes backwards = run<WideIndex>(ordered_scene(), way, 1, {3, 1, 2, 0});
    CHECK(backwards == expected);
    Bytes single;
    for (const std::size_t frame : all_frames) single.merge(run<WideIndex>(ordered_scene(), way, 1, {frame}));
    CHECK(single == expected);
  }
}

TEST_CASE("determinism: an object that came to a place is as one that always stood there") {
  const auto without_doppler = [](const FrameResult& frame, const Scene& scene) {
    Bytes bytes;
    for (const LinkResult& link : frame.links) {
      std::string& text = bytes[scene.transmitters()[link.transmitter].id + scene.receivers()[link.receiver].id];
      for (PathContribution path : link.paths) {
        path.doppler_hz = 0.0;
        text += path_id(scene, path.path);
        append_bits(text, all_numbers(path));
      }
    }
    return bytes;
  };
  for (const Way& way : without_memory) {
    Simulator moving(ordered_scene(), settings_of(way));
    for (const std::size_t frame : all_frames) {
      const double time_s = 0.23 * static_cast<double>(frame);
      Simulator standing(moving_scene(counted(transmitters), counted(receivers), time_s), settings_of(way));
      CHECK(without_doppler(moving.advance_to(time_s, frame), moving.scene()) ==
            without_doppler(standing.advance_to(time_s, frame), standing.scene()));
    }
  }
}

TEST_CASE("determinism: the tree changes the work and nothing else") {
  for (const Way& way : all_ways) {
    const Bytes expected = run<BruteForceIndex>(ordered_scene(), way, 1, all_frames);
    CHECK(run<WideIndex>(ordered_scene(), way, 1, all_frames) == expected);
    CHECK(run<BinaryIndex>(ordered_scene(), way, 1, all_frames) == expected);
  }
}

}  // namespace test_determinism
