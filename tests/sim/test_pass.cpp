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
io::Scenario town(const char* discovery, const char* cache) {
  io::ScenarioOverrides overrides;
  overrides.discovery = discovery;
  overrides.cache = cache;
  io::Scenario scenario = io::load_scenario(DCEM_DATA_DIR "/town_drive.json", overrides);
  Device rider = device_at("rider", Vec3(0.0), 20.0);
  rider.attachment = Attachment{"car2", Vec3(0, 0, 1.6), false};
  scenario.scene.add_transmitter(rider);
  scenario.settings.threads = 1;
  return scenario;
}

/// All of a frame but what a clock has measured, to the last bit: paths and, where they are asked for, counters of work
/// and how the tree was kept.
std::string bytes_of(const FrameResult& frame, bool counters) {
  io::ByteWriter writer;
  writer(frame.index, frame.time_s, frame.links);
  if (counters) writer(frame.work, frame.tree, frame.cache);
  return writer.bytes();
}

/// Passes some of the frames of a drive and solves the others; `counters`: these must be the same, too.
void check_behind_passed_frames(const io::Scenario& scenario, bool counters) {
  constexpr std::size_t frames = 10;
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
      const FrameResult own = simulator.advance(frame_at(index));
      CHECK((bytes_of(own, counters) == bytes_of(solved[index], counters)));
    }
  }
}

}  // namespace

TEST_CASE("behind frames that were passed every frame is what it would have been, every counter included") {
  check_behind_passed_frames(town("exact", "off"), true);
}

TEST_CASE("behind passed frames what is remembered begins anew, and every path is what it would have been") {
  check_behind_passed_frames(town("exact", "exact"), false);
}

TEST_CASE("frames are not passed where the cache would miss them") {
  const io::Scenario scenario = town("sampled", "seed");
  Simulator simulator(scenario.scene, scenario.settings);
  REQUIRE(simulator.cache() == CacheMode::seed);
  CHECK_THROWS_AS(simulator.pass(scenario.scene.frame_at(0.0), {}), std::logic_error);
}

}  // namespace test_pass
