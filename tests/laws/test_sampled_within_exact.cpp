/// Ray shooting finds some of the paths that the exhaustive search finds, never another one, and its rays serve all
/// transmitters at once.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_sampled_within_exact {

using namespace dcem;
using namespace dcem::test;

namespace {

struct RecallTally {
  double found = 0.0, all = 0.0;
  std::size_t paths_found = 0, paths = 0;
};

/// Every path of `sampled` is in `exact`, to the last bit.
void compare(const Scene& scene, const LinkResult& exact, const LinkResult& sampled, RecallTally& recall) {
  REQUIRE(exact.transmitter == sampled.transmitter);
  REQUIRE(exact.complete);
  CHECK_FALSE(sampled.complete);
  std::map<std::string, const PathContribution*> by_id;
  for (const PathContribution& path : exact.paths) {
    by_id[path_id(scene, path.path)] = &path;
    recall.all += path.power_ratio;
  }
  CHECK(by_id.size() == exact.paths.size());
  std::set<std::string> seen;
  for (const PathContribution& path : sampled.paths) {
    const std::string id = path_id(scene, path.path);
    CHECK_MESSAGE(seen.insert(id).second, "reported twice: " << id);
    const auto partner = by_id.find(id);
    REQUIRE_MESSAGE(partner != by_id.end(), "not in the exact set: " << id);
    CHECK(all_numbers(path) == all_numbers(*partner->second));
    recall.found += path.power_ratio;
  }
  recall.paths += exact.paths.size();
  recall.paths_found += sampled.paths.size();
}

void report(const std::string& name, const RecallTally& recall, double least) {
  MESSAGE(name << ": 2000 rays find " << recall.paths_found << " of " << recall.paths << " paths, with "
               << 100.0 * recall.found / recall.all << " % of the power");
  CHECK(recall.paths > 100);
  CHECK(recall.found >= least * recall.all);
}

/// The two simulators of a scenario.
struct Both {
  Simulator exact, sampled;

  explicit Both(const io::Scenario& scenario)
      : exact(scenario.scene, with(scenario.settings, Discovery::exact)),
        sampled(scenario.scene, with(scenario.settings, Discovery::sampled)) {}

  static SimulationSettings with(SimulationSettings settings, Discovery discovery) {
    settings.propagation.discovery = discovery;
    settings.propagation.cache = CacheMode::off;
    settings.propagation.rays = 2000;
    settings.threads = 1;
    return settings;
  }
};

io::Scenario data_scenario(const std::string& name) {
  return io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / name);
}

}  // namespace

TEST_CASE("sampled within exact: random rooms, three reflections") {
  RecallTally recall;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    const RandomRoom room = random_room(70'000 + seed, seed % 5, seed % 3);
    Scene scene = scene_through_files(room.patches);
    scene.add_transmitter(device_at("tx", room.transmitter_m, 0.0, antenna(PolarizationKind::dual)));
    scene.add_receiver(device_at("rx", room.receiver_m, 0.0, antenna(PolarizationKind::dual)));
    Simulator exact(scene, law_settings(3, 2)), sampled(scene, law_settings(3, 2, Discovery::sampled));
    compare(scene, exact.advance_to(0.0).links.at(0), sampled.advance_to(0.0).links.at(0), recall);
  }
  // Rooms are simple: a wall fills a large part of the sphere. What is missed is mostly small sheets far away.
  report("random rooms", recall, 0.95);
}

TEST_CASE("sampled within exact: the crossing") {
  const io::Scenario scenario = data_scenario("crossing_drive.json");
  Both both(scenario);
  RecallTally recall;
  for (std::size_t frame = 0; frame < scenario.time.frames; ++frame) {
    const FrameResult exact = both.exact.advance_to(scenario.time_s(frame), frame);
    const FrameResult sampled = both.sampled.advance_to(scenario.time_s(frame), frame);
    REQUIRE(exact.links.size() == sampled.links.size());
    for (std::size_t link = 0; link < exact.links.size(); ++link) {
      compare(scenario.scene, exact.links[link], sampled.links[link], recall);
    }
  }
  report("crossing", recall, 0.9);
}

TEST_CASE("sampled within exact: the office") {
  const io::Scenario scenario = data_scenario("office_map_coarse.json");
  Both both(scenario);
  std::vector<Device> receivers;
  for (const ReceiverGrid& grid : scenario.grids) {
    for (std::size_t row = 1; row < grid.rows(); row += 5) {
      for (std::size_t column = 1; column < grid.columns(); column += 5) {
        receivers.push_back(grid_receiver(grid, row, column));
      }
    }
  }
  REQUIRE(receivers.size() > 20);
  const auto exact = both.exact.solve(receivers), sampled = both.sampled.solve(receivers);
  REQUIRE(exact.size() == sampled.size());
  RecallTally recall;
  for (std::size_t link = 0; link < exact.size(); ++link) {
    compare(scenario.scene, exact[link], sampled[link], recall);
  }
  report("office", recall, 0.9);
}

TEST_CASE("the rays cast are the same for 1, 10 and 100 transmitters") {
  const RandomRoom room = random_room(81, 3, 1);
  std::set<std::uint64_t> rays;
  for (const int transmitters : {1, 10, 100}) {
    Dice dice(82);
    Scene scene = scene_through_files(room.patches);
    for (int index = 0; index < transmitters; ++index) {
      scene.add_transmitter(device_at("tx" + std::to_string(index), dice.inside(Vec3(0.2), room.size_m - 0.2)));
    }
    scene.add_receiver(device_at("rx", room.receiver_m));
    Simulator simulator(std::move(scene), law_settings(3, 2, Discovery::sampled));
    const FrameResult frame = simulator.advance_to(0.0);
    CHECK(frame.links.size() == static_cast<std::size_t>(transmitters));
    rays.insert(frame.work.rays);
  }
  CHECK(rays.size() == 1);
  CHECK(*rays.begin() >= 2000);
}

TEST_CASE("more rays find more, and the path set grows with every order limit") {
  const RandomRoom room = random_room(83, 5, 2);
  const Scene scene = scene_through_files(room.patches);
  const auto ids = [&](const SimulationSettings& settings) {
    std::set<std::string> result;
    for (const PathContribution& path : paths_between(scene, room.transmitter_m, room.receiver_m, settings)) {
      result.insert(path_id(scene, path.path));
    }
    return result;
  };
  const auto within = [](const std::set<std::string>& part, const std::set<std::string>& whole) {
    return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
  };
  for (int order = 1; order <= 4; ++order) {
    CHECK(within(ids(law_settings(order - 1, 2)), ids(law_settings(order, 2))));
    CHECK(within(ids(law_settings(3, order - 1)), ids(law_settings(3, order))));
  }
  std::vector<std::size_t> counts;
  for (const std::uint32_t rays : {30U, 300U, 3000U, 30'000U}) {
    SimulationSettings settings = law_settings(3, 2, Discovery::sampled);
    settings.propagation.rays = rays;
    counts.push_back(ids(settings).size());
  }
  // Each step has ten times the rays: by chance alone it will not find less.
  CHECK(std::is_sorted(counts.begin(), counts.end()));
  CHECK(counts.front() < counts.back());
}

}  // namespace test_sampled_within_exact
