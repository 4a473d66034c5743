#pragma once
/// A room through which things move, solved in every way that there is: all bytes of some frames.
#include <doctest/doctest.h>

#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/sim/basic_simulator.hpp"
#include "tests/support/law_scenes.hpp"

namespace moving_room {

using namespace dcem;
using namespace dcem::test;

inline constexpr std::size_t transmitters = 4, receivers = 7;

/// A room with sheets and boxes, through which two objects move and turn; one carries devices of both kinds.
inline Scene moving_scene(const std::vector<std::size_t>& transmitter_order,
                          const std::vector<std::size_t>& receiver_order,
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

inline std::vector<std::size_t> counted(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

/// All bytes of some frames, by frame, transmitter and receiver.
using Bytes = std::map<std::string, std::string>;

inline void add_bytes(Bytes& bytes, const Scene& scene, const FrameResult& frame) {
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

inline constexpr Way without_memory[]{{Discovery::exact, CacheMode::off}, {Discovery::sampled, CacheMode::off}};
inline constexpr Way seeded{Discovery::sampled, CacheMode::seed};
inline constexpr Way all_ways[]{without_memory[0], without_memory[1], seeded};

inline SimulationSettings settings_of(const Way& way) {
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

inline Scene ordered_scene() {
  return moving_scene(counted(transmitters), counted(receivers));
}

inline const std::vector<std::size_t> all_frames{0, 1, 2, 3};

}  // namespace moving_room
