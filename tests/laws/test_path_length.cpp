/// `max_path_length_m` takes away the paths that are longer, nothing else and no bit of the others, however paths are
/// found; and what is longer is not looked for.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_path_length {

using namespace dcem;
using namespace dcem::test;

namespace {

io::Scenario town(int interactions, Discovery discovery = Discovery::automatic) {
  io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
  PropagationSettings& propagation = scenario.settings.propagation;
  propagation.discovery = discovery;
  propagation.cache = CacheMode::off;
  propagation.max_interactions = interactions;
  scenario.settings.threads = 1;
  return scenario;
}

FrameResult frame_of(const io::Scenario& scenario, double time_s, std::optional<double> longest_m) {
  SimulationSettings settings = scenario.settings;
  settings.propagation.max_path_length_m = longest_m;
  Simulator simulator(scenario.scene, settings);
  return simulator.advance_to(time_s);
}

struct Tally {
  std::size_t kept = 0, dropped = 0;
};

/// The numbers of a link's paths that are no longer than this.
std::vector<double> numbers_of(const LinkResult& link, double longest_m, Tally* tally = nullptr) {
  std::vector<double> numbers;
  for (const PathContribution& path : link.paths) {
    const bool is_kept = path.path.length_m <= longest_m;
    if (tally != nullptr) ++(is_kept ? tally->kept : tally->dropped);
    if (!is_kept) continue;
    const auto own = all_numbers(path);
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
  return numbers;
}

/// Holds a frame with the bound against the same one without.
Tally check_bound(const io::Scenario& scenario, double time_s, double longest_m) {
  constexpr double unbounded = std::numeric_limits<double>::infinity();
  const FrameResult all = frame_of(scenario, time_s, std::nullopt), bounded = frame_of(scenario, time_s, longest_m);
  Tally tally;
  REQUIRE(all.links.size() == bounded.links.size());
  for (std::size_t link = 0; link < all.links.size(); ++link) {
    CAPTURE(link);
    CHECK(numbers_of(bounded.links[link], unbounded) == numbers_of(all.links[link], longest_m, &tally));
    CHECK(bounded.links[link].statistics.path_count == bounded.links[link].paths.size());
    CHECK(bounded.links[link].statistics.line_of_sight == all.links[link].statistics.line_of_sight);
    CHECK(bounded.links[link].complete == all.links[link].complete);
  }
  return tally;
}

}  // namespace

TEST_CASE("a bound on lengths leaves the shorter paths as they are: exact search of one, two and three interactions") {
  for (const int interactions : {1, 2, 3}) {
    Tally tally;
    for (const double longest_m : {40.0, 75.0, 110.0}) {
      CAPTURE(interactions);
      CAPTURE(longest_m);
      const Tally of_one = check_bound(town(interactions), 4.0, longest_m);
      tally.kept += of_one.kept;
      tally.dropped += of_one.dropped;
    }
    CHECK(tally.kept > 50);
    CHECK(tally.dropped > 50);
  }
}

TEST_CASE("a bound on lengths leaves the shorter paths as they are: rays, and all sequences of a small scene") {
  io::Scenario rays = town(3, Discovery::sampled);
  rays.settings.propagation.rays = 5000;
  const Tally sampled = check_bound(rays, 4.0, 75.0);
  CHECK(sampled.kept > 20);
  CHECK(sampled.dropped > 20);
  io::Scenario yard = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "first_path.json");
  yard.settings.propagation.cache = CacheMode::off;
  REQUIRE(yard.scene.surface_count() < exact_discovery_facet_limit);
  const Tally tried = check_bound(yard, 0.0, 60.0);
  CHECK(tried.kept > 5);
  CHECK(tried.dropped > 5);
}

TEST_CASE("a path that is just as long as it may be is there, one a bit longer is not") {
  const io::Scenario scenario = town(2);
  const FrameResult all = frame_of(scenario, 4.0, std::nullopt);
  std::size_t tried = 0;
  for (const PathContribution& path : all.links.at(0).paths) {
    if (++tried % 4 != 0) continue;  // some of them
    const double length_m = path.path.length_m;
    const auto count = [&](double longest_m) { return frame_of(scenario, 4.0, longest_m).links.at(0).paths.size(); };
    CHECK(count(length_m) > count(std::nextafter(length_m, 0.0)));
  }
  CHECK(tried > 4);
}

TEST_CASE("longer paths are not looked for: less is solved, and far less of what is far away is seen") {
  const io::Scenario scenario = town(2);
  const WorkCounters all = frame_of(scenario, 4.0, std::nullopt).work, bounded = frame_of(scenario, 4.0, 60.0).work;
  CHECK(2 * bounded.sequences_solved < all.sequences_solved);
  CHECK(2 * bounded.legs < all.legs);
}

TEST_CASE("the points of a map have the bound of a run") {
  io::Scenario scenario = town(2);
  scenario.settings.propagation.max_path_length_m = 70.0;
  ReceiverGrid grid;
  grid.id = "map";
  grid.spacing_m = {2.0, 1.5};
  grid.count = {6, 5};
  grid.origin_m = scenario.scene.device_state(scenario.scene.receivers()[0], scenario.scene.frame_at(4.0)).position_m +
                  Vec3(-6.0, -3.0, 0.0);
  Simulator simulator(scenario.scene, scenario.settings);
  simulator.move_to(simulator.scene().frame_at(4.0));
  const std::vector<RadioMap> maps = simulator.radio_maps(grid);
  std::vector<Device> points;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    points.push_back(grid_receiver(grid, cell / grid.columns(), cell % grid.columns()));
  }
  std::size_t found = 0;
  for (const LinkResult& link : simulator.solve(points)) {
    const RadioMapPoint& point = maps.at(link.transmitter).points.at(link.receiver);
    for (const PathContribution& path : link.paths) CHECK(path.path.length_m <= 70.0);
    if (point.obstructed) continue;
    CHECK(point.statistics.path_count == link.statistics.path_count);
    CHECK(point.statistics.power_dbm == link.statistics.power_dbm);
    found += link.paths.size();
  }
  CHECK(found > 50);
}

}  // namespace test_path_length
