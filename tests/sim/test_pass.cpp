/// Frames whose results are known already: the simulator goes past them, and stands as if it had solved them.
#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "dcem/io/src/results/frame_archive.hpp"
#include "dcem/sim/simulator.hpp"

namespace test_pass {

using namespace dcem;

namespace {

/// A town with twelve cars, a transmitter in the street and one on a roof, and beside them one that rides on a car:
/// what is kept of a transmitter differs with how it moves.
io::Scenario town(const std::vector<std::string>& discovery = {}) {
  io::ScenarioOverrides overrides;
  if (!discovery.empty()) overrides.discovery = discovery[0];
  io::Scenario scenario = io::load_scenario(DCEM_DATA_DIR "/town_drive.json", overrides);
  Device rider = device_at("rider", Vec3(0.0), 20.0);
  rider.attachment = Attachment{"car2", Vec3(0, 0, 1.6), false};
  scenario.scene.add_transmitter(rider);
  scenario.settings.threads = 1;
  return scenario;
}

/// All of a frame but what a clock has measured, to the last bit: paths, counters of work, how the tree was kept.
std::string bytes_of(const FrameResult& frame) {
  io::ByteWriter writer;
  writer(frame.index, frame.time_s, frame.links, frame.work, frame.tree, frame.cache);
  return writer.bytes();
}

}  // namespace

TEST_CASE("behind frames that were passed every frame is what it would have been, every counter included") {
  constexpr std::size_t frames = 10;
  const io::Scenario scenario = town();
  const auto frame_at = [&](std::size_t index) { return scenario.scene.frame_at(scenario.time_s(index), index); };
  std::vector<FrameResult> solved;
  Simulator all(scenario.scene, scenario.settings);
  for (std::size_t index = 0; index < frames; ++index) solved.push_back(all.advance(frame_at(index)));
  REQUIRE(all.plan().joined > 0);  // otherwise there is nothing to keep of a transmitter
  for (const std::size_t known : {std::size_t{1}, std::size_t{4}, frames - 1}) {
    CAPTURE(known);
    Simulator simulator(scenario.scene, scenario.settings);
    for (std::size_t index = 0; index < known; ++index) {
      CHECK(simulator.pass(frame_at(index), solved[index].work) == solved[index].tree);
    }
    for (std::size_t index = known; index < frames; ++index) {
      CAPTURE(index);
      CHECK((bytes_of(simulator.advance(frame_at(index))) == bytes_of(solved[index])));
    }
  }
}

TEST_CASE("frames are not passed where the cache would miss them") {
  const io::Scenario scenario = town({"sampled"});
  Simulator simulator(scenario.scene, scenario.settings);
  REQUIRE(simulator.cache() == CacheMode::seed);
  CHECK_THROWS_AS(simulator.pass(scenario.scene.frame_at(0.0), {}), std::logic_error);
}

}  // namespace test_pass
